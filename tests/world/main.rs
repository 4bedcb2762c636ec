//! Worlds of any size: what an eye sees is in the sets while pages come and go and the origin
//! moves; places are rounded to the safe side; ids stay and old results are refused.

#[path = "../common/mod.rs"]
mod common;

mod attack;
mod calls;
mod model;
mod origin;
mod rounding;
