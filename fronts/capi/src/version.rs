//! The version.

/// The version of this header: 10000 * major + 100 * minor + patch.
pub const CASCA_VERSION: u32 = 100;

/// The version of the library that the program runs with, as CASCA_VERSION. Costs nothing.
#[unsafe(no_mangle)]
pub extern "C" fn casca_version() -> u32 {
    CASCA_VERSION
}
