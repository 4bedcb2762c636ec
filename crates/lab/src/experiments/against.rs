//! The default method against a vectorised occlusion buffer, as engines ship it, and its presets
//! beside each other, on all scenes.

use casca::{Method, PointOptions};

use super::Place;
use super::walker::{Walker, item_buffer};
use super::{BUFFER, Contender, Lab, LabError, Section, Table, median, p99};
use casca_scenes::drive::fitted_grid;
use casca_scenes::generated::SceneKind;
use casca_scenes::world::World;

/// The sets of options that have names, from the fastest to the tightest.
const PRESETS: [(&str, PointOptions); 3] = [
    ("fast", PointOptions::fast()),
    ("balanced", PointOptions::balanced()),
    ("tight", PointOptions::tight()),
];
/// The default among [`PRESETS`].
const BALANCED: usize = 1;
/// Times that differ by less than this share count as equal: the machine is not quieter.
const NOISE: f64 = 0.05;

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
#[derive(Debug, Clone, Copy, Default)]
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
#[derive(Debug, Clone, Default)]
struct BufferCost {
    /// The scene's name.
    scene: String,
    /// Mean numbers of objects in the frustum, and of visible ones.
    in_frustum: f64,
    /// Objects of which the item buffer shows a pixel.
    visible: f64,
    /// The point method in the grid of [`fitted_grid`], with each of [`PRESETS`].
    presets: [Score; PRESETS.len()],
    /// The buffer.
    buffer: Score,
}

impl BufferCost {
    /// The default options.
    fn point(&self) -> &Score {
        &self.presets[BALANCED]
    }

    /// Whether each of the presets is no faster and no looser than the one before it, but for
    /// noise.
    fn keeps_order(&self) -> bool {
        self.presets.windows(2).all(|w| w[0].ms <= w[1].ms * (1.0 + NOISE) && w[0].ratio >= w[1].ratio)
    }
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
    let fitted = fitted_grid(&world)?;
    let mut walker = Walker::new(world)?;
    walker.add(&fitted)?;
    let mut contenders = vec![Contender::hzb(BUFFER.0, BUFFER.1)];
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
    let mut scores = sums.iter_mut().map(|s| s.score(visible_sum, judged));
    Ok(BufferCost {
        scene: walker.world.name.clone(),
        in_frustum: mean(frustum_sum as f64, done),
        visible: mean(visible_sum as f64, judged),
        buffer: scores.next().unwrap_or_default(),
        presets: std::array::from_fn(|_| scores.next().unwrap_or_default()),
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
    section.text(order(&costs));
    section.rows("The presets as CSV", presets_table(&costs));
    Ok(section)
}

/// The time of the default method over that of the buffer.
fn slower(cost: &BufferCost) -> f64 {
    cost.point().ms / cost.buffer.ms.max(f64::MIN_POSITIVE)
}

/// The names of the scenes of which something is true; "none" if there are none.
fn names(costs: &[BufferCost], which: impl Fn(&BufferCost) -> bool) -> String {
    let chosen: Vec<&str> = costs.iter().filter(|c| which(c)).map(|c| c.scene.as_str()).collect();
    if chosen.is_empty() { "none".to_owned() } else { chosen.join(", ") }
}

fn comparison(costs: &[BufferCost]) -> String {
    let (least, most) =
        costs.iter().map(slower).fold((f64::INFINITY, 0.0f64), |(lo, hi), r| (lo.min(r), hi.max(r)));
    let [tighter, losing] = [
        costs.iter().filter(|c| c.point().ratio <= c.buffer.ratio).count(),
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

fn order(costs: &[BufferCost]) -> String {
    let lost: f64 = costs.iter().flat_map(|c| c.presets).map(|s| s.lost).sum();
    let losses = if lost > 0.0 { "some lose" } else { "none loses" };
    format!(
        "`PointOptions::fast`, `balanced` (the default) and `tight`; {losses} visible objects. **From one to \
         the next, times grow and sets shrink on {} of {} scenes**; exceptions: {}. Times within 5% count as \
         equal.",
        costs.iter().filter(|c| c.keeps_order()).count(),
        costs.len(),
        names(costs, |c| !c.keeps_order())
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
        let point = cost.point();
        let first = [cost.scene.clone(), format!("{:.0}", cost.in_frustum), format!("{:.1}", cost.visible)];
        let scores = score(point).chain(score(&cost.buffer));
        table.row(first.into_iter().chain(scores).chain([format!("{:.1}", slower(cost))]));
    }
    table
}

fn presets_table(costs: &[BufferCost]) -> Table {
    let quantities = ["ms", "p99, ms", "PVS/visible", "lost"];
    let of = |(name, _): &(&str, _)| quantities.map(|q| format!("{name}, {q}"));
    let columns: Vec<String> = std::iter::once("scene".to_owned())
        .chain(PRESETS.iter().flat_map(of))
        .chain(["in order".to_owned()])
        .collect();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let mut table = Table::new("presets", &columns);
    for cost in costs {
        let scores = cost.presets.iter().flat_map(|s| {
            [
                format!("{:.3}", s.ms),
                format!("{:.3}", s.p99),
                format!("{:.3}", s.ratio),
                format!("{:.2}", s.lost),
            ]
        });
        let order = if cost.keeps_order() { "yes" } else { "no" };
        table.row(std::iter::once(cost.scene.clone()).chain(scores).chain([order.to_owned()]));
    }
    table
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
}
