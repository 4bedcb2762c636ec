//! Furry animals and fields of them among walls, made from a seed, and characters of glTF files.

pub mod animals;
mod character;
pub mod field;
pub mod import;
pub mod sample;

pub use character::{Character, CharacterRig};
