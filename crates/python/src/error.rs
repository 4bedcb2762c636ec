//! What is raised where casca refuses a call.

use pyo3::PyErr;
use pyo3::PyResult;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

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
