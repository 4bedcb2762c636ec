//! The native part of the Python package `casca`: scenes, views, queries and exact visibility over
//! numpy arrays. `python/casca/__init__.pyi` documents them for their users.

mod arrays;
mod error;
mod mesh;
mod query;
mod scene;
mod truth;
mod view;

use pyo3::prelude::*;

/// casca for Python.
#[pymodule]
fn _casca(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<error::CascaError>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SCENES", scene::names())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<view::View>()?;
    module.add_class::<query::Query>()?;
    module.add_function(wrap_pyfunction!(query::run_many, module)?)?;
    module.add_function(wrap_pyfunction!(truth::exact_visible, module)?)?;
    Ok(())
}
