//! A walk on a map, in the terminal: the fog lifts where the walker looks, doors open and close,
//! guards walk and are hidden or seen.
//!
//! ```sh
//! cargo run --release -p casca-plane --features maps --example fog
//! cargo run --release -p casca-plane --features maps --example fog -- rooms
//! cargo run --release -p casca-plane --features maps,tiled --example fog -- FILE   # .tmx, or letters
//! cargo run --release -p casca-plane --features maps --example fog -- harbour 240
//! ```
//!
//! Keys: the arrows, or `w` `a` `s` `d`, move and open doors; space opens and closes the doors
//! around; `x` explores by itself; `q` ends. With a number behind the map the walker explores by
//! itself for so many steps, and prints what it knows then.

mod game;
mod look;
mod screen;

use std::error::Error;

use casca_plane::maps::{Drawing, FloorPlan, HARBOUR, MapKind};

use crate::game::Game;
use crate::look::look;

/// The seed of floor plans, caves and fields, and of where guards go.
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let name = words.next().unwrap_or("harbour".into());
    let mut game = Game::new(map(&name)?, SEED)?;
    let Some(steps) = words.next() else { return screen::play(&mut game) };
    for _ in 0..steps.parse::<u32>()? {
        let Some(step) = game.next_step() else { break };
        game.step(step);
        game.end_turn()?;
    }
    let (width, height) = game.size();
    for y in 0..height {
        println!("{}", (0..width).map(|x| look(&game, (x, y)).letter).collect::<String>());
    }
    Ok(())
}

/// The map of a name or in a file, with its doors, guards and start.
fn map(name: &str) -> Result<Drawing, Box<dyn Error>> {
    const WIDTH: u32 = 96;
    const HEIGHT: u32 = 54;
    let drawing = match name {
        "harbour" => Drawing::read(HARBOUR),
        "rooms" => {
            let plan = FloorPlan::generate(WIDTH, HEIGHT, SEED);
            Drawing { walls: plan.walls, doors: plan.doors, ..Drawing::default() }
        }
        "caves" | "fields" => {
            let kind = if name == "caves" { MapKind::Caves } else { MapKind::Fields };
            Drawing { walls: kind.generate(WIDTH, HEIGHT, SEED), ..Drawing::default() }
        }
        file if std::path::Path::new(file).exists() => Drawing::open(file)?,
        other => {
            return Err(format!(
                "{other} is no map: there are harbour, rooms, caves, fields, and files (.tmx, letters)"
            )
            .into());
        }
    };
    drawing.warnings.iter().for_each(|warning| eprintln!("{name}: {warning}"));
    Ok(drawing)
}
