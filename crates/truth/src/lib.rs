//! What casca is judged by. Nothing here is part of the library's API.
//!
//! - [`oracle`]: exact visibility, which shares no code with the
//!   library.
//! - [`baselines`]: what engines do today, for comparison.
//! - [`places`]: coordinates of random tests, half of them from a small lattice.
//! - `attack` (a feature): random operations on small scenes, against a model of the truth.

#[cfg(feature = "attack")]
pub mod attack;
pub mod baselines;
mod numeric;
pub mod oracle;
pub mod places;

/// The configuration of a property test of `n` cases: the same cases in every
/// run, unless `CASCA_SEED` is set; `CASCA_CASES` multiplies their number.
#[cfg(feature = "proptest")]
pub fn cases(n: u32) -> proptest::test_runner::Config {
    let from_env = |name: &str| std::env::var(name).ok().and_then(|v| v.parse::<u64>().ok());
    proptest::test_runner::Config {
        cases: n.saturating_mul(from_env("CASCA_CASES").unwrap_or(1).min(100_000) as u32),
        rng_seed: proptest::test_runner::RngSeed::Fixed(from_env("CASCA_SEED").unwrap_or(1)),
        failure_persistence: None,
        ..proptest::test_runner::Config::default()
    }
}
