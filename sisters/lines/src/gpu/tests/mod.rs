//! The shaders beside the processor's version, and pictures with and without culling.

mod colours;
mod context;
mod culled;
mod nearest;
mod occlusion;
mod places;
mod smooth;
mod values;

use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::timing::Clock;
use glam::{Vec3, vec3};

use crate::gpu::context::GpuContext;
use crate::gpu::culling::Seen;
use crate::gpu::renderer::{Look, Renderer};
use crate::gpu::set::GpuLines;
use crate::gpu::settings::Settings;
use crate::numeric::MARGIN_IN_TUBES;
use crate::occlusion::AoOptions;
use crate::sets::LineSet;
use crate::sets::generate::{Family, Recipe};
use crate::sets::random::Random;
use crate::view::View;

const SIZE: [u32; 2] = [64, 48];

fn set(family: Family, lines: u32) -> LineSet {
    Recipe { lines, ..Recipe::new(family, 3) }.make().unwrap()
}

/// Segments of all directions, many far longer than the picture, some steep, and dots.
fn wild(seed: u64) -> LineSet {
    let mut random = Random::new(seed);
    let mut point =
        |s: f64| Vec3::from_array(std::array::from_fn(|_| (random.within(-s, s) * random.unit()) as f32));
    let lines = (0..120).map(|i| match i % 4 {
        0 => vec![point(9.0), point(9.0)],
        1 => (0..6).map(|_| point(1.5)).collect(),
        2 => {
            let start = point(1.0);
            vec![start, start + vec3(0.3, 0.4, 1.0) * (i as f32 / 60.0) + point(0.01)]
        }
        _ => vec![point(1.2)],
    });
    LineSet::new(lines).unwrap()
}

fn views(bounds: [Vec3; 2]) -> [View; 2] {
    [None, Some(0.8)].map(|fov| View::around(bounds, vec3(0.3, 0.4, 1.0), fov, SIZE).unwrap())
}

fn settings(ao: AoOptions) -> Settings {
    Settings { samples: 60, sets: 4, ao, ..Settings::new(0.3, 0.01) }
}

/// Settings whose cells have a margin.
fn of_margin(margin: f32) -> Settings {
    Settings::new(0.3, margin / MARGIN_IN_TUBES)
}

/// The picture of some bundles among context, with their occlusion.
fn picture(
    (gpu, canvas): (&Gpu, &Canvas),
    renderer: &mut Renderer,
    view: &View,
    lines: (&GpuLines, &Seen),
    context: &[GpuContext],
) -> Vec<u8> {
    renderer.update(gpu, view, lines, context, &mut Clock::off()).unwrap();
    renderer.paint(gpu, &canvas.picture(), Look::Occluded, 1.0, Vec3::ONE, &mut Clock::off()).unwrap();
    canvas.read_picture(gpu).unwrap()
}

/// A frame of all lines without context.
fn draw(gpu: &Gpu, renderer: &mut Renderer, lines: &GpuLines, view: &View) {
    let seen = Seen::all(lines.bundles().len());
    renderer.update(gpu, view, (lines, &seen), &[], &mut Clock::off()).unwrap();
}

/// The renderer after such a frame.
fn run(gpu: &Gpu, lines: &LineSet, view: &View, settings: Settings) -> Renderer {
    let on_device = GpuLines::new(gpu, lines, &settings).unwrap();
    let mut renderer = Renderer::new(gpu, COLOUR, settings).unwrap();
    draw(gpu, &mut renderer, &on_device, view);
    renderer
}
