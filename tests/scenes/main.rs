//! Whole scenes, built and random, against exact visibility; and queries that must find the same sets.

#[path = "../common/mod.rs"]
mod common;

mod coherent;
mod layers;
mod parallel;
mod stats;
mod tightness;
mod visibility;
