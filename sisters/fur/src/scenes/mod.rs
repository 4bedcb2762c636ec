//! Furry animals and fields of them among walls, made from a seed, and characters of glTF files.

pub mod animals;
mod character;
pub mod field;
pub mod import;
pub mod sample;

pub use character::{Character, CharacterRig};

/// Milliseconds that Linux gave to the threads of this process: a software adapter draws with them.
pub fn threads() -> f64 {
    let words = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    words.split(' ').skip(13).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() * 10.0
}
