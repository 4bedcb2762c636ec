//! Test scenes, exact visibility and pictures for casca's tests, benches, fuzz targets and viewer,
//! and for the program `casca-lab`. Nothing here is part of the library's API.
//!
//! - [`world`]: what a test scene is: objects, their motion, a camera path.
//! - [`scenes`]: the procedural scenes, seeded.
//! - [`import`]: scenes from glTF 2.0 files.
//! - [`lit`]: scenes with materials and lights.
//! - [`export`]: scenes written as such files.
//! - [`oracle`]: exact visibility, which shares no code with the library.
//! - `attack` (a feature): random operations on small scenes, against a model of the truth.
//! - [`baselines`]: what engines do today, for comparison.
//! - [`drive`]: a test scene put into the library, frame by frame.
//! - [`command_line`]: what the command lines share.
//! - `lab` (the feature `experiments`): the experiments of the report.
//! - [`measure`]: what benches share.
//! - `pictures` (a feature): charts and views from above.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

#[cfg(feature = "attack")]
pub mod attack;
pub mod baselines;
pub mod command_line;
pub mod drive;
pub mod export;
pub mod import;
#[cfg(feature = "experiments")]
pub mod lab;
pub mod lit;
pub mod measure;
pub mod oracle;
#[cfg(feature = "pictures")]
pub mod pictures;
pub mod scenes;
pub mod world;

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
