//! The time of each stage of a frame.

use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::renderer::{Look, Renderer};
use casca_lines::gpu::set::GpuLines;
use casca_lines::gpu::settings::Settings;
use casca_lines::view::View;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::timing::{Clock, Instant};
use casca_stage::window::Done;
use casca_tools::command_line::say;
use glam::Quat;

use crate::common::Failed;
use crate::lines::headless::BACKGROUND;
use crate::lines::options::Options;
use crate::lines::source::Source;
use crate::times::{Stages, table};

/// Frames that are timed, if no other number is given.
const FRAMES: u32 = 10;
/// Degrees that the camera turns between frames.
const TURN: f32 = 0.2;
/// Rooms from which a house is looked at.
const ROOMS: u32 = 8;

/// Prints the time of each stage: of frames that find nothing of older ones, and of frames of a
/// camera that turns; in a house those from some rooms with and without culling.
pub fn print(options: &Options, source: &Source) -> Done {
    let gpu = options.common.drawing.device()?;
    let size = <[u32; 2]>::from(options.common.drawing.size);
    let frames = options.common.drawing.frames.unwrap_or(FRAMES);
    let set = source.at(0.0)?;
    let [eye, middle] = source.start(options, size, 0)?;
    let view = source.view(options, [eye, middle], size)?;
    let settings = source.settings(options, &view);
    let lines = GpuLines::new(&gpu, &set, &settings)?;
    say(format_args!(
        "{}: {} lines with {} vertices, {} x {} pixels, on {}; {:.1} MiB, {} places along the lines",
        source.name,
        set.len(),
        set.points().len(),
        size[0],
        size[1],
        gpu.name,
        lines.bytes() as f64 / f64::from(1 << 20),
        lines.places()
    ));
    let bench = Bench { gpu: &gpu, canvas: Canvas::new(&gpu, options.common.drawing.size), source, lines };
    if let Some(side) = options.rooms {
        let rooms = ROOMS.min(side * side);
        let views = (0..rooms).map(|i| {
            let eye = source.start(options, size, i * side * side / rooms)?;
            let view = source.view(options, eye, size)?;
            // With the tubes that the lines were copied for.
            Ok((view, settings))
        });
        let views = views.collect::<Result<Vec<_>, Failed>>()?;
        table(&[
            ("without culling", bench.frames(&views, false, true)?),
            ("with culling", bench.frames(&views, true, true)?),
        ]);
        return Ok(());
    }
    let turned = (0..frames).map(|i| {
        let turn = Quat::from_rotation_y((TURN * i as f32).to_radians());
        Ok((source.view(options, [middle + turn * (eye - middle), middle], size)?, settings))
    });
    let turned = turned.collect::<Result<Vec<_>, Failed>>()?;
    table(&[
        ("from nothing", bench.frames(&turned, options.cull, true)?),
        ("turned by 0.2°", bench.frames(&turned, options.cull, false)?),
    ]);
    Ok(())
}

struct Bench<'a> {
    gpu: &'a Gpu,
    canvas: Canvas,
    source: &'a Source,
    lines: GpuLines,
}

impl Bench<'_> {
    /// The stages of a frame for each view. With `forgets` each of them finds nothing of older ones.
    fn frames(&self, views: &[(View, Settings)], cull: bool, forgets: bool) -> Result<Vec<Stages>, Failed> {
        let context = self.source.context_on_device(self.gpu)?;
        let mut culling = Culling::new(self.lines.bundles(), &self.source.context)?;
        let mut renderer: Option<Renderer> = None;
        let mut frames = Vec::new();
        // The first frame makes buffers, and is not counted.
        for (number, (view, settings)) in views.iter().take(1).chain(views).enumerate() {
            if forgets {
                self.lines.forget();
                renderer = renderer.filter(|renderer| renderer.settings() == settings);
            }
            let renderer = match &mut renderer {
                Some(renderer) => renderer,
                none => none.insert(Renderer::new(self.gpu, COLOUR, *settings)?),
            };
            let (mut clock, start) = (Clock::on(), Instant::now());
            let seen = match cull {
                true => culling.look(view, settings.reach(view))?,
                false => Seen::all(self.lines.bundles().len()),
            };
            clock.add("query", start.elapsed());
            renderer.update(self.gpu, view, (&self.lines, &seen), &context, &mut clock)?;
            renderer.paint(self.gpu, &self.canvas.picture(), Look::Occluded, 1.0, BACKGROUND, &mut clock)?;
            if number > 0 {
                frames.push(clock.stages().to_vec());
            }
        }
        Ok(frames)
    }
}
