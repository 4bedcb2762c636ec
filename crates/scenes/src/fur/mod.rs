//! Furry animals, and fields of them among walls, made from a seed.

pub mod animals;
pub mod field;
mod walk;
