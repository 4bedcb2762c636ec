//! Visibility in the plane.

use casca_plane::glam::Vec2;
use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, TilePoint};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{place2, walls};
use crate::error::{check, refused};
use crate::forms::{Given, map};

/// The tiles that are seen from a place on a map.
#[pyfunction]
#[pyo3(signature = (walls, eye, *, radius=None, direction=None, half_angle=None, symmetric=false))]
pub fn field_of_view<'py>(
    py: Python<'py>,
    walls: Given<'_, 'py>,
    eye: Given<'_, 'py>,
    radius: Option<f32>,
    direction: Option<Bound<'py, PyAny>>,
    half_angle: Option<f32>,
    symmetric: bool,
) -> PyResult<Bound<'py, PyArray2<bool>>> {
    let (walls, height, width) = map(walls)?;
    let size = |side: usize| u32::try_from(side).ok().filter(|side| *side <= 1 << 20);
    let wrong = || refused(format!("a map has at most 2^20 tiles a side, not {width} x {height}"));
    let (w, h) = size(width).zip(size(height)).ok_or_else(wrong)?;
    let mut opaque = BitGrid::new(w, h);
    for (tile, _) in walls.iter().enumerate().filter(|(_, wall)| **wall) {
        opaque.set((tile % width) as u32, (tile / width) as u32, true);
    }
    let mut options = FovOptions::default();
    if let Some(radius) = radius {
        options = options.in_circle(radius).map_err(refused)?;
    }
    check(!symmetric || direction.is_none(), || "a symmetric field of view has no direction".into())?;
    match (&direction, half_angle) {
        (Some(direction), Some(angle)) => {
            options = options.in_sector(place2("direction", direction)?, angle).map_err(refused)?;
        }
        (None, None) => {}
        _ => return Err(refused("direction and half_angle belong together")),
    }
    let Vec2 { x, y } = place2("eye", eye)?;
    let (mut fov, opaque) = (FieldOfView::new(), OpaqueTiles::new(opaque));
    let seen = if symmetric {
        let outside =
            || refused(format!("eye must lie on the map of {width} x {height} tiles, not at {x}, {y}"));
        if x.min(y) < 0.0 {
            return Err(outside());
        }
        fov.run_symmetric(&opaque, x as u32, y as u32, &options).map_err(|_| outside())?
    } else {
        fov.run(&opaque, TilePoint::new(x.into(), y.into()).map_err(refused)?, &options)
    };
    let mut tiles = Array2::from_elem((height, width), false);
    seen.cells().for_each(|(x, y)| tiles[(y as usize, x as usize)] = true);
    Ok(tiles.into_pyarray(py))
}

/// The corners of the region that is seen from a place between walls.
#[pyfunction]
pub fn visible_region<'py>(
    py: Python<'py>,
    walls: Given<'_, 'py>,
    eye: Given<'_, 'py>,
    range: f32,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (eye, walls): (Vec2, _) = (place2("eye", eye)?, self::walls(walls)?);
    let polygon = py.detach(|| casca_plane::visible_region(&walls, eye, range)).map_err(refused)?;
    let numbers = polygon.iter().flat_map(|at| at.to_array()).collect();
    let corners = Array2::from_shape_vec((polygon.len(), 2), numbers).map_err(refused)?;
    Ok(corners.into_pyarray(py))
}
