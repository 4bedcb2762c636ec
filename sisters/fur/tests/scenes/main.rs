//! Animals, herds of them, and characters of files.

mod character;
mod coated;
mod field;
#[path = "../../../../crates/scenes/src/import/tests/parts.rs"]
mod parts;
mod skins;
