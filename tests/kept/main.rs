//! Sets and queries that are kept over frames.

#[path = "../common/mod.rs"]
mod common;

mod queries;
mod sets;
