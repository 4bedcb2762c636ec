//! Prints the costs of soft visibility: nanoseconds for each question, and bytes, at three resolutions of one scene.
//!
//! `cargo run --release --features soft --example soft_costs`

fn main() {}
