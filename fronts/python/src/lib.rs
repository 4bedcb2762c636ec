//! The native part of the Python package `casca`: scenes, views, queries and exact visibility over
//! numpy arrays, the plane, points and lines. `python/casca/__init__.pyi` documents them for their users.

mod arrays;
mod bake;
mod error;
mod forms;
mod lines;
mod mesh;
mod plane;
mod points;
mod query;
mod scene;
mod truth;
mod view;

/// casca for Python.
#[pyo3::pymodule]
mod _casca {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::{
        bake::{Bake, Baked, Merge},
        error::Error,
        lines::{line_occlusion, line_picture},
        mesh::Mesh,
        plane::{field_of_view, visible_region},
        points::{hidden_point_removal, splat_visible},
        query::{Query, run_many},
        scene::Scene,
        truth::exact_visible,
        view::View,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("SCENES", crate::scene::names())
    }
}
