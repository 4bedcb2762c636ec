//! Furry animals, and fields of them among walls, made from a seed.

pub mod animals;
mod character;
pub mod field;
pub mod sample;
mod walk;

pub use character::{Character, CharacterRig, Masks};
