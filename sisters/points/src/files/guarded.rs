//! Calls into libraries that may panic.

use std::panic::{self, AssertUnwindSafe};

/// The result of a library. A panic in it, as `laz` has on some broken files, becomes an error:
/// nothing of the library is used after it.
pub(super) fn guarded<T, E: ToString>(call: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    match panic::catch_unwind(AssertUnwindSafe(call)) {
        Ok(result) => result.map_err(|e| e.to_string()),
        Err(_) => Err("the decoder panicked".into()),
    }
}
