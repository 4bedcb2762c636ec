//! Objects that move, are hidden in volumes, are reported late, or reach out of the grid: none that an
//! eye sees is lost.

#[path = "../common/mod.rs"]
mod common;

mod dynamics;
mod hiding;
mod lists;
mod overhang;
mod reports;
mod volumes;
