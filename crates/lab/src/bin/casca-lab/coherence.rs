//! A walking camera, and the ways to answer its frames side by side.

use casca_lab::experiments::LabError;
use casca_lab::experiments::coherence::{MOVERS, SCENES, Sampling, WalkScore, measure, table};
use casca_tools::command_line::{EXIT_CODES, Outcome, say};
use clap::{Parser, value_parser};

use crate::arguments::{WalkArguments, Width, about, default_to};
use crate::limits::FRAMES;
use crate::progress;
use crate::report::files_in;

/// Movers of a scene, at most.
const MOST_MOVERS: i64 = 1_000_000;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Times the frames of a walking camera, by each way to answer them, and checks the answers",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("scenes", |a| a.help("Scenes: procedural ones or glTF files [default: city, rooms, town and the files in ../shared/scenes]")),
    mut_arg("frames", about("600", "Frames of a walk, at 60 a second")),
    mut_arg("width", default_to("1280"))
)]
pub struct Options {
    #[command(flatten)]
    walks: WalkArguments,
    /// Objects that move, one run for each number
    #[arg(long, value_delimiter = ',', default_values_t = MOVERS.map(|n| n as u32),
        value_parser = value_parser!(u32).range(0..=MOST_MOVERS))]
    movers: Vec<u32>,
    /// Places along the path of the scene in which these frames are walked
    #[arg(long, default_value_t = 3, value_parser = value_parser!(u32).range(1..=1000))]
    stretches: u32,
    /// One frame of so many is compared with exact visibility
    #[arg(long, default_value_t = 7, value_parser = value_parser!(u32).range(FRAMES))]
    judge: u32,
    #[command(flatten)]
    width: Width,
}

impl Options {
    fn sampling(&self) -> Sampling {
        Sampling {
            frames: self.walks.frames as usize,
            stretches: self.stretches as usize,
            judge: self.judge as usize,
            width: self.width.width as usize,
            rays: 4,
            seed: self.walks.common.seed,
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
    let names = options.walks.scenes_or(&SCENES, files_in("../shared/scenes"))?;
    say(
        "ms: mean time of a frame. mean, median, p99 and found: over those of `fresh`. wrong: visible objects that are missing. update: begin_frame, \
         update and end_frame.\n",
    );
    let mut wrong = 0;
    for name in &names {
        for &movers in &options.movers {
            let world = options.walks.open(name)?;
            let bar = progress::bar(
                options.walks.common.quiet,
                options.walks.frames as usize,
                &world.name,
                "frame",
            );
            let score =
                measure(world, movers as usize, &options.sampling(), |done| bar.set_position(done as u64))?;
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
