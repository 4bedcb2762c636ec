//! The points of a point cloud that an eye can see.
//!
//! Points hide nothing by themselves. They are taken as samples of a surface that nobody knows, so every answer here is an
//! estimate, and none is conservative. Two kinds of errors are counted apart: a *false visible* point is reported though the
//! surface hides it, a *false hidden* point is left out though it can be seen.
//!
//! - [`hpr`]: hidden point removal: points are turned inside out around the eye, and those on their convex hull are visible.
//! - [`cluster`]: the same for one representative of each cell of a grid or octree.
//! - [`hull`]: the extreme points of the convex hull of any points, exactly.

pub mod cluster;
pub mod hpr;
pub mod hull;
mod numeric;

/// The configuration of a property test of `n` cases: the same in every run. `CASCA_CASES` multiplies their number.
#[cfg(test)]
fn cases(n: u32) -> proptest::test_runner::Config {
    let factor = std::env::var("CASCA_CASES").ok().and_then(|v| v.parse::<u32>().ok()).unwrap_or(1);
    proptest::test_runner::Config {
        cases: n.saturating_mul(factor.min(100_000)),
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..proptest::test_runner::Config::default()
    }
}
