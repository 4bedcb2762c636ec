//! Visibility in the plane.

use casca_plane::glam::Vec2;
use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, Segment, TilePoint};
use numpy::ndarray::{Array2, Ix2};
use numpy::{IntoPyArray, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{Array, Floats1, Floats3, check};
use crate::error::refused;

fn vec2(name: &str, array: &Floats1) -> PyResult<Vec2> {
    let array = array.as_array();
    check(array.len() == 2, || format!("{name} must have 2 numbers, not {}", array.len()))?;
    Ok(Vec2::new(array[0], array[1]))
}

/// The tiles that are seen from a place on a map.
#[pyfunction]
#[pyo3(signature = (walls, eye, *, radius=None, direction=None, half_angle=None))]
pub fn field_of_view<'py>(
    py: Python<'py>,
    walls: Array<'py, bool, Ix2>,
    eye: (f64, f64),
    radius: Option<f32>,
    direction: Option<Floats1<'py>>,
    half_angle: Option<f32>,
) -> PyResult<Bound<'py, PyArray2<bool>>> {
    let walls = walls.as_array();
    let (height, width) = walls.dim();
    let size = |side: usize| u32::try_from(side).ok().filter(|side| *side <= 1 << 20);
    let sizes = size(width).zip(size(height));
    let (w, h) = sizes
        .ok_or_else(|| refused(format!("a map has at most 2^20 tiles a side, not {width} x {height}")))?;
    let mut opaque = BitGrid::new(w, h);
    for ((y, x), _) in walls.indexed_iter().filter(|(_, wall)| **wall) {
        opaque.set(x as u32, y as u32, true);
    }
    let mut options = FovOptions::default();
    if let Some(radius) = radius {
        options = options.in_circle(radius).map_err(refused)?;
    }
    match (&direction, half_angle) {
        (Some(direction), Some(angle)) => {
            options = options.in_sector(vec2("the direction", direction)?, angle).map_err(refused)?;
        }
        (None, None) => {}
        _ => return Err(refused("direction and half_angle belong together")),
    }
    let eye = TilePoint::new(eye.0, eye.1).map_err(refused)?;
    let mut fov = FieldOfView::new();
    let seen = fov.run(&OpaqueTiles::new(opaque), eye, &options);
    let mut tiles = Array2::from_elem((height, width), false);
    seen.cells().for_each(|(x, y)| tiles[(y as usize, x as usize)] = true);
    Ok(tiles.into_pyarray(py))
}

/// The corners of the region that is seen from a place between walls.
#[pyfunction]
pub fn visible_region<'py>(
    py: Python<'py>,
    walls: Floats3<'py>,
    eye: Floats1<'py>,
    range: f32,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (walls, eye) = (walls.as_array(), vec2("the eye", &eye)?);
    let (count, ends, axes) = walls.dim();
    check((ends, axes) == (2, 2), || format!("walls must be of shape (n, 2, 2), not {:?}", walls.dim()))?;
    let end = |i, k| Vec2::from_array([walls[[i, k, 0]], walls[[i, k, 1]]]);
    let walls: Vec<Segment> = (0..count).map(|i| Segment::new(end(i, 0), end(i, 1))).collect();
    let polygon = py.detach(|| casca_plane::visible_region(&walls, eye, range)).map_err(refused)?;
    let numbers = polygon.iter().flat_map(|at| at.to_array()).collect();
    let corners = Array2::from_shape_vec((polygon.len(), 2), numbers).map_err(refused)?;
    Ok(corners.into_pyarray(py))
}
