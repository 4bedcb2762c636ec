//! Rays against triangles, by the signs of triple products: in doubt, a triangle blocks.

use casca_scenes::world::Camera;

use crate::common::*;

pub type Triangle = [DVec3; 3];

/// What hides: triangles, turned so that their corners run counter-clockwise seen from the front.
#[derive(Debug, Clone)]
pub struct Blocker {
    pub triangles: Vec<Triangle>,
    /// Whether they hide from their front only.
    pub front: bool,
}

/// Where rays start and which points are looked at.
#[derive(Debug, Clone)]
pub enum Eye {
    Around(Vec3),
    Camera(Camera),
    /// With the direction that it looks along.
    Parallel(Camera, Vec3),
}

/// A clip coordinate, and how far rounding may move it.
fn clip(m: &DMat4, row: usize, p: DVec3) -> (f64, f64) {
    let r = m.row(row);
    let parts = r * p.extend(1.0);
    (parts.element_sum(), 1e-6 * parts.abs().element_sum())
}

impl Eye {
    fn matrix(&self) -> Option<DMat4> {
        match self {
            Self::Around(_) => None,
            Self::Camera(c) | Self::Parallel(c, _) => Some(c.view_projection().as_dmat4()),
        }
    }

    /// Whether a point surely lies in the frustum.
    fn holds(&self, p: DVec3) -> bool {
        let Some(m) = self.matrix() else { return true };
        let (w, doubt) = clip(&m, 3, p);
        w > doubt
            && (0..2).all(|row| {
                let (v, doubt) = clip(&m, row, p);
                v.abs() < w - doubt - 1e-6 * w
            })
            && {
                let (z, doubt) = clip(&m, 2, p);
                z > doubt && z < w - doubt
            }
    }

    /// Whether a point may lie beyond the near plane.
    fn may_be_beyond_near(&self, p: DVec3) -> bool {
        let Some(m) = self.matrix() else { return true };
        let (z, doubt) = clip(&m, 2, p);
        z >= -doubt
    }

    /// Where the ray to a point starts.
    fn start(&self, p: DVec3) -> DVec3 {
        match self {
            Self::Around(eye) => eye.as_dvec3(),
            Self::Camera(c) => c.eye.as_dvec3(),
            Self::Parallel(c, forward) => {
                let m = c.view_projection().as_dmat4();
                let row = |i: usize| -> DVec4 { m.row(i) };
                let d = row(0).truncate().cross(row(1).truncate()).normalize();
                let d = d * d.dot(forward.as_dvec3()).signum();
                p - d * (row(2).dot(p.extend(1.0)) / row(2).truncate().dot(d))
            }
        }
    }

    /// Whether a ray surely reaches a point before any blocker.
    pub fn sees(&self, p: DVec3, blockers: &[&Blocker]) -> bool {
        if !p.is_finite() || !self.holds(p) {
            return false;
        }
        let start = self.start(p);
        !blockers.iter().any(|b| b.triangles.iter().any(|t| self.may_block(t, b.front, start, p)))
    }

    fn may_block(&self, t: &Triangle, front: bool, start: DVec3, target: DVec3) -> bool {
        let ray = target - start;
        let length = ray.length();
        let [a, b, c] = t.map(|v| v - start);
        let largest = t.iter().fold(start.abs().max_element(), |m, v| m.max(v.abs().max_element()));
        // What subtractions leave open, and what ties may differ by.
        let near = 1e-15 * largest;
        let edge = |p: DVec3, q: DVec3| {
            let doubt =
                1e-12 * length * p.length() * q.length() + 4.0 * near * length * (p.length() + q.length());
            (ray.dot(p.cross(q)), doubt)
        };
        let edges = [edge(a, b), edge(b, c), edge(c, a)];
        let positive = edges.iter().all(|e| e.0 >= -e.1);
        let negative = edges.iter().all(|e| e.0 <= e.1);
        if !positive && !negative {
            return false;
        }
        if positive && negative {
            // Seen edge-on: it may block wherever the ray passes its box.
            let room = 1e-6 * length + 4.0 * near;
            let (lo, hi) = (a.min(b).min(c) - room, a.max(b).max(c) + room);
            let (mut from, mut to) = (0.0f64, 1.0f64);
            for axis in 0..3 {
                if ray[axis] == 0.0 {
                    if lo[axis] > 0.0 || hi[axis] < 0.0 {
                        return false;
                    }
                    continue;
                }
                let (p, q) = (lo[axis] / ray[axis], hi[axis] / ray[axis]);
                (from, to) = (from.max(p.min(q)), to.min(p.max(q)));
            }
            return from <= to;
        }
        // Rays against the normal meet the front.
        let normal = (b - a).cross(c - a);
        let towards = normal.dot(ray);
        if front && towards > 1e-9 * normal.length() * length {
            return false;
        }
        // The plane is met where the ray has come this share of the way.
        let at = normal.dot(a) / towards;
        let doubt = 1e-6 + near / length;
        at <= 1.0 + doubt && at >= -doubt && self.may_be_beyond_near(start + ray * at)
    }
}

/// How far from edges of a triangle its points near edges and corners are, as shares of it: where
/// neighbours leave gaps.
const FROM_CORNER: f64 = 1e-4;
const FROM_EDGE: f64 = 1e-5;

/// A point of a triangle: near a corner, near an edge or anywhere.
pub fn point_of(t: &Triangle, random: &mut Random) -> DVec3 {
    let (mut u, mut v) = match random.below(3) {
        0 => (FROM_CORNER, FROM_CORNER),
        1 => (random.next(), FROM_EDGE),
        _ => (random.next(), random.next()),
    };
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    let first = random.below(3);
    let [a, b, c] = [t[first], t[(first + 1) % 3], t[(first + 2) % 3]];
    a + (b - a) * u + (c - a) * v
}
