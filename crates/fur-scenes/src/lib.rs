//! Furry animals and fields of them among walls, made from a seed: for the tests and the program of [`casca_fur`].

pub mod animals;
pub mod field;
