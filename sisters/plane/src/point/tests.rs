//! The keys of directions beside exact arithmetic alone: the answers are the same to the last bit.

use glam::{UVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::point::arcs::{EXACTLY, Ray, order, quarter};

use crate::{
    ConvexPolygon, Disc, GridSpec, ObjectDesc, ObjectId, Polyline, Query, Rect, Scene, Segment, Shape, View,
};

/// Keys that differ by less count as near: a rounding or two of single precision.
const NEAR_KEYS: f64 = 1e-7;

/// All that a query says: the set, the polygon, and which points it sees.
type Answer = (Vec<ObjectId>, Vec<[u32; 2]>, Vec<bool>);

fn answer(scene: &Scene, view: &View, points: &[Vec2], exactly: bool) -> Answer {
    EXACTLY.set(exactly);
    let mut query = Query::new();
    let set = query.run(scene, view).visible().to_vec();
    let polygon = query.polygon().iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    let seen = points.iter().map(|&p| query.sees_point(p)).collect();
    EXACTLY.set(false);
    (set, polygon, seen)
}

/// A kind of points: how they lie to each other decides which comparisons are near.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Anywhere,
    /// Small whole numbers: many directions are the same, or opposite.
    Lattice,
    /// On few rays from the eye, and a digit beside them.
    Grazing,
    /// Of all sizes, from the least number to the greatest.
    Huge,
}

fn point(kind: Kind, eye: Vec2, random: &mut Pcg32) -> Vec2 {
    let mut whole = |most: i32| random.random_range(-most..=most) as f32;
    match kind {
        Kind::Anywhere => Vec2::new(whole(1 << 20), whole(1 << 20)) * (9.0 / (1 << 20) as f32),
        Kind::Lattice => Vec2::new(whole(6), whole(6)),
        Kind::Grazing => {
            let p = eye + Vec2::new(whole(2), whole(2)) * 0.37 * (1.0 + whole(5).abs());
            match whole(2) as i32 {
                0 => Vec2::new(p.x.next_up(), p.y),
                1 => Vec2::new(p.x, p.y.next_down()),
                _ => p,
            }
        }
        Kind::Huge => {
            let [x, y] = [0, 0].map(|_| whole(7) * 2f32.powi(whole(120) as i32));
            Vec2::new(x, y)
        }
    }
}

fn shape(kind: Kind, eye: Vec2, random: &mut Pcg32) -> Shape {
    let points: Vec<Vec2> = (0..4).map(|_| point(kind, eye, random)).collect();
    let [a, b] = [points[0], points[1]];
    match random.random_range(0..8) {
        0 => Rect::new(a.min(b), a.max(b)).into(),
        1 => ConvexPolygon::new(&points).map_or(Segment::new(a, b).into(), Shape::from),
        2 => Polyline::new(&points).map_or(Segment::new(a, b).into(), Shape::from),
        3 => Disc::new(a, random.random_range(0.0..2.0)).into(),
        _ => Segment::new(a, b).into(),
    }
}

#[test]
fn keys_and_exact_arithmetic_answer_the_same() {
    let mut random = Pcg32::seed_from_u64(39);
    let (mut seen, mut hidden) = (0, 0);
    for round in 0..1200 {
        let kind = [Kind::Anywhere, Kind::Lattice, Kind::Grazing, Kind::Huge][round % 4];
        let cells = [18, 1, 40][round / 4 % 3];
        let spec = GridSpec { min: Vec2::splat(-9.0), cell: 18.0 / cells as f32, dims: UVec2::splat(cells) };
        let mut scene = Scene::new(&spec).unwrap();
        let eye = if round % 3 == 0 { Vec2::ZERO } else { point(Kind::Anywhere, Vec2::ZERO, &mut random) };
        for _ in 0..random.random_range(1..60) {
            let shape = shape(kind, eye, &mut random);
            let desc = ObjectDesc::new(shape.clone());
            let hides = random.random_range(0..4) > 0;
            // Discs of no size at huge places are refused.
            let _ = scene.insert(if hides { desc.occluder(shape) } else { desc });
        }
        let points: Vec<Vec2> = (0..20).map(|_| point(kind, eye, &mut random)).collect();
        let round_view = View::all_round(eye).unwrap();
        let sector = View::sector(eye, Vec2::from_angle(round as f32), 0.9).unwrap();
        for view in [round_view, sector, round_view.with_range(5.0).unwrap()] {
            let answers = [false, true].map(|exactly| answer(&scene, &view, &points, exactly));
            assert_eq!(answers[0], answers[1], "{kind:?}, round {round}");
            seen += answers[0].0.len();
            hidden += scene.len() - answers[0].0.len();
        }
    }
    assert!(seen > 10_000 && hidden > 10_000, "{seen} seen, {hidden} hidden");
}

/// The margin of keys is needed and enough: directions that differ by less than a digit of their
/// keys are told apart exactly.
#[test]
fn keys_tell_no_order_that_is_not_so() {
    let mut random = Pcg32::seed_from_u64(40);
    let mut near = 0;
    for _ in 0..200_000 {
        let mut number = || random.random_range(-1.0f32..1.0) * 2f32.powi(random.random_range(-20..20));
        let eye = Vec2::new(number(), number());
        let p = eye + Vec2::new(number(), number());
        // On almost the same ray.
        let along = 2f32.powi(random.random_range(-3..3)) * random.random_range(0.9f32..1.1);
        let q = eye + (p - eye) * along;
        let [eye, p, q] = [eye, p, q].map(|v| v.as_dvec2());
        let quarters = [quarter(eye, p), quarter(eye, q)];
        if quarters[0] != quarters[1] || p == eye || q == eye {
            continue;
        }
        let rays = [p, q].map(|v| Ray::new(eye, v, quarters[0]));
        let quick = order(eye, &rays[0], &rays[1]);
        EXACTLY.set(true);
        assert_eq!(quick, order(eye, &rays[0], &rays[1]), "{eye} {p} {q}");
        EXACTLY.set(false);
        near += u32::from((rays[0].key - rays[1].key).abs() < NEAR_KEYS);
    }
    assert!(near > 10_000, "{near}");
}
