//! Furry animals, and fields of them among walls: made from a seed, or of glTF files.

pub mod animals;
mod character;
pub mod field;
mod gait;
pub mod import;
pub mod sample;
mod species;

pub use character::{Character, CharacterRig};
pub use species::Species;
