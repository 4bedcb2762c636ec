//! Statuses, messages by thread, and the wall that no panic crosses.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a call came to. All functions return it, but for those that cannot fail.
///
/// The numbers are stable. Newer versions may return numbers that this header does not list: treat
/// them as errors.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum casca_status {
    /// All went well.
    CASCA_OK = 0,
    /// A pointer is null that must not be.
    CASCA_ERROR_NULL_POINTER = 1,
    /// A span is misaligned, or longer than memory can be.
    CASCA_ERROR_BAD_SPAN = 2,
    /// The size field of a struct is wrong, or it has fields that only a newer version knows.
    CASCA_ERROR_BAD_STRUCT = 3,
    /// The handle was never given out; 0 is such a handle.
    CASCA_ERROR_INVALID_HANDLE = 4,
    /// The handle was freed. It never comes back.
    CASCA_ERROR_STALE_HANDLE = 5,
    /// The handle is of another kind: a mesh where a scene is needed.
    CASCA_ERROR_WRONG_KIND = 6,
    /// Another thread uses the handle at this moment in a way that shuts this call out, or the call
    /// was given one handle for two parts.
    CASCA_ERROR_BUSY = 7,
    /// The span for results is too small. The call wrote how many there are.
    CASCA_ERROR_TOO_SMALL = 8,
    /// The id names no object of this scene: it was removed, or belongs to another scene.
    CASCA_ERROR_UNKNOWN_OBJECT = 9,
    /// An argument is out of its range or contradicts another one.
    CASCA_ERROR_INVALID_ARGUMENT = 10,
    /// A result of one scene was given to another scene, or to a query that never ran.
    CASCA_ERROR_FOREIGN_RESULT = 11,
    /// The bytes are no prepared mesh, or are damaged.
    CASCA_ERROR_DAMAGED = 12,
    /// There is no room for more handles or objects.
    CASCA_ERROR_FULL = 13,
    /// The caller ended a preparation.
    CASCA_ERROR_CANCELLED = 14,
    /// A bug in casca. The handles that the call changed answer no more calls; free them.
    CASCA_ERROR_PANIC = 15,
}

/// Why a call is refused.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: casca_status,
    code: &'static str,
    message: String,
}

impl Failure {
    pub(crate) fn new(status: casca_status, message: impl Into<String>) -> Self {
        Self { status, code: "", message: message.into() }
    }

    /// An argument that this border refuses.
    pub(crate) fn argument(message: impl Into<String>) -> Self {
        Self::new(casca_status::CASCA_ERROR_INVALID_ARGUMENT, message)
    }

    /// A field whose number stands for nothing.
    pub(crate) fn unknown(field: &str, value: u32) -> Self {
        let what = field.rsplit('.').next().unwrap_or(field);
        Self::argument(format!("{field} is {value}, which names no {what}"))
    }

    /// A failure with the place in a span where it stands.
    pub(crate) fn at(mut self, index: usize) -> Self {
        self.message = format!("element {index}: {}", self.message);
        self
    }
}

impl From<casca::Error> for Failure {
    fn from(error: casca::Error) -> Self {
        use casca::Error;
        let status = match error {
            Error::UnknownObject(_) | Error::UnknownKey(_) => casca_status::CASCA_ERROR_UNKNOWN_OBJECT,
            Error::ForeignPvs => casca_status::CASCA_ERROR_FOREIGN_RESULT,
            Error::SceneFull(_) => casca_status::CASCA_ERROR_FULL,
            Error::Cancelled => casca_status::CASCA_ERROR_CANCELLED,
            _ => casca_status::CASCA_ERROR_INVALID_ARGUMENT,
        };
        Self { status, code: error.code(), message: in_c(error.to_string()) }
    }
}

/// Names of Rust in messages, and those of C for the same.
const NAMES: [(&str, &str); 5] = [
    ("Scene::", "casca_scene_"),
    ("describe it by ObjectDesc::dynamic", "set CASCA_MOVES"),
    ("describe it with ObjectDesc::placed, or by instances of meshes", "set CASCA_PLACED"),
    ("an Instance of a mesh", "a mesh with CASCA_PLACED"),
    ("MeshOptions::occludes = false", "CASCA_MESH_BOUNDS_ONLY"),
];

fn in_c(message: String) -> String {
    NAMES.iter().fold(message, |text, (rust, c)| text.replace(rust, c))
}

impl From<casca::FileError> for Failure {
    fn from(error: casca::FileError) -> Self {
        let status = casca_status::CASCA_ERROR_DAMAGED;
        Self { status, code: error.code(), message: error.to_string() }
    }
}

impl From<casca_plane::Error> for Failure {
    fn from(error: casca_plane::Error) -> Self {
        use casca_plane::Error;
        let status = match error {
            Error::UnknownObject(_) => casca_status::CASCA_ERROR_UNKNOWN_OBJECT,
            Error::SceneFull(_) => casca_status::CASCA_ERROR_FULL,
            _ => casca_status::CASCA_ERROR_INVALID_ARGUMENT,
        };
        Self::new(status, error.to_string())
    }
}

/// The last failure of a thread, as C reads it.
#[derive(Default)]
struct Last {
    message: CString,
    code: CString,
}

thread_local! {
    static LAST: RefCell<Last> = RefCell::default();
}

fn remember(failure: &Failure) {
    let text = |text: &str| CString::new(text.replace('\0', " ")).unwrap_or_default();
    let last = Last { message: text(&failure.message), code: text(failure.code) };
    // A thread that is about to end keeps no message.
    let _ = LAST.try_with(|kept| kept.replace(last));
}

fn panicked(payload: &(dyn Any + Send)) -> Failure {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no message");
    Failure::new(casca_status::CASCA_ERROR_PANIC, format!("a bug in casca: {text}"))
}

/// Runs the body of an exported function: errors become statuses, and panics end here.
pub(crate) fn call(body: impl FnOnce() -> Result<(), Failure>) -> casca_status {
    let failure = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return casca_status::CASCA_OK,
        Ok(Err(failure)) => failure,
        Err(payload) => panicked(&*payload),
    };
    let status = failure.status;
    // Making the message must not carry a panic over the border either.
    let _ = catch_unwind(AssertUnwindSafe(|| remember(&failure)));
    status
}

/// The message of the last call that failed on this thread; empty before one failed.
///
/// It says which argument was refused and why. It stays until the next call fails on this thread;
/// copy it to keep it longer. Never null; do not free it. Costs a look-up.
#[unsafe(no_mangle)]
pub extern "C" fn casca_last_error() -> *const c_char {
    LAST.try_with(|last| last.borrow().message.as_ptr()).unwrap_or(c"".as_ptr())
}

/// A short, stable name of the last failure on this thread in kebab-case, such as "eye-mismatch",
/// where the library has one; else empty.
///
/// It lives as long as that of casca_last_error. Never null; do not free it.
#[unsafe(no_mangle)]
pub extern "C" fn casca_last_error_code() -> *const c_char {
    LAST.try_with(|last| last.borrow().code.as_ptr()).unwrap_or(c"".as_ptr())
}

/// The name of a status, such as "CASCA_ERROR_BUSY"; of any other number "unknown status".
///
/// It lives for ever. Never null.
#[unsafe(no_mangle)]
pub extern "C" fn casca_status_name(status: i32) -> *const c_char {
    let name = match status {
        0 => c"CASCA_OK",
        1 => c"CASCA_ERROR_NULL_POINTER",
        2 => c"CASCA_ERROR_BAD_SPAN",
        3 => c"CASCA_ERROR_BAD_STRUCT",
        4 => c"CASCA_ERROR_INVALID_HANDLE",
        5 => c"CASCA_ERROR_STALE_HANDLE",
        6 => c"CASCA_ERROR_WRONG_KIND",
        7 => c"CASCA_ERROR_BUSY",
        8 => c"CASCA_ERROR_TOO_SMALL",
        9 => c"CASCA_ERROR_UNKNOWN_OBJECT",
        10 => c"CASCA_ERROR_INVALID_ARGUMENT",
        11 => c"CASCA_ERROR_FOREIGN_RESULT",
        12 => c"CASCA_ERROR_DAMAGED",
        13 => c"CASCA_ERROR_FULL",
        14 => c"CASCA_ERROR_CANCELLED",
        15 => c"CASCA_ERROR_PANIC",
        _ => c"unknown status",
    };
    name.as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_status_with_its_message() {
        let status = call(|| panic!("the wheel {} came off", 3));
        assert_eq!(status, casca_status::CASCA_ERROR_PANIC);
        let message = LAST.with(|last| last.borrow().message.clone().into_string().unwrap());
        assert_eq!(message, "a bug in casca: the wheel 3 came off");
    }

    #[test]
    fn messages_are_those_of_their_thread() {
        call(|| Err(Failure::argument("here")));
        let there = std::thread::spawn(|| LAST.with(|last| last.borrow().message.clone()));
        assert_eq!(there.join().unwrap(), CString::default());
        assert_eq!(LAST.with(|last| last.borrow().message.clone()), CString::from(c"here"));
    }
}
