//! The cost of a sampled occlusion buffer, and the default method beside it, on one thread.

use casca_lab::command_line::{EXIT_CODES, FRAMES, Outcome, SceneName, WIDTHS, say};
use casca_lab::lab::LabError;
use casca_lab::lab::buffer::{BufferCost, Score, measure};
use casca_lab::lab::tradeoff::Sampling;
use casca_lab::scenes::{SceneKind, SceneOptions};
use clap::{Parser, value_parser};

use crate::progress;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Times a sampled occlusion buffer, a triangle and a box, beside the default method",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// Scenes: procedural ones or glTF files [default: all procedural ones]
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<SceneName>,
    /// Width of the buffer in pixels, 16 to 16384; it is 16:9
    #[arg(long, default_value_t = 320, value_parser = value_parser!(u32).range(WIDTHS))]
    pixels: u32,
    /// Frames of each walk that are measured, evenly spread
    #[arg(long, default_value_t = 30, value_parser = value_parser!(u32).range(FRAMES))]
    frames: u32,
    /// Times each frame is measured; the least counts
    #[arg(long, default_value_t = 5, value_parser = value_parser!(u32).range(1..=1000))]
    repeats: u32,
    /// Width of the item buffer that finds the visible objects, 16 to 16384
    #[arg(long, default_value_t = 2560, value_parser = value_parser!(u32).range(WIDTHS))]
    width: u32,
    /// Seed of procedural scenes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// No progress bar
    #[arg(long)]
    quiet: bool,
}

fn print(cost: &BufferCost) {
    let score = |s: &Score| format!("{:>8.3}{:>7.3}{:>7.2}", s.ms, s.ratio, s.lost);
    say(format_args!(
        "{:<16}{:>8.0}{:>8.1}{}{}{:>7.1}{:>9.0}{:>9.0}{:>8.0}{:>8.1}{:>8.1}",
        cost.scene,
        cost.in_frustum,
        cost.visible,
        score(&cost.point),
        score(&cost.buffer),
        cost.point.ms / cost.buffer.ms,
        cost.triangles[0],
        cost.triangles[1],
        cost.tests,
        cost.ns_triangle,
        cost.ns_box
    ));
}

/// Measures and prints.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let names = match &options.scenes[..] {
        [] => SceneKind::ALL.map(SceneName::Built).to_vec(),
        given => given.to_vec(),
    };
    names.iter().try_for_each(SceneName::check)?;
    let sampling = Sampling {
        frames: options.frames as usize,
        repeats: options.repeats as usize,
        width: options.width as usize,
    };
    let size = (options.pixels as usize, (options.pixels as usize * 9).div_ceil(16));
    say(format_args!(
        "the buffer has {}x{} pixels; ratios are times of `point` over those of the buffer",
        size.0, size.1
    ));
    say(format_args!(
        "{:<16}{:>8}{:>8}{:>8}{:>7}{:>7}{:>8}{:>7}{:>7}{:>7}{:>9}{:>9}{:>8}{:>8}{:>8}",
        "scene",
        "frustum",
        "visible",
        "point ms",
        "PVS/",
        "lost",
        "hzb ms",
        "PVS/",
        "lost",
        "ratio",
        "tris",
        "on pix",
        "tests",
        "ns/tri",
        "ns/box"
    ));
    for name in &names {
        let world = name.open(&SceneOptions { seed: options.seed, ..SceneOptions::default() })?;
        let frames = sampling.frames.min(world.frames);
        let bar = progress::bar(options.quiet, frames, &world.name, "frame");
        let cost = measure(world, size, &sampling, |done| bar.set_position(done as u64))?;
        bar.finish_and_clear();
        print(&cost);
    }
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_measured_and_absurd_values_are_refused() {
        let options = |line: &str| {
            Options::try_parse_from(std::iter::once("buffer").chain(line.split_whitespace()))
                .map_err(|e| e.to_string())
        };
        for (line, word) in
            [("--pixels 15", "16..=16384"), ("--repeats 0", "1..=1000"), ("--scenes house", "spheres, city")]
        {
            let said = options(line).expect_err(line);
            assert!(said.contains(word), "{line}: {said}");
        }
        let quick = options("--scenes rooms --frames 1 --repeats 1 --width 160 --pixels 64 --quiet").unwrap();
        assert_eq!(run(&quick).unwrap(), Outcome::Well);
    }
}
