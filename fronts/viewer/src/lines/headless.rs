//! Pictures without a window.

use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::renderer::Renderer;
use casca_lines::gpu::set::GpuLines;
use casca_stage::egui::Align2;
use casca_stage::gpu::COLOUR;
use casca_stage::panel::{Panel, boxed};
use casca_stage::timing::Clock;
use casca_stage::window::Done;
use casca_tools::command_line::{make_folder, say};
use glam::Vec3;

use crate::common::{Film, counted};
use crate::lines::legend::entries;
use crate::lines::options::{LOOKS, Options};
use crate::lines::source::Source;

/// Behind lines.
pub const BACKGROUND: Vec3 = Vec3::splat(1.0);

/// The bundles of lines, and those that were needed.
pub fn bundles(lines: &GpuLines, seen: &Seen) -> String {
    format!("{} of {} drawn", seen.drawn.len(), counted(lines.bundles().len(), ["bundle", "bundles"]))
}

/// Draws the pictures that the command line asks for.
pub fn pictures(options: &Options, source: &Source) -> Done {
    let gpu = options.common.drawing.device()?;
    let film = Film::new(&gpu, options.common.drawing.size, false);
    let size = <[u32; 2]>::from(film.size());
    let view = source.view(options, source.start(options, size, 0)?, size)?;
    let set = source.at(0.0)?;
    let settings = source.settings(options, &view);
    let (lines, legend) = source.on_device(&gpu, &set, &settings)?;
    let (mut panel, legend) = (Panel::new(&gpu, COLOUR), entries(&legend));
    let mut renderer = Renderer::new(&gpu, COLOUR, settings)?;
    let seen = match options.cull {
        true => Culling::new(lines.bundles(), &source.context)?.look(&view, settings.reach(&view))?,
        false => Seen::all(lines.bundles().len()),
    };
    let context = source.context_on_device(&gpu)?;
    renderer.update(&gpu, &view, (&lines, &seen), &context, &mut Clock::off())?;
    let folder = options.common.folder("lines");
    make_folder(&folder)?;
    let all = counted(set.len(), ["line", "lines"]);
    let vertices = counted(lines.vertices(), ["vertex", "vertices"]);
    say(format_args!("{all} with {vertices}, {}, on {}", bundles(&lines, &seen), gpu.name));
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
