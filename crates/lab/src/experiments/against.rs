//! The default method against a vectorised occlusion buffer, as engines ship it, on all scenes.

use casca::Method;

use super::Place;
use super::walker::{Walker, item_buffer};
use super::{BUFFER, Contender, Lab, LabError, Section, Table, median, p99};
use casca_scenes::drive::fitted_cell;
use casca_scenes::generated::SceneKind;
use casca_scenes::world::World;

/// How much is measured of a walk.
#[derive(Debug, Clone, Copy)]
struct Sampling {
    /// Frames that are timed, evenly spread.
    frames: usize,
    /// How many of those are compared with exact visibility.
    judged: usize,
    /// Times that each frame is measured; the least counts.
    repeats: usize,
    /// Pixels of a row of the item buffer that finds the visible objects.
    width: usize,
}

/// What a method did on a walk.
#[derive(Debug, Clone, Copy)]
struct Score {
    /// Milliseconds of a frame, the median of the frames' least.
    ms: f64,
    /// The 99th percentile of the same.
    p99: f64,
    /// Objects found over objects visible.
    ratio: f64,
    /// Visible objects that are lost in a frame.
    lost: f64,
}

/// What was measured on one scene.
#[derive(Debug, Clone)]
struct BufferCost {
    /// The scene's name.
    scene: String,
    /// Mean numbers of objects in the frustum, and of visible ones.
    in_frustum: f64,
    /// Objects of which the item buffer shows a pixel.
    visible: f64,
    /// The point method in the grid of [`fitted_cell`].
    point: Score,
    /// The buffer.
    buffer: Score,
}

/// Sums over the frames of a walk.
#[derive(Default)]
struct Sums {
    ms: Vec<f64>,
    /// In the frames that are judged.
    found: usize,
    lost: usize,
}

impl Sums {
    fn add(&mut self, contender: &Contender, ms: f64, visible: Option<&[usize]>) {
        self.ms.push(ms);
        if let Some(visible) = visible {
            self.found += contender.found().len();
            self.lost += visible.iter().filter(|&&i| !contender.sees(i)).count();
        }
    }

    fn score(&mut self, visible: usize, judged: usize) -> Score {
        Score {
            ms: median(&mut self.ms),
            p99: p99(&mut self.ms),
            ratio: self.found as f64 / visible.max(1) as f64,
            lost: self.lost as f64 / judged.max(1) as f64,
        }
    }
}

/// Measures a world.
fn measure(world: World, sampling: &Sampling) -> Result<BufferCost, LabError> {
    let cell = fitted_cell(&world)?;
    let mut walker = Walker::new(world)?;
    walker.add(cell)?;
    let mut contenders = [Contender::hzb(BUFFER.0, BUFFER.1), Contender::casca("point", Method::point())?];
    let mut sums: [Sums; 2] = Default::default();
    let mut exact = item_buffer(sampling.width);
    let every = sampling.frames.min(walker.world.frames).div_ceil(sampling.judged.max(1)).max(1);
    let (mut visible_sum, mut frustum_sum, mut done, mut judged) = (0, 0, 0, 0);
    walker.walk::<LabError>(sampling.frames, |walker, _, frame| {
        let judges = done % every == every / 2;
        let visible = judges.then(|| walker.visible(frame, &mut exact));
        for (contender, sums) in contenders.iter_mut().zip(&mut sums) {
            let ms = contender.least(&walker.input(frame, 1), sampling.repeats)?;
            sums.add(contender, ms, visible.as_deref());
        }
        if let Some(visible) = visible {
            visible_sum += visible.len();
            judged += 1;
        }
        frustum_sum += frame.in_frustum.iter().filter(|&&i| walker.world.objects[i].tested).count();
        done += 1;
        Ok(())
    })?;
    let mean = |sum: f64, frames: usize| sum / frames.max(1) as f64;
    let [buffer, point] = sums.map(|mut s| s.score(visible_sum, judged));
    Ok(BufferCost {
        scene: walker.world.name.clone(),
        in_frustum: mean(frustum_sum as f64, done),
        visible: mean(visible_sum as f64, judged),
        point,
        buffer,
    })
}

/// The default method and the buffer, on every scene in turn.
///
/// # Errors
/// If a scene cannot be read or is refused.
pub fn against(lab: &Lab) -> Result<Section, LabError> {
    let sampling = Sampling {
        frames: lab.pick(150, 2),
        judged: lab.pick(30, 1),
        repeats: lab.pick(3, 1),
        width: lab.pick(2560, 160),
    };
    let mut costs = Vec::new();
    let built = SceneKind::ALL.iter().copied().map(Place::Built);
    for place in built.chain(lab.files.iter().map(|f| Place::File(f))) {
        if lab.quick && !matches!(place, Place::Built(SceneKind::City)) {
            continue;
        }
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        costs.push(measure(world, &sampling)?);
    }
    let mut section = Section::new("Against a vectorised occlusion buffer");
    section.text(comparison(&costs));
    section.rows("All scenes as CSV", against_table(&costs));
    Ok(section)
}

/// The time of the default method over that of the buffer.
fn slower(cost: &BufferCost) -> f64 {
    cost.point.ms / cost.buffer.ms.max(f64::MIN_POSITIVE)
}

fn comparison(costs: &[BufferCost]) -> String {
    let (least, most) =
        costs.iter().map(slower).fold((f64::INFINITY, 0.0f64), |(lo, hi), r| (lo.min(r), hi.max(r)));
    let [tighter, losing] = [
        costs.iter().filter(|c| c.point.ratio <= c.buffer.ratio).count(),
        costs.iter().filter(|c| c.buffer.lost > 0.0).count(),
    ];
    format!(
        "`hzb` has {}x{} pixels here, draws all triangles front to back in vectors of 32-bit floats and \
         tests the box of each object before and after: the kind of buffer that engines ship. **`point` \
         takes {least:.1} to {most:.1} times as long; its set is the smaller one on {tighter} of {} scenes, \
         and `hzb` loses visible objects on {losing}.** Each frame of a walk counts with the least of \
         several runs; medians and 99th percentiles (p99) are over the frames. Sets and lost objects are \
         those of a frame, in a part of the frames.",
        BUFFER.0,
        BUFFER.1,
        costs.len()
    )
}

fn against_table(costs: &[BufferCost]) -> Table {
    let columns = [
        "scene",
        "in the frustum",
        "visible",
        "point, ms",
        "point p99, ms",
        "point, PVS/visible",
        "point, lost",
        "hzb, ms",
        "hzb p99, ms",
        "hzb, PVS/visible",
        "hzb, lost",
        "time of point over that of hzb",
    ];
    let mut table = Table::new("against", &columns);
    for cost in costs {
        let score = |s: &Score| {
            let fine = [s.ms, s.p99].map(|ms| format!("{ms:.3}"));
            fine.into_iter().chain([s.ratio, s.lost].map(|v| format!("{v:.2}")))
        };
        let first = [cost.scene.clone(), format!("{:.0}", cost.in_frustum), format!("{:.1}", cost.visible)];
        let scores = score(&cost.point).chain(score(&cost.buffer));
        table.row(first.into_iter().chain(scores).chain([format!("{:.1}", slower(cost))]));
    }
    table
}
