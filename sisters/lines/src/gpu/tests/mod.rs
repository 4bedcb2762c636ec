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

use crate::buffers::Fragment;
use crate::gpu::context::{Context, GpuContext};
use crate::gpu::culling::{Culling, Seen};
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

/// Pictures of lines among context, with and without culling.
struct Culled<'a> {
    gpu: &'a Gpu,
    canvas: Canvas,
    renderer: Renderer,
    lines: GpuLines,
    culling: Culling,
    context: Vec<GpuContext>,
}

impl<'a> Culled<'a> {
    fn new(gpu: &'a Gpu, lines: &LineSet, context: &[Context], settings: Settings) -> Self {
        let lines = GpuLines::new(gpu, lines, &of_margin(0.04)).unwrap();
        Self {
            gpu,
            canvas: Canvas::new(gpu, (160, 120)),
            renderer: Renderer::new(gpu, COLOUR, settings).unwrap(),
            culling: Culling::new(lines.bundles(), context).unwrap(),
            lines,
            context: context.iter().map(|c| GpuContext::new(gpu, c).unwrap()).collect(),
        }
    }

    /// The picture of some bundles, with their fragments and occlusion.
    fn shot(&mut self, view: &View, seen: &Seen) -> (Vec<u8>, Vec<Option<Fragment>>, Vec<f32>) {
        let (gpu, off) = (self.gpu, &mut Clock::off());
        self.renderer.update(gpu, view, (&self.lines, seen), &self.context, off).unwrap();
        self.renderer.paint(gpu, &self.canvas.picture(), Look::Occluded, 1.0, Vec3::ONE, off).unwrap();
        let picture = self.canvas.read_picture(gpu).unwrap();
        let fragments = self.renderer.read_fragments(gpu).unwrap();
        (picture, fragments, self.renderer.read_occlusion(gpu).unwrap())
    }

    /// Asserts that culling changes no pixel; the bundles drawn with it, and the sum of the
    /// occlusion.
    fn changes_nothing(&mut self, view: &View) -> (usize, f32) {
        let seen = self.culling.look(view, self.renderer.settings().reach(view)).unwrap();
        let all = self.shot(view, &Seen::all(self.lines.bundles().len()));
        let culled = self.shot(view, &seen);
        let lost = all.1.iter().zip(&culled.1).filter(|(a, b)| a != b).count();
        assert!(all == culled, "{view:?}: {lost} pixels");
        (seen.drawn.len(), all.2.iter().sum())
    }
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
