//! The points of a cloud that can be seen.

use casca_points::glam::{DVec3, Vec3};
use casca_points::splat::{self, Bias, Filter, Radius, SplatOptions};
use casca_points::{Camera, hpr, spacing};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{Flags, place, points};
use crate::error::refused;
use crate::forms::{Given, Rule, height, width};

/// Hidden point removal.
#[pyfunction]
#[pyo3(signature = (points, eye, *, log10_radius=3.0))]
pub fn hidden_point_removal<'py>(
    py: Python<'py>,
    points: Given<'_, 'py>,
    eye: Given<'_, 'py>,
    log10_radius: f64,
) -> Flags<'py> {
    let points: Vec<DVec3> = self::points("points", points, Rule::Finite)?;
    let eye: DVec3 = place("eye", eye)?;
    let visible = py.detach(|| hpr::visible_points(&points, eye, log10_radius)).map_err(refused)?;
    Ok(PyArray1::from_iter(py, visible.iter().by_vals()))
}

/// The points that are not behind squares around others.
#[pyfunction]
pub fn splat_visible<'py>(
    py: Python<'py>,
    points: Given<'_, 'py>,
    eye: Given<'_, 'py>,
    target: Given<'_, 'py>,
    how: (Option<f32>, f32),
    lens: (f32, [Bound<'py, PyAny>; 2], f32, f32),
) -> Flags<'py> {
    let points: Vec<Vec3> = self::points("points", points, Rule::Finite)?;
    let (eye, target) = (place("eye", eye)?, place("target", target)?);
    let ((radius, bias), (fov_y, size, near, far)) = (how, lens);
    let size = (width(&size[0])?, height(&size[1])?);
    let camera = Camera::look_at(eye, target, Vec3::Y, fov_y.to_radians(), size, near, far);
    let camera = camera.map_err(refused)?;
    let visible = py
        .detach(|| {
            let radius = radius.map_or_else(|| spacing::automatic_radius(&points), Ok)?;
            let options = SplatOptions {
                radius: Radius::Same(radius),
                bias: Bias::Window(bias),
                filter: Filter::Max,
                slopes: false,
            };
            splat::visible_points(&points, &camera, &options)
        })
        .map_err(refused)?;
    Ok(PyArray1::from_iter(py, visible.iter().by_vals()))
}
