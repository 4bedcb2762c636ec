//! The directions that the sides of a view bound: a pyramid, by its edges.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;
use crate::numeric::shape::DISTANCE;
use crate::numeric::view::{IN_SIDE, NO_CORNER, NOT_FLAT};
use crate::view::{Origin, View};

/// A cone of directions around an eye, with edges: the hull of these.
#[derive(Debug, Clone)]
pub(super) struct Cone {
    /// The directions of its edges, of length 1.
    pub(super) edges: SmallVec<[DVec3; 8]>,
    /// The mean of these, of length 1. It points into each of the sides.
    pub(super) middle: DVec3,
    /// The view lies in the cone, moved back along `middle` by this.
    pub(super) slack: f64,
}

impl View {
    /// The planes with a bit in `marked`.
    pub(super) fn marked(&self, marked: u32) -> impl Iterator<Item = &HalfSpace> {
        self.planes.iter().zip(0..).filter(move |(_, i)| marked >> i & 1 != 0).map(|(p, _)| p)
    }

    /// How far an eye lies inside a plane, without the reach and with room for rounding.
    pub(super) fn depth(&self, at: DVec3, plane: &HalfSpace) -> f64 {
        plane.distance(at) - self.room.along(plane.normal) + DISTANCE * (at.length() + plane.offset.abs())
    }

    /// The cone of the sides; `None` if they bound none with edges, such as those of a wedge.
    pub(super) fn cone(&self) -> Option<Cone> {
        let Origin::Eye { at, .. } = self.origin else { return None };
        let sides: SmallVec<[&HalfSpace; 6]> = self.marked(self.sides).collect();
        let edges = edges_of(&sides)?;
        let middle = edges.iter().sum::<DVec3>().try_normalize()?;
        // A cone with a straight line inside has edges that point both ways, or none.
        if edges.iter().any(|e| e.dot(middle) < NOT_FLAT) {
            return None;
        }
        let mut slack = 0f64;
        for side in sides {
            let into = side.normal.dot(middle);
            if into < NOT_FLAT {
                return None;
            }
            slack = slack.max(self.depth(at, side) / into);
        }
        Some(Cone { edges, middle, slack })
    }
}

/// The directions in which two sides meet and that lie inside all of them; `None` if two sides are
/// nearly parallel.
fn edges_of(sides: &[&HalfSpace]) -> Option<SmallVec<[DVec3; 8]>> {
    let mut edges = SmallVec::new();
    for (i, a) in sides.iter().enumerate() {
        for b in &sides[i + 1..] {
            let along = a.normal.cross(b.normal);
            if along.length() < NO_CORNER {
                return None;
            }
            let along = along.normalize();
            let inside = |d: &DVec3| sides.iter().all(|s| s.normal.dot(*d) >= -IN_SIDE);
            edges.extend([along, -along].into_iter().filter(inside));
        }
    }
    (edges.len() >= 3).then_some(edges)
}

impl Cone {
    /// How far from the eye the points of the view lie, at most, that are no deeper than `depth`
    /// along a direction; infinity if the view goes on for ever.
    pub(super) fn farthest(&self, direction: DVec3, depth: f64) -> f64 {
        let far = self.edges.iter().map(|e| {
            let along = e.dot(direction);
            if along > NOT_FLAT { (depth + self.slack) / along } else { f64::INFINITY }
        });
        self.slack + far.fold(0.0, f64::max)
    }
}
