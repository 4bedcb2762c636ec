//! What is raised where casca refuses a call.

use std::ffi::CString;

use casca_scenes::world::World;
use pyo3::create_exception;
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;

create_exception!(casca, Error, PyValueError, "A call that casca refused; nothing was changed.");

/// The exception for a refusal of the library.
pub fn refused(why: impl std::fmt::Display) -> PyErr {
    Error::new_err(why.to_string())
}

/// Refuses a call unless something holds.
pub fn check(holds: bool, why: impl FnOnce() -> String) -> PyResult<()> {
    if holds { Ok(()) } else { Err(refused(why())) }
}

/// The exception for the entry of an array that was refused. Entries before it were taken.
pub fn refused_at(index: usize, why: impl std::fmt::Display) -> PyErr {
    Error::new_err(format!("entry {index}: {why}"))
}

/// Python's warnings for what the file of a world says.
pub fn warn(py: Python, world: &World) -> PyResult<()> {
    let kind = py.get_type::<PyUserWarning>();
    world.source.warnings.iter().try_for_each(|line| {
        // No byte of 0 can be passed on.
        let line = CString::new(line.replace('\0', " ")).unwrap_or_default();
        PyErr::warn(py, &kind, &line, 1)
    })
}
