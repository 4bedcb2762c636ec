//! Pictures without a window.

use casca_lines::gpu::culling::{Culling, Seen};
use casca_lines::gpu::renderer::Renderer;
use casca_lines::gpu::set::GpuLines;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::COLOUR;
use casca_stage::panel::Panel;
use casca_stage::timing::Clock;
use casca_stage::window::Done;
use casca_tools::command_line::{make_folder, say};
use casca_tools::image::write_png;
use clap::ValueEnum;
use glam::Vec3;

use crate::common::counted;
use crate::lines::legend;
use crate::lines::options::Options;
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
    let canvas = Canvas::new(&gpu, options.common.drawing.size);
    let size = <[u32; 2]>::from(canvas.size());
    let view = source.view(options, source.start(options, size, 0)?, size)?;
    let set = source.at(f64::from(options.at))?;
    let settings = source.settings(options, &view);
    let (lines, legend) = source.on_device(&gpu, &set, &settings)?;
    let mut panel = Panel::new(&gpu, COLOUR);
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
        let (target, strength) = (canvas.picture(), options.factor);
        renderer.paint(&gpu, &target, look.look(), strength, BACKGROUND, &mut Clock::off())?;
        legend::draw(&mut panel, &gpu, &target, &legend);
        let name = look.to_possible_value().map_or(String::new(), |v| v.get_name().to_owned());
        let path = folder.join(format!("lines_{}_{name}.png", source.name));
        write_png(&path, canvas.size(), &canvas.read_picture(&gpu)?)?;
        say(format_args!("{}", path.display()));
    }
    Ok(())
}
