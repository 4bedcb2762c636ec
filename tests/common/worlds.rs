//! Small worlds of boxes and balls, and segments that share no code with the library.

use super::*;

pub const SIZE: f32 = 32.0;

/// Whether a box cuts the segment between two points, its surface included.
pub fn cuts_box(b: &Aabb, from: DVec3, to: DVec3) -> bool {
    let (min, max, way) = (b.min.as_dvec3(), b.max.as_dvec3(), to - from);
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

/// Walls, and balls that an eye may see.
pub struct World {
    pub scene: Scene,
    pub targets: Vec<ObjectId>,
}

impl World {
    pub fn new(walls: &[Aabb], targets: &[Sphere]) -> Self {
        let mut scene = empty();
        walls.iter().for_each(|&wall| _ = scene.solid(wall));
        let targets = targets.iter().map(|&target| scene.fixed(target)).collect();
        Self { scene, targets }
    }
}

/// Points of a box: so many along each edge, its corners among them.
pub fn points_of(b: &Aabb, n: u32) -> impl Iterator<Item = DVec3> + use<> {
    let (min, size) = (b.min.as_dvec3(), b.max.as_dvec3() - b.min.as_dvec3());
    let share = move |i: u32| f64::from(i) / f64::from(n - 1);
    (0..n * n * n).map(move |i| min + size * DVec3::new(share(i % n), share(i / n % n), share(i / (n * n))))
}

/// The boxes that hide something from an eye: one sees out of those around it.
pub fn hiding(boxes: &[Aabb], eye: DVec3) -> Vec<Aabb> {
    let holds = |b: &Aabb| b.min.as_dvec3().cmple(eye).all() && b.max.as_dvec3().cmpge(eye).all();
    boxes.iter().filter(|b| !holds(b)).copied().collect()
}

/// Whether none of these is before a point.
pub fn is_free(hiding: &[Aabb], eye: DVec3, p: DVec3) -> bool {
    !hiding.iter().any(|b| cuts_box(b, eye, p))
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
