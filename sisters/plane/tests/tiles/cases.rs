//! How many cases property tests have.

/// The configuration of a property test of `n` cases: the same cases in every run, unless
/// `CASCA_SEED` is set; `CASCA_CASES` multiplies their number.
pub fn cases(n: u32) -> proptest::test_runner::Config {
    let from_env = |name: &str| std::env::var(name).ok().and_then(|v| v.parse::<u64>().ok());
    proptest::test_runner::Config {
        cases: n.saturating_mul(from_env("CASCA_CASES").unwrap_or(1).min(100_000) as u32),
        rng_seed: proptest::test_runner::RngSeed::Fixed(from_env("CASCA_SEED").unwrap_or(1)),
        failure_persistence: None,
        ..proptest::test_runner::Config::default()
    }
}
