//! Points and configurations that tests share.

use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};

/// Points spread evenly on the unit sphere (the golden spiral).
pub fn sphere(count: usize) -> Vec<DVec3> {
    let turn = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
    let at = |i: usize| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (y, x) = (turn * i as f64).sin_cos();
        DVec3::new(x * (1.0 - z * z).sqrt(), y * (1.0 - z * z).sqrt(), z)
    };
    (0..count).map(at).collect()
}

/// Coordinates within `most` of zero: half of them are -1, 0 or 1 times it, so that points are at
/// one place, on one line and on one plane, and eyes on them.
pub fn coordinate(most: f32) -> impl Strategy<Value = f32> {
    prop_oneof![-most..most, (-1..=1_i8).prop_map(move |step| f32::from(step) * most)]
}

/// The configuration of a property test of `n` cases: the same in every run. `CASCA_CASES`
/// multiplies their number.
pub fn cases(n: u32) -> Config {
    let factor = std::env::var("CASCA_CASES").ok().and_then(|v| v.parse::<u32>().ok()).unwrap_or(1);
    let (cases, rng_seed) = (n.saturating_mul(factor.min(100_000)), RngSeed::Fixed(1));
    Config { cases, rng_seed, failure_persistence: None, ..Config::default() }
}
