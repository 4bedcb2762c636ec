//! Animals, herds of them, and characters of files.

mod character;
mod coated;
mod herd;
#[path = "../../../../crates/scenes/src/import/tests/parts.rs"]
mod parts;
mod skins;
