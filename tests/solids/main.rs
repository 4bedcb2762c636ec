//! Shapes and the cells that they fill, against points inside them.

#[path = "../common/mod.rs"]
mod common;

mod bounds;
mod cells;
mod convex;
mod opacity;
mod outside;
mod placed;
