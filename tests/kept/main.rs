//! Sets and queries that are kept over frames.

#[path = "../common/mod.rs"]
mod common;

mod game;
mod queries;
mod sets;
