//! Views: where their eyes are, and what any of the eyes that they stand for sees.

#[path = "../common/mod.rs"]
mod common;

mod eye;
mod reach;
mod sight;
mod turn;
mod view_cell;
