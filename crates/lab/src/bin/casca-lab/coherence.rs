//! A walking camera, and the ways to answer its frames side by side.

use casca_lab::command_line::{EXIT_CODES, FRAMES, Outcome, SceneName, WIDTHS, say};
use casca_lab::experiments::LabError;
use casca_lab::experiments::coherence::{Effort, MOVERS, SCENES, WalkScore, measure, table};
use casca_scenes::generated::SceneOptions;
use clap::{Parser, value_parser};

use crate::progress;
use crate::report::files_in;

/// Movers of a scene, at most.
const MOST_MOVERS: i64 = 1_000_000;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Times the frames of a walking camera, by each way to answer them, and checks the answers",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// Scenes: procedural ones or glTF files [default: city, rooms, town and the files in ../shared/scenes]
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<SceneName>,
    /// Objects that move, one run for each number
    #[arg(long, value_delimiter = ',', default_values_t = MOVERS.map(|n| n as u32),
        value_parser = value_parser!(u32).range(0..=MOST_MOVERS))]
    movers: Vec<u32>,
    /// Frames of a walk, at 60 a second
    #[arg(long, default_value_t = 600, value_parser = value_parser!(u32).range(FRAMES))]
    frames: u32,
    /// Places along the path of the scene in which these frames are walked
    #[arg(long, default_value_t = 3, value_parser = value_parser!(u32).range(1..=1000))]
    stretches: u32,
    /// One frame of so many is compared with exact visibility
    #[arg(long, default_value_t = 7, value_parser = value_parser!(u32).range(FRAMES))]
    judge: u32,
    /// Width of the item buffer that finds the visible objects, 16 to 16384
    #[arg(long, default_value_t = 1280, value_parser = value_parser!(u32).range(WIDTHS))]
    width: u32,
    /// Seed of procedural scenes, movers and rays
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// No progress bar
    #[arg(long)]
    quiet: bool,
}

impl Options {
    fn effort(&self) -> Effort {
        Effort {
            frames: self.frames as usize,
            stretches: self.stretches as usize,
            judge: self.judge as usize,
            width: self.width as usize,
            rays: 4,
            seed: self.seed,
        }
    }
}

/// Prints the table of a walk.
fn print(score: &WalkScore) {
    say(format_args!(
        "{}, {} movers: {} frames timed, {} judged, {:.1} objects visible",
        score.scene, score.movers, score.frames, score.judged, score.visible
    ));
    say(table(std::slice::from_ref(score)).aligned());
}

/// Walks, prints, and tells whether an answer was wrong.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let names = match &options.scenes[..] {
        [] => {
            let files = files_in("../shared/scenes").into_iter().map(SceneName::File);
            SCENES.into_iter().map(SceneName::Built).chain(files).collect()
        }
        given => given.to_vec(),
    };
    names.iter().try_for_each(SceneName::check)?;
    say(
        "ms: mean time of a frame. mean, median, p99 and found: over those of `fresh`. wrong: visible objects that are missing. update: begin_frame, \
         update and end_frame.\n",
    );
    let mut wrong = 0;
    for name in &names {
        for &movers in &options.movers {
            let world = name.open(&SceneOptions { seed: options.seed, ..SceneOptions::default() })?;
            let bar = progress::bar(options.quiet, options.frames as usize, &world.name, "frame");
            let score =
                measure(world, movers as usize, &options.effort(), |done| bar.set_position(done as u64))?;
            bar.finish_and_clear();
            print(&score);
            wrong += score.ways.iter().map(|w| w.wrong).sum::<usize>();
        }
    }
    Ok(if wrong == 0 { Outcome::Well } else { Outcome::Lost })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(line: &str) -> Result<Options, String> {
        Options::try_parse_from(std::iter::once("coherence").chain(line.split_whitespace()))
            .map_err(|e| e.to_string())
    }

    #[test]
    fn a_walk_is_measured_and_absurd_values_are_refused() {
        for (line, word) in [
            ("--movers 1000001", "0..=1000000"),
            ("--movers 1,x", "--movers"),
            ("--frames 0", "1..=100000"),
            ("--judge 0", "1..=100000"),
            ("--scenes house", "spheres, city"),
        ] {
            let said = options(line).expect_err(line);
            assert!(said.contains(word), "{line}: {said}");
        }
        assert_eq!(options("").unwrap().movers, [0, 200, 10_000]);
        let quick = options("--scenes rooms --movers 0,20 --frames 20 --width 160 --quiet").unwrap();
        assert_eq!(run(&quick).unwrap(), Outcome::Well);
    }
}
