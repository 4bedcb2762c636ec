//! Views.

use std::hash::{DefaultHasher, Hash, Hasher};

use casca::glam::{DVec3, Mat4, Vec3};
use casca_scenes::world::Camera;
use pyo3::prelude::*;

use crate::arrays::{mat4, place};
use crate::error::{check, refused};
use crate::forms::{Given, mask};

/// A step in which a view was made: its name, and its numbers.
type Step = (String, Vec<f64>);

/// What can be looked at, and from where.
#[pyclass(frozen, module = "casca")]
#[derive(Clone)]
pub struct View {
    pub(crate) view: casca::View,
    /// The camera that it was made of, if it was one.
    pub(crate) camera: Option<Camera>,
    /// The first one makes a view, the others change it: other processes do the same.
    steps: Vec<Step>,
}

impl View {
    /// The view that a step makes, of another one or of none.
    fn made(of: Option<&Self>, step: Step) -> PyResult<Self> {
        let floats: Vec<f32> = step.1.iter().map(|number| *number as f32).collect();
        let place = |at: usize| Vec3::from_slice(&floats[at..]);
        let matrix = |at: usize| Mat4::from_cols_slice(&floats[at..]);
        let camera = || Camera { eye: place(0), view: matrix(3), projection: matrix(19) };
        let (view, camera) = match (of, &*step.0, floats.len()) {
            (None, "camera", 35) => {
                (casca::View::perspective(place(0), camera().view_projection()), Some(camera()))
            }
            (None, "perspective", 19) => (casca::View::perspective(place(0), matrix(3)), None),
            (None, "orthographic", 19) => (casca::View::orthographic(place(0), matrix(3)), None),
            (None, "omnidirectional", 3) => (casca::View::omnidirectional(place(0)), None),
            (Some(of), "reach", 1) => (of.view.clone().with_reach(floats[0]), of.camera),
            (Some(of), "turn", 1) => (of.view.clone().with_turn(floats[0]), of.camera),
            (Some(of), "layers", 2) => {
                let [low, high] = [step.1[0], step.1[1]].map(|half| half as u64);
                (Ok(of.view.clone().with_layers(high << 32 | low)), of.camera)
            }
            (Some(of), "carried", 3) => {
                let by = DVec3::from_slice(&step.1);
                let carried = casca::Scene::new(1.0).and_then(|scene| scene.view(by, &of.view));
                (carried, of.camera.map(|camera| camera.at(camera.eye + by.as_vec3())))
            }
            _ => return Err(refused("no view can be made of these steps")),
        };
        let before = of.map(|of| of.steps.clone()).unwrap_or_default();
        let steps = before.into_iter().chain([step]).collect();
        Ok(Self { view: view.map_err(refused)?, camera, steps })
    }

    /// The view that a place or direction and matrices make.
    fn of(name: &str, place: Vec3, matrices: &[Mat4]) -> PyResult<Self> {
        let matrices = matrices.iter().flat_map(|matrix| matrix.to_cols_array());
        let numbers = place.to_array().into_iter().chain(matrices);
        Self::made(None, (name.into(), numbers.map(f64::from).collect()))
    }

    /// The view of a camera.
    pub fn from_camera(camera: Camera) -> PyResult<Self> {
        Self::of("camera", camera.eye, &[camera.view, camera.projection])
    }

    /// The same in coordinates that differ by an offset.
    pub fn carried(&self, by: DVec3) -> PyResult<Self> {
        Self::made(Some(self), ("carried".into(), by.to_array().into()))
    }
}

#[pymethods]
impl View {
    /// A camera at a place that looks at another one, y up.
    #[staticmethod]
    #[pyo3(signature = (eye, target, *, fov_y=60.0, aspect=16.0 / 9.0, near=0.1, far=1000.0))]
    fn look_at(eye: Given, target: Given, fov_y: f32, aspect: f32, near: f32, far: f32) -> PyResult<Self> {
        let (eye, target): (Vec3, Vec3) = (place("eye", eye)?, place("target", target)?);
        check(eye != target, || format!("the eye {eye} and the target must be two places"))?;
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
        Self::of("perspective", place("eye", eye)?, &[mat4("matrix", matrix)?])
    }

    /// An orthographic camera with such a matrix.
    #[staticmethod]
    fn orthographic(forward: Given, matrix: Given) -> PyResult<Self> {
        Self::of("orthographic", place("forward", forward)?, &[mat4("matrix", matrix)?])
    }

    /// All directions from a place.
    #[staticmethod]
    fn omnidirectional(eye: Given) -> PyResult<Self> {
        Self::of("omnidirectional", place("eye", eye)?, &[])
    }

    /// The same for all eyes that are no farther than this.
    fn with_reach(&self, reach: f32) -> PyResult<Self> {
        Self::made(Some(self), ("reach".into(), vec![reach.into()]))
    }

    /// The same for cameras that are turned by no more than this, in radians.
    fn with_turn(&self, angle: f32) -> PyResult<Self> {
        Self::made(Some(self), ("turn".into(), vec![angle.into()]))
    }

    /// The same for objects that share a layer with this mask.
    fn with_layers(&self, #[pyo3(from_py_with = mask)] mask: u64) -> PyResult<Self> {
        let halves = [mask & u64::from(u32::MAX), mask >> 32].map(|half| half as f64);
        Self::made(Some(self), ("layers".into(), halves.into()))
    }

    /// The eye, or None for an orthographic camera.
    #[getter]
    fn eye(&self) -> Option<[f64; 3]> {
        self.view.eye().map(|eye| eye.to_array())
    }

    /// The view that some steps make: for pickles.
    #[staticmethod]
    fn _made(steps: Vec<Step>) -> PyResult<Self> {
        let made = steps.into_iter().try_fold(None, |of, step| Self::made(of.as_ref(), step).map(Some));
        made?.ok_or_else(|| refused("no view can be made of no steps"))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Vec<Step>,))> {
        Ok((slf.get_type().getattr("_made")?, (slf.get().steps.clone(),)))
    }

    fn __eq__(&self, other: &Self) -> bool {
        (&self.view, self.camera) == (&other.view, other.camera)
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        // Of the two zeros, which are equal, one.
        let eye = self.eye().unwrap_or_default().map(|at| (at + 0.0).to_bits());
        (eye, self.view.reach().to_bits(), self.view.layers()).hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        self.eye().map_or("View(orthographic)".into(), |eye| format!("View(eye={eye:?})"))
    }
}
