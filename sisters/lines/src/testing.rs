//! The numbers of tests.

use glam::Vec3;
use proptest::prelude::*;

use crate::sets::LineSet;
use crate::sets::random::Random;

/// Steps of the lattice of which half of the coordinates are.
const STEPS: i32 = 8;

/// A number from `-most` to `most`: one of nine on a lattice, half of the time, so that lines
/// touch, lie along axes and have no length.
pub fn coordinate(random: &mut Random, most: f64) -> f64 {
    match random.unit() < 0.5 {
        true => ((random.unit() * f64::from(STEPS + 1)).floor() * 2.0 / f64::from(STEPS) - 1.0) * most,
        false => random.within(-most, most),
    }
}

/// Points with such coordinates.
pub fn places(most: f32) -> impl Strategy<Value = Vec3> + Clone {
    let on = (0..=STEPS).prop_map(move |i| (i as f32 * 2.0 / STEPS as f32 - 1.0) * most);
    let coordinate = prop_oneof![-most..most, on];
    [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Vec3::from)
}

/// The same lines with each vertex moved.
pub fn moved(lines: &LineSet, place: impl Fn(Vec3) -> Vec3) -> LineSet {
    let line = |line: &[Vec3]| line.iter().map(|p| place(*p)).collect::<Vec<_>>();
    LineSet::new(lines.iter().map(line)).unwrap()
}

/// The root of the mean square of differences.
pub fn rmse(a: &[f32], b: &[f32]) -> f32 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f32>() / a.len() as f32).sqrt()
}
