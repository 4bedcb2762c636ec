//! Questions about boxes and points to one set of occlusion buffers, compared with exact rays and
//! with the nine rays that games usually cast.

mod measure;
mod questions;

pub use measure::{Sampling, SightCost, measure};

use super::worlds::Place;
use super::{Lab, LabError, Section, Table, grouped};
use casca_scenes::generated::SceneKind;

/// Questions to all scenes.
///
/// # Errors
/// If a scene cannot be read or is refused.
pub fn sight(lab: &Lab) -> Result<Section, LabError> {
    let sampling = Sampling {
        frames: lab.pick(20, 1),
        questions: lab.pick(10_000, 100),
        samples: lab.pick(64, 8),
        repeats: lab.pick(3, 1),
        seed: lab.seed,
    };
    let mut costs = Vec::new();
    let built = SceneKind::ALL.iter().copied().map(Place::Built);
    for place in built.chain(lab.files.iter().map(|f| Place::File(f))) {
        if lab.quick && !matches!(place, Place::Built(SceneKind::Rooms)) {
            continue;
        }
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        costs.push(measure(world, &sampling, |_| ())?);
    }
    let mut section = Section::new("Questions about boxes and points");
    section.text(finding(&costs, &sampling));
    section.table(table(&costs));
    Ok(section)
}

/// The least and the greatest of some values.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
}

fn finding(costs: &[SightCost], sampling: &Sampling) -> String {
    let wrong: usize = costs.iter().map(|c| c.wrong).sum();
    let (fastest, slowest) = range(costs.iter().map(|c| c.box_ns));
    let (least_rays, most_rays) = range(costs.iter().map(|c| c.nine_ns));
    let (least_lost, most_lost) = range(costs.iter().map(SightCost::lost_by_rays));
    let wrong = if wrong == 0 { "none is wrong".to_owned() } else { format!("{wrong} are wrong") };
    format!(
        "`Query::sight` answers whether a box or a point may be seen, from the buffers of the last query. {} boxes of mixed sizes \
         and as many points inside the frustum, in {} frames of each walk; an answer is wrong if it is \"hidden\" and one of {} \
         exact rays reaches the box. **A box takes {fastest:.0} to {slowest:.0} ns, and {wrong}.** The usual nine rays, to the \
         corners and the centre of a box, take {least_rays:.0} to {most_rays:.0} ns and lose {least_lost:.1}% to \
         {most_lost:.1}% of the visible boxes. Times are medians over the frames; the query is run once for all questions.",
        grouped(sampling.questions),
        sampling.frames,
        sampling.samples,
    )
}

/// A row for each scene.
pub fn table(costs: &[SightCost]) -> Table {
    let mut table = Table::new(
        "sight",
        &[
            "scene",
            "query, ms",
            "box, ns",
            "point, ns",
            "wrong answers",
            "visible boxes, %",
            "hidden boxes called visible, %",
            "nine rays, ns",
            "visible boxes lost by nine rays, %",
        ],
    );
    for cost in costs {
        table.row([
            cost.scene.clone(),
            format!("{:.3}", cost.query_ms),
            format!("{:.0}", cost.box_ns),
            format!("{:.0}", cost.point_ns),
            cost.wrong.to_string(),
            format!("{:.1}", cost.visible_share()),
            format!("{:.1}", cost.called_visible()),
            format!("{:.0}", cost.nine_ns),
            format!("{:.2}", cost.lost_by_rays()),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use casca::Aabb;
    use glam::Vec3;

    use super::*;
    use casca_scenes::world::{Animation, Camera, GridHint, Motion, Object, Shape, World};

    /// A camera that stands still.
    struct Still(Camera);

    impl Animation for Still {
        fn shapes(&self, _: usize, _: &mut dyn FnMut(usize, Shape)) {}

        fn camera(&self, _: usize, _: f32) -> Camera {
            self.0
        }
    }

    /// A wall across half of the picture, with a narrow slit.
    fn walls() -> World {
        let wall = |x0: f32, x1: f32| Object {
            name: String::new(),
            shape: Shape::Box { min: Vec3::new(x0, 0.0, 19.0), max: Vec3::new(x1, 32.0, 20.0) },
            motion: Motion::Static,
            occludes: true,
            tested: true,
        };
        let camera =
            Camera::look_at(Vec3::new(16.0, 16.0, 31.0), Vec3::new(16.0, 16.0, 0.0), 60.0, 1.0, 0.1, 99.0);
        World {
            source: Default::default(),
            name: "walls".to_owned(),
            objects: vec![wall(0.0, 12.0), wall(12.5, 20.0)],
            grid: GridHint { min: Vec3::ZERO, max: Vec3::splat(32.0), cell: 1.0 },
            frames: 1,
            animation: Box::new(Still(camera)),
        }
    }

    #[test]
    fn boxes_behind_a_wall_are_hidden_and_none_is_lost_but_by_nine_rays() {
        let sampling = Sampling { frames: 1, questions: 4000, samples: 64, repeats: 1, seed: 5 };
        let mut done = 0;
        let cost = measure(walls(), &sampling, |n| done = n).unwrap();
        assert_eq!((done, cost.wrong, cost.visible + cost.hidden), (1, 0, 4000));
        assert!(cost.visible > 500 && cost.hidden > 1000, "{cost:?}");
        // Through the slit shows a part of some boxes that is neither a corner nor the centre.
        assert!(cost.lost > 0 && cost.lost < cost.visible / 10, "{cost:?}");
        assert!(cost.kept < cost.hidden / 5, "{cost:?}");
        assert!(cost.box_ns > 0.0 && cost.point_ns > 0.0 && cost.nine_ns > 0.0);
        let text = finding(std::slice::from_ref(&cost), &sampling);
        assert!(text.contains("none is wrong") && text.contains("4,000 boxes"), "{text}");
        assert_eq!(table(&[cost]).rows.len(), 1);
    }

    #[test]
    fn questions_are_the_same_for_the_same_seed_and_lie_in_the_frustum() {
        let world = walls();
        let camera = world.camera(0, 1.0);
        let asked = |seed| questions::questions(&world.grid, &camera, 200, seed);
        let (boxes, points) = asked(1);
        assert_eq!((boxes.len(), points.len()), (200, 200));
        assert_eq!(boxes, asked(1).0);
        assert_ne!(boxes, asked(2).0);
        let frustum = casca_truth::oracle::Frustum::new(&camera);
        let middle = |b: &Aabb| ((b.min + b.max) * 0.5).as_dvec3();
        assert!(boxes.iter().all(|b| frustum.contains(middle(b))));
        let edges: Vec<f32> = boxes.iter().map(|b| (b.max - b.min).max_element()).collect();
        let (least, most) = edges.iter().fold((f32::MAX, 0.0f32), |(lo, hi), &e| (lo.min(e), hi.max(e)));
        assert!(most > 10.0 * least, "boxes of mixed sizes: {least} to {most}");
    }
}
