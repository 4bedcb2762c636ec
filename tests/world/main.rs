//! Worlds of any size: what an eye sees is in the sets when the origin moves; places are rounded to
//! the safe side; ids stay and old results are refused.

#[path = "../common/mod.rs"]
mod common;

mod flight;
mod origin;
mod rounding;
