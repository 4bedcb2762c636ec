//! Queries.

use casca::glam::Vec3;
use casca::{Light, Method, ObjectId, PointOptions};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{self, Flags, Keys, place};
use crate::error::{check, refused};
use crate::forms::{Given, Rule, own_threads};
use crate::scene::Scene;
use crate::view::View;

/// Finds what views can see of a scene.
#[pyclass(module = "casca")]
pub struct Query {
    pub(crate) query: casca::Query,
    /// Another one, for lights.
    light: casca::Query,
}

/// The method with a name.
pub fn method(name: &str, preset: Option<&str>, pixel_degrees: Option<f32>) -> PyResult<Method> {
    let is_point = name == "point";
    check(is_point || preset.is_none() && pixel_degrees.is_none(), || {
        format!("preset and pixel_degrees are options of the method \"point\", not of {name:?}")
    })?;
    let mut options = match preset {
        None => PointOptions::new(),
        Some("fast") => PointOptions::fast(),
        Some("balanced") => PointOptions::balanced(),
        Some("tight") => PointOptions::tight(),
        Some(it) => return Err(refused(format!("preset must be 'fast', 'balanced' or 'tight', not {it:?}"))),
    };
    if let Some(degrees) = pixel_degrees {
        options = options.pixel_degrees(degrees);
    }
    match name {
        "point" => Ok(Method::Point(options)),
        "cell" => Ok(Method::cell()),
        "frustum" => Ok(Method::Frustum),
        _ => Err(refused(format!("the method must be \"point\", \"cell\" or \"frustum\", not {name:?}"))),
    }
}

impl Query {
    /// What the sight of the last run says.
    fn may_see<'py>(
        &self,
        py: Python<'py>,
        scene: &casca::Scene,
        of: impl Sync + Fn(&casca::Sight) -> Vec<bool>,
    ) -> Flags<'py> {
        let seen = py.detach(|| self.query.sight(scene).map(|sight| of(&sight)));
        Ok(PyArray1::from_vec(py, seen.ok_or_else(|| refused("the query has not run yet"))?))
    }
}

#[pymethods]
impl Query {
    #[new]
    #[pyo3(signature = (method="point", *, preset=None, pixel_degrees=None, parallel=false))]
    fn new(method: &str, preset: Option<&str>, pixel_degrees: Option<f32>, parallel: bool) -> PyResult<Self> {
        let method = self::method(method, preset, pixel_degrees)?;
        let make = || casca::Query::with_method(method).map_err(refused);
        let mut query = make()?;
        query.set_parallel(parallel);
        Ok(Self { query, light: make()? })
    }

    /// Finds the objects that a view can see.
    fn run<'py>(&mut self, py: Python<'py>, scene: PyRef<'py, Scene>, view: &View) -> Keys<'py> {
        let (query, scene, view) = (&mut self.query, &scene.scene, &view.view);
        py.detach(|| query.run(scene, view).len());
        arrays::keys(py, scene, self.query.pvs().iter())
    }

    /// Whether the view of the last run may see each of some boxes.
    fn may_see_boxes<'py>(&self, py: Python<'py>, scene: PyRef<'py, Scene>, boxes: Given) -> Flags<'py> {
        let boxes = arrays::boxes(boxes, Rule::Any)?;
        self.may_see(py, &scene.scene, |sight| boxes.iter().map(|b| sight.may_see_box(b)).collect())
    }

    /// Whether the view of the last run may see each of some points.
    fn may_see_points<'py>(&self, py: Python<'py>, scene: PyRef<'py, Scene>, points: Given) -> Flags<'py> {
        let points: Vec<Vec3> = arrays::points("points", points, Rule::Any)?;
        self.may_see(py, &scene.scene, |sight| points.iter().map(|at| sight.may_see_point(*at)).collect())
    }

    /// The objects whose shadows may fall on what the view of the last run sees.
    #[pyo3(signature = (scene, *, direction=None, position=None, reach=f32::INFINITY))]
    fn shadow_casters<'py>(
        &mut self,
        py: Python<'py>,
        scene: PyRef<'py, Scene>,
        direction: Option<Bound<'py, PyAny>>,
        position: Option<Bound<'py, PyAny>>,
        reach: f32,
    ) -> Keys<'py> {
        let light = match (direction, position) {
            (Some(direction), None) => Light::directional(place("direction", &direction)?),
            (None, Some(position)) => Light::point(place("position", &position)?, reach),
            _ => return Err(refused("a light has a direction, or a position")),
        };
        let (query, lamp, scene) = (&self.query, &mut self.light, &scene.scene);
        let mut casters: Vec<ObjectId> = Vec::new();
        py.detach(|| lamp.shadow_casters(scene, query, &light, &mut casters)).map_err(refused)?;
        arrays::keys(py, scene, casters.into_iter())
    }

    fn __repr__(&self) -> String {
        format!("Query({:?})", self.query.method().name())
    }
}

/// Runs a new query for each of some views, by several threads.
#[pyfunction]
#[pyo3(signature = (scene, views, *, method="point", preset=None, pixel_degrees=None, threads=None))]
pub fn run_many<'py>(
    py: Python<'py>,
    scene: PyRef<'py, Scene>,
    views: Vec<PyRef<'py, View>>,
    method: &str,
    preset: Option<&str>,
    pixel_degrees: Option<f32>,
    threads: Option<Bound<'py, PyAny>>,
) -> PyResult<Vec<Bound<'py, PyArray1<u64>>>> {
    use rayon::prelude::*;
    let query = casca::Query::with_method(self::method(method, preset, pixel_degrees)?).map_err(refused)?;
    let views: Vec<casca::View> = views.iter().map(|view| view.view.clone()).collect();
    let threads = threads.map_or(Ok(0), |threads| own_threads(&threads))?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(refused)?;
    let scene = &scene.scene;
    let find = |query: &mut casca::Query, view: &casca::View| query.run(scene, view).visible().to_vec();
    let sets: Vec<Vec<ObjectId>> =
        py.detach(|| pool.install(|| views.par_iter().map_init(|| query.clone(), find).collect()));
    sets.into_iter().map(|set| arrays::keys(py, scene, set.into_iter())).collect()
}
