//! Visibility in the plane.

use casca_plane::glam::Vec2;
use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, Segment, TilePoint};
use wasm_bindgen::prelude::*;

use crate::arrays::{groups, refused};

/// The tiles that are seen from a place on a map: 1 or 0 for each, row by row. `walls` has a number
/// for each tile, row by row, `width` tiles a row; a number other than 0 is a wall. The eye
/// is at (x, y) in tiles, (0.5, 0.5) in the middle of the first. It sees so far, if there is a
/// radius.
#[wasm_bindgen(js_name = fieldOfView)]
pub fn field_of_view(
    walls: &[u8],
    width: u32,
    x: f64,
    y: f64,
    radius: Option<f32>,
) -> Result<Vec<u8>, JsError> {
    let height = walls.len().checked_div(width as usize).unwrap_or(0);
    let longest = 1 << 20;
    if height == 0 || height * width as usize != walls.len() || width > longest || height > longest as usize {
        return Err(refused(format!(
            "{} tiles make no rows of {width}; rows and columns have 2^20 tiles at most",
            walls.len()
        )));
    }
    let mut opaque = BitGrid::new(width, height as u32);
    for (at, _) in (0u32..).zip(walls).filter(|(_, wall)| **wall != 0) {
        opaque.set(at % width, at / width, true);
    }
    let mut options = FovOptions::default();
    if let Some(radius) = radius {
        options = options.in_circle(radius).map_err(refused)?;
    }
    let eye = TilePoint::new(x, y).map_err(refused)?;
    let mut fov = FieldOfView::new();
    let seen = fov.run(&OpaqueTiles::new(opaque), eye, &options);
    let mut tiles = vec![0; walls.len()];
    seen.cells().for_each(|(x, y)| tiles[y as usize * width as usize + x as usize] = 1);
    Ok(tiles)
}

/// The corners of the region that is seen from a place between walls, up to so far: x and y of
/// each, in their order around the eye. Walls have 4 numbers each: both ends.
#[wasm_bindgen(js_name = visibleRegion)]
pub fn visible_region(walls: &[f32], eye: &[f32], range: f32) -> Result<Vec<f32>, JsError> {
    let walls: &[[f32; 4]] = groups("walls", walls)?;
    let wall = |&[a, b, c, d]: &[f32; 4]| Segment::new(Vec2::new(a, b), Vec2::new(c, d));
    let walls: Vec<Segment> = walls.iter().map(wall).collect();
    let eye = <[f32; 2]>::try_from(eye)
        .map_err(|_| refused(format!("the eye has {} numbers, not 2", eye.len())))?;
    let corners = casca_plane::visible_region(&walls, Vec2::from_array(eye), range).map_err(refused)?;
    Ok(corners.into_iter().flat_map(|at| at.to_array()).collect())
}
