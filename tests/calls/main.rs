//! Calls, and what applications rely on beside the sets.

#[path = "../common/mod.rs"]
mod common;

mod misuse;
mod public_face;
mod serde;
