//! Pictures without a window.

use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::renderer::Renderer;
use casca_lines::gpu::set::GpuLines;
use casca_stage::egui::Align2;
use casca_stage::gpu::COLOUR;
use casca_stage::panel::{Panel, boxed};
use casca_stage::timing::{Clock, Instant};
use casca_stage::window::Done;
use casca_tools::command_line::say;
use glam::{Quat, Vec3};

use crate::common::{Film, counted, say_stages};
use crate::lines::legend::entries;
use crate::lines::options::{LOOKS, Options};
use crate::lines::source::Source;

/// Behind lines.
pub const BACKGROUND: Vec3 = Vec3::splat(1.0);

/// The bundles of lines, and those that were needed.
pub fn bundles(lines: &GpuLines, seen: &Seen) -> String {
    format!("{} of {} drawn", seen.drawn.len(), counted(lines.bundles().len(), ["bundle", "bundles"]))
}

/// Degrees that the camera turns between frames.
const TURN: f32 = 0.2;

/// Draws the pictures that the command line asks for, of the last of its frames, and prints the time
/// of each stage of all.
pub fn pictures(options: &Options, source: &Source) -> Done {
    let (gpu, folder) = options.common.studio("lines")?;
    let film = Film::new(&gpu, options.common.size, false);
    let size = <[u32; 2]>::from(film.size());
    let [eye, middle] = source.start(options, size)?;
    let view = source.view(options, [eye, middle], size)?;
    let set = source.at(0.0)?;
    let settings = source.settings(options, &view);
    let (lines, legend) = source.on_device(&gpu, &set, &settings)?;
    let (mut panel, legend) = (Panel::new(&gpu, COLOUR), entries(&legend));
    let mut renderer = Renderer::new(&gpu, COLOUR, settings)?;
    let mut culling = Culling::new(lines.bundles(), &source.context)?;
    let context = source.context_on_device(&gpu)?;
    let all = counted(set.len(), ["line", "lines"]);
    let vertices = counted(lines.vertices(), ["vertex", "vertices"]);
    for frame in 0..options.common.frames.unwrap_or(1) {
        let turn = Quat::from_rotation_y((TURN * frame as f32).to_radians());
        let view = source.view(options, [middle + turn * (eye - middle), middle], size)?;
        let (mut clock, start) = (Clock::on(), Instant::now());
        let seen = match options.cull {
            true => culling.look(&view, settings.reach(&view))?,
            false => Seen::all(lines.bundles().len()),
        };
        clock.add("query", start.elapsed());
        renderer.update(&gpu, &view, (&lines, &seen), &context, &mut clock)?;
        say(format_args!("{all} with {vertices}, {}", bundles(&lines, &seen)));
        say_stages(&clock);
    }
    for look in &options.look {
        let (target, strength) = (film.canvas.picture(), options.factor);
        renderer.paint(&gpu, &target, *look, strength, BACKGROUND, &mut Clock::off())?;
        if !legend.is_empty() {
            panel.draw(&gpu, &target, 1.0, &|context| {
                boxed(context, "colours", Align2::LEFT_TOP, [8.0, 8.0], &mut |ui| {
                    legend.iter().for_each(|entry| entry.add(ui));
                });
            });
        }
        let name = LOOKS.iter().find(|l| l.1 == *look).map_or("", |l| l.0);
        film.save(&gpu, &folder.join(format!("lines_{}_{name}.png", source.name)))?;
    }
    Ok(())
}
