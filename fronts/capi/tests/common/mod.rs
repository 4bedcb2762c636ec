//! Calls of the C face from tests in Rust.

/// A struct of the header as CASCA_INIT makes it.
macro_rules! init {
    ($name:ident) => {{
        // SAFETY: all zeros are a value of each struct in the header.
        let mut value: $name = unsafe { std::mem::zeroed() };
        value.size = size_of::<$name>();
        value
    }};
}

/// Calls of the C face, which must all be taken.
macro_rules! ok {
    ($call:expr) => {{
        // SAFETY: pointers are of references and slices with their lengths.
        let status = unsafe { $call };
        // SAFETY: the message is a string that ends.
        let why = || unsafe { std::ffi::CStr::from_ptr(casca_last_error()) }.to_string_lossy().into_owned();
        assert_eq!(status, casca_status::CASCA_OK, "{}", why());
    }};
}
