//! The cost of a sampled occlusion buffer, and the presets of the default method beside it, on one
//! thread.

use casca_lab::experiments::LabError;
use casca_lab::experiments::buffer::{BufferCost, PRESETS, Sampling, Score, measure};
use casca_scenes::generated::SceneKind;
use casca_tools::command_line::{EXIT_CODES, Outcome, say};
use clap::{Parser, value_parser};

use crate::arguments::{Repeats, WalkArguments, Width, default_to};
use crate::limits::{FRAMES, WIDTHS};
use crate::progress;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Times a sampled occlusion buffer, a triangle and a box, beside the default method and its presets",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("frames", default_to("150")),
    mut_arg("width", default_to("2560"))
)]
pub struct Options {
    #[command(flatten)]
    walks: WalkArguments,
    /// Width of the buffer in pixels, 16 to 16384; it is 16:9
    #[arg(long, default_value_t = 320, value_parser = value_parser!(u32).range(WIDTHS))]
    pixels: u32,
    /// How many of the frames are compared with exact visibility
    #[arg(long, default_value_t = 30, value_parser = value_parser!(u32).range(FRAMES))]
    judged: u32,
    #[command(flatten)]
    repeats: Repeats,
    #[command(flatten)]
    width: Width,
}

fn print(cost: &BufferCost) {
    let score = |s: &Score| format!("{:>8.3}{:>8.3}{:>7.3}{:>7.2}", s.ms, s.p99, s.ratio, s.lost);
    let row = |name: &str, rest: String| say(format_args!("  {name:<14}{rest}"));
    say(format_args!(
        "{}: {:.0} objects in the frustum, {:.1} visible; the buffer draws {:.0} triangles, {:.0} on pixels ({:.1} ns each), \
         and tests {:.0} boxes ({:.1} ns each)",
        cost.scene,
        cost.in_frustum,
        cost.visible,
        cost.triangles[0],
        cost.triangles[1],
        cost.ns_triangle,
        cost.tests,
        cost.ns_box
    ));
    row("hzb", score(&cost.buffer));
    for ((name, _), s) in PRESETS.iter().zip(&cost.presets) {
        let buffer = s.ms / cost.buffer.ms.max(f64::MIN_POSITIVE);
        row(&format!("point, {name}"), format!("{}{buffer:>7.1}{:>7.1}{:>7.1}", score(s), s.tail(), s.swing));
    }
    if !cost.keeps_order() {
        say("  the presets are out of order");
    }
}

/// Measures and prints.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let names = options.walks.scenes_or(&SceneKind::ALL, Vec::new())?;
    let sampling = Sampling {
        frames: options.walks.frames as usize,
        judged: options.judged as usize,
        repeats: options.repeats.repeats as usize,
        width: options.width.width as usize,
    };
    let size = (options.pixels as usize, (options.pixels as usize * 9).div_ceil(16));
    say(format_args!(
        "The buffer has {}x{} pixels. Columns: median ms, p99 ms, PVS/visible, visible objects lost in a frame; for `point` also \
         time over that of the buffer, p99 over median of the time, and of the set.",
        size.0, size.1
    ));
    for name in &names {
        let world = options.walks.open(name)?;
        let frames = sampling.frames.min(world.frames);
        let bar = progress::bar(options.walks.common.quiet, frames, &world.name, "frame");
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
