//! Views.

use casca::glam::Vec3;
use casca_scenes::world::Camera;
use pyo3::prelude::*;

use crate::arrays::{mat4, place};
use crate::error::{check, refused};
use crate::forms::Given;

/// What can be looked at, and from where.
#[pyclass(frozen, module = "casca")]
#[derive(Clone)]
pub struct View {
    pub(crate) view: casca::View,
    /// The camera that it was made of, if it was one.
    pub(crate) camera: Option<Camera>,
}

impl View {
    fn of(view: Result<casca::View, casca::Error>) -> PyResult<Self> {
        Ok(Self { view: view.map_err(refused)?, camera: None })
    }

    /// The view of a camera.
    pub fn from_camera(camera: Camera) -> PyResult<Self> {
        let view = casca::View::perspective(camera.eye, camera.view_projection());
        Ok(Self { camera: Some(camera), ..Self::of(view)? })
    }

    fn change(
        &self,
        change: impl FnOnce(casca::View) -> Result<casca::View, casca::Error>,
    ) -> PyResult<Self> {
        let view = change(self.view.clone()).map_err(refused)?;
        Ok(Self { view, camera: self.camera })
    }
}

#[pymethods]
impl View {
    /// A camera at a place that looks at another one, y up.
    #[staticmethod]
    #[pyo3(signature = (eye, target, *, fov_y=60.0, aspect=16.0 / 9.0, near=0.1, far=1000.0))]
    fn look_at(eye: Given, target: Given, fov_y: f32, aspect: f32, near: f32, far: f32) -> PyResult<Self> {
        let (eye, target): (Vec3, Vec3) = (place("eye", eye)?, place("target", target)?);
        check(eye.is_finite() && target.is_finite() && eye != target, || {
            format!("the eye {eye} and the target {target} must be finite, and two places")
        })?;
        check(fov_y > 0.0 && fov_y < 180.0, || {
            format!("fov_y must lie between 0 and 180 degrees, not {fov_y}")
        })?;
        check(aspect > 0.0 && aspect.is_finite(), || format!("aspect must be positive, not {aspect}"))?;
        check(near > 0.0 && far > near && far.is_finite(), || {
            format!("near and far must be positive, and far the greater one: {near}, {far}")
        })?;
        Self::from_camera(Camera::look_at(eye, target, fov_y, aspect, near, far))
    }

    /// A perspective camera with a matrix from world to clip space, depth 0 to 1.
    #[staticmethod]
    fn perspective(eye: Given, matrix: Given) -> PyResult<Self> {
        Self::of(casca::View::perspective(place("eye", eye)?, mat4("matrix", matrix)?))
    }

    /// An orthographic camera with such a matrix.
    #[staticmethod]
    fn orthographic(forward: Given, matrix: Given) -> PyResult<Self> {
        Self::of(casca::View::orthographic(place("forward", forward)?, mat4("matrix", matrix)?))
    }

    /// All directions from a place.
    #[staticmethod]
    fn omnidirectional(eye: Given) -> PyResult<Self> {
        Self::of(casca::View::omnidirectional(place("eye", eye)?))
    }

    /// The same for all eyes that are no farther than this.
    fn with_reach(&self, reach: f32) -> PyResult<Self> {
        self.change(|view| view.with_reach(reach))
    }

    /// The same for cameras that are turned by no more than this, in radians.
    fn with_turn(&self, angle: f32) -> PyResult<Self> {
        self.change(|view| view.with_turn(angle))
    }

    /// The same for objects that share a layer with this mask.
    fn with_layers(&self, mask: u64) -> PyResult<Self> {
        self.change(|view| Ok(view.with_layers(mask)))
    }

    /// The eye, or None for an orthographic camera.
    #[getter]
    fn eye(&self) -> Option<[f64; 3]> {
        self.view.eye().map(|eye| eye.to_array())
    }

    fn __repr__(&self) -> String {
        self.eye().map_or("View(orthographic)".into(), |eye| format!("View(eye={eye:?})"))
    }
}
