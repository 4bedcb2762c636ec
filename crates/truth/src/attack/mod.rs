//! An attack on the library: operations on small scenes, as applications and mistakes make them,
//! played on the library and on a model of the truth that shares no code with it.
//!
//! The truth knows every solid, and moves objects whose motion goes unreported to where they do
//! most harm, within what they promised. Each set that a query finds, and each kept set that is
//! said to hold, must hold every object that a ray in double precision reaches.
//!
//! - [`play_seed`] plays one scene by a seed, and reduces what fails to few operations.
//! - [`play_bytes`] does so for the bytes of a fuzzer.
//! - [`long_run`] plays scene after scene.
//! - [`grazing`] aims at tiny objects closely past the outlines of occluders.

mod dice;
mod forms;
pub mod grazing;
mod make;
mod ops;
mod player;
mod run;
mod solid;
mod truth;
mod views;

pub use run::{Run, Tally, long_run, play_bytes, play_seed};
