//! Levels whose faces touch, eyes and entities that lie on faces, edges and corners, and have no
//! height: what is seen was told.

use casca_server::casca::glam::{DVec3, Vec3};
use casca_server::casca::{Aabb, ObjectDesc, Scene};
use casca_server::{ClientDesc, EntityDesc, ServerOptions, VisibilityServer};
use casca_truth::places::{coordinates, place_in, points};
use proptest::prelude::*;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// The edge of a level, in metres.
const SIZE: f32 = 8.0;

/// All may move for so long until the next answer counts: half a second of latency, and a tick.
const AHEAD: f64 = 1.0;

/// Places are this far from faces that they lie on, at most.
const CLOSE: f64 = 1e-7;

/// Whether a box that moves from one place of its middle to another one touches a solid.
fn is_stopped(solids: &[Aabb], half: DVec3, from: DVec3, to: DVec3) -> bool {
    solids.iter().any(|solid| {
        let (min, max) = (solid.min.as_dvec3() - half, solid.max.as_dvec3() + half);
        let mut span = (0.0f64, 1.0f64);
        for i in 0..3 {
            let step = to[i] - from[i];
            if step == 0.0 {
                if from[i] < min[i] || max[i] < from[i] {
                    return false;
                }
                continue;
            }
            let (a, b) = ((min[i] - from[i]) / step, (max[i] - from[i]) / step);
            span = (span.0.max(a.min(b)), span.1.min(a.max(b)));
        }
        span.0 <= span.1
    })
}

fn sees(solids: &[Aabb], eye: DVec3, point: DVec3) -> bool {
    !is_stopped(solids, DVec3::ZERO, eye, point)
}

/// Something that is reported in a box, or at a point, and moves.
#[derive(Debug, Clone)]
struct Mover {
    bounds: Aabb,
    speed: f32,
    /// Where it goes to, as far as its speed lets it.
    way: Vec3,
}

impl Mover {
    /// Where its middle may be: on either side of what it lies on, and there after a way that no
    /// solid stops.
    fn middle(&self, solids: &[Aabb], random: &mut SmallRng) -> Option<DVec3> {
        let b = &self.bounds;
        let (middle, half) = ((b.min.as_dvec3() + b.max.as_dvec3()) * 0.5, self.half());
        let mut beside = || place_in(DVec3::ZERO, DVec3::ZERO, || random.random_range(0.0..1.0));
        let (from, to) = (middle + beside(), middle + beside());
        let way = self.way.as_dvec3().clamp_length_max(f64::from(self.speed) * AHEAD * 0.999_999);
        let to = if self.speed == 0.0 { from } else { to + way };
        (!is_stopped(solids, half, from, to)).then_some(to)
    }

    /// Half of its edges, so that a box that touches a solid is beside it.
    fn half(&self) -> DVec3 {
        ((self.bounds.max.as_dvec3() - self.bounds.min.as_dvec3()) * 0.5 - CLOSE).max(DVec3::ZERO)
    }
}

fn boxes(sizes: impl Strategy<Value = f32> + Clone) -> impl Strategy<Value = Aabb> {
    let sizes = prop::array::uniform3(sizes).prop_map(Vec3::from_array);
    (points(0.0..SIZE, 1.0), sizes).prop_map(|(min, size)| Aabb::new(min, min + size))
}

fn mover(bounds: impl Strategy<Value = Aabb>) -> impl Strategy<Value = Mover> {
    let speed = prop_oneof![Just(0.0f32), coordinates(0.0..2.0, 1.0)];
    (bounds, speed, points(-2.0..2.0, 1.0)).prop_map(|(bounds, speed, way)| Mover { bounds, speed, way })
}

/// Long boxes, so that most are walls, and a floor.
fn level() -> impl Strategy<Value = Vec<Aabb>> {
    let sizes = prop_oneof![coordinates(0.5..2.5, 0.5), coordinates(4.0..SIZE, 1.0)];
    let floor = Aabb::new(Vec3::new(0.0, -1.0, 0.0), Vec3::new(SIZE, 0.0, SIZE));
    (prop::collection::vec(boxes(sizes), 1..7), any::<bool>()).prop_map(move |(mut solids, has_floor)| {
        solids.extend(has_floor.then_some(floor));
        solids
    })
}

fn server(solids: &[Aabb]) -> VisibilityServer {
    let mut level = Scene::new(1.0).unwrap();
    for &solid in solids {
        level.insert(ObjectDesc::fixed(solid).occluder(solid)).unwrap();
    }
    VisibilityServer::new(level, ServerOptions::new().tick(0.5)).unwrap()
}

/// An entity that is seen though its client was not told of it.
fn late(solids: &[Aabb], eye: &Mover, entities: &[Mover], seed: u64) -> Option<String> {
    let mut server = server(solids);
    let client = ClientDesc::new(eye.bounds.min, eye.speed, 0.5);
    let client = server.add_client(client, 0.0).unwrap();
    let ids: Vec<_> = entities
        .iter()
        .map(|one| server.add_entity(EntityDesc::new(one.bounds, one.speed), 0.0).unwrap())
        .collect();
    server.tick(0.0).unwrap();
    let told = &server.answer(client).unwrap().told;
    let mut random = SmallRng::seed_from_u64(seed);
    let unknown = entities.iter().zip(&ids).filter(|(_, id)| !told.contains(id));
    for (one, id) in unknown {
        for _ in 0..60 {
            let Some(from) = eye.middle(solids, &mut random) else { continue };
            let Some(middle) = one.middle(solids, &mut random) else { continue };
            let half = one.half();
            let point = middle + place_in(-half, half, || random.random_range(0.0..1.0));
            if sees(solids, from, point) {
                return Some(format!("{id:?} is seen from {from} at {point}"));
            }
        }
    }
    None
}

proptest! {
    #![proptest_config(casca_truth::cases(400))]
    #[test]
    fn nothing_is_told_late(
        solids in level(),
        eye in mover(boxes(Just(0.0))),
        entities in prop::collection::vec(mover(boxes(prop_oneof![Just(0.0f32), coordinates(0.0..2.0, 1.0)])), 1..6),
        seed in any::<u64>(),
    ) {
        prop_assert_eq!(late(&solids, &eye, &entities, seed), None);
    }
}

/// A wall across the field, from x = 4 to 4.5.
fn wall() -> Aabb {
    Aabb::new(Vec3::new(4.0, -1.0, -1.0), Vec3::new(4.5, SIZE, SIZE))
}

#[test]
fn an_eye_on_the_face_of_a_wall_is_told_of_what_is_before_it() {
    for (x, before, behind) in [(3.999, 2.0, 7.0), (4.0, 2.0, 7.0), (4.5, 7.0, 2.0)] {
        for speed in [0.0, 1.0] {
            let mut server = server(&[wall()]);
            let client = ClientDesc::new(Vec3::new(x, 3.0, 4.0), speed, 0.0);
            let client = server.add_client(client, 0.0).unwrap();
            let [before, behind] = [before, behind].map(|x| {
                let b = Aabb::from_center(Vec3::new(x, 1.0, 4.0), Vec3::splat(0.4));
                server.add_entity(EntityDesc::new(b, 0.0), 0.0).unwrap()
            });
            server.tick(0.0).unwrap();
            assert_eq!(server.answer(client).unwrap().told, [before], "{x} {speed}: not {behind:?}");
            // A player who is pressed against the wall may have come there, and may leave.
            let away = Vec3::new(if x > 4.2 { 6.0 } else { 2.0 }, 3.0, 4.0);
            assert!(!server.has_wall_between(Vec3::new(x, 3.0, 4.0), away));
            assert!(server.has_wall_between(Vec3::new(x, 3.0, 4.0), Vec3::new(8.5 - x, 3.0, 4.0)));
        }
    }
}

#[test]
fn what_lies_flat_on_a_floor_is_told_before_it_rises() {
    let floor = Aabb::new(Vec3::new(0.0, -1.0, 0.0), Vec3::new(SIZE, 0.0, SIZE));
    let low = Aabb::new(Vec3::new(4.0, 0.0, 0.0), Vec3::new(4.5, 1.0, SIZE));
    // A plate, a line and a point, behind a wall that is 1 m high.
    for size in [Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, Vec3::new(1.0, 0.001, 2.0)] {
        for (speed, is_told) in [(2.0, true), (0.1, false)] {
            let mut server = server(&[floor, low]);
            let client = ClientDesc::new(Vec3::new(2.0, 1.2, 4.0), 0.0, 0.5);
            let client = server.add_client(client, 0.0).unwrap();
            let min = Vec3::new(6.0, 0.0, 3.0);
            let entity = EntityDesc::new(Aabb::new(min, min + size), speed);
            server.add_entity(entity, 0.0).unwrap();
            server.tick(0.0).unwrap();
            assert_eq!(server.answer(client).unwrap().told.len() == 1, is_told, "{size} {speed}");
        }
    }
}
