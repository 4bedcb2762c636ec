//! Stand-in for the program until its branch is merged.

#[path = "../src/bin/casca-points/large/mod.rs"]
mod large;

use clap::Parser;

#[derive(Parser)]
enum Options {
    Generate(large::Generate),
    Bricks(large::Cut),
    Walk(large::Walk),
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    match Options::parse() {
        Options::Generate(generate) => generate.run(),
        Options::Bricks(cut) => cut.run(),
        Options::Walk(walk) => walk.run(),
    }
}
