//! Exact visibility, by code that shares nothing with the library.

use std::sync::Arc;

use casca::glam::Affine3A;
use casca::{Bounds, Facing, ObjectId, Occluder, TriMesh};
use casca_scenes::world::{Mesh, Motion, Object, Shape, Sides};
use casca_truth::oracle::{Oracle, OracleOptions};
use pyo3::prelude::*;

use crate::arrays::{self, Keys};
use crate::error::refused;
use crate::forms::{height, width};
use crate::scene::Scene;
use crate::view::View;

/// The objects that a camera sees in at least one pixel.
#[pyfunction]
#[pyo3(signature = (scene, view, *, width=1280, height=720))]
pub fn exact_visible<'py>(
    py: Python<'py>,
    scene: PyRef<'py, Scene>,
    view: &View,
    #[pyo3(from_py_with = width)] width: u32,
    #[pyo3(from_py_with = height)] height: u32,
) -> Keys<'py> {
    let camera =
        view.camera.ok_or_else(|| refused("exact visibility needs a view by look_at or path_view"))?;
    let [width, height] = [width, height].map(|side| side as usize);
    let scene = &scene.scene;
    let (objects, ids) = objects(scene)?;
    let options = OracleOptions { width, height, samples_per_object: 0, ..OracleOptions::default() };
    let exact = py.detach(|| {
        let mut oracle = Oracle::new(&objects, options);
        // Nothing is looked for besides the pixels.
        oracle.frame(&objects, &[], &camera, &|_| true).exact
    });
    arrays::keys(py, scene, exact.into_iter().map(|object| ids[object]))
}

/// What is drawn of bounds or of an occluder.
macro_rules! drawn {
    ($kind:ident, $shape:expr) => {
        match $shape {
            $kind::Sphere(s) => Some(Shape::Sphere { center: s.center, radius: s.radius }),
            $kind::Box(b) => Some(Shape::Box { min: b.min, max: b.max }),
            $kind::Mesh(mesh) => Some(of_mesh(mesh, Affine3A::IDENTITY)),
            $kind::Instance(instance) => Some(of_mesh(instance.mesh(), instance.transform())),
            _ => None,
        }
    };
}

/// The objects of a scene as the truth takes them. What hides by another shape than its bounds
/// comes twice: once to be tested, and once to hide.
fn objects(scene: &casca::Scene) -> PyResult<(Vec<Object>, Vec<ObjectId>)> {
    let (mut objects, mut ids) = (Vec::new(), Vec::new());
    for (id, object) in scene.iter() {
        let mut put = |shape, occludes, tested| {
            objects.push(Object { name: String::new(), shape, motion: Motion::Static, occludes, tested });
            ids.push(id);
        };
        let bounds = object.bounds();
        let drawn =
            drawn!(Bounds, bounds).ok_or_else(|| refused(format!("{id} has no shape that is drawn")))?;
        match object.occluder() {
            None => put(drawn, false, true),
            Some(occluder) if is_same(bounds, occluder) => put(drawn, true, true),
            Some(occluder) => {
                let hides = drawn!(Occluder, occluder);
                let hides =
                    hides.ok_or_else(|| refused(format!("{id} hides by a shape that is not drawn")))?;
                put(drawn, false, true);
                put(hides, true, false);
            }
        }
    }
    Ok((objects, ids))
}

/// Whether an object hides by all of its shape.
fn is_same(bounds: &Bounds, occluder: &Occluder) -> bool {
    match (bounds, occluder) {
        (Bounds::Sphere(a), Occluder::Sphere(b)) => a == b,
        (Bounds::Box(a), Occluder::Box(b)) => a == b,
        (Bounds::Mesh(a), Occluder::Mesh(b)) => Arc::ptr_eq(a, b),
        (Bounds::Instance(a), Occluder::Instance(b)) => {
            Arc::ptr_eq(a.mesh(), b.mesh()) && a.transform() == b.transform()
        }
        _ => false,
    }
}

fn of_mesh(mesh: &TriMesh, transform: Affine3A) -> Shape {
    let sides = match mesh.facing() {
        Facing::Front => vec![Sides::Front; mesh.triangles().len()],
        Facing::Both => Vec::new(),
    };
    let mesh = Mesh { positions: mesh.positions().to_vec(), triangles: mesh.triangles().to_vec(), sides };
    Shape::Mesh { mesh: mesh.into(), transform }
}
