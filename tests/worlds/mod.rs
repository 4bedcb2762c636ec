//! Small worlds of boxes and balls, and the objects that an eye sees in them, by segments that
//! share no code with the library.

// Each test uses a part of it.
#![allow(dead_code)]

#[path = "../segments/mod.rs"]
mod segments;

use casca::{Aabb, GridSpec, ObjectDesc, ObjectId, Plane, Scene, Sphere};
use casca_truth::places::points;
use glam::{DVec3, DVec4, Mat4, UVec3, Vec3};
use proptest::prelude::*;

use self::segments::cuts_box;

pub const SIZE: f32 = 32.0;

/// An occluder as the test knows it.
#[derive(Debug, Clone, Copy)]
pub enum Solid {
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

pub struct World {
    pub scene: Scene,
    pub solids: Vec<Solid>,
    pub targets: Vec<(ObjectId, Sphere)>,
}

impl World {
    pub fn new(solids: &[Solid], targets: &[Sphere]) -> Self {
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

    /// The targets of which an eye sees the middle or a point of the surface inside the
    /// half-spaces.
    pub fn seen(&self, eye: DVec3, planes: &[(DVec3, f64)]) -> Vec<ObjectId> {
        seen(&self.solids, &self.targets, eye, planes)
    }
}

/// The half-spaces of a matrix are smaller by this, for its rounding.
const INWARDS: f64 = 1e-4;

/// As [`World::seen`], of some targets before some solids.
pub fn seen(
    solids: &[Solid],
    targets: &[(ObjectId, Sphere)],
    eye: DVec3,
    planes: &[(DVec3, f64)],
) -> Vec<ObjectId> {
    let hiding: Vec<&Solid> = solids.iter().filter(|s| !s.contains(eye)).collect();
    let sees = |p: DVec3| {
        planes.iter().all(|&(n, offset)| n.dot(p) + offset >= 0.0)
            && !hiding.iter().any(|s| {
                // Rays start at the near plane.
                let start = planes.iter().fold(0.0f64, |t, &(n, offset)| {
                    // The sides of a camera pass through its eye, but for the room by which they
                    // were moved.
                    let (a, b) = (n.dot(eye) + offset + INWARDS, n.dot(p) + offset + INWARDS);
                    if a < -INWARDS { t.max(a / (a - b)) } else { t }
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
    let found = targets.iter().filter(|(_, s)| points(s).into_iter().any(sees));
    found.map(|(id, _)| *id).collect()
}

pub fn point() -> impl Strategy<Value = Vec3> {
    points(0.0..SIZE, 2.0)
}

pub fn solid() -> impl Strategy<Value = Solid> {
    prop_oneof![
        (point(), points(0.0..12.0, 2.0))
            .prop_map(|(p, size)| Solid::Box(Aabb::new(p - size * 0.5, p + size * 0.5))),
        (point(), 0.5f32..6.0).prop_map(|(p, radius)| Solid::Ball(Sphere::new(p, radius))),
        // Boxes on whole numbers stand on each other, abut and lie inside each other.
        (prop::array::uniform3(0u8..32), prop::array::uniform3(1u8..16)).prop_map(|(p, size)| {
            let min = Vec3::from_array(p.map(f32::from));
            Solid::Box(Aabb::new(min, min + Vec3::from_array(size.map(f32::from))))
        }),
    ]
}

pub fn target() -> impl Strategy<Value = Sphere> {
    (point(), 0.05f32..0.8).prop_map(|(p, radius)| Sphere::new(p, radius))
}

/// Directions in and on the ball of length 1.
pub fn steps() -> impl Strategy<Value = Vec<Vec3>> {
    let any = points(-1.0..1.0, 0.5);
    let step = prop_oneof![
        any.clone().prop_map(|v| v.clamp_length_max(1.0)),
        any.prop_map(|v| v.normalize_or(Vec3::Y)),
    ];
    prop::collection::vec(step, 12)
}

/// The half-spaces of a camera that looks along an axis, with a near plane.
pub fn camera(eye: Vec3, axis: usize, near: f32) -> Vec<Plane> {
    let forward = Vec3::AXES[axis];
    let mut planes = vec![Plane { normal: forward, offset: -forward.dot(eye) - near }];
    for side in [Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]] {
        for normal in [forward * 0.6 + side * 0.8, forward * 0.6 - side * 0.8] {
            planes.push(Plane { normal, offset: -normal.dot(eye) });
        }
    }
    planes
}

/// The half-spaces of a matrix, moved inwards by more than its rounding.
pub fn planes_of(matrix: Mat4) -> Vec<(DVec3, f64)> {
    let m = matrix.as_dmat4();
    let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
    let inwards = |plane: DVec4| {
        let length = plane.truncate().length();
        (plane.truncate() / length, plane.w / length - INWARDS)
    };
    [w + x, w - x, w + y, w - y, z, w - z].map(inwards).to_vec()
}
