//! Faces: the planes on which silhouettes are drawn. Six sides of a cube around
//! an eye, or one plane across parallel rays.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::plane::HalfSpace;
use crate::grid::side::Side;
use crate::numeric::occlusion::{DIRECTION, PLANE_EDGE_ON, SMALLEST_DIVISOR, VERTEX_DEPTH};

/// A plane of directions. Points are given relative to the origin (the eye, or
/// the middle of the plane of parallel rays); a point's coordinates are `(u, v)`, both in
/// [-1, 1] on the face, and its *nearness*, which falls with depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Face {
    pub(crate) right: DVec3,
    pub(crate) up: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) parallel: bool,
}

/// A rectangle on a face.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Rect {
    pub(crate) u0: f64,
    pub(crate) v0: f64,
    pub(crate) u1: f64,
    pub(crate) v1: f64,
}

impl Rect {
    pub(crate) const FACE: Self = Self { u0: -1.0, v0: -1.0, u1: 1.0, v1: 1.0 };

    pub(crate) fn corners(&self) -> [(f64, f64); 4] {
        [(self.u0, self.v0), (self.u1, self.v0), (self.u0, self.v1), (self.u1, self.v1)]
    }

    /// The rectangle widened by more than the rounding of coordinates on a face.
    pub(crate) fn grown(&self) -> Self {
        Self {
            u0: self.u0 - DIRECTION,
            v0: self.v0 - DIRECTION,
            u1: self.u1 + DIRECTION,
            v1: self.v1 + DIRECTION,
        }
    }

    /// Whether a point lies in it.
    #[inline]
    pub(crate) fn contains(&self, u: f64, v: f64) -> bool {
        self.u0 <= u && u <= self.u1 && self.v0 <= v && v <= self.v1
    }

    /// Whether two rectangles have a point in common.
    #[inline]
    pub(crate) fn overlaps(&self, o: &Self) -> bool {
        self.u0 <= o.u1 && o.u0 <= self.u1 && self.v0 <= o.v1 && o.v0 <= self.v1
    }

    /// The common part; `None` if there is none, or if a bound is not a number.
    pub(crate) fn intersect(&self, o: &Self) -> Option<Self> {
        let r = Self {
            u0: self.u0.max(o.u0),
            v0: self.v0.max(o.v0),
            u1: self.u1.min(o.u1),
            v1: self.v1.min(o.v1),
        };
        (r.u0 <= r.u1 && r.v0 <= r.v1).then_some(r)
    }
}

/// A linear function of (u, v): `a u + b v + c`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Linear {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
}

impl Linear {
    #[inline]
    pub(crate) fn at(&self, u: f64, v: f64) -> f64 {
        self.a * u + self.b * v + self.c
    }

    /// Least value on a rectangle.
    #[inline]
    pub(crate) fn least(&self, r: &Rect) -> f64 {
        let u = if self.a >= 0.0 { r.u0 } else { r.u1 };
        let v = if self.b >= 0.0 { r.v0 } else { r.v1 };
        self.at(u, v)
    }

    /// Greatest value on a rectangle.
    #[inline]
    pub(crate) fn most(&self, r: &Rect) -> f64 {
        let u = if self.a >= 0.0 { r.u1 } else { r.u0 };
        let v = if self.b >= 0.0 { r.v1 } else { r.v0 };
        self.at(u, v)
    }
}

impl Face {
    /// One side of the cube around an eye.
    pub(crate) fn side(side: &Side) -> Self {
        Self {
            right: DVec3::AXES[side.axes.col],
            up: DVec3::AXES[side.axes.row],
            forward: DVec3::AXES[side.axes.normal] * f64::from(side.sign),
            parallel: false,
        }
    }

    /// The plane across `direction`, on which the ball of `radius` around the origin
    /// fills the face.
    pub(crate) fn across(direction: DVec3, right: DVec3, radius: f64) -> Self {
        let up = direction.cross(right);
        Self { right: right / radius, up: up / radius, forward: direction, parallel: true }
    }

    /// A half-space `n . x + h >= 0` whose plane passes through the eye, or runs along
    /// the parallel rays, as a function that is not negative on the directions inside.
    pub(crate) fn half(&self, n: DVec3, h: f64) -> Linear {
        if self.parallel {
            // In units of the face, so that one margin serves all sizes.
            let scale = self.right.length();
            Linear { a: n.dot(self.right) / scale, b: n.dot(self.up) / scale, c: h * scale }
        } else {
            Linear { a: n.dot(self.right), b: n.dot(self.up), c: n.dot(self.forward) }
        }
    }

    /// Nearness of the plane of a half-space as a function of the direction. From outside
    /// (an eye that is not in it, or rays that run into it) it is where rays pass the plane.
    pub(crate) fn nearness(&self, plane: &HalfSpace) -> Option<Linear> {
        let (m, h) = (-plane.normal, plane.offset);
        if self.parallel {
            let slope = m.dot(self.forward);
            if slope.abs() < PLANE_EDGE_ON {
                return None;
            }
            // x = u right / |right|^2 + v up / |up|^2 + depth forward; nearness is -depth.
            let scale = slope * self.right.length_squared();
            Some(Linear { a: m.dot(self.right) / scale, b: m.dot(self.up) / scale, c: -h / slope })
        } else {
            if h.abs() < SMALLEST_DIVISOR {
                return None;
            }
            let inverse = 1.0 / h;
            Some(Linear {
                a: m.dot(self.right) * inverse,
                b: m.dot(self.up) * inverse,
                c: m.dot(self.forward) * inverse,
            })
        }
    }

    /// Nearness of a depth along the face's axis: 1/depth from an eye, -depth along parallel rays.
    #[inline]
    pub(crate) fn nearness_of(&self, depth: f64) -> f64 {
        if self.parallel {
            -depth
        } else if depth > 0.0 {
            1.0 / depth
        } else {
            f64::INFINITY
        }
    }

    /// Coordinates of a point: across, up and in depth, not yet divided.
    #[inline]
    pub(crate) fn local(&self, p: DVec3) -> DVec3 {
        DVec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.forward))
    }

    /// Whether a box reaches beyond the face along parallel rays, by more than rounding: not so if
    /// it lies in the scene.
    pub(crate) fn leaves(&self, b: &Block) -> bool {
        let most = 1.0 + DIRECTION;
        let inside = |r: &Rect| r.u0 >= -most && r.v0 >= -most && r.u1 <= most && r.v1 <= most;
        !self.block(b).is_some_and(|(rect, _)| inside(&rect))
    }

    /// A rectangle around the part of a box that the face sees, and the least and greatest depth of
    /// that part; `None` if the face sees no part. The caller adds the margins.
    pub(crate) fn block(&self, b: &Block) -> Option<(Rect, (f64, f64))> {
        if self.parallel {
            let c = self.local((b.min + b.max) * 0.5);
            let half = (b.max - b.min) * 0.5;
            let radius =
                DVec3::new(half.dot(self.right.abs()), half.dot(self.up.abs()), half.dot(self.forward.abs()));
            let (lo, hi) = (c - radius, c + radius);
            return Some((Rect { u0: lo.x, v0: lo.y, u1: hi.x, v1: hi.y }, (lo.z, hi.z)));
        }
        let ordered = |a: f64, b: f64| if a < b { (a, b) } else { (b, a) };
        let (nearest, far) = ordered(b.min.dot(self.forward), b.max.dot(self.forward));
        if far < 0.0 {
            return None;
        }
        let (left, right) = ordered(b.min.dot(self.right), b.max.dot(self.right));
        let (low, high) = ordered(b.min.dot(self.up), b.max.dot(self.up));
        // Inside the face's pyramid depth is at least |u| and |v| times depth.
        let near =
            [left, -right, low, -high, 0.0].into_iter().fold(nearest, |a, b| if b > a { b } else { a });
        // A depth that is not a number passes, and makes the target visible in the end.
        if near > far {
            return None;
        }
        let (by_near, by_far) = (1.0 / near, 1.0 / far);
        let least = |c: f64| if c >= 0.0 { c * by_far } else { c * by_near };
        let most = |c: f64| if c >= 0.0 { c * by_near } else { c * by_far };
        let rect = Rect { u0: least(left), v0: least(low), u1: most(right), v1: most(high) };
        Some((rect, (near, far)))
    }

    /// A rectangle around points, and their least depth; `None` if one is not in front of the eye.
    pub(crate) fn points(&self, points: &[DVec3]) -> Option<(Rect, f64)> {
        let mut r =
            Rect { u0: f64::INFINITY, v0: f64::INFINITY, u1: f64::NEG_INFINITY, v1: f64::NEG_INFINITY };
        let mut near = f64::INFINITY;
        for &p in points {
            let q = self.local(p);
            let (u, v) = if self.parallel {
                (q.x, q.y)
            } else {
                if q.z <= VERTEX_DEPTH * (q.x.abs() + q.y.abs()) {
                    return None;
                }
                (q.x / q.z, q.y / q.z)
            };
            r = Rect { u0: r.u0.min(u), v0: r.v0.min(v), u1: r.u1.max(u), v1: r.v1.max(v) };
            near = near.min(q.z);
        }
        Some((r, near))
    }

    /// The corners of the part of a rectangle inside all half-planes.
    pub(crate) fn clip(rect: &Rect, halves: &[Linear]) -> SmallVec<[(f64, f64); 12]> {
        let mut polygon: SmallVec<[(f64, f64); 12]> = SmallVec::new();
        polygon.extend([(rect.u0, rect.v0), (rect.u1, rect.v0), (rect.u1, rect.v1), (rect.u0, rect.v1)]);
        for half in halves {
            let mut next: SmallVec<[(f64, f64); 12]> = SmallVec::new();
            for (i, &p) in polygon.iter().enumerate() {
                let q = polygon[(i + 1) % polygon.len()];
                let (a, b) = (half.at(p.0, p.1), half.at(q.0, q.1));
                if a >= 0.0 {
                    next.push(p);
                }
                if (a < 0.0) != (b < 0.0) {
                    let t = a / (a - b);
                    next.push((p.0 + (q.0 - p.0) * t, p.1 + (q.1 - p.1) * t));
                }
            }
            polygon = next;
        }
        polygon
    }
}
