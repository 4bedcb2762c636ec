//! Views whose eye may go some way: their sets have all that any of these eyes sees, by segments cut by the shapes
//! themselves.

mod segments;

use casca::{Aabb, GridSpec, Method, ObjectDesc, ObjectId, Plane, PointOptions, Query, Scene, Sphere, View};
use casca_lab::cases;
use glam::{DVec3, UVec3, Vec3};
use proptest::prelude::*;

use crate::segments::cuts_box;

const SIZE: f32 = 32.0;

/// An occluder as the test knows it.
#[derive(Debug, Clone, Copy)]
enum Solid {
    Box(Aabb),
    Ball(Sphere),
}

impl Solid {
    fn contains(&self, p: DVec3) -> bool {
        match self {
            Self::Box(b) => b.min.as_dvec3().cmple(p).all() && b.max.as_dvec3().cmpge(p).all(),
            Self::Ball(s) => (p - s.center.as_dvec3()).length() <= f64::from(s.radius),
        }
    }

    /// Whether the segment between two points meets it.
    fn cuts(&self, from: DVec3, to: DVec3) -> bool {
        match self {
            Self::Box(b) => cuts_box(b, from, to),
            Self::Ball(s) => {
                let way = to - from;
                let c = s.center.as_dvec3() - from;
                let t = (c.dot(way) / way.length_squared()).clamp(0.0, 1.0);
                (c - way * t).length() <= f64::from(s.radius)
            }
        }
    }
}

struct World {
    scene: Scene,
    solids: Vec<Solid>,
    targets: Vec<(ObjectId, Sphere)>,
}

impl World {
    fn new(solids: &[Solid], targets: &[Sphere]) -> Self {
        let grid = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(SIZE as u32) };
        let mut scene = Scene::new(&grid).unwrap();
        for solid in solids {
            let desc = match *solid {
                Solid::Box(b) => ObjectDesc::fixed(b).occluder(b),
                Solid::Ball(s) => ObjectDesc::fixed(s).occluder(s),
            };
            scene.insert(desc).unwrap();
        }
        let insert = |&s: &Sphere| (scene.insert(ObjectDesc::fixed(s)).unwrap(), s);
        let targets = targets.iter().map(insert).collect();
        Self { scene, solids: solids.to_vec(), targets }
    }

    /// The targets of which an eye sees the middle or a point of the surface inside the half-spaces.
    fn seen(&self, eye: DVec3, planes: &[(DVec3, f64)]) -> Vec<ObjectId> {
        let hiding: Vec<&Solid> = self.solids.iter().filter(|s| !s.contains(eye)).collect();
        let sees = |p: DVec3| {
            planes.iter().all(|&(n, offset)| n.dot(p) + offset >= 0.0)
                && !hiding.iter().any(|s| {
                    // Rays start at the near plane.
                    let start = planes.iter().fold(0.0f64, |t, &(n, offset)| {
                        let (a, b) = (n.dot(eye) + offset, n.dot(p) + offset);
                        if a < 0.0 { t.max(a / (a - b)) } else { t }
                    });
                    s.cuts(eye + (p - eye) * start, p)
                })
        };
        let points = |s: &Sphere| {
            let (c, r) = (s.center.as_dvec3(), f64::from(s.radius));
            let way = (eye - c).normalize_or(DVec3::X);
            let side = way.any_orthonormal_vector();
            [DVec3::ZERO, way, side, -side, way.cross(side), side.cross(way)].map(|d| c + d * r * 0.999)
        };
        let found = self.targets.iter().filter(|(_, s)| points(s).into_iter().any(sees));
        found.map(|(id, _)| *id).collect()
    }
}

fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(0.0f32..SIZE).prop_map(Vec3::from)
}

fn solid() -> impl Strategy<Value = Solid> {
    prop_oneof![
        (point(), prop::array::uniform3(0.5f32..12.0)).prop_map(|(p, size)| {
            let half = Vec3::from(size) * 0.5;
            Solid::Box(Aabb::new(p - half, p + half))
        }),
        (point(), 0.5f32..6.0).prop_map(|(p, radius)| Solid::Ball(Sphere::new(p, radius))),
        // Boxes on whole numbers stand on each other, abut and lie inside each other.
        (prop::array::uniform3(0u8..32), prop::array::uniform3(1u8..16)).prop_map(|(p, size)| {
            let min = Vec3::from_array(p.map(f32::from));
            Solid::Box(Aabb::new(min, min + Vec3::from_array(size.map(f32::from))))
        }),
    ]
}

fn target() -> impl Strategy<Value = Sphere> {
    (point(), 0.05f32..0.8).prop_map(|(p, radius)| Sphere::new(p, radius))
}

/// Directions in and on the ball of length 1.
fn steps() -> impl Strategy<Value = Vec<Vec3>> {
    let any = prop::array::uniform3(-1.0f32..1.0).prop_map(Vec3::from);
    let step = prop_oneof![
        any.clone().prop_map(|v| v.clamp_length_max(1.0)),
        any.prop_map(|v| v.normalize_or(Vec3::Y)),
    ];
    prop::collection::vec(step, 12)
}

/// The half-spaces of a camera that looks along an axis, with a near plane.
fn camera(eye: Vec3, axis: usize, near: f32) -> Vec<Plane> {
    let forward = Vec3::AXES[axis];
    let mut planes = vec![Plane { normal: forward, offset: -forward.dot(eye) - near }];
    for side in [Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]] {
        for normal in [forward * 0.6 + side * 0.8, forward * 0.6 - side * 0.8] {
            planes.push(Plane { normal, offset: -normal.dot(eye) });
        }
    }
    planes
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn all_eyes_within_reach_are_served(
        solids in prop::collection::vec(solid(), 1..14),
        targets in prop::collection::vec(target(), 60),
        (eye, axis) in (point(), prop::option::of(0usize..3)),
        near in 0.05f32..1.0,
        reach in prop_oneof![Just(0.01f32), 0.0f32..0.3, 0.0f32..3.0],
        steps in steps(),
    ) {
        let world = World::new(&solids, &targets);
        let planes = axis.map_or_else(Vec::new, |axis| camera(eye, axis, near));
        let view = View::from_planes(eye, &planes).unwrap();
        for method in [Method::point(), Method::Point(PointOptions::fast()), Method::cell(), Method::Frustum] {
            let mut query = Query::with_method(method).unwrap();
            let wide = view.clone().with_reach(reach).unwrap();
            let pvs = query.run(&world.scene, &wide);
            prop_assert!(pvs.is_valid_for(&world.scene, &wide));
            for step in &steps {
                let step = *step * reach * 0.999;
                let at = eye + step;
                let moved: Vec<(DVec3, f64)> = planes.iter().map(|p| {
                    let normal = p.normal.as_dvec3();
                    (normal, f64::from(p.offset) - normal.dot((at - eye).as_dvec3()))
                }).collect();
                for id in world.seen(at.as_dvec3(), &moved) {
                    prop_assert!(pvs.contains(id), "{method:?}: {id} from {at}, {reach} around {eye}");
                }
            }
        }
    }
}

#[test]
fn sets_grow_with_the_reach() {
    let mut state = 5u64;
    let mut next = move |lo: f32, hi: f32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        lo + (hi - lo) * (state >> 40) as f32 / (1u64 << 24) as f32
    };
    const REACHES: [f32; 6] = [0.0, 0.01, 0.1, 0.3, 1.0, 3.0];
    let mut sizes = [0; REACHES.len()];
    let mut query = Query::new();
    for _ in 0..40 {
        let mut point = || Vec3::new(next(0.0, SIZE), next(0.0, SIZE), next(0.0, SIZE));
        let (eye, points): (Vec3, Vec<Vec3>) = (point(), (0..140).map(|_| point()).collect());
        let solids: Vec<Solid> = points[..40]
            .iter()
            .map(|&p| Solid::Box(Aabb::new(p - next(1.0, 4.0), p + next(1.0, 4.0))))
            .collect();
        let targets: Vec<Sphere> = points[40..].iter().map(|&p| Sphere::new(p, 0.2)).collect();
        let world = World::new(&solids, &targets);
        let view = View::omnidirectional(eye).unwrap();
        let plain = query.run(&world.scene, &view).visible().to_vec();
        for (reach, size) in REACHES.iter().zip(&mut sizes) {
            let pvs = query.run(&world.scene, &view.clone().with_reach(*reach).unwrap());
            assert!(*reach > 0.0 || pvs.visible() == plain, "without a reach nothing changes");
            *size += pvs.len();
        }
    }
    assert!(sizes.is_sorted() && sizes[5] > sizes[0] * 3 / 2, "{sizes:?}");
}

/// A wall across the grid, one object behind it and one at its side.
fn wall() -> (World, Vec3) {
    let wall = Solid::Box(Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 17.0)));
    let targets =
        [Sphere::new(Vec3::new(16.0, 16.0, 24.0), 1.0), Sphere::new(Vec3::new(31.5, 16.0, 17.5), 0.2)];
    (World::new(&[wall], &targets), Vec3::new(16.0, 16.0, 8.0))
}

#[test]
fn a_result_holds_for_all_eyes_within_reach() {
    let (world, eye) = wall();
    let view = View::omnidirectional(eye).unwrap();
    let mut query = Query::new();
    let pvs = query.run(&world.scene, &view.clone().with_reach(0.5).unwrap()).clone();
    assert!(!pvs.contains(world.targets[0].0), "a wall still hides if it is half a unit smaller");
    for (step, holds) in [(0.0, true), (0.3, true), (0.499, true), (0.51, false)] {
        let at = View::omnidirectional(eye + Vec3::X * step).unwrap();
        assert_eq!(pvs.is_valid_for(&world.scene, &at), holds, "{step}");
        let close = at.with_reach(0.25).unwrap();
        assert_eq!(pvs.is_valid_for(&world.scene, &close), step == 0.0, "{step}");
    }
    assert!(
        !query
            .run(&world.scene, &view)
            .is_valid_for(&world.scene, &View::omnidirectional(eye + 0.01).unwrap())
    );
    // Turned views see what this one does not.
    let planes = camera(eye, 2, 0.1);
    let ahead = View::from_planes(eye, &planes).unwrap().with_reach(0.5).unwrap();
    let pvs = query.run(&world.scene, &ahead);
    let moved = |by: f32| {
        let planes: Vec<Plane> =
            planes.iter().map(|p| Plane { offset: p.offset - p.normal.dot(Vec3::X * by), ..*p }).collect();
        View::from_planes(eye + Vec3::X * by, &planes).unwrap()
    };
    assert!(pvs.is_valid_for(&world.scene, &moved(0.4)) && !pvs.is_valid_for(&world.scene, &moved(0.6)));
    let turned = View::from_planes(eye, &camera(eye, 1, 0.1)).unwrap();
    assert!(!pvs.is_valid_for(&world.scene, &turned));
}

#[test]
fn solids_narrower_than_the_reach_hide_nothing() {
    let pole = Solid::Box(Aabb::new(Vec3::new(15.0, 2.0, 15.0), Vec3::new(17.0, 30.0, 17.0)));
    let world = World::new(&[pole], &[Sphere::new(Vec3::new(16.0, 16.0, 18.0), 0.1)]);
    let view = View::omnidirectional(Vec3::new(16.0, 16.0, 6.0)).unwrap();
    let mut query = Query::new();
    for (reach, seen) in [(0.0, false), (0.5, false), (1.01, true)] {
        let pvs = query.run(&world.scene, &view.clone().with_reach(reach).unwrap());
        assert_eq!(pvs.contains(world.targets[0].0), seen, "{reach}");
    }
}

#[test]
fn walls_thinner_than_the_reach_hide_what_is_behind_them() {
    let wall = Solid::Box(Aabb::new(Vec3::new(2.0, 2.0, 16.0), Vec3::new(30.0, 30.0, 16.1)));
    let targets = [16.0, 28.0].map(|x| Sphere::new(Vec3::new(x, 16.0, 24.0), 0.1));
    let world = World::new(&[wall], &targets);
    let view = View::omnidirectional(Vec3::new(16.0, 16.0, 6.0)).unwrap();
    let mut query = Query::new();
    let pvs = query.run(&world.scene, &view.with_reach(0.5).unwrap());
    assert!(!pvs.contains(world.targets[0].0) && !pvs.contains(world.targets[1].0));
}

#[test]
fn a_reach_is_a_length() {
    let view = View::omnidirectional(Vec3::ONE).unwrap();
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        assert!(view.clone().with_reach(bad).is_err(), "{bad}");
    }
    let there_and_back = view.clone().with_reach(2.0).unwrap().with_reach(0.0).unwrap();
    assert_eq!(there_and_back, view);
    assert_eq!(view.with_reach(0.25).unwrap().reach(), 0.25);
}
