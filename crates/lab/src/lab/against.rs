//! The default method against a vectorised occlusion buffer, as engines ship it, on all scenes.

use super::buffer::{BufferCost, measure};
use super::tradeoff::Sampling;
use super::worlds::Place;
use super::{Lab, LabError, Section, Table};
use crate::scenes::SceneKind;

/// Pixels of the buffer: what engines use.
const SIZE: (usize, usize) = (320, 180);

/// The default method and the buffer, on every scene in turn.
///
/// # Errors
/// If a scene cannot be read or is refused.
pub fn against(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Against a vectorised occlusion buffer");
    let mut table = Table::new(
        "against",
        &[
            "scene",
            "in the frustum",
            "visible",
            "point, ms",
            "point, PVS/visible",
            "point, lost",
            "hzb, ms",
            "hzb, PVS/visible",
            "hzb, lost",
            "time of point over that of hzb",
        ],
    );
    let sampling = Sampling { frames: lab.pick(30, 1), repeats: lab.pick(5, 1), width: lab.pick(2560, 160) };
    let mut costs = Vec::new();
    let built = SceneKind::ALL.iter().copied().map(Place::Built);
    for place in built.chain(lab.files.iter().map(|f| Place::File(f))) {
        if lab.quick && !matches!(place, Place::Built(SceneKind::City)) {
            continue;
        }
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        let cost = measure(world, SIZE, &sampling, |_| ())?;
        table.row(row(&cost));
        costs.push(cost);
    }
    section.text(text(&costs));
    section.table(table);
    Ok(section)
}

/// What the table says, in words.
fn text(costs: &[BufferCost]) -> String {
    let ratios = costs.iter().map(|c| c.point.ms / c.buffer.ms.max(f64::MIN_POSITIVE));
    let (least, most) = ratios.fold((f64::INFINITY, 0.0f64), |(lo, hi), r| (lo.min(r), hi.max(r)));
    let [tighter, losing] = [
        costs.iter().filter(|c| c.point.ratio <= c.buffer.ratio).count(),
        costs.iter().filter(|c| c.buffer.lost > 0.0).count(),
    ];
    format!(
        "`hzb` has {}x{} pixels here, draws all triangles front to back in vectors of 32-bit floats and tests the box of each \
         object before and after: the kind of buffer that engines ship. **`point` takes {least:.1} to {most:.1} times as long; \
         its set is the smaller one on {tighter} of {} scenes, and `hzb` loses visible objects on {losing}.** Medians of \
         the least of several runs of each frame; lost objects are those of one frame.",
        SIZE.0,
        SIZE.1,
        costs.len()
    )
}

fn row(cost: &BufferCost) -> [String; 10] {
    let [point, buffer] = [cost.point, cost.buffer]
        .map(|s| [format!("{:.2}", s.ms), format!("{:.2}", s.ratio), format!("{:.2}", s.lost)]);
    let [a, b, c] = point;
    let [d, e, f] = buffer;
    let ratio = format!("{:.1}", cost.point.ms / cost.buffer.ms.max(f64::MIN_POSITIVE));
    let (frustum, visible) = (format!("{:.0}", cost.in_frustum), format!("{:.1}", cost.visible));
    [cost.scene.clone(), frustum, visible, a, b, c, d, e, f, ratio]
}
