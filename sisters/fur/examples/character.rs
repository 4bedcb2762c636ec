//! Writes a character for `casca fur FILE.glb`: an animal with colours, stripes, a collar,
//! materials and a walk. `cargo run --release -p casca-fur --features scenes --example character --
//! cat.glb [SEED]`

use std::error::Error;

use casca_fur::scenes::sample::character_glb;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let path = words.next().ok_or("give the name of the file to write")?;
    let seed = words.next().map_or(Ok(2), |word| word.parse())?;
    std::fs::write(&path, character_glb(seed, 96)?)?;
    println!("{path}");
    Ok(())
}
