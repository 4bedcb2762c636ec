//! The time of each stage by resolution: of a first picture, and of one after balls have moved.

use std::error::Error;
use std::time::{Duration, Instant};

use casca_stage::canvas::Canvas;
use casca_stage::gpu::Gpu;
use casca_stage::timing::Clock;
use casca_tools::command_line::say;

use crate::light::headless::told;
use crate::light::layer::Layer;
use crate::light::options::Options;
use crate::light::renderer::{Renderer, Settings};
use crate::light::scene::Start;

/// Frames of which times are the median, if no other number is given.
const FRAMES: u32 = 5;
/// Seconds that balls move between frames.
const SECONDS: f32 = 0.1;
/// Cells of all surfaces, before anything is lit.
const CELLS: &str = "cells";
/// Balls in other cells, and the rays that must be sent again.
const MOVE: &str = "move balls";

/// Stages with their times.
type Frame = Vec<(&'static str, Duration)>;

/// A renderer whose frames are timed.
struct Run {
    renderer: Renderer,
    first: Frame,
    frames: Vec<Frame>,
}

/// Prints the time of each stage at several resolutions.
pub fn time(gpu: &Gpu, start: &Start, options: &Options) -> Result<(), Box<dyn Error>> {
    let (width, height) = options.common.drawing.size;
    let frames = options.common.drawing.frames.unwrap_or(FRAMES);
    let balls = start.balls_at(0.0).count();
    say(format_args!(
        "{}, {width}x{height}; a first picture, and medians of {frames} after {balls} balls have moved",
        start.scene.name
    ));
    let canvas = Canvas::new(gpu, options.common.drawing.size);
    let mut runs = Vec::new();
    for &resolution in &options.times {
        match Run::new(gpu, start, Settings { resolution, ..options.settings() }, &canvas) {
            Ok(run) => runs.push(run),
            // The resolutions that fit are told nevertheless.
            Err(why) if !runs.is_empty() => say(format_args!("{resolution} cells: {why}")),
            Err(why) => return Err(why),
        }
    }
    // In turn, so that other work on the machine slows down all alike.
    for number in 1..=frames {
        runs.iter_mut().try_for_each(|run| run.frame(gpu, start, &canvas, number))?;
    }
    runs.iter().for_each(|run| say(told(&run.renderer)));
    let of = |pick: &dyn Fn(&Run) -> Frame| {
        runs.iter().map(|r| (r.renderer.settings().resolution, pick(r))).collect::<Vec<_>>()
    };
    table("first picture, ms", &of(&|run| medians(std::slice::from_ref(&run.first))));
    table("after a move, ms", &of(&|run| medians(&run.frames)));
    Ok(())
}

/// A row for each stage, and a column for each resolution.
fn table(title: &str, columns: &[(u32, Frame)]) {
    let heads: String = columns.iter().map(|(n, _)| format!("{n:>10}")).collect();
    say(format_args!("{title:<18}{heads} cells"));
    for (name, _) in columns.first().map_or(&[][..], |c| &c.1) {
        let times: String = columns.iter().map(|(_, stages)| format!("{:10.2}", of(stages, name))).collect();
        say(format_args!("  {name:<16}{times}"));
    }
}

/// Stages in the order in which they first ran, with the median over frames of their time in a
/// frame.
fn medians(frames: &[Frame]) -> Frame {
    let mut names: Vec<&'static str> = Vec::new();
    for (name, _) in frames.iter().flatten() {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let in_frame = |name: &str, frame: &Frame| frame.iter().filter(|s| s.0 == name).map(|s| s.1).sum();
    let median = |name: &'static str| {
        let mut times: Vec<Duration> = frames.iter().map(|frame| in_frame(name, frame)).collect();
        times.sort_unstable();
        (name, times[times.len() / 2])
    };
    names.into_iter().map(median).collect()
}

/// The time of a stage in milliseconds.
fn of(stages: &Frame, wanted: &str) -> f64 {
    let time: Duration = stages.iter().filter(|s| s.0 == wanted).map(|s| s.1).sum();
    time.as_secs_f64() * 1e3
}

impl Run {
    /// Draws a first picture, with all light that it reads.
    fn new(gpu: &Gpu, start: &Start, settings: Settings, canvas: &Canvas) -> Result<Self, Box<dyn Error>> {
        let begun = Instant::now();
        let mut clock = Clock::on();
        let renderer = Renderer::new(gpu, &start.scene, settings)?;
        clock.add(CELLS, begun.elapsed());
        let mut run = Self { renderer, first: Frame::new(), frames: Vec::new() };
        run.picture(gpu, start, canvas, &mut clock)?;
        run.first = clock.stages().to_vec();
        Ok(run)
    }

    fn picture(
        &mut self,
        gpu: &Gpu,
        start: &Start,
        canvas: &Canvas,
        clock: &mut Clock,
    ) -> Result<(), Box<dyn Error>> {
        let camera = start.camera(canvas.size());
        self.renderer.update(gpu, (&camera, canvas.size()), None, clock)?;
        self.renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, clock)
    }

    /// Draws a picture in which the balls have moved.
    fn frame(
        &mut self,
        gpu: &Gpu,
        start: &Start,
        canvas: &Canvas,
        number: u32,
    ) -> Result<(), Box<dyn Error>> {
        let mut clock = Clock::on();
        let begun = Instant::now();
        let balls: Vec<_> = start.balls_at(number as f32 * SECONDS).collect();
        self.renderer.move_objects(gpu, &balls)?;
        clock.add(MOVE, begun.elapsed());
        self.picture(gpu, start, canvas, &mut clock)?;
        self.frames.push(clock.stages().to_vec());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_that_of_the_sums_of_each_frame() {
        let ms = Duration::from_millis;
        let frames: Vec<Frame> =
            [3, 90, 4, 5, 1].map(|t| vec![("rays", ms(t)), ("show", ms(7)), ("rays", ms(1))]).into();
        let stages = medians(&frames);
        assert_eq!(stages, [("rays", ms(5)), ("show", ms(7))]);
        assert_eq!((of(&stages, "rays"), of(&stages, "none")), (5.0, 0.0));
        assert!(medians(&[]).is_empty());
    }
}
