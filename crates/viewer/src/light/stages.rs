//! The time of each stage, beside the thesis' ratios, and what culling saves.

use std::error::Error;
use std::time::{Duration, Instant};

use casca_light::culling::{Culling, may_see};
use casca_light::picture::Layer;
use casca_light::renderer::{Renderer, Settings, Updated};
use casca_stage::canvas::Canvas;
use casca_stage::command_line::say;
use casca_stage::gpu::Gpu;
use casca_stage::timing::Clock;

use crate::light::headless::told;
use crate::light::options::Options;
use crate::light::scene::Start;

/// Frames of which times are the median, if no other number is given.
const FRAMES: u32 = 5;
/// Seconds that balls move between frames.
const SECONDS: f32 = 0.1;
/// Step factors of the thesis, as shares of a cone's diameter, and its times relative to that of
/// 0.5 (table 4.6, mean of four scenes).
const STEP_FACTORS: [(f32, f32); 4] = [(0.1, 3.99), (0.25, 1.73), (0.5, 1.0), (2.5, 0.38)];
/// The thesis' ratios for a doubling of the resolution, from 128 to 256 or 256 to 512 (table 4.4).
const DOUBLINGS: [(&str, &str); 4] =
    [("mips", "5.3 to 7.9"), ("cones", "1.1"), ("bounce", "5.2 to 6.6"), ("shade", "4.8 to 6.1")];
/// The culler's part of a frame: the query, and the bricks that the picture can read.
const CULLER: &str = "culler";
/// The stages that culling makes shorter.
const LIGHT: [&str; 4] = ["shade", "bounce", "write voxels", "mips"];

/// A frame: its stages, and the times of the culler.
type Frame = Vec<(&'static str, Duration)>;

/// Prints the time of each stage at several resolutions, and that of cones by step; or what culling
/// saves.
pub fn time(gpu: &Gpu, start: &Start, options: &Options) -> Result<(), Box<dyn Error>> {
    let (width, height) = options.common.drawing.size;
    say(format_args!(
        "{}, {width}x{height}, {} balls move; medians of {} frames",
        start.scene.name,
        start.balls_at(0.0).count(),
        options.common.drawing.frames.unwrap_or(FRAMES)
    ));
    let canvas = Canvas::new(gpu, options.common.drawing.size);
    if options.cull {
        return culled(gpu, start, options, &canvas);
    }
    by_resolution(gpu, start, options, &canvas)?;
    by_step(gpu, start, options, &canvas)
}

fn by_resolution(gpu: &Gpu, start: &Start, options: &Options, canvas: &Canvas) -> Result<(), Box<dyn Error>> {
    let mut runs = Vec::new();
    for &resolution in &options.times {
        match Run::new(gpu, start, Settings { resolution, ..options.settings() }, Update::All, canvas) {
            Ok(run) => runs.push(run),
            // The resolutions that fit are told nevertheless.
            Err(why) if !runs.is_empty() => say(format_args!("{resolution} cells: {why}")),
            Err(why) => return Err(why),
        }
    }
    run_frames(gpu, start, options, canvas, &mut runs)?;
    let columns: Vec<(u32, Frame)> =
        runs.iter().map(|run| (run.renderer.settings().resolution, medians(&run.frames))).collect();
    runs.iter().for_each(|run| say(told(&run.renderer, &run.updated)));
    let heads: String = columns.iter().map(|(n, _)| format!("{n:>10}")).collect();
    say(format_args!("{:<16}{heads} cells; ms", ""));
    for (name, _) in columns.first().map_or(&[][..], |c| &c.1) {
        let times: Vec<f64> = columns.iter().map(|(_, stages)| of(stages, &[*name])).collect();
        let row: String = times.iter().map(|t| format!("{t:10.2}")).collect();
        let ratios: Vec<String> = times.windows(2).map(|w| format!("x{:.1}", w[1] / w[0])).collect();
        let thesis = DOUBLINGS.iter().find(|d| d.0 == *name);
        let thesis = thesis.map_or(String::new(), |d| format!("; thesis x{} for a doubling", d.1));
        say(format_args!("{name:<16}{row}   {}{thesis}", ratios.join(" ")));
    }
    Ok(())
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

/// The sum of some stages in milliseconds.
fn of(stages: &Frame, wanted: &[&str]) -> f64 {
    let time: Duration = stages.iter().filter(|s| wanted.contains(&s.0)).map(|s| s.1).sum();
    time.as_secs_f64() * 1e3
}

/// What is brought up to date in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Update {
    /// All light, as after a change of all lights.
    All,
    /// The light that the balls may change.
    OnNeed,
    /// Of that, what the picture can read.
    Culled,
}

/// A renderer whose frames are timed.
struct Run {
    renderer: Renderer,
    update: Update,
    /// For updates of what the picture can read.
    culling: Option<Culling>,
    frames: Vec<Frame>,
    updated: Updated,
}

impl Run {
    /// Draws a first frame, which is not counted.
    fn new(
        gpu: &Gpu,
        start: &Start,
        settings: Settings,
        update: Update,
        canvas: &Canvas,
    ) -> Result<Self, Box<dyn Error>> {
        let mut renderer = Renderer::new(gpu, &start.scene, settings)?;
        let mut clock = Clock::on();
        let updated = renderer.update(gpu, None, &mut clock)?;
        // The layer that stays is voxelized once.
        if let Some((name, time)) = clock.stages().first() {
            let ms = time.as_secs_f64() * 1e3;
            say(format_args!("{} cells: {name} {ms:.2} ms, once", settings.resolution));
        }
        let camera = start.camera(canvas.size());
        renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, &mut Clock::off())?;
        let culling = if update == Update::Culled {
            Some(Culling::new(&start.scene, renderer.volume())?)
        } else {
            None
        };
        Ok(Self { renderer, update, culling, frames: Vec::new(), updated })
    }

    /// Draws a frame in which the balls move.
    fn frame(
        &mut self,
        gpu: &Gpu,
        start: &Start,
        canvas: &Canvas,
        number: u32,
    ) -> Result<(), Box<dyn Error>> {
        let camera = start.camera(canvas.size());
        for (ball, place) in start.balls_at(number as f32 * SECONDS) {
            self.renderer.move_object(gpu, ball, place)?;
            if let Some(culling) = &mut self.culling {
                culling.move_object(ball, place)?;
            }
        }
        if self.update == Update::All {
            self.renderer.set_lights(gpu, &start.scene.lights)?;
        }
        let (mut frame, mut reach) = (Frame::new(), None);
        if let Some(culling) = &mut self.culling {
            let begun = Instant::now();
            let sight = culling.look(&camera)?.ok_or("the query has not run")?;
            reach = Some(self.renderer.reach(&|b| may_see(&sight, b)));
            frame.push((CULLER, begun.elapsed()));
        }
        let mut clock = Clock::on();
        self.updated = self.renderer.update(gpu, reach.as_ref(), &mut clock)?;
        self.renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, &mut clock)?;
        frame.extend_from_slice(clock.stages());
        self.frames.push(frame);
        Ok(())
    }
}

/// Draws the frames of all runs in turn, so that other work on the machine slows down all alike.
fn run_frames(
    gpu: &Gpu,
    start: &Start,
    options: &Options,
    canvas: &Canvas,
    runs: &mut [Run],
) -> Result<(), Box<dyn Error>> {
    for number in 1..=options.common.drawing.frames.unwrap_or(FRAMES) {
        runs.iter_mut().try_for_each(|run| run.frame(gpu, start, canvas, number))?;
    }
    Ok(())
}

fn by_step(gpu: &Gpu, start: &Start, options: &Options, canvas: &Canvas) -> Result<(), Box<dyn Error>> {
    let camera = start.camera(canvas.size());
    let mut renderer = Renderer::new(gpu, &start.scene, options.settings())?;
    renderer.update(gpu, None, &mut Clock::off())?;
    let mut times = Vec::new();
    for (factor, _) in STEP_FACTORS {
        // The thesis measures steps in diameters, of two texels.
        renderer.set_settings(gpu, Settings { step: 2.0 * factor, ..options.settings() })?;
        let mut frames = Vec::new();
        for _ in 0..options.common.drawing.frames.unwrap_or(FRAMES) {
            let mut clock = Clock::on();
            renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, &mut clock)?;
            frames.push(clock.stages().to_vec());
        }
        times.push(of(&medians(&frames), &["cones"]));
    }
    say(format_args!("cones at {} cells by step factor, relative to 0.5:", options.resolution));
    for (time, (factor, theirs)) in times.iter().zip(STEP_FACTORS) {
        say(format_args!("  {factor:<5} {time:9.2} ms  x{:.2}; thesis x{theirs}", time / times[2]));
    }
    Ok(())
}

/// The time of light in voxels for updates of everything, on need, and of what the picture can
/// read.
fn culled(gpu: &Gpu, start: &Start, options: &Options, canvas: &Canvas) -> Result<(), Box<dyn Error>> {
    let mut runs = Vec::new();
    for update in [Update::All, Update::OnNeed, Update::Culled] {
        runs.push(Run::new(gpu, start, options.settings(), update, canvas)?);
    }
    run_frames(gpu, start, options, canvas, &mut runs)?;
    let mut totals = Vec::new();
    for run in &runs {
        let stages = medians(&run.frames);
        totals.push(of(&stages, &LIGHT) + of(&stages, &[CULLER]));
        say(format_args!(
            "{}: light in voxels {:.2} ms (shade {:.2}, bounce {:.2}, writing and mips {:.2}), culler {:.2} ms; {}",
            match run.update {
                Update::All => "all light",
                Update::OnNeed => "on need",
                Update::Culled => "culled",
            },
            of(&stages, &LIGHT),
            of(&stages, &LIGHT[..1]),
            of(&stages, &LIGHT[1..2]),
            of(&stages, &LIGHT[2..]),
            of(&stages, &[CULLER]),
            told(&run.renderer, &run.updated)
        ));
    }
    let saved = |to: usize| 100.0 * (1.0 - totals[to] / totals[0]);
    say(format_args!(
        "an update on need saves {:.1} % of the time for all light, and with culling {:.1} %, the culler's time included",
        saved(1),
        saved(2)
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_that_of_the_sums_of_each_frame() {
        let ms = Duration::from_millis;
        let frames: Vec<Frame> =
            [3, 90, 4, 5, 1].map(|t| vec![("mips", ms(t)), ("cones", ms(7)), ("mips", ms(1))]).into();
        let stages = medians(&frames);
        assert_eq!(stages, [("mips", ms(5)), ("cones", ms(7))]);
        assert_eq!(of(&stages, &["mips", "cones", "none"]), 12.0);
        assert!(medians(&[]).is_empty());
    }
}
