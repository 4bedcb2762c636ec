//! Convex polytopes from points or half-spaces.

mod cells;
mod facets;
mod hull;
mod planes;
#[cfg(feature = "serde")]
pub(crate) mod stored;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

use crate::error::{Error, finite3};
use crate::geometry::body::Body;
use crate::geometry::placement::Placement;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::{Part, Polytope};
use crate::geometry::{Block, Plane};
use crate::heap::in_arc;
use crate::numeric::shape::{CORNER, FLAT, KEPT, LENGTH_OF_ERROR, MAX_PULL, MOST_PULL};
use crate::shape::convex::facets::{Closed, closed};
use crate::shape::kind::Kind;

/// The most points or half-spaces of a [`Convex`].
pub const MAX_CONVEX: usize = 64;

/// A convex polytope: a hull of points, or an intersection of half-spaces.
///
/// Made once and shared; as an occluder its silhouette is drawn as one shape, without
/// seams between faces.
///
/// ```
/// use casca::Convex;
/// use glam::Vec3;
///
/// # fn main() -> Result<(), casca::Error> {
/// let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let tetrahedron = Convex::from_points(&corners)?;
/// assert_eq!(tetrahedron.vertices().count(), 4);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Convex {
    pub(crate) vertices: Vec<DVec3>,
    /// The solid is inside all of them.
    pub(crate) faces: Vec<HalfSpace>,
    /// Two vertices, and the two faces on both sides.
    pub(crate) edges: Vec<[u16; 4]>,
    /// The solid asked for reaches beyond faces and bounding box by this much at most, in world
    /// units.
    pub(crate) lost: f64,
}

impl Convex {
    /// The hull of points. Costs about n^2 for n points.
    ///
    /// The solid lies inside the hull. It may leave out points that are nearer than a millionth of
    /// the hull's size to the hull of the others: corners may come several times, each a few
    /// roundings elsewhere.
    ///
    /// # Errors
    /// Refuses points that are not finite, fewer than 4 or more than [`MAX_CONVEX`], and points
    /// that lie in one plane to within a millionth of their size.
    pub fn from_points(points: &[Vec3]) -> Result<Self, Error> {
        for &p in points {
            finite3("a point of a convex solid", p)?;
        }
        if !(4..=MAX_CONVEX).contains(&points.len()) {
            return Err(Error::Convex("it needs 4 to 64 points"));
        }
        let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
        Self::hull(&points, 0.0).ok_or(Error::Convex("its points lie in one plane, or too close together"))
    }

    /// The intersection of half-spaces. Costs about n^4 for n of them.
    ///
    /// The solid lies inside the intersection: each of its corners satisfies every half-space
    /// exactly, and so do all points behind its faces. Corners nearer than a millionth of the
    /// solid's size to the hull of the others may be cut off.
    ///
    /// # Errors
    /// Refuses planes without direction, fewer than 4 or more than [`MAX_CONVEX`], half-spaces
    /// whose intersection is empty, flat or unbounded, and solids so thin and so far from the
    /// origin that double precision does not resolve them.
    pub fn from_planes(planes: &[Plane]) -> Result<Self, Error> {
        if !(4..=MAX_CONVEX).contains(&planes.len()) {
            return Err(Error::Convex("it needs 4 to 64 half-spaces"));
        }
        for (i, plane) in planes.iter().enumerate() {
            let length = plane.normal.as_dvec3().length();
            if !(length > 0.0 && length.is_finite() && plane.offset.is_finite()) {
                return Err(Error::Plane(i));
            }
        }
        let corners = planes::corners(planes)?;
        let largest = corners.inside.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        if largest > f64::from(f32::MAX) {
            return Err(Error::Convex("its corners lie beyond the range of single precision"));
        }
        let mut solid = Self::hull(&corners.inside, CORNER * largest).ok_or(planes::NO_SOLID)?;
        solid.lost = solid.beyond(&corners.found) + FLAT * size_of_hull(&corners.found) + CORNER * largest;
        Ok(solid)
    }

    /// The hull of points that are known to within `rounded`.
    fn hull(points: &[DVec3], rounded: f64) -> Option<Self> {
        let size = size_of_hull(points);
        let Closed { vertices, faces, edges } = closed(points, KEPT * size, FLAT * size + 2.0 * rounded)?;
        let mut solid = Self { vertices, faces, edges, lost: 0.0 };
        solid.lost = solid.beyond(points);
        Some(solid)
    }

    /// How far points reach beyond the faces or the bounding box.
    fn beyond(&self, points: &[DVec3]) -> f64 {
        let (min, max) = self.corner_bounds();
        let over = |&p: &DVec3| {
            let outside = (min - p).max(p - max).max_element();
            self.faces.iter().map(|face| face.beyond(p)).fold(outside, f64::max)
        };
        points.iter().map(over).fold(0.0, f64::max)
    }

    /// The same solid, moved. Where sums round, it is smaller than the solid moved exactly, inside
    /// which it lies: by a few units in the last place of its coordinates, more for corners far
    /// from its middle.
    ///
    /// # Errors
    /// Refuses an offset that is not finite, and one that takes the solid where double precision
    /// hardly resolves it.
    pub fn translated(&self, offset: Vec3) -> Result<Self, Error> {
        const TOO_FAR: Error = Error::Convex("it is too thin to be moved so far from the origin");
        finite3("the offset", offset)?;
        let by = offset.as_dvec3();
        // The exact rounding error of a sum of two numbers (Knuth's two-sum).
        let lost = |a: f64, b: f64| {
            let (sum, back) = (a + b, a + b - a);
            (a - (sum - back)) + (b - back)
        };
        let exact = |v: &DVec3| (0..3).all(|i| lost(v[i], by[i]) == 0.0);
        let mut moved = self.clone();
        for v in &mut moved.vertices {
            *v += by;
        }
        let largest = moved.vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        let mut pull = 0.0;
        if !self.vertices.iter().all(exact) {
            // A ball of the pull times the depth around each corner as pulled exactly lies in the
            // solid: it leaves room for the roundings that follow.
            let middle = self.middle();
            let depth = self.faces.iter().map(|face| face.distance(middle)).fold(f64::INFINITY, f64::min);
            let room = 2.0 * CORNER * (largest + self.largest());
            pull = room / depth;
            if !(0.0..MAX_PULL).contains(&pull) {
                return Err(TOO_FAR);
            }
            let center = middle + by;
            for v in &mut moved.vertices {
                *v = center + (*v - center) * (1.0 - pull);
            }
        }
        moved.lost += pull * size_of_hull(&self.vertices) + CORNER * (largest + self.largest());
        moved.fit_faces(largest);
        Ok(moved)
    }

    /// Moves faces, whose directions stay, to their corners.
    fn fit_faces(&mut self, largest: f64) {
        self.faces.iter_mut().for_each(|face| face.offset = f64::INFINITY);
        for &[a, b, f, g] in &self.edges {
            for (face, v) in [(f, a), (f, b), (g, a), (g, b)] {
                let face = &mut self.faces[usize::from(face)];
                face.offset = face.offset.min(-face.normal.dot(self.vertices[usize::from(v)]));
            }
        }
        self.faces.iter_mut().for_each(|face| face.offset = hull::lowered(face.offset, largest));
    }

    /// The hull of points in double precision, smaller by `room` at least on all sides; `None` if
    /// hardly anything of it is left.
    pub(crate) fn inside_hull(points: &[DVec3], room: f64) -> Option<Self> {
        let largest = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let mut solid = Self::hull(points, CORNER * largest)?;
        let middle = solid.middle();
        let depth = solid.faces.iter().map(|face| face.distance(middle)).fold(f64::INFINITY, f64::min);
        // A ball of the pull times the depth around each corner as pulled lies in the hull, and a
        // ball of the room.
        let pull = (room + 2.0 * CORNER * largest) / depth;
        if !(0.0..MOST_PULL).contains(&pull) {
            return None;
        }
        for v in &mut solid.vertices {
            *v = middle + (*v - middle) * (1.0 - pull);
        }
        solid.fit_faces(largest);
        solid.lost = solid.beyond(points) + room + CORNER * largest;
        Some(solid)
    }

    /// The intersection of half-spaces that are given relative to a point inside all of them,
    /// smaller by `room` at least on all sides; `None` if hardly anything of it is left.
    pub(crate) fn inside_planes(center: DVec3, planes: &[HalfSpace], room: f64) -> Option<Self> {
        let corners = planes::corners_around(planes)?;
        // How far rounding put corners beyond planes: no point of their hull lies farther beyond.
        let off = |p: &DVec3| planes.iter().map(|plane| plane.beyond(*p)).fold(0.0, f64::max);
        let off = corners.iter().map(off).fold(0.0, f64::max);
        let points: Vec<DVec3> = corners.iter().map(|p| center + *p).collect();
        Self::inside_hull(&points, room + off)
    }

    /// Its volume, but for rounding.
    pub(crate) fn volume(&self) -> f64 {
        let middle = self.middle();
        let mut ends: Vec<[DVec3; 2]> = Vec::new();
        let face = |(face, f): (&HalfSpace, u16)| {
            let own = self.edges.iter().filter(|e| e[2] == f || e[3] == f);
            ends.clear();
            ends.extend(own.map(|e| [e[0], e[1]].map(|v| self.vertices[usize::from(v)])));
            // A point of the face, so that the triangles to its edges do not overlap.
            let inside = ends.iter().flatten().sum::<DVec3>() / (2 * ends.len()).max(1) as f64;
            let area: f64 = ends.iter().map(|[a, b]| (*a - inside).cross(*b - inside).length() * 0.5).sum();
            area * face.distance(middle) / 3.0
        };
        self.faces.iter().zip(0..).map(face).sum()
    }

    /// The solid under a transform, smaller by the error of that; `None` if hardly anything of it
    /// is left.
    pub(crate) fn placed(&self, placement: &Placement) -> Option<Self> {
        let points: Vec<DVec3> =
            self.vertices.iter().map(|&v| placement.affine.transform_point3(v)).collect();
        let mut solid = Self::inside_hull(&points, LENGTH_OF_ERROR * placement.error)?;
        solid.lost += self.lost * placement.growth;
        Some(solid)
    }

    /// The corners.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = DVec3> {
        self.vertices.iter().copied()
    }

    /// Number of faces.
    pub fn faces(&self) -> usize {
        self.faces.len()
    }

    /// Bytes on the heap.
    pub(crate) fn memory_bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<DVec3>()
            + self.faces.capacity() * size_of::<HalfSpace>()
            + self.edges.capacity() * size_of::<[u16; 4]>()
    }

    /// A point inside.
    pub(crate) fn middle(&self) -> DVec3 {
        self.vertices.iter().sum::<DVec3>() / self.vertices.len().max(1) as f64
    }

    /// The solid relative to an origin.
    pub(crate) fn seen_from(&self, origin: DVec3) -> Polytope {
        self.part(origin).polytope()
    }

    /// The solid, to be placed relative to an origin.
    pub(crate) fn part(&self, origin: DVec3) -> Part<'_> {
        Part { vertices: &self.vertices, faces: &self.faces, edges: &self.edges, origin }
    }

    /// The greatest coordinate.
    fn largest(&self) -> f64 {
        self.vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
    }

    pub(crate) fn corner_bounds(&self) -> (DVec3, DVec3) {
        let Block { min, max } = Block::around(self.vertices());
        (min, max)
    }
}

fn size_of_hull(points: &[DVec3]) -> f64 {
    let Block { min, max } = Block::around(points.iter().copied());
    (max - min).max_element()
}

impl Kind for Convex {
    fn same(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }

    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        self.translated(offset).map(Some)
    }

    fn shared(&self, out: &mut dyn FnMut(*const u8, usize)) {
        out(std::ptr::from_ref(self).cast(), in_arc::<Self>() + self.memory_bytes());
    }

    /// Only eyes known exactly see it whole.
    fn inner(&self, origin: DVec3, shrink: f64) -> Option<Body<'_>> {
        (shrink == 0.0).then(|| Body::Part(self.part(origin)))
    }
}
