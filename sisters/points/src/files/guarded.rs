//! Calls into libraries that may panic, and what their errors say.

use std::panic::{self, AssertUnwindSafe};

/// The longest text of a library that is handed on, in characters: some repeat the file.
const LONGEST: usize = 300;

/// The result of a library. A panic in it, as `laz` has on some broken files, becomes an error.
pub(super) fn guarded<T, E: ToString>(call: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    match panic::catch_unwind(AssertUnwindSafe(call)) {
        Ok(result) => result.map_err(plain),
        Err(_) => Err(PANICKED.into()),
    }
}

/// What is said of a panic.
pub(super) const PANICKED: &str = "the bytes make no sense to the decoder, which panicked";

/// What an error says, in plain words and not at length.
pub(super) fn plain(error: impl ToString) -> String {
    let mut text = error.to_string();
    if text.contains("failed to fill whole buffer") {
        return "the file ends here".into();
    }
    if let Some((end, _)) = text.char_indices().nth(LONGEST) {
        text.truncate(end);
        text.push_str(" ...");
    }
    text
}
