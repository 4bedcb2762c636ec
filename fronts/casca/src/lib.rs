//! What the program `casca` does that no other crate does: [`doctor`], which examines a level.

pub mod doctor;
