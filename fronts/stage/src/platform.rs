//! Where the program runs.

/// Whether this is a page of a browser: there the device answers only after the program has
/// returned, and the page says what a program shows, which then draws no panels.
pub const IS_PAGE: bool = cfg!(target_arch = "wasm32");
