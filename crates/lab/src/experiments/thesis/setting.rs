//! What the experiments share: sizes of pictures, the grids of the thesis, and findings.

use casca::GridSpec;
use glam::UVec3;

use super::super::LabError;
use casca_scenes::drive::grid_for;
use casca_scenes::world::World;

/// Pixels of the software depth buffer that stands for the graphics card.
pub(super) const SCREEN: (usize, usize) = (1280, 720);
/// Pixels of the item buffer that says what is visible.
pub(super) const EXACT: (usize, usize) = (1920, 1080);
/// The two grids of the thesis.
pub(super) const COARSE: UVec3 = UVec3::new(50, 30, 50);
pub(super) const FINE: UVec3 = UVec3::new(100, 60, 100);

/// A finding of the thesis, and the one of this run.
pub(super) struct Finding {
    pub(super) place: &'static str,
    pub(super) thesis: String,
    pub(super) here: String,
}

impl Finding {
    pub(super) fn new(place: &'static str, thesis: impl Into<String>, here: impl Into<String>) -> Self {
        Self { place, thesis: thesis.into(), here: here.into() }
    }
}

pub(super) fn grid(world: &World, dims: UVec3) -> Result<GridSpec, LabError> {
    Ok(grid_for(&world.grid, Some(dims))?)
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// A over b, or 0 where there is no b.
pub(super) fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

/// The value of a curve at one of its points; 0 elsewhere.
pub(super) fn at(points: &[(f64, f64)], x: f64) -> f64 {
    points.iter().find(|p| p.0 == x).map_or(0.0, |p| p.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_nothing_are_nothing() {
        assert_eq!((ratio(3.0, 2.0), ratio(3.0, 0.0), mean(&[])), (1.5, 0.0, 0.0));
        assert_eq!(mean(&[1.0, 4.0]), 2.5);
    }
}
