//! Questions about boxes and points to the buffers of a query, beside exact rays and nine rays to
//! each box, as a table (CSV).

use casca_lab::experiments::LabError;
use casca_lab::experiments::sight::{Sampling, measure, table};
use casca_scenes::generated::SceneKind;
use casca_tools::command_line::{EXIT_CODES, Outcome, PathError, say, try_writing};
use clap::{Parser, value_parser};

use crate::arguments::{Out, Repeats, WalkArguments, about};
use crate::limits::MOST_SAMPLES;
use crate::progress;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Times questions about boxes and points, and compares the answers with exact rays",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("frames", about("20", "Frames of each walk in which questions are asked, evenly spread")),
    mut_arg("out", about("target/sight.csv", "Where the table goes"))
)]
pub struct Options {
    #[command(flatten)]
    walks: WalkArguments,
    /// Boxes that are asked for in a frame, and points
    #[arg(long, default_value_t = 10_000, value_parser = value_parser!(u32).range(1..=1_000_000))]
    questions: u32,
    /// Exact rays to a box, at most
    #[arg(long, default_value_t = 64, value_parser = value_parser!(u32).range(1..=MOST_SAMPLES))]
    samples: u32,
    #[command(flatten)]
    repeats: Repeats,
    #[command(flatten)]
    out: Out,
}

/// Measures, prints the table and writes it.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let names = options.walks.scenes_or(&SceneKind::ALL, Vec::new())?;
    try_writing(&options.out.out)?;
    let sampling = Sampling {
        frames: options.walks.frames as usize,
        questions: options.questions as usize,
        samples: options.samples as usize,
        repeats: options.repeats.repeats as usize,
        seed: options.walks.common.seed,
    };
    let mut costs = Vec::new();
    for name in &names {
        let world = options.walks.open(name)?;
        let frames = sampling.frames.min(world.frames);
        let bar = progress::bar(options.walks.common.quiet, frames, &world.name, "frame");
        costs.push(measure(world, &sampling, |done| bar.set_position(done as u64))?);
        bar.finish_and_clear();
    }
    let table = table(&costs);
    say(table.markdown());
    std::fs::write(&options.out.out, table.csv()).map_err(PathError::write(&options.out.out))?;
    say(options.out.out.display());
    let wrong = costs.iter().any(|c| c.wrong > 0);
    Ok(if wrong { Outcome::Lost } else { Outcome::Well })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_asked_and_absurd_values_are_refused() {
        let options = |line: &str| {
            Options::try_parse_from(std::iter::once("sight").chain(line.split_whitespace()))
                .map_err(|e| e.to_string())
        };
        for (line, word) in
            [("--questions 0", "1..=1000000"), ("--samples 0", "1..="), ("--scenes house", "spheres, city")]
        {
            let said = options(line).expect_err(line);
            assert!(said.contains(word), "{line}: {said}");
        }
        let folder = std::env::temp_dir().join(format!("casca-sight-{}", std::process::id()));
        let file = folder.join("sight.csv");
        let line =
            format!("--scenes rooms --frames 1 --questions 50 --repeats 1 --quiet --out {}", file.display());
        assert_eq!(run(&options(&line).unwrap()).unwrap(), Outcome::Well);
        let text = std::fs::read_to_string(&file).unwrap();
        assert_eq!(text.lines().count(), 2, "{text}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
