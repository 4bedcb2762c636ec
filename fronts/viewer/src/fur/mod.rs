//! Furry animals: one, or a field of them among walls, in a window or in files.

mod choices;
mod field;
mod herd;
mod one;
mod walker;
mod window;

pub use choices::Choices as Options;
