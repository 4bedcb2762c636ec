//! What the experiments share: sizes of pictures, the grids of the thesis, and findings.

use glam::UVec3;

use casca_scenes::world::World;

/// Pixels of the software depth buffer that stands for the graphics card.
pub(super) const SCREEN: (usize, usize) = (1280, 720);
/// Pixels of the item buffer that says what is visible.
pub(super) const EXACT: (usize, usize) = (1920, 1080);
/// The two grids of the thesis.
pub(super) const COARSE: UVec3 = UVec3::new(50, 30, 50);
pub(super) const FINE: UVec3 = UVec3::new(100, 60, 100);

/// A section of the thesis, its claim, and the figure that this run measured for it.
pub(super) type Finding = (&'static str, String, String);

/// The edge length of cells of which a grid of `dims` covers a world.
pub(super) fn cell(world: &World, dims: UVec3) -> f32 {
    ((world.grid.max - world.grid.min) / dims.as_vec3()).max_element()
}

/// The edge length of cells of which there are so many along the longest axis of a world.
pub(super) fn across(world: &World, cells: u32) -> f32 {
    cell(world, UVec3::splat(cells))
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// A over b, or 0 where there is no b.
pub(super) fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}
