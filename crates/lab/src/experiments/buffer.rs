//! The cost of a sampled occlusion buffer, a triangle and a box, and how the default method
//! compares with it.

use casca::{Aabb, GridSpec, Method, PointOptions};

use super::walker::{Walker, item_buffer};
use super::{Contender, LabError, median, p99};
use casca_scenes::world::World;

/// The sets of options that have names, from the fastest to the tightest.
pub const PRESETS: [(&str, PointOptions); 3] = [
    ("fast", PointOptions::fast()),
    ("balanced", PointOptions::balanced()),
    ("tight", PointOptions::tight()),
];
/// The default among [`PRESETS`].
const BALANCED: usize = 1;
/// The most that the 99th percentile of the times should be over their median, where the sets vary
/// by less.
pub const STEADY: f64 = 3.0;
/// Times that differ by less than this share count as equal: the machine is not quieter.
const NOISE: f64 = 0.05;

/// How much is measured of a walk.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Frames that are timed, evenly spread.
    pub frames: usize,
    /// How many of those are compared with exact visibility.
    pub judged: usize,
    /// Times that each frame is measured; the least counts.
    pub repeats: usize,
    /// Pixels of a row of the item buffer that finds the visible objects.
    pub width: usize,
}

/// What a method did on a walk.
#[derive(Debug, Clone, Copy, Default)]
pub struct Score {
    /// Milliseconds of a frame, the median of the frames' least.
    pub ms: f64,
    /// The 99th percentile of the same.
    pub p99: f64,
    /// The 99th percentile of the size of the set over its median.
    pub swing: f64,
    /// Objects found over objects visible.
    pub ratio: f64,
    /// Visible objects that are lost in a frame.
    pub lost: f64,
}

impl Score {
    /// The 99th percentile of the times over their median.
    pub fn tail(&self) -> f64 {
        self.p99 / self.ms.max(f64::MIN_POSITIVE)
    }

    /// Whether the tail is at most [`STEADY`]; `None` if the set itself varies by more.
    pub fn is_steady(&self) -> Option<bool> {
        (self.swing < STEADY).then(|| self.tail() <= STEADY)
    }
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
    /// The point method in the grid of [`GridSpec::fit`], with each of [`PRESETS`].
    pub presets: [Score; PRESETS.len()],
    /// The buffer.
    pub buffer: Score,
}

impl BufferCost {
    /// The default options.
    pub fn point(&self) -> &Score {
        &self.presets[BALANCED]
    }

    /// Whether each of the presets is no faster and no looser than the one before it, but for
    /// noise.
    pub fn keeps_order(&self) -> bool {
        self.presets.windows(2).all(|w| w[0].ms <= w[1].ms * (1.0 + NOISE) && w[0].ratio >= w[1].ratio)
    }
}

/// Sums over the frames of a walk.
#[derive(Default)]
struct Sums {
    ms: Vec<f64>,
    sizes: Vec<f64>,
    /// In the frames that are judged.
    found: usize,
    lost: usize,
}

impl Sums {
    fn add(&mut self, contender: &Contender, ms: f64, visible: Option<&[usize]>) {
        self.ms.push(ms);
        self.sizes.push(contender.found().len() as f64);
        if let Some(visible) = visible {
            self.found += contender.found().len();
            self.lost += visible.iter().filter(|&&i| !contender.sees(i)).count();
        }
    }

    fn score(&mut self, visible: usize, judged: usize) -> Score {
        Score {
            ms: median(&mut self.ms),
            p99: p99(&mut self.ms),
            swing: p99(&mut self.sizes) / median(&mut self.sizes).max(1.0),
            ratio: self.found as f64 / visible.max(1) as f64,
            lost: self.lost as f64 / judged.max(1) as f64,
        }
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
    let mut contenders = vec![Contender::hzb(size.0, size.1)];
    for (name, options) in PRESETS {
        contenders.push(Contender::casca(name, Method::Point(options))?);
    }
    let mut sums: Vec<Sums> = contenders.iter().map(|_| Sums::default()).collect();
    let mut exact = item_buffer(sampling.width);
    let every = sampling.frames.min(walker.world.frames).div_ceil(sampling.judged.max(1)).max(1);
    let (mut visible_sum, mut frustum_sum, mut done, mut judged) = (0, 0, 0, 0);
    walker.walk::<LabError>(sampling.frames, |walker, _, frame| {
        let judges = done % every == every / 2;
        let visible = judges.then(|| walker.visible(frame, &mut exact));
        for (contender, sums) in contenders.iter_mut().zip(&mut sums) {
            let mut best = f64::INFINITY;
            for _ in 0..sampling.repeats.max(1) {
                best = best.min(contender.run(&walker.input(frame, 1))?.as_secs_f64() * 1e3);
            }
            sums.add(contender, best, visible.as_deref());
        }
        if let Some(visible) = visible {
            visible_sum += visible.len();
            judged += 1;
        }
        frustum_sum += frame.in_frustum.iter().filter(|&&i| walker.world.objects[i].tested).count();
        done += 1;
        progress(done);
        Ok(())
    })?;
    let mean = |sum: f64, frames: usize| sum / frames.max(1) as f64;
    let mut scores = sums.iter_mut().map(|s| s.score(visible_sum, judged));
    Ok(BufferCost {
        scene: walker.world.name.clone(),
        in_frustum: mean(frustum_sum as f64, done),
        visible: mean(visible_sum as f64, judged),
        buffer: scores.next().unwrap_or_default(),
        presets: std::array::from_fn(|_| scores.next().unwrap_or_default()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(ms: f64, ratio: f64) -> Score {
        Score { ms, ratio, ..Score::default() }
    }

    #[test]
    fn presets_are_in_order_if_each_takes_longer_and_finds_less() {
        let order = |presets| BufferCost { presets, ..BufferCost::default() }.keeps_order();
        assert!(order([score(1.0, 1.3), score(2.0, 1.1), score(3.0, 1.1)]));
        assert!(order([score(1.01, 1.3), score(1.0, 1.3), score(3.0, 1.1)]), "a hundredth is noise");
        assert!(!order([score(2.0, 1.3), score(1.0, 1.1), score(3.0, 1.0)]));
        assert!(!order([score(1.0, 1.1), score(2.0, 1.2), score(3.0, 1.0)]));
    }

    #[test]
    fn times_are_steady_unless_they_vary_by_more_than_the_sets() {
        let steady = |p99, swing| Score { ms: 1.0, p99, swing, ..Score::default() }.is_steady();
        assert_eq!([steady(2.9, 1.5), steady(3.1, 1.5), steady(9.0, 4.0)], [Some(true), Some(false), None]);
    }
}
