//! A walk on a map, in the terminal: the fog lifts where the walker looks, doors open and close,
//! guards walk and are hidden or seen.
//!
//! ```sh
//! cargo run --release -p casca-plane --features maps --example fog
//! cargo run --release -p casca-plane --features maps --example fog -- --map rooms --seed 7
//! cargo run --release -p casca-plane --features maps --example fog -- --gif fog.gif
//! cargo run --release -p casca-plane --features maps,tiled --example fog -- FILE   # .tmx, or letters
//! ```
//!
//! Keys: the arrows, or `w` `a` `s` `d`, move and open doors; space opens and closes the doors
//! around; `x` explores by itself; `q` ends. With `--png FILE` or `--gif FILE` the walker explores
//! by itself for `--frames` steps, without a terminal.

mod explore;
mod game;
mod look;
mod pictures;
mod screen;

use std::error::Error;

use casca_plane::maps::{Drawing, FloorPlan, HARBOUR, MapKind};

use crate::game::Game;

struct Options {
    map: String,
    seed: u64,
    png: Option<String>,
    gif: Option<String>,
    frames: u32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = options()?;
    let mut game = Game::new(map(&options)?, options.seed)?;
    if options.png.is_none() && options.gif.is_none() {
        return screen::play(&mut game);
    }
    pictures::record(&mut game, options.frames, options.png.as_deref(), options.gif.as_deref())
}

fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options { map: "harbour".into(), seed: 1, png: None, gif: None, frames: 240 };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if !word.starts_with('-') {
            options.map = word;
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        match word.as_str() {
            "--map" => options.map = value,
            "--seed" => options.seed = value.parse()?,
            "--png" => options.png = Some(value),
            "--gif" => options.gif = Some(value),
            "--frames" => options.frames = value.parse()?,
            _ => {
                return Err(
                    format!("{word} is no option: there are --map, --seed, --png, --gif, --frames").into()
                );
            }
        }
    }
    Ok(options)
}

/// The map that the options name, with its doors, guards and start.
fn map(options: &Options) -> Result<Drawing, Box<dyn Error>> {
    const WIDTH: u32 = 96;
    const HEIGHT: u32 = 54;
    let drawing = match options.map.as_str() {
        "harbour" => Drawing::read(HARBOUR),
        "rooms" => {
            let plan = FloorPlan::generate(WIDTH, HEIGHT, options.seed);
            Drawing { walls: plan.walls, doors: plan.doors, ..Drawing::default() }
        }
        "caves" | "fields" => {
            let kind = if options.map == "caves" { MapKind::Caves } else { MapKind::Fields };
            Drawing { walls: kind.generate(WIDTH, HEIGHT, options.seed), ..Drawing::default() }
        }
        file if std::path::Path::new(file).exists() => Drawing::open(file)?,
        other => {
            return Err(format!(
                "{other} is no map: there are harbour, rooms, caves, fields, and files (.tmx, letters)"
            )
            .into());
        }
    };
    drawing.warnings.iter().for_each(|warning| eprintln!("{}: {warning}", options.map));
    Ok(drawing)
}
