//! Speed against accuracy: every method at several settings on every scene, beside the
//! methods that engines use today, as a chart (SVG) and a table (CSV).
//!
//! All queries run on one thread. "Visible" is an exact item buffer, one ray a pixel. The command
//! `report` has the same for all scenes, with the settings that it recommends.

use casca_lab::experiments::LabError;
use casca_lab::experiments::tradeoff::{Sampling, SceneTradeoff, chart, measure, table};
use casca_scenes::generated::SceneKind;
use casca_tools::command_line::{EXIT_CODES, Outcome, PathError, say, try_writing_into};
use clap::Parser;

use crate::arguments::{Out, Repeats, WalkArguments, Width, about, default_to};
use crate::progress;

/// What is written.
const FILES: [&str; 2] = ["tradeoff.csv", "tradeoff.svg"];

/// The options.
#[derive(Debug, Parser)]
#[command(about = "Charts speed against accuracy for all methods and settings", after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("scenes", |a| a.help("Scenes: procedural ones or glTF files [default: the procedural ones of solids]")),
    mut_arg("frames", default_to("30")),
    mut_arg("width", default_to("2560")),
    mut_arg("out", about("target/tradeoff", "Where the chart and the table go")))]
pub struct Options {
    #[command(flatten)]
    walks: WalkArguments,
    #[command(flatten)]
    repeats: Repeats,
    #[command(flatten)]
    width: Width,
    #[command(flatten)]
    out: Out,
}

fn print(scene: &SceneTradeoff) {
    say(format_args!(
        "\n{}: {} frames, {:.1} objects in the frustum, {:.1} visible",
        scene.scene, scene.frames, scene.in_frustum, scene.visible
    ));
    say(format_args!(
        "{:<34}{:<32}{:>9}{:>9}{:>9}{:>9}  front",
        "method", "setting", "ms", "PVS", "PVS/EVS", "lost"
    ));
    for p in &scene.points {
        say(format_args!(
            "{:<34}{:<32}{:>9.3}{:>9.1}{:>9.3}{:>9.3}{}",
            p.method,
            p.setting,
            p.ms,
            p.ratio * scene.visible,
            p.ratio,
            p.lost,
            if p.front { "  *" } else { "" }
        ));
    }
    say(format_args!(
        "the automatic settings are {:.1}% behind the front",
        scene.automatic_distance() * 100.0
    ));
}

/// Measures, prints and writes the chart and the table.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let names = options.walks.scenes_or(&SceneKind::SOLIDS, Vec::new())?;
    // Measuring takes minutes: what cannot be read or written is said before it.
    try_writing_into(&options.out.out, &FILES)?;
    let sampling = Sampling {
        frames: options.walks.frames as usize,
        repeats: options.repeats.repeats as usize,
        width: options.width.width as usize,
    };
    let mut scenes = Vec::new();
    for name in &names {
        let world = options.walks.open(name)?;
        let frames = sampling.frames.min(world.frames);
        let bar = progress::bar(options.walks.common.quiet, frames, &world.name, "frame");
        let scene = measure(world, &sampling, |done| bar.set_position(done as u64))?;
        bar.finish_and_clear();
        print(&scene);
        scenes.push(scene);
    }
    let [csv, charts @ ..] = FILES.map(|file| options.out.out.join(file));
    std::fs::write(&csv, table(&scenes).csv()).map_err(PathError::write(&csv))?;
    for file in &charts {
        chart(file, &scenes)?;
    }
    say(format_args!("\nchart and table: {}", options.out.out.join("tradeoff.{svg,csv}").display()));
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_values_are_refused_and_the_ends_of_each_range_taken() {
        let options = |line: &str| {
            Options::try_parse_from(std::iter::once("tradeoff").chain(line.split_whitespace()))
                .map_err(|e| e.to_string())
        };
        for (line, word) in [
            ("--frames 0", "1..=100000"),
            ("--frames 99999999999", "1..=100000"),
            ("--repeats 0", "1..=1000"),
            ("--repeats 99999999999", "1..=1000"),
            ("--width 0", "16..=16384"),
            ("--width 100000", "16..=16384"),
            ("--seed NaN", "--seed"),
            ("--scenes city,house", "spheres, city"),
            ("--scenes city,", "spheres, city"),
        ] {
            let said = options(line).expect_err(line);
            assert!(said.contains(word), "{line}: {said}");
        }
        for line in ["", "--frames 1 --repeats 1 --width 16", "--width 16384 --scenes city,a.glb"] {
            assert!(options(line).is_ok(), "{line}");
        }
    }

    #[test]
    fn a_missing_scene_or_a_folder_that_is_none_is_named_before_anything_is_measured() {
        let place = std::env::temp_dir().join(format!("casca-tradeoff-{}", std::process::id()));
        std::fs::write(&place, "no folder").unwrap();
        let failure = |words: &[&str]| {
            let options = Options::parse_from(std::iter::once(&"tradeoff").chain(words));
            run(&options).unwrap_err().to_string()
        };
        let place_name = place.to_str().unwrap();
        assert!(failure(&["--quiet", "--out", place_name]).contains(place_name));
        assert!(failure(&["--quiet", "--scenes", "crowd,no/such.glb"]).contains("no/such.glb"));
        std::fs::remove_file(&place).unwrap();
    }
}
