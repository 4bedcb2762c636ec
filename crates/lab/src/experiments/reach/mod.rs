//! How far an eye may go before its set is too large: `View::with_reach` on every scene.

mod measure;

pub use measure::{REACHES, ReachScore, Sampling, Step, measure};

use super::worlds::Place;
use super::{Effort, Lab, LabError, Section, Table, grouped};
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, lines};
use casca_scenes::generated::SceneKind;

/// Where charts draw the sets without a reach: a logarithmic axis has no 0.
const NOWHERE: f64 = 0.005;
/// The reach that titles speak of: four frames of a walking camera.
const TYPICAL: f32 = 0.1;

/// Sets for eyes that may go ever farther, on all scenes.
///
/// # Errors
/// If a scene cannot be read or is refused, or a chart cannot be written.
pub fn reach(lab: &Lab) -> Result<Section, LabError> {
    let sampling = Sampling::new(lab.pick(Effort::Short, Effort::Quick), lab.seed);
    let kinds: &[SceneKind] =
        if lab.quick { &[SceneKind::Rooms, SceneKind::CityMeshes] } else { &SceneKind::ALL };
    let built = kinds.iter().copied().map(Place::Built);
    let mut scores = Vec::new();
    for place in built.chain(lab.files.iter().map(|f| Place::File(f))) {
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        scores.push(measure(world, &sampling, |_| ())?);
    }
    section(lab, &sampling, &scores)
}

/// The text, charts and tables about scenes that were measured.
///
/// # Errors
/// If a chart cannot be written.
pub fn section(lab: &Lab, sampling: &Sampling, scores: &[ReachScore]) -> Result<Section, LabError> {
    let mut section = Section::on_its_own_page("Eyes that may go some way");
    section.text(text(sampling, scores));
    for (kind, name, meshes) in [("solids", "Spheres and boxes", false), ("meshes", "Triangle meshes", true)]
    {
        let some: Vec<&ReachScore> = scores.iter().filter(|s| s.meshes == meshes).collect();
        charts(lab, &mut section, kind, name, &some)?;
    }
    section.table(growth(scores));
    section.rows("All figures as CSV", table(scores));
    Ok(section)
}

fn text(sampling: &Sampling, scores: &[ReachScore]) -> String {
    let lost: usize = scores.iter().map(ReachScore::lost).sum();
    let lost = if lost == 0 {
        "No set lacks a visible object".to_owned()
    } else {
        format!("Sets lack {} visible objects", grouped(lost))
    };
    let rays: u64 = scores.iter().map(|s| s.counts.rays).sum();
    let pixels: u64 = scores.iter().map(|s| s.counts.item_rays).sum();
    format!(
        "PVS(r) is the set of `point` for all eyes within r metres of a place (`View::with_reach(r)`), EVS(r) the set of objects that one of \
         these eyes sees: {} eyes for each r in each of {} frames of a walk. Half of them are on the surface of the ball, beside the rims of near occluders; \
         {} of them get an item buffer of {}x{} pixels, and all look along rays at objects that none has seen yet and past the rims of occluders. \
         EVS(r) is a lower bound, since no finite number of eyes finds all. The ball goes through walls: an eye inside of a solid sees all that the solid hid before. **{lost}, by {:.0} million rays aimed and {:.0} million pixels.** The table gives PVS(r)/EVS(0) \
         by r, and the time of a query over that without a reach. A reach pays as long as the set is larger than that of r = 0 by at most a quarter: \
         the last column.",
        sampling.balls.eyes,
        sampling.frames,
        sampling.balls.buffers.min(sampling.balls.eyes),
        sampling.balls.each.width,
        sampling.balls.each.height,
        rays as f64 / 1e6,
        pixels as f64 / 1e6
    )
}

/// A quotient of the sets of a scene at a reach.
struct Quantity {
    /// The part of its file's name.
    file: &'static str,
    /// The label of its axis.
    label: &'static str,
    /// What it is, in a sentence.
    words: &'static str,
    of: fn(&ReachScore, &Step) -> f64,
}

/// The quantities of the charts.
const QUANTITIES: [Quantity; 2] = [
    Quantity {
        file: "size",
        label: "objects in the set over objects visible from the place",
        words: "PVS(r) over EVS(0): objects in the set over objects that the eye sees from its place.",
        of: |score, step| step.found / score.steps[0].visible.max(1.0),
    },
    Quantity {
        file: "tightness",
        label: "objects in the set over objects visible from the ball",
        words: "PVS(r) over EVS(r): objects in the set over objects that any eye within reach sees; 1 is exact.",
        of: |_, step| step.found / step.visible.max(1.0),
    },
];

/// Draws a quantity of some scenes by the reach, under a title that says a finding.
fn chart(
    lab: &Lab,
    section: &mut Section,
    quantity: &Quantity,
    (kind, title): (&str, &str),
    scores: &[&ReachScore],
) -> Result<(), LabError> {
    let line = |(i, score): (usize, &&ReachScore)| {
        let points = score.steps.iter().map(|s| (s.reach.max(NOWHERE), (quantity.of)(score, s)));
        Line::new(&score.scene, other(i), points.collect())
    };
    let all: Vec<Line> = scores.iter().enumerate().map(line).collect();
    let subtitle =
        format!("{} The leftmost marks, at {NOWHERE} m, are the sets without a reach.", quantity.words);
    let axes = (&Axis::log("reach r: how far the eye may go, m (logarithmic)"), &Axis::log(quantity.label));
    let file = format!("reach-{}-{kind}.svg", quantity.file);
    lines(&lab.folder.join(&file), title, &subtitle, axes, &all)?;
    section.picture(&file, title);
    Ok(())
}

/// The least and the greatest of a quantity at the typical reach, with the names of their scenes.
fn extremes(scores: &[&ReachScore], of: impl Fn(&ReachScore, &Step) -> f64) -> String {
    let mut all: Vec<(f64, &str)> = scores.iter().map(|s| (of(s, typical(s)), s.scene.as_str())).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    match (all.first(), all.last()) {
        (Some(least), Some(most)) if all.len() > 1 => {
            format!("{:.2} ({}) to {:.2} ({})", least.0, least.1, most.0, most.1)
        }
        (Some(one), _) => format!("{:.2} ({})", one.0, one.1),
        _ => String::new(),
    }
}

/// The charts of some scenes.
fn charts(
    lab: &Lab,
    section: &mut Section,
    kind: &str,
    name: &str,
    scores: &[&ReachScore],
) -> Result<(), LabError> {
    if scores.is_empty() {
        return Ok(());
    }
    let growth = extremes(scores, |score, step| step.found / score.steps[0].found.max(1.0));
    let tight = extremes(scores, QUANTITIES[1].of);
    let titles = [
        format!("{name}: an eye that may go {TYPICAL} m needs {growth} times the objects of one that stays"),
        format!("{name}: at {TYPICAL} m, sets have {tight} objects for each that some eye within reach sees"),
    ];
    for (quantity, title) in QUANTITIES.iter().zip(&titles) {
        chart(lab, section, quantity, (kind, title), scores)?;
    }
    Ok(())
}

/// The figures at the typical reach.
fn typical(score: &ReachScore) -> &Step {
    score.steps.iter().find(|s| s.reach >= f64::from(TYPICAL)).unwrap_or(&score.steps[0])
}

/// PVS(r)/EVS(0) by scene and reach, and how far a reach pays.
fn growth(scores: &[ReachScore]) -> Table {
    let of = |r: &f32| if *r == 0.0 { "PVS(0)/EVS(0)".to_owned() } else { format!("{r} m") };
    let columns: Vec<String> = ["scene", "EVS(0)"]
        .map(str::to_owned)
        .into_iter()
        .chain(REACHES.iter().map(of))
        .chain(["PVS/EVS at 0.1 m", "time at 0.1 m", "pays up to, m"].map(str::to_owned))
        .collect();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let mut table = Table::new("reach-growth", &columns);
    for score in scores {
        let visible = score.steps[0].visible;
        let typical = typical(score);
        let sets = score.steps.iter().map(|s| format!("{:.2}", s.found / visible.max(1.0)));
        let last = [
            format!("{:.2}", typical.found / typical.visible.max(1.0)),
            format!("{:.2}", typical.ms / score.steps[0].ms.max(f64::MIN_POSITIVE)),
            format!("{}", rounded(score.pays_to())),
        ];
        table.row([score.scene.clone(), format!("{visible:.1}")].into_iter().chain(sets).chain(last));
    }
    table
}

/// A reach without the digits that single precision adds.
fn rounded(reach: f64) -> f64 {
    (reach * 1e4).round() / 1e4
}

/// A row for each scene and reach.
pub fn table(scores: &[ReachScore]) -> Table {
    let columns = [
        "scene",
        "r, m",
        "in the frustum",
        "PVS(r)",
        "EVS(r)",
        "PVS(r)/EVS(r)",
        "PVS(r)/EVS(0)",
        "PVS(r)/PVS(0)",
        "ms",
        "time over that of r = 0",
        "lost",
    ];
    let mut table = Table::new("reach", &columns);
    for score in scores {
        let none = &score.steps[0];
        for step in &score.steps {
            let counts = [step.in_frustum, step.found, step.visible].map(|v| format!("{v:.1}"));
            let over = |a: f64, b: f64| format!("{:.3}", a / b.max(f64::MIN_POSITIVE));
            let ratios = [
                over(step.found, step.visible),
                over(step.found, none.visible),
                over(step.found, none.found),
                format!("{:.4}", step.ms),
                over(step.ms, none.ms),
            ];
            let first = [score.scene.clone(), format!("{}", rounded(step.reach))];
            table.row(first.into_iter().chain(counts).chain(ratios).chain([step.lost.to_string()]));
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_scenes::generated::{SceneOptions, build};

    fn score(found: [f64; REACHES.len()]) -> ReachScore {
        let step = |i: usize| Step {
            reach: f64::from(REACHES[i]),
            found: found[i],
            visible: 9.0,
            ..Step::default()
        };
        ReachScore { steps: std::array::from_fn(step), ..ReachScore::default() }
    }

    #[test]
    fn a_reach_pays_while_sets_are_larger_by_at_most_a_quarter() {
        let pays = |found| rounded(score(found).pays_to());
        assert_eq!(pays([10.0, 10.0, 11.0, 12.0, 12.5, 12.6, 20.0, 20.0, 20.0]), 0.1);
        assert_eq!(
            pays([10.0, 13.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0]),
            0.0,
            "a smaller one does not"
        );
        assert_eq!(pays([10.0; 9]), 3.0);
    }

    #[test]
    fn sets_grow_with_the_reach_and_lose_nothing() {
        for kind in [SceneKind::Rooms, SceneKind::CityMeshes] {
            let world = build(kind, &SceneOptions::default());
            let score = measure(world, &Sampling::new(Effort::Quick, 3), |_| ()).unwrap();
            assert_eq!(
                (score.lost(), score.meshes),
                (0, kind == SceneKind::CityMeshes),
                "{:?}",
                score.examples
            );
            assert!(score.counts.rays > 1000 && score.counts.eyes == 9 * 8);
            for (i, s) in score.steps.iter().enumerate() {
                assert!(s.found >= s.visible && s.in_frustum >= s.found, "{kind:?}: {s:?}");
                assert!(i == 0 || s.found >= score.steps[i - 1].found, "{kind:?}: {s:?}");
                assert!(i == 0 || s.visible >= score.steps[i - 1].visible, "{kind:?}: {s:?}");
            }
            assert!(score.steps[8].visible > score.steps[0].visible, "{kind:?}: three metres show more");
            let rows = table(&[score]).rows;
            assert!(rows.len() == 9 && rows[0][9] == "1.000" && rows[4][1] == "0.1");
        }
    }
}
