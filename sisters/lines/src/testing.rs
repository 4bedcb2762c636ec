//! The configuration of property tests.

/// `n` cases, the same in every run. `CASCA_CASES` multiplies their number.
pub fn cases(n: u32) -> proptest::test_runner::Config {
    let factor = std::env::var("CASCA_CASES").ok().and_then(|v| v.parse::<u32>().ok()).unwrap_or(1);
    proptest::test_runner::Config {
        cases: n.saturating_mul(factor.min(100_000)),
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..proptest::test_runner::Config::default()
    }
}
