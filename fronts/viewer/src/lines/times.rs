//! The time of each stage, and how it grows.

use std::time::{Duration, Instant};

use casca_lines::buffers::Fragment;
use casca_lines::gpu::context::GpuContext;
use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::renderer::{Look, Renderer};
use casca_lines::gpu::set::GpuLines;
use casca_lines::gpu::settings::Settings;
use casca_lines::sets::LineSet;
use casca_lines::view::View;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::timing::Clock;
use casca_stage::window::Done;
use casca_tools::command_line::say;
use glam::Quat;

use crate::common::Failed;
use crate::lines::headless::BACKGROUND;
use crate::lines::options::Options;
use crate::lines::source::Source;

/// Times that a frame is drawn; the least time counts, since other programs only add to it.
const REPEATS: usize = 5;
/// Rooms from which a house is looked at.
const ROOMS: u32 = 8;
/// The stages of the occlusion.
const OCCLUSION: [&str; 3] = ["places asked for", "rays of places", "occlusion"];
/// Frames of a camera that turns.
const TURNS: usize = 20;
const SAMPLES: [u32; 8] = [8, 16, 32, 64, 96, 128, 150, 256];
/// Shares of the picture's height, and of the lines.
const SHARES: [f64; 4] = [0.4, 0.6, 0.8, 1.0];

/// Prints all times of a source.
pub fn print(options: &Options, source: &Source) -> Done {
    let gpu = options.common.drawing.device()?;
    let context = source.context_on_device(&gpu)?;
    let bench = Bench { gpu: &gpu, options, source, context, set: source.at(f64::from(options.at))? };
    say(format_args!(
        "{}: {} lines with {} vertices, {} x {} pixels, on {}; the least of {REPEATS} times, in milliseconds",
        source.name,
        bench.set.len(),
        bench.set.points().len(),
        options.common.drawing.size.0,
        options.common.drawing.size.1,
        gpu.name
    ));
    match options.rooms {
        Some(_) => bench.culling(),
        None => bench.growth(),
    }
}

struct Bench<'a> {
    gpu: &'a Gpu,
    options: &'a Options,
    source: &'a Source,
    context: Vec<GpuContext>,
    set: LineSet,
}

/// Stages of a frame with their milliseconds.
type Stages = Vec<(&'static str, f64)>;

fn of(stages: &Stages, names: &[&str]) -> f64 {
    stages.iter().filter(|(name, _)| names.contains(name)).fold(0.0, |sum, (_, ms)| sum + ms)
}

/// The pixels that lines cover, and the parts of lines in them: several in a pixel of smooth lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Covered {
    pixels: usize,
    lines: usize,
}

impl Covered {
    /// Counts the fragments of a picture, layer after layer. A pixel with any has one in the first.
    fn new(fragments: &[Option<Fragment>], [width, height]: [u32; 2]) -> Self {
        let pixels = fragments.iter().take(width as usize * height as usize).flatten().count();
        Self { pixels, lines: fragments.iter().flatten().count() }
    }
}

impl Bench<'_> {
    fn view(&self, share: f64, room: u32) -> Result<View, Failed> {
        let side = |s: u32| ((f64::from(s) * share) as u32).max(1);
        let size = [side(self.options.common.drawing.size.0), side(self.options.common.drawing.size.1)];
        Ok(self.source.view(self.options, self.source.start(self.options, size, room)?, size)?)
    }

    /// The times of a frame, and the pixels that lines cover. With `culling`, its query is a stage.
    fn frame(
        &self,
        (view, settings): (&View, Settings),
        lines: &GpuLines,
        mut culling: Option<&mut Culling>,
    ) -> Result<(Stages, Covered, Seen), Failed> {
        // What stays from other frames is forgotten, so that each repeat does the same.
        let mut renderer = Renderer::new(self.gpu, COLOUR, settings)?;
        let canvas = Canvas::new(self.gpu, (view.size()[0], view.size()[1]));
        let mut least = Stages::new();
        let mut seen = Seen::all(lines.bundles().len());
        // The first frame makes buffers, and is not counted.
        for repeat in 0..=REPEATS {
            let mut clock = Clock::on();
            lines.forget();
            if let Some(culling) = &mut culling {
                let start = Instant::now();
                seen = culling.look(view, settings.reach(view))?;
                clock.add("query", start.elapsed());
            }
            renderer.update(self.gpu, view, (lines, &seen), &self.context, &mut clock)?;
            let target = canvas.picture();
            renderer.paint(self.gpu, &target, Look::Occluded, 1.0, BACKGROUND, &mut clock)?;
            let ms = |time: &Duration| time.as_secs_f64() * 1e3;
            let stages: Stages = clock.stages().iter().map(|(name, time)| (*name, ms(time))).collect();
            match repeat {
                0 => {}
                1 => least = stages,
                _ => least.iter_mut().zip(stages).for_each(|(least, new)| least.1 = least.1.min(new.1)),
            }
        }
        let covered = Covered::new(&renderer.read_fragments(self.gpu)?, view.size());
        Ok((least, covered, seen))
    }

    fn growth(&self) -> Done {
        let view = self.view(1.0, 0)?;
        let settings = self.source.settings(self.options, &view);
        let start = Instant::now();
        let lines = GpuLines::new(self.gpu, &self.set, &settings)?;
        say(format_args!(
            "copied to the device and put into bundles: {:.1}",
            start.elapsed().as_secs_f64() * 1e3
        ));
        say(format_args!(
            "on the device: {:.1} MiB, {} places along the lines",
            lines.bytes() as f64 / f64::from(1 << 20),
            lines.places()
        ));
        let (stages, covered, _) = self.frame((&view, settings), &lines, None)?;
        say(format_args!("a frame that finds nothing of older ones:"));
        for (name, ms) in &stages {
            say(format_args!("{name:>16} {ms:9.2}"));
        }
        let frame = stages.iter().map(|s| s.1).sum::<f64>();
        let Covered { pixels, lines: shown } = covered;
        say(format_args!("{:>16} {frame:9.2}, {pixels} pixels covered by {shown} parts of lines", "frame"));
        self.turning(settings, &lines)?;
        if self.options.brief {
            return Ok(());
        }

        let mut points = Vec::new();
        for samples in SAMPLES {
            let with = Settings { samples, ..settings };
            points.push((f64::from(samples), of(&self.frame((&view, with), &lines, None)?.0, &OCCLUSION)));
        }
        print_series("occlusion by samples", &points);

        let (mut by_covered, mut by_vertices) = (Vec::new(), Vec::new());
        for share in SHARES {
            let view = self.view(share, 0)?;
            // With the settings of the full picture: the radius and the tubes keep their size in
            // the scene.
            let (stages, covered, _) = self.frame((&view, settings), &lines, None)?;
            by_covered.push((covered.pixels as f64, of(&stages, &OCCLUSION)));
        }
        print_series("occlusion by covered pixels", &by_covered);
        for share in SHARES {
            let some = (self.set.len() as f64 * share).ceil() as usize;
            let set = LineSet::new(self.set.iter().take(some).map(|line| line.iter().copied()))?;
            let lines = GpuLines::new(self.gpu, &set, &settings)?;
            let (stages, ..) = self.frame((&view, settings), &lines, None)?;
            by_vertices.push((lines.vertices() as f64, of(&stages, &["nearest lines"])));
        }
        print_series("nearest lines by vertices", &by_vertices);
        Ok(())
    }

    /// The mean of frames while the camera flies around the lines.
    fn turning(&self, settings: Settings, lines: &GpuLines) -> Done {
        let size = <[u32; 2]>::from(self.options.common.drawing.size);
        let mut renderer = Renderer::new(self.gpu, COLOUR, settings)?;
        let seen = Seen::all(lines.bundles().len());
        let [eye, middle] = self.source.start(self.options, size, 0)?;
        lines.forget();
        for (degrees, frames) in [(0.0, REPEATS), (0.2, TURNS), (1.0, TURNS)] {
            let (mut all, mut computed) = (Stages::new(), 0);
            // The first frame finds nothing, and is not counted.
            for i in 0..=frames {
                let turn = Quat::from_rotation_y((degrees * i as f32).to_radians());
                let view = self.source.view(self.options, [middle + turn * (eye - middle), middle], size)?;
                let mut clock = Clock::on();
                renderer.update(self.gpu, &view, (lines, &seen), &self.context, &mut clock)?;
                if i > 0 {
                    all.extend(clock.stages().iter().map(|(name, time)| (*name, time.as_secs_f64() * 1e3)));
                    computed += renderer.read_computed(self.gpu)? as usize;
                }
            }
            let rays = of(&all, &OCCLUSION) / frames as f64;
            let frame = all.iter().map(|s| s.1).sum::<f64>() / frames as f64;
            say(format_args!(
                "turned by {degrees} degrees a frame, mean of {frames}: occlusion {rays:.2} of {frame:.2} without the picture, {} values of places computed",
                computed / frames
            ));
        }
        Ok(())
    }

    fn culling(&self) -> Done {
        let settings = self.source.settings(self.options, &self.view(1.0, 0)?);
        let lines = GpuLines::new(self.gpu, &self.set, &settings)?;
        let mut culling = Culling::new(lines.bundles(), &self.source.context)?;
        let (mut all, mut culled) = (Stages::new(), Stages::new());
        let mut drawn = 0;
        let side = self.options.rooms.unwrap_or(1);
        let rooms = ROOMS.min(side * side);
        for i in 0..rooms {
            let view = self.view(1.0, i * side * side / rooms)?;
            // With the tubes that the lines were copied for.
            all.extend(self.frame((&view, settings), &lines, None)?.0);
            let (stages, _, seen) = self.frame((&view, settings), &lines, Some(&mut culling))?;
            culled.extend(stages);
            drawn += seen.drawn.len();
        }
        let mean = |n: usize| n as f64 / f64::from(rooms);
        let bundles = lines.bundles().len();
        let vertices = |n: usize| mean(n) / bundles.max(1) as f64 * lines.vertices() as f64;
        let triangles = || self.source.context.iter().map(|c| c.mesh().triangles.len()).sum::<usize>();
        say(format_args!("means of the views from {rooms} rooms, with {} triangles", triangles()));
        say(format_args!("bundles: {bundles}; drawn {:.0}", mean(drawn)));
        say(format_args!("vertices, about: drawn {:.0}", vertices(drawn)));
        let alone = ["query", "context", "nearest lines", "picture"].map(|name| (name, vec![name]));
        for (name, names) in alone.into_iter().chain([("occlusion", OCCLUSION.to_vec())]) {
            let ms = |stages: &Stages| of(stages, &names) / f64::from(rooms);
            say(format_args!("{name:>14} {:9.2} without culling {:9.2} with", ms(&all), ms(&culled)));
        }
        let sum = |stages: &Stages| stages.iter().map(|s| s.1).sum::<f64>();
        let lines = ["query", "nearest lines"];
        say(format_args!(
            "the frame takes {:.2} of the time without culling; the passes over lines {:.2}",
            sum(&culled) / sum(&all),
            of(&culled, &lines) / of(&all, &lines)
        ));
        Ok(())
    }
}

/// Prints points and the straight line of least squares through them.
fn print_series(name: &str, points: &[(f64, f64)]) {
    let (offset, slope, share) = straight_line(points);
    say(format_args!("{name}: {offset:.2} + {:.4} per 1000, r² {share:.4}", slope * 1e3));
    for (x, ms) in points {
        say(format_args!("{x:14.0} {ms:9.2}"));
    }
}

/// Offset, slope and the share of the variance that the line explains.
fn straight_line(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let count = points.len().max(1) as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let (xx, xy, yy) =
        (mean(&|p| (p.0 - x).powi(2)), mean(&|p| (p.0 - x) * (p.1 - y)), mean(&|p| (p.1 - y).powi(2)));
    if xx == 0.0 || yy == 0.0 {
        return (y, 0.0, 1.0);
    }
    (y - x * xy / xx, xy / xx, xy * xy / (xx * yy))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::{Covered, Fragment, straight_line};

    #[test]
    fn a_pixel_with_several_lines_is_covered_once() {
        let here = Some(Fragment { position: Vec3::ZERO, line: 0, tangent: Vec3::X, along: 0.0 });
        // Four layers of two pixels.
        let layers = [None, here, None, here, None, here, None, None];
        assert_eq!(Covered::new(&layers, [2, 1]), Covered { pixels: 1, lines: 3 });
        assert_eq!(Covered::new(&layers[..2], [2, 1]), Covered { pixels: 1, lines: 1 });
    }

    #[test]
    fn a_straight_line_is_found_with_its_share() {
        let (offset, slope, share) = straight_line(&[(1.0, 5.0), (2.0, 7.0), (4.0, 11.0)]);
        assert!((offset - 3.0).abs() < 1e-9 && (slope - 2.0).abs() < 1e-9 && (share - 1.0).abs() < 1e-9);
        assert!(straight_line(&[(0.0, 1.0), (1.0, 0.0), (2.0, 1.0)]).2 < 0.01);
        assert_eq!(straight_line(&[(2.0, 1.0)]), (1.0, 0.0, 1.0));
    }
}
