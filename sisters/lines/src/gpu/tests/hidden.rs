//! Lines behind lines: pictures with and without them, and how many are drawn.

use super::*;
use crate::buffers::Fragment;
use crate::gpu::context::{Context, GREY, GpuContext};
use crate::gpu::hidden::{Drawn, LineCulling};
use crate::view::Lens;

/// Draws views in turn, with and without the lines behind lines, and compares all fragments.
struct Pair<'a> {
    gpu: &'a Gpu,
    lines: GpuLines,
    context: Vec<GpuContext>,
    renderers: [Renderer; 2],
}

impl<'a> Pair<'a> {
    fn new(gpu: &'a Gpu, lines: &LineSet, context: Vec<GpuContext>) -> Self {
        let with = Settings { samples: 1, ..Settings::new(0.01, 0.001) };
        let renderers = [LineCulling::Always, LineCulling::Never].map(|culling| {
            let mut renderer = Renderer::new(gpu, COLOUR, with).unwrap();
            renderer.cull_lines(culling);
            renderer
        });
        Self { gpu, lines: GpuLines::new(gpu, lines, &with).unwrap(), context, renderers }
    }

    /// The segments that were drawn of all.
    fn compare(&mut self, view: &View, what: &str) -> [u32; 2] {
        let seen = Seen::all(self.lines.bundles().len());
        let [culled, all]: [Vec<Option<Fragment>>; 2] = [0, 1].map(|i| {
            let renderer = &mut self.renderers[i];
            renderer.update(self.gpu, view, (&self.lines, &seen), &self.context, &mut Clock::off()).unwrap();
            renderer.read_fragments(self.gpu).unwrap()
        });
        let lost = culled.iter().zip(&all).filter(|(a, b)| a != b).count();
        let [drawn, without] = [0, 1].map(|i| self.renderers[i].read_drawn(self.gpu).unwrap());
        assert_eq!(lost, 0, "{what}: {drawn:?} of {without:?}");
        assert!(drawn.chunks <= without.chunks && drawn.segments <= without.segments);
        [drawn.segments, without.segments]
    }
}

/// Views of a set from all around, inside and close by, from parallel rays to a wide angle.
pub(super) fn around(size: [u32; 2]) -> impl Iterator<Item = View> {
    let mut random = Random::new(7);
    (0..24).map(move |i| {
        let mut point = || Vec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0) as f32));
        let (towards, far_off) = (point() * 0.5, [3.0, 1.2, 0.4][i as usize % 3]);
        let eye = towards + point().normalize_or(Vec3::Z) * far_off;
        let (lens, near) = match i % 4 {
            0 => (Lens::Orthographic { half_height: 1.1 }, -1.0),
            1 => (Lens::Perspective { fov_y: 0.05 }, 0.05),
            2 => (Lens::Perspective { fov_y: 2.2 }, 0.01),
            _ => (Lens::Perspective { fov_y: 0.9 }, 0.3),
        };
        View::look_at([eye, towards, Vec3::new(0.1, 1.0, 0.05)], lens, [near, 6.0], size).unwrap()
    })
}

#[test]
fn pictures_with_and_without_lines_behind_lines_are_the_same_in_every_pixel() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let dense = |family| Recipe { lines: 1500, vertices: 40, ..Recipe::new(family, 3) }.make().unwrap();
    let ball = Recipe::new(Family::PomPom, 3).surface().unwrap();
    for (name, lines, context) in [
        ("abc", dense(Family::Abc), None),
        ("hair", dense(Family::PomPom), Some(ball)),
        ("wild", wild(5), None),
        ("parallel", dense(Family::Parallel), None),
    ] {
        let context = context.map(|mesh| Context::new(mesh, GREY).unwrap());
        let context = context.iter().map(|c| GpuContext::new(&gpu, c).unwrap()).collect();
        let mut pair = Pair::new(&gpu, &lines, context);
        let (mut drawn, mut all) = (0, 0);
        for (i, view) in around([61, 45]).enumerate() {
            // Twice: the second frame first draws the chunks that the first one saw.
            for again in 0..2 {
                let [some, every] = pair.compare(&view, &format!("{name}, view {i}, {again}"));
                (drawn, all) = (drawn + some, all + every);
            }
        }
        println!("{name}: {drawn} of {all} segments");
        assert!(name == "wild" || drawn * 10 < all * 9, "{name}: {drawn} of {all}");
    }
}

#[test]
fn a_curtain_hides_what_hangs_behind_it_until_it_is_seen_from_the_other_side_or_opened() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // More lines than pixels, before a few that have the same places in the picture.
    let vertical = |x: f32, z: f32| {
        (0..=20).map(move |i| Vec3::new(x, -1.2 + 0.12 * i as f32, z)).collect::<Vec<Vec3>>()
    };
    let at = |i: u32, count: u32| (i as f32 + 0.5) / count as f32 * 2.4 - 1.2;
    let curtain = |gap: f32| (0..400).map(move |i| at(i, 400)).filter(move |x| x.abs() > gap);
    let behind = || (0..300).map(|i| vertical(at(i % 60, 60), -0.2 - 0.1 * (i / 60) as f32));
    for gap in [0.0, 0.06] {
        let set = LineSet::new(curtain(gap).map(|x| vertical(x, 0.5)).chain(behind())).unwrap();
        let mut pair = Pair::new(&gpu, &set, Vec::new());
        let from = |z: f32| View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z * z, Some(0.3), SIZE).unwrap();
        let (front, back) = (from(1.0), from(-1.0));
        pair.compare(&front, "first");
        let [drawn, all] = pair.compare(&front, "again");
        let [hidden, opened] = [300 * 20, 9 * 20 * 5];
        // A chunk on the Z-curve may hold segments of both.
        let most = all - hidden + 5 * 64 + if gap > 0.0 { 4 * opened } else { 0 };
        assert!(drawn <= most, "{gap}: {drawn} of {all}");
        for _ in 0..2 {
            pair.compare(&back, "from behind");
        }
        pair.compare(&front, "before it again");
    }
}

#[test]
fn sets_of_no_or_few_segments_and_other_sets_of_the_same_size_are_drawn() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let [view, _] = views([-Vec3::ONE, Vec3::ONE]);
    let mut pair = Pair::new(&gpu, &LineSet::default(), Vec::new());
    assert_eq!(pair.compare(&view, "none"), [0, 0]);
    assert_eq!(pair.renderers[0].read_drawn(&gpu).unwrap(), Drawn::default());
    for x in [0.0, 0.5] {
        let one = LineSet::new([[vec3(x, -0.5, 0.0), vec3(x, 0.5, 0.1)]]).unwrap();
        pair.lines = GpuLines::new(&gpu, &one, &of_margin(0.04)).unwrap();
        for _ in 0..2 {
            assert_eq!(pair.compare(&view, "one"), [1, 1]);
        }
    }
}
