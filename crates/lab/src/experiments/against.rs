//! The default method against a vectorised occlusion buffer, as engines ship it, and its presets
//! beside each other, on all scenes.

use super::buffer::{BufferCost, PRESETS, STEADY, Sampling, Score, measure};
use super::worlds::Place;
use super::{Lab, LabError, Section, Table};
use casca_scenes::generated::SceneKind;

/// Pixels of the buffer: those that engines use.
const SIZE: (usize, usize) = (320, 180);

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
        costs.push(measure(world, SIZE, &sampling, |_| ())?);
    }
    let mut section = Section::new("Against a vectorised occlusion buffer");
    section.text(comparison(&costs));
    section.text(steadiness(&costs));
    section.table(against_table(&costs));
    section.text(format!("### The presets\n\n{}", order(&costs)));
    section.table(presets_table(&costs));
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
        "`hzb` has {}x{} pixels here, draws all triangles front to back in vectors of 32-bit floats and tests the box of each \
         object before and after: the kind of buffer that engines ship. **`point` takes {least:.1} to {most:.1} times as long; \
         its set is the smaller one on {tighter} of {} scenes, and `hzb` loses visible objects on {losing}.** Each frame of a \
         walk counts with the least of several runs; medians and 99th percentiles (p99) are over the frames. Sets and \
         lost objects are those of a frame, in a part of the frames.",
        SIZE.0,
        SIZE.1,
        costs.len()
    )
}

fn steadiness(costs: &[BufferCost]) -> String {
    let steady = |is: Option<bool>| costs.iter().filter(|c| c.point().is_steady() == is).count();
    format!(
        "**The p99 of `point` is at most {STEADY} times its median on {} of the {} walks whose set varies by less than \
         that** (its p99 over its median); exceptions: {}. On {} walks the set varies by more.",
        steady(Some(true)),
        costs.len() - steady(None),
        names(costs, |c| c.point().is_steady() == Some(false)),
        steady(None)
    )
}

fn order(costs: &[BufferCost]) -> String {
    let lost: f64 = costs.iter().flat_map(|c| c.presets).map(|s| s.lost).sum();
    let losses = if lost > 0.0 { "some lose" } else { "none loses" };
    format!(
        "`PointOptions::fast`, `balanced` (the default) and `tight`; {losses} visible objects. **From one to the next, times \
         grow and sets shrink on {} of {} scenes**; exceptions: {}. Times within 5% count as equal.",
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
        "p99 over median, point",
        "the same of its set",
        "at most 3",
    ];
    let mut table = Table::new("against", &columns);
    for cost in costs {
        let score = |s: &Score| {
            let fine = [s.ms, s.p99].map(|ms| format!("{ms:.3}"));
            fine.into_iter().chain([s.ratio, s.lost].map(|v| format!("{v:.2}")))
        };
        let point = cost.point();
        let first = [cost.scene.clone(), format!("{:.0}", cost.in_frustum), format!("{:.1}", cost.visible)];
        let last = [slower(cost), point.tail(), point.swing].map(|v| format!("{v:.1}"));
        let steady = match point.is_steady() {
            Some(true) => "yes",
            Some(false) => "no",
            None => "-",
        };
        let scores = score(point).chain(score(&cost.buffer));
        table.row(first.into_iter().chain(scores).chain(last).chain([steady.to_owned()]));
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
