//! Fur by Bevy: beside casca-fur's own pictures, and a herd behind walls with and without culling.
//!
//! `cargo run --bin fur`, with Rust 1.97.1 or newer. `--out FOLDER` keeps the pictures.

use std::path::PathBuf;
use std::process::ExitCode;

use bevy::prelude::Transform;
use bevy_casca::CascaSettings;
use bevy_casca_rendered::fur::{Ball, coats, rmse, timed};
use bevy_casca_rendered::herd::Herd;
use bevy_casca_rendered::rendered::{HEIGHT, WIDTH, save};
use casca_tools::image::halved;
use clap::Parser;

/// Compares fur by Bevy with fur by casca-fur, and a herd with and without bevy_casca.
#[derive(Parser)]
struct Arguments {
    /// The folder of PNG files
    #[arg(long)]
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match ball(&arguments).and_then(|()| herd(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

/// The greatest RMSE between a picture of Bevy's and one of casca-fur's: rounding and another curve
/// of colours, but no strand that is missing.
const ALIKE: f64 = 0.004;

/// A ball by Bevy, by casca-fur and by rays.
fn ball(arguments: &Arguments) -> Result<(), String> {
    let ball = Ball::new()?;
    let traced = ball.traced()?;
    for layers in [4, 8, 16, 24] {
        let ((bevy, time), own) = (ball.by_bevy(layers)?, ball.by_casca_fur(layers)?);
        let half = |picture: &[u8]| halved(picture, (WIDTH, HEIGHT));
        println!(
            "{layers} layers: Bevy to casca-fur {:.4}; to traced strands Bevy {:.4}, casca-fur {:.4}; \
             {time:.0} ms a frame",
            rmse(&bevy, &own),
            rmse(&half(&bevy), &traced),
            rmse(&half(&own), &traced)
        );
        if rmse(&bevy, &own) > ALIKE {
            return Err(format!("pictures of {layers} layers differ by more than {ALIKE}"));
        }
        for (name, picture) in [("bevy", &bevy), ("own", &own)] {
            save(arguments.out.as_deref(), &format!("ball-{layers}-{name}.png"), (WIDTH, HEIGHT), picture)?;
        }
    }
    save(arguments.out.as_deref(), "ball-traced.png", (WIDTH / 2, HEIGHT / 2), &traced)
}

/// The same pictures with and without culling.
fn herd(arguments: &Arguments) -> Result<(), String> {
    let herd = Herd::behind_walls();
    let mut apps = [herd.app(Some(CascaSettings::default()))?, herd.app(None)?];
    let mut differ = 0;
    for (i, eye) in herd.eyes.iter().enumerate() {
        let mut pictures = Vec::new();
        let mut counts = Vec::new();
        for (app, name) in apps.iter_mut().zip(["casca", "bevy"]) {
            let (world, camera) = app.world_and_camera();
            if let Some(mut at) = world.get_mut::<Transform>(camera) {
                *at = *eye;
            }
            let (picture, time) = timed(app)?;
            println!("eye {i}, {name}: {time:.0} ms a frame");
            save(arguments.out.as_deref(), &format!("herd-{i}-{name}.png"), (WIDTH, HEIGHT), &picture)?;
            pictures.push(picture);
            counts.push(coats(app));
        }
        let other = pictures[0].chunks(4).zip(pictures[1].chunks(4)).filter(|(a, b)| a != b).count();
        // Coats drawn without culling have the same layers with it; hidden ones may lag behind.
        let drawn = |coats: &[(u32, bool)]| coats.iter().filter(|(_, drawn)| *drawn).count();
        let lag = counts[0].iter().zip(&counts[1]).filter(|(a, b)| a.1 && a.0 != b.0).count();
        println!(
            "eye {i}: {other} pixels differ; {} coats of {} drawn by casca, {} by Bevy, {lag} with other layers",
            drawn(&counts[0]),
            herd.animals.len(),
            drawn(&counts[1])
        );
        differ += other;
    }
    if differ > 0 { Err("pictures with and without culling differ".into()) } else { Ok(()) }
}
