//! A walking camera: what the frames of a second cost that hardly differ, by each way to answer
//! them.

mod measure;

use measure::{Sampling, WalkScore, measure};

use super::{Lab, LabError, Place, Section, Table, grouped};
use casca_scenes::generated::SceneKind;

/// The scenes that are walked, beside files.
const SCENES: [SceneKind; 3] = [SceneKind::City, SceneKind::Rooms, SceneKind::Town];
/// How many objects move.
const MOVERS: [usize; 3] = [0, 200, 10_000];

/// Ways to answer the frames of a walking camera, side by side.
///
/// # Errors
/// If a scene cannot be read or is refused.
pub fn coherence(lab: &Lab) -> Result<Section, LabError> {
    let sampling = Sampling {
        frames: lab.pick(300, 12),
        stretches: lab.pick(3, 1),
        judge: 7,
        width: lab.pick(960, 160),
        rays: 4,
        seed: lab.seed,
    };
    let mut scores = Vec::new();
    let scenes = if lab.quick { &SCENES[1..2] } else { &SCENES };
    let built = scenes.iter().copied().map(Place::Built);
    for place in built.chain(lab.files.iter().map(|f| Place::File(f))) {
        for movers in MOVERS {
            let world = place.open(lab)?;
            (lab.progress)(&format!("{}, {} movers", world.name, grouped(movers)));
            scores.push(measure(world, movers, &sampling)?);
        }
    }
    let mut section = Section::new("A walking camera");
    section.text(text(&scores));
    section.rows("A summary as CSV", summary(&scores));
    Ok(section)
}

fn text(scores: &[WalkScore]) -> String {
    let wrong: usize = scores.iter().flat_map(|s| &s.ways).map(|w| w.wrong).sum();
    let judged: usize = scores.iter().map(|s| s.judged * s.ways.len()).sum();
    let lost = if wrong == 0 { "none lacks".to_owned() } else { format!("they lack {}", grouped(wrong)) };
    format!(
        "A person walks through each scene at 1.5 m/s and looks around, at 60 frames a second. The scene \
         stands still, but for spheres that float about (*movers*; every second one hides others). `fresh` \
         runs a query of `point` in every frame, `coherent` the same with `PointOptions::coherent`; `kept` \
         is a `KeptQuery`, whose new results are found in the frame that needs them or on *another thread* \
         before (not counted then). Cells of the summary give, over those of `fresh`: the mean time of a \
         frame, its 99th percentile, and the objects of the set in the frustum. **Of {} sets compared with \
         exact visibility, {lost} visible objects.**",
        grouped(judged)
    )
}

/// A row for each walk, and a column for each way.
fn summary(scores: &[WalkScore]) -> Table {
    let first = ["scene", "movers", "visible", "fresh, ms", "fresh, p99, ms", "fresh, PVS/visible"];
    let ways = scores.first().into_iter().flat_map(|s| s.ways.iter().skip(1));
    let columns: Vec<&str> = first.into_iter().chain(ways.map(|w| w.name.as_str())).collect();
    let mut table = Table::new("coherence-summary", &columns);
    let over = |a: f64, b: f64| a / b.max(f64::MIN_POSITIVE);
    for score in scores {
        let Some((fresh, others)) = score.ways.split_first() else { continue };
        let first = [score.scene.clone(), score.movers.to_string(), format!("{:.1}", score.visible)];
        let times = [fresh.mean, fresh.p99, fresh.found / score.visible.max(1.0)].map(|v| format!("{v:.2}"));
        let cells = others.iter().map(|way| {
            let (mean, p99) = (over(way.mean, fresh.mean), over(way.p99, fresh.p99));
            format!("{mean:.2}, {p99:.2}, {:.2}", way.found / fresh.found.max(1.0))
        });
        table.row(first.into_iter().chain(times).chain(cells));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_scenes::generated::{SceneOptions, build};

    #[test]
    fn all_ways_find_all_that_is_visible_with_and_without_movers() {
        let sampling = Sampling { frames: 40, stretches: 2, judge: 3, width: 160, rays: 2, seed: 1 };
        for movers in [0, 50] {
            let world = build(SceneKind::Rooms, &SceneOptions::default());
            let score = measure(world, movers, &sampling).unwrap();
            assert_eq!((score.judged, score.movers), (14, movers));
            assert_eq!(score.ways.len(), measure::ways().unwrap().len());
            for way in &score.ways {
                assert_eq!(way.wrong, 0, "{}", way.name);
                assert!(way.found >= score.visible, "{way:?}");
                assert!(way.mean > 0.0 && way.p99 > 0.0);
            }
            let ways = score.ways.len();
            let table = summary(&[score]);
            assert_eq!((table.columns.len(), table.rows[0].len()), (5 + ways, 5 + ways));
        }
    }
}
