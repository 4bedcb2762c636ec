//! The native part of the Python package `casca`: scenes, views, queries and exact visibility over
//! numpy arrays, the plane and points. `python/casca/__init__.pyi` documents them for their users.

mod arrays;
mod bake;
mod error;
mod forms;
mod mesh;
mod plane;
mod points;
mod query;
mod scene;
mod truth;
mod view;

use pyo3::prelude::*;

/// casca for Python.
#[pymodule]
fn _casca(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<error::Error>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SCENES", scene::names())?;
    module.add_class::<bake::Bake>()?;
    module.add_class::<bake::Baked>()?;
    module.add_class::<bake::Merge>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<view::View>()?;
    module.add_class::<query::Query>()?;
    module.add_function(wrap_pyfunction!(query::run_many, module)?)?;
    module.add_function(wrap_pyfunction!(truth::exact_visible, module)?)?;
    module.add_function(wrap_pyfunction!(plane::field_of_view, module)?)?;
    module.add_function(wrap_pyfunction!(plane::visible_region, module)?)?;
    module.add_function(wrap_pyfunction!(points::hidden_point_removal, module)?)?;
    module.add_function(wrap_pyfunction!(points::splat_visible, module)?)?;
    Ok(())
}
