//! The cost of a sampled occlusion buffer, a triangle and a box, and how the default method compares with it.

use casca::{Aabb, GridSpec, Method};

use super::walker::{Snapshot, Walker, item_buffer};
use super::{Contender, LabError, median};
use crate::baselines::Hzb;
use crate::lab::tradeoff::Sampling;
use crate::measure::timed;
use crate::world::World;

/// What a method did on a walk.
#[derive(Debug, Clone, Copy, Default)]
pub struct Score {
    /// Milliseconds of a frame, the median of the frames' least.
    pub ms: f64,
    /// Objects found over objects visible.
    pub ratio: f64,
    /// Visible objects that are lost in a frame.
    pub lost: f64,
}

/// What was measured on one scene.
#[derive(Debug, Clone, Default)]
pub struct BufferCost {
    /// The scene's name.
    pub scene: String,
    /// Mean numbers of objects in the frustum, and of visible ones.
    pub in_frustum: f64,
    /// Objects of which the item buffer shows a pixel.
    pub visible: f64,
    /// The default method, in the grid of [`GridSpec::fit`].
    pub point: Score,
    /// The buffer.
    pub buffer: Score,
    /// Triangles drawn in a frame, and those of them that may cover the centre of a pixel.
    pub triangles: [f64; 2],
    /// Tests of a box in a frame.
    pub tests: f64,
    /// Nanoseconds of drawing for each triangle drawn, with its share of the objects' boxes.
    pub ns_triangle: f64,
    /// Nanoseconds of testing a box against the finished buffer.
    pub ns_box: f64,
}

/// Sums over the frames of a walk.
#[derive(Default)]
struct Sums {
    ms: Vec<f64>,
    found: usize,
    lost: usize,
}

impl Sums {
    fn add(&mut self, contender: &Contender, ms: f64, visible: &[usize]) {
        self.ms.push(ms);
        self.found += contender.found().len();
        self.lost += visible.iter().filter(|&&i| !contender.sees(i)).count();
    }

    fn score(&mut self, visible: usize) -> Score {
        let frames = self.ms.len().max(1) as f64;
        Score {
            ratio: self.found as f64 / visible.max(1) as f64,
            lost: self.lost as f64 / frames,
            ms: median(&mut self.ms),
        }
    }
}

/// The least seconds of so many calls.
fn least(repeats: usize, mut call: impl FnMut()) -> f64 {
    (0..repeats.max(1)).map(|_| timed(&mut call).1.as_secs_f64()).fold(f64::INFINITY, f64::min)
}

/// The parts of the buffer's work, each alone.
#[derive(Default)]
struct Parts {
    drawing: f64,
    testing: f64,
    triangles: u64,
    on_pixels: u64,
    /// Tests alone, and those of whole frames.
    tests: [u64; 2],
}

impl Parts {
    /// Draws the objects found, and tests all in the frustum against them.
    fn add(&mut self, hzb: &mut Hzb, walker: &Walker, frame: &Snapshot, repeats: usize) {
        let (objects, camera) = (&walker.world.objects, &frame.camera);
        let found = hzb.frame(objects, &frame.in_frustum, camera);
        self.tests[1] += hzb.work().tests;
        let occluders: Vec<usize> = found.into_iter().filter(|&i| objects[i].occludes).collect();
        self.drawing += least(repeats, || hzb.draw_all(objects, occluders.iter().copied(), camera));
        self.triangles += hzb.work().triangles;
        self.on_pixels += hzb.work().on_pixels;
        self.testing += least(repeats, || {
            hzb.test(objects, &frame.in_frustum, camera);
        });
        self.tests[0] += hzb.work().tests;
    }
}

/// Measures a world with a buffer of `size` pixels. `progress` is told the frames done.
///
/// # Errors
/// If the library refuses the world.
pub fn measure(
    world: World,
    size: (usize, usize),
    sampling: &Sampling,
    mut progress: impl FnMut(usize),
) -> Result<BufferCost, LabError> {
    let fitted = GridSpec::fit(Aabb::new(world.grid.min, world.grid.max), world.objects.len())?;
    let mut walker = Walker::new(world)?;
    walker.add(&fitted)?;
    let mut contenders = [Contender::casca("default", Method::default())?, Contender::hzb(size.0, size.1)];
    let mut sums = [Sums::default(), Sums::default()];
    let (mut hzb, mut parts) = (Hzb::new(size.0, size.1), Parts::default());
    let mut exact = item_buffer(sampling.width);
    let (mut visible_sum, mut frustum_sum, mut done) = (0, 0, 0);
    walker.walk::<LabError>(sampling.frames, |walker, _, frame| {
        let visible = walker.visible(frame, &mut exact);
        for (contender, sums) in contenders.iter_mut().zip(&mut sums) {
            let mut best = f64::INFINITY;
            for _ in 0..sampling.repeats.max(1) {
                best = best.min(contender.run(&walker.input(frame, 1))?.as_secs_f64() * 1e3);
            }
            sums.add(contender, best, &visible);
        }
        parts.add(&mut hzb, walker, frame, sampling.repeats);
        visible_sum += visible.len();
        frustum_sum += frame.in_frustum.iter().filter(|&&i| walker.world.objects[i].tested).count();
        done += 1;
        progress(done);
        Ok(())
    })?;
    let a_frame = |n: f64| n / f64::from(done.max(1) as u32);
    let [point, buffer] = sums.each_mut().map(|s| s.score(visible_sum));
    Ok(BufferCost {
        scene: walker.world.name.clone(),
        in_frustum: a_frame(frustum_sum as f64),
        visible: a_frame(visible_sum as f64),
        point,
        buffer,
        triangles: [a_frame(parts.triangles as f64), a_frame(parts.on_pixels as f64)],
        tests: a_frame(parts.tests[1] as f64),
        ns_triangle: parts.drawing * 1e9 / parts.triangles.max(1) as f64,
        ns_box: parts.testing * 1e9 / parts.tests[0].max(1) as f64,
    })
}
