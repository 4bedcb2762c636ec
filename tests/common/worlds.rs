//! Small worlds of boxes and balls, and the objects that an eye sees in them, by segments that
//! share no code with the library.

use super::*;

pub const SIZE: f32 = 32.0;

/// Whether a box cuts the segment between two points, its surface included.
pub fn cuts_box(b: &Aabb, from: DVec3, to: DVec3) -> bool {
    cuts((b.min.as_dvec3(), b.max.as_dvec3()), from, to)
}

/// The same, of its corners in double precision.
pub fn cuts((min, max): (DVec3, DVec3), from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (lo, hi) = (min[axis] - from[axis], max[axis] - from[axis]);
        if way[axis] == 0.0 {
            if lo > 0.0 || hi < 0.0 {
                return false;
            }
            continue;
        }
        let (x, y) = (lo / way[axis], hi / way[axis]);
        (enter, leave) = (enter.max(x.min(y)), leave.min(x.max(y)));
    }
    enter <= leave
}

/// Segments through an edge that two triangles share pass both: triangles are larger by this share
/// of themselves, far more than the rounding of double precision.
const SHARED: f64 = 1e-9;

/// Whether the segment between two points passes a triangle (Möller & Trumbore 1997).
pub fn cuts_triangle(&[a, b, c]: &[DVec3; 3], from: DVec3, to: DVec3) -> bool {
    let (way, e, f) = (to - from, b - a, c - a);
    let p = way.cross(f);
    let inverse = 1.0 / e.dot(p);
    let u = (from - a).dot(p) * inverse;
    let q = (from - a).cross(e);
    let (v, t) = (way.dot(q) * inverse, f.dot(q) * inverse);
    u >= -SHARED && v >= -SHARED && u + v <= 1.0 + SHARED && (0.0..=1.0).contains(&t)
}

/// A shape as the test knows it: of an occluder, or of an object that is looked for.
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

impl From<Aabb> for Solid {
    fn from(b: Aabb) -> Self {
        Self::Box(b)
    }
}

impl From<Sphere> for Solid {
    fn from(s: Sphere) -> Self {
        Self::Ball(s)
    }
}

impl From<Solid> for Bounds {
    fn from(solid: Solid) -> Self {
        match solid {
            Solid::Box(b) => b.into(),
            Solid::Ball(s) => s.into(),
        }
    }
}

impl From<Solid> for Occluder {
    fn from(solid: Solid) -> Self {
        match solid {
            Solid::Box(b) => b.into(),
            Solid::Ball(s) => s.into(),
        }
    }
}

pub struct World {
    pub scene: Scene,
    pub solids: Vec<Solid>,
    pub targets: Vec<(ObjectId, Solid)>,
}

impl World {
    pub fn new(solids: &[Solid], targets: &[impl Copy + Into<Solid>]) -> Self {
        let mut scene = empty();
        solids.iter().for_each(|&solid| _ = scene.solid(solid));
        let insert = |&target: &_| {
            let solid: Solid = Into::into(target);
            (scene.fixed(solid), solid)
        };
        let targets = targets.iter().map(insert).collect();
        Self { scene, solids: solids.to_vec(), targets }
    }

    /// The targets of which an eye sees a point inside the half-spaces: of balls, the middle and
    /// points of the surface are looked for, of boxes a lattice.
    pub fn seen(&self, eye: DVec3, planes: &[(DVec3, f64)]) -> Vec<ObjectId> {
        let hiding = hiding(&self.solids, eye);
        let sees = |p: DVec3| {
            // Rays start at the near plane. The sides of a camera pass through its eye, but for the
            // room by which they were moved.
            let start = planes.iter().fold(0.0f64, |t, &(n, offset)| {
                let (a, b) = (n.dot(eye) + offset + INWARDS, n.dot(p) + offset + INWARDS);
                if a < -INWARDS { t.max(a / (a - b)) } else { t }
            });
            planes.iter().all(|&(n, offset)| n.dot(p) + offset >= 0.0)
                && is_free(&hiding, eye + (p - eye) * start, p)
        };
        let points = |target: &Solid| match target {
            Solid::Box(b) => points_of(b, 5).collect(),
            Solid::Ball(s) => {
                let (c, r) = (s.center.as_dvec3(), f64::from(s.radius));
                let way = (eye - c).normalize_or(DVec3::X);
                let side = way.any_orthonormal_vector();
                let ways = [DVec3::ZERO, way, side, -side, way.cross(side), side.cross(way)];
                ways.map(|d| c + d * r * 0.999).to_vec()
            }
        };
        let found = self.targets.iter().filter(|(_, target)| points(target).into_iter().any(sees));
        found.map(|(id, _)| *id).collect()
    }
}

/// The half-spaces of a matrix are smaller by this, for its rounding.
const INWARDS: f64 = 1e-4;

/// Points of a box: so many along each edge, its corners among them.
pub fn points_of(b: &Aabb, n: u32) -> impl Iterator<Item = DVec3> + use<> {
    let (min, size) = (b.min.as_dvec3(), b.max.as_dvec3() - b.min.as_dvec3());
    let share = move |i: u32| f64::from(i) / f64::from(n - 1);
    (0..n * n * n).map(move |i| min + size * DVec3::new(share(i % n), share(i / n % n), share(i / (n * n))))
}

/// The solids that hide something from an eye: one sees out of those around it.
pub fn hiding(solids: &[Solid], eye: DVec3) -> Vec<Solid> {
    solids.iter().filter(|s| !s.contains(eye)).copied().collect()
}

/// Whether none of these is before a point.
pub fn is_free(hiding: &[Solid], eye: DVec3, p: DVec3) -> bool {
    !hiding.iter().any(|s| s.cuts(eye, p))
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
