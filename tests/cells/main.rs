//! Hidden cells, and the walks through them.

#[path = "../common/mod.rs"]
mod common;

mod occlusion;
mod sparse;
mod work;
