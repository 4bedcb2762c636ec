//! Views of cameras that may turn.
//!
//! Let a camera at e, whose view lies in the cone C around e, go to e' with |e' - e| <= r and turn
//! by at most an angle a. Each point that it then sees is e' + p where p lies within the angle a of
//! a direction of C, and no farther from e' than the view reached from e. A half-space `n·(q -
//! e) >= 0` contains all e + p if n differs from every direction of C by at most a right angle less
//! a, so if `n·c >= sin(a)` for all directions c of C. Those with `n·c >= sin(a)` are a convex
//! cone: it is enough to ask the edges of C. Moved outwards by r, the half-space contains all e' +
//! p.
//!
//! So each side is tilted about the axis across its middle until that holds for all edges. That is
//! more than the angle a: the directions within a of a side's edge are bounded by a small circle,
//! not by a plane.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use smallvec::SmallVec;

use crate::error::{Error, not_negative};
use crate::geometry::Room;
use crate::geometry::plane::HalfSpace;
use crate::numeric::shape::{DISTANCE, LENGTH_OF_ERROR, REGION};
use crate::numeric::view::{IN_SIDE, NEAR_ROOM, NEAR_ROUNDINGS, NO_CORNER, NOT_FLAT, TURN};
use crate::view::cut::cuboid;
use crate::view::{Origin, Turned, View};

/// A cone of directions around an eye, with edges: the hull of these.
#[derive(Debug, Clone)]
pub(super) struct Cone {
    /// The directions of its edges, of length 1.
    edges: SmallVec<[DVec3; 8]>,
    /// The mean of these, of length 1. It points into each of the sides.
    pub(super) middle: DVec3,
    /// The view lies in the cone, moved back along `middle` by this.
    slack: f64,
}

impl View {
    /// The same view for a camera that may also turn by up to `angle` radians, about any axis
    /// through its eye: the result of a query has all that it can see after any such turn, from
    /// anywhere within the [reach](View::with_reach).
    ///
    /// Side planes are tilted outwards, by more than the angle where the view is wide; a side that
    /// would have to be tilted too far is left out. The far plane moves out to the distance of the
    /// farthest corner. The near plane is left out: no occluder counts that reaches into the ball
    /// around the eye with the nearest corners. Of a view made [of planes](View::from_planes),
    /// those through the eye are its sides. If they do not bound a pyramid, the view sees all
    /// round, and if a plane cuts off the eye then, nothing is hidden.
    ///
    /// The angle replaces that of an earlier call; 0 is the view as it was.
    ///
    /// # Errors
    /// Refuses an angle that is negative or not finite, and with [`Error::ParallelTurn`] a view of
    /// parallel rays and an angle other than 0.
    pub fn with_turn(self, angle: f32) -> Result<Self, Error> {
        not_negative("the angle", f64::from(angle))?;
        match self.origin {
            _ if angle == 0.0 => Ok(self.straight()),
            Origin::Direction(_) => Err(Error::ParallelTurn),
            Origin::Eye { .. } => Ok(self.straight().opened(f64::from(angle))),
        }
    }

    /// By how much the camera may turn, in radians: see [`View::with_turn`].
    pub fn turn(&self) -> f64 {
        self.turned.as_ref().map_or(0.0, |turned| turned.angle)
    }

    /// The view before it was opened for turns.
    pub(super) fn straight(self) -> Self {
        match self.turned {
            Some(turned) => Self { layers: self.layers, ..turned.straight },
            None => self,
        }
    }

    /// The view of all cameras that this one may be, and that go on within `aside` of a way, of which
    /// `way` is half, and turn by `turn` more. Its near plane is a ball also if it does not turn.
    /// Parallel rays stay as they are.
    pub(crate) fn widened(&self, way: DVec3, aside: f64, turn: f64) -> Self {
        if matches!(self.origin, Origin::Direction(_)) {
            return self.clone();
        }
        let room = Room::along_way(way, self.reach() + aside);
        self.clone().straight().roaming(room).opened(self.turn() + turn)
    }

    /// A view that is not opened yet, opened for turns by up to an angle, also by 0: then its near
    /// plane still turns into a ball around the eye. Parallel rays stay as they are.
    pub(crate) fn opened(self, angle: f64) -> Self {
        let Origin::Eye { at, error } = self.origin else { return self };
        let cone = self.cone();
        // An eye that is not known exactly: the camera turns about another point.
        let slack = 2.0 * LENGTH_OF_ERROR * error + cone.as_ref().map_or(0.0, |cone| cone.slack);
        let room = |normal| slack + self.room.along(normal) + DISTANCE * at.length();
        let through_eye = |normal: DVec3| HalfSpace { normal, offset: room(normal) - normal.dot(at) };
        let mut planes: SmallVec<[HalfSpace; 6]> = SmallVec::new();
        if let Some(cone) = &cone {
            let tilted = self.marked(self.sides).filter_map(|side| tilted(side.normal, cone, angle));
            planes.extend(tilted.map(through_eye));
            let far = self.far(cone, at);
            if far.is_finite() {
                let moved = |p: &HalfSpace| HalfSpace {
                    offset: far * (1.0 + REGION) + room(p.normal) - p.normal.dot(at),
                    ..*p
                };
                planes.extend(self.marked(!(self.sides | self.cutting)).map(moved));
            }
        }
        let near = self.near(cone.as_ref(), at);
        let sides = 0;
        let turned = Some(Box::new(Turned { angle, near, straight: self.clone() }));
        Self { planes, cutting: 0, sides, widened: 0.0, turned, ..self }
    }

    /// How far an eye lies inside a plane, without the reach and with room for rounding.
    fn depth(&self, at: DVec3, plane: &HalfSpace) -> f64 {
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

    /// How far the view goes from the eye; infinity if no plane ends it.
    fn far(&self, cone: &Cone, at: DVec3) -> f64 {
        let ends = self.marked(!(self.sides | self.cutting));
        ends.map(|p| cone.farthest(-p.normal, self.depth(at, p))).fold(f64::INFINITY, f64::min)
    }

    /// How far from the eye rays start at most: at the corners of its near plane.
    fn near(&self, cone: Option<&Cone>, at: DVec3) -> f64 {
        // How far the planes were moved outwards for their rounding.
        let rounding = (self.widened - self.reach()).max(0.0);
        let starts = self.marked(self.cutting).map(|p| {
            let depth = 2.0 * rounding - self.depth(at, p) + 2.0 * DISTANCE * (at.length() + p.offset.abs());
            cone.map_or(f64::INFINITY, |cone| cone.farthest(p.normal, depth) + NEAR_ROUNDINGS * rounding)
        });
        starts.fold(0.0, f64::max)
    }

    /// The region where rays start, of a view that may turn and has a near plane.
    pub(super) fn before_turned(&self) -> Option<Self> {
        let near = self.turned.as_ref().map(|turned| turned.near).filter(|near| *near > 0.0)?;
        let Origin::Eye { at, error } = self.origin else { return None };
        let room = near * (1.0 + NEAR_ROOM) + self.reach() + LENGTH_OF_ERROR * error;
        let ball = cuboid(at, DVec3::splat(room)).filter(|p| p.offset.is_finite());
        Some(self.region(self.planes.iter().copied().chain(ball).collect()))
    }

    /// Whether rays of another view start only where rays of this one may, a view that may turn, if
    /// they go to points in its half-spaces. So no occluder that this view lets hide anything is
    /// cut by the near plane of the other.
    pub(crate) fn covers_starts(&self, other: &Self) -> bool {
        let (Some(own), Origin::Eye { at, error }) = (&self.turned, self.origin) else { return false };
        let Origin::Eye { at: eye, error: unsure } = other.origin else { return false };
        let straight = other.turned.as_ref().map_or_else(
            || other.near(other.cone().as_ref(), eye) - NEAR_ROUNDINGS * (other.widened - other.reach()),
            |turned| turned.near,
        );
        let away = (eye - at).length() + LENGTH_OF_ERROR * (unsure + error);
        // Equal reaches are no doubt.
        (away + straight.max(0.0)) * (1.0 + REGION) + other.reach()
            <= own.near * (1.0 + NEAR_ROOM) + self.reach()
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
    fn farthest(&self, direction: DVec3, depth: f64) -> f64 {
        let far = self.edges.iter().map(|e| {
            let along = e.dot(direction);
            if along > NOT_FLAT { (depth + self.slack) / along } else { f64::INFINITY }
        });
        self.slack + far.fold(0.0, f64::max)
    }
}

/// The normal of a side tilted outwards, so that it makes at least the sine of `angle` with all
/// directions of the cone; `None` if no tilt does.
fn tilted(normal: DVec3, cone: &Cone, angle: f64) -> Option<DVec3> {
    if angle >= FRAC_PI_2 {
        return None;
    }
    let sine = angle.sin() + TURN;
    let inwards = (cone.middle - normal * normal.dot(cone.middle)).try_normalize()?;
    // Along each edge: x cos t + y sin t >= sine, for tilts t in an interval.
    let (mut least, mut most) = (0f64, FRAC_PI_2);
    for edge in &cone.edges {
        let (x, y) = (normal.dot(*edge), inwards.dot(*edge));
        let (middle, half) = (y.atan2(x), (sine / x.hypot(y)).acos());
        // The sine of no angle is greater than 1: then nothing is compared.
        if half.is_nan() {
            return None;
        }
        (least, most) = (least.max(middle - half), most.min(middle + half));
    }
    let tilted = (normal * least.cos() + inwards * least.sin()).normalize();
    let holds = cone.edges.iter().all(|e| tilted.dot(*e) >= sine - 0.5 * TURN);
    (least <= most && holds).then_some(tilted)
}
