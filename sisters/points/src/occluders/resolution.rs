//! The side of the cells that surfaces are drawn in.

use rayon::prelude::*;

use super::voxels::Grid;
use crate::bricks::{BrickError, Bricks};

/// The side of a cell over the spacing of points. Points at random leave then a fifth of the cells
/// empty, and nine together in one of a million places.
const CELL_OF_SPACING: f32 = 1.25;
/// The share of the points that lie at most so far apart as the spacing that the cell is made from:
/// parts scanned more thinly hide less, and none falls apart because others are dense.
const DENSER: f64 = 0.75;
/// The most cells along the longest edge of a cloud: their numbers fit into 32 bits with room.
const MOST_CELLS: f32 = (1 << 20) as f32;
/// The sizes that are tried, over the first: a spacing found where both sides of walls are one is
/// too small by the root of two, and a little more where surfaces cross.
const SIZES: [f32; 5] = [1.0, 1.12, 1.26, 1.41, 1.58];
/// Cells at least so large are large enough, over those that the spacing on flat parts asks for: of
/// 0.8, 0.9 and 1 it spared most in the generated buildings of the example `occluders`.
const ENOUGH: f32 = 0.8;
/// The bricks whose points tell the spacing, at most.
const SAMPLE: usize = 256;

/// The side of a cell; 0 without points.
pub(super) fn resolution(bricks: &Bricks, wanted: Option<f32>) -> Result<f32, BrickError> {
    if bricks.is_empty() {
        return Ok(0.0);
    }
    let bounds = bricks.bounds();
    let longest = (bounds.max - bounds.min).max_element();
    let limited = |side: f32| {
        let side = side.max(longest / MOST_CELLS).min(longest);
        if side.is_normal() && longest.is_finite() { side } else { 0.0 }
    };
    if let Some(wanted) = wanted.filter(|&side| side > 0.0 && side.is_finite()) {
        return Ok(limited(wanted));
    }
    let rough = limited(CELL_OF_SPACING * bricks.usual_spacing(DENSER));
    if rough == 0.0 { Ok(0.0) } else { Ok(limited(filled(bricks, rough)?)) }
}

/// The smallest of some sizes at which points on flat parts fill the cells; the first if none is.
///
/// Bricks tell the area of surfaces by cells of a few spacings, in which both sides of a wall are
/// one. Cells of the images may be small enough to tell the sides apart, so that each has half of
/// the points, or too large for it, so that smaller ones are full. Each size is asked for itself.
fn filled(bricks: &Bricks, rough: f32) -> Result<f32, BrickError> {
    for size in SIZES {
        let cell = rough * size;
        let spacing = flat_spacing(bricks, cell)?;
        if spacing.is_none_or(|spacing| cell >= ENOUGH * CELL_OF_SPACING * spacing) {
            return Ok(cell);
        }
    }
    Ok(rough)
}

/// The spacing of points on flat parts that a share of their points keeps.
fn flat_spacing(bricks: &Bricks, cell: f32) -> Result<Option<f32>, BrickError> {
    let grid = Grid::new(bricks, cell);
    let step = bricks.len().div_ceil(SAMPLE);
    let mut all: Vec<(f64, f64)> = Vec::new();
    for brick in (0..bricks.len() as u32).step_by(step) {
        let groups = grid.groups(bricks, brick)?;
        let facets = groups.par_iter().flat_map_iter(|group| grid.facets(group));
        let spreads = facets.map(|facet| (facet.spread.spacing(), facet.spread.count()));
        all.extend(spreads.collect::<Vec<_>>());
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = DENSER * all.iter().map(|(_, count)| count).sum::<f64>();
    let usual = all.iter().find(|(_, count)| {
        left -= count;
        left <= 0.0
    });
    Ok(usual.map(|&(spacing, _)| spacing as f32))
}
