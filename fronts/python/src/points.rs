//! The points of a cloud that can be seen.

use casca_points::glam::{DVec3, Vec3};
use casca_points::splat::{self, Bias, Filter, Radius, SplatOptions};
use casca_points::{Camera, hpr, spacing};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{place, points, vec3};
use crate::error::refused;
use crate::forms::{Given, Rule};

/// Hidden point removal.
#[pyfunction]
#[pyo3(signature = (points, eye, *, log10_radius=3.0))]
pub fn hidden_point_removal<'py>(
    py: Python<'py>,
    points: Given<'_, 'py>,
    eye: Given<'_, 'py>,
    log10_radius: f64,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let points: Vec<DVec3> = self::points("points", points, Rule::Finite)?;
    let eye = DVec3::from(place("eye", eye)?);
    let visible = py.detach(|| hpr::visible_points(&points, eye, log10_radius)).map_err(refused)?;
    Ok(PyArray1::from_iter(py, visible.iter().by_vals()))
}

/// The points that are not behind squares around others.
#[pyfunction]
#[pyo3(signature = (points, eye, target, *, radius=None, bias=0.05, fov_y=60.0, width=1280, height=720, near=0.1, far=1000.0))]
#[expect(clippy::too_many_arguments, reason = "by keyword")]
pub fn splat_visible<'py>(
    py: Python<'py>,
    points: Given<'_, 'py>,
    eye: Given<'_, 'py>,
    target: Given<'_, 'py>,
    radius: Option<f32>,
    bias: f32,
    fov_y: f32,
    width: u32,
    height: u32,
    near: f32,
    far: f32,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let points: Vec<Vec3> = self::points("points", points, Rule::Finite)?;
    let (eye, target) = (vec3("eye", eye)?, vec3("target", target)?);
    let camera = Camera::look_at(eye, target, Vec3::Y, fov_y.to_radians(), (width, height), near, far);
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
