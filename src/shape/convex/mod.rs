//! Convex solids: oriented boxes, and polytopes from points or half-spaces.
//!
//! A cell is inside if its corners are, and touched if it is not wholly beyond one face.
//! Margin: sums of three products of coordinates err by less than 16 units in the last
//! place of the largest; faces are moved by that.

pub(crate) mod hull;
pub(crate) mod planes;

use glam::{DMat3, DVec3, IVec3, Vec3};

use crate::error::{Error, finite3};
use crate::geometry::polytope::Polytope;
use crate::geometry::{Obb, Plane};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::shape::Shape;
use crate::shape::convex::hull::{Closed, closed};
use crate::shape::traits::Rows;

/// The most points or half-spaces of a [`Convex`].
pub const MAX_CONVEX: usize = 64;

/// Points this close to a face's plane, as a share of the solid's size, lie on it: far above the rounding of
/// double precision, far below what single precision tells apart.
const FLAT: f64 = 1e-9;

/// Points this close to the hull of the others, as a share of its size, are left out of it: somewhat more than
/// the few units in the last place by which copies of a corner differ in single precision.
const KEPT: f64 = 1e-6;

/// Distances from faces are off by this share of the greatest coordinate and offset: sums of three products err
/// by less than 16 units in the last place.
const DISTANCE: f64 = 16.0 * f64::EPSILON;

/// Corners computed in double precision are off by this share of the greatest coordinate at most: by a
/// rounding for each of their three coordinates, and as much again for what led to them.
const ROUNDED: f64 = 4.0 * f64::EPSILON;

/// Solids moved are pulled in by a share of themselves, to lie in the solid as moved exactly. A
/// larger share is refused: hardly a solid is left between roundings.
const MAX_MOVE_PULL: f64 = 1e-3;

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
    /// Outward normal and offset: the solid is `m . x <= h`.
    pub(crate) faces: Vec<(DVec3, f64)>,
    /// Two vertices, and the two faces that meet there.
    pub(crate) edges: Vec<[u16; 4]>,
    /// The solid asked for reaches beyond faces and bounding box by this much at most, in world units.
    pub(crate) lost: f64,
}

impl Convex {
    /// The hull of points. Costs about n^2 for n points.
    ///
    /// The solid lies inside the hull. Of points nearer than a millionth of the hull's size to the hull of
    /// the others it may leave out any: corners may come several times, each a few roundings elsewhere.
    ///
    /// # Errors
    /// Refuses points that are not finite, fewer than 4 or more than [`MAX_CONVEX`], and points that lie
    /// in one plane to within a millionth of their size.
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

    /// The intersection of half-spaces, all of which hold the solid. Costs n^4 for n of them.
    ///
    /// The solid lies inside the intersection: each of its corners satisfies every half-space exactly, and
    /// so do all points behind its faces. Corners nearer than a millionth of the solid's size to the hull of
    /// the others may be cut off.
    ///
    /// # Errors
    /// Refuses planes without direction, fewer than 4 or more than [`MAX_CONVEX`], half-spaces whose
    /// intersection is empty, flat or unbounded, and solids so thin and so far from the origin that double
    /// precision does not resolve them.
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
        let reach = corners.inside.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        if reach > f64::from(f32::MAX) {
            return Err(Error::Convex("its corners lie beyond the range of single precision"));
        }
        let mut solid = Self::hull(&corners.inside, ROUNDED * reach).ok_or(planes::NO_SOLID)?;
        solid.lost = solid.beyond(&corners.found) + FLAT * size_of_hull(&corners.found) + ROUNDED * reach;
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
            self.faces.iter().map(|&(n, h)| n.dot(p) - h).fold(outside, f64::max)
        };
        points.iter().map(over).fold(0.0, f64::max)
    }

    /// The same solid, moved. Where sums round, it is smaller than the solid moved exactly, inside which it lies:
    /// by a few units in the last place of its coordinates, more for corners far from its middle.
    ///
    /// # Errors
    /// Refuses an offset that is not finite, and one that takes the solid where double precision hardly resolves it.
    pub fn translated(&self, offset: Vec3) -> Result<Self, Error> {
        const TOO_FAR: Error = Error::Convex("it is too thin to be moved so far from the origin");
        finite3("the offset", offset)?;
        let by = offset.as_dvec3();
        // What a sum of two numbers loses, exactly (Knuth's two-sum).
        let lost = |a: f64, b: f64| {
            let (sum, back) = (a + b, a + b - a);
            (a - (sum - back)) + (b - back)
        };
        let exact = |v: &DVec3| (0..3).all(|i| lost(v[i], by[i]) == 0.0);
        let mut moved = self.clone();
        for v in &mut moved.vertices {
            *v += by;
        }
        let reach = moved.vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        let mut pull = 0.0;
        if !self.vertices.iter().all(exact) {
            // A ball of the pull times the depth around each corner as pulled exactly lies in the solid: it
            // has room for what rounds.
            let middle = self.middle();
            let depth = self.faces.iter().map(|&(n, h)| h - n.dot(middle)).fold(f64::INFINITY, f64::min);
            let room = 2.0 * ROUNDED * (reach + self.reach());
            pull = room / depth;
            if !(0.0..MAX_MOVE_PULL).contains(&pull) {
                return Err(TOO_FAR);
            }
            let center = middle + by;
            for v in &mut moved.vertices {
                *v = center + (*v - center) * (1.0 - pull);
            }
        }
        moved.lost += pull * size_of_hull(&self.vertices) + ROUNDED * (reach + self.reach());
        for (f, (n, h)) in moved.faces.iter_mut().enumerate() {
            let own = moved.edges.iter().filter(|e| usize::from(e[2]) == f || usize::from(e[3]) == f);
            let ends = own.flat_map(|e| [e[0], e[1]]).map(|v| n.dot(moved.vertices[usize::from(v)]));
            *h = hull::lowered(ends.fold(f64::INFINITY, f64::min), reach);
        }
        Ok(moved)
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
            + self.faces.capacity() * size_of::<(DVec3, f64)>()
            + self.edges.capacity() * size_of::<[u16; 4]>()
    }

    /// A point inside.
    pub(crate) fn middle(&self) -> DVec3 {
        self.vertices.iter().sum::<DVec3>() / self.vertices.len().max(1) as f64
    }

    /// The solid relative to an origin.
    pub(crate) fn seen_from(&self, origin: DVec3) -> Polytope {
        Polytope {
            vertices: self.vertices.iter().map(|&v| v - origin).collect(),
            faces: self.faces.iter().map(|&(n, h)| (n, h - n.dot(origin))).collect(),
            edges: self.edges.iter().copied().collect(),
        }
    }

    /// Whether no face keeps a box out of what was asked for.
    fn near(&self, min: DVec3, max: DVec3) -> bool {
        self.faces.iter().all(|&(n, h)| {
            let nearest = DVec3::select(n.cmpge(DVec3::ZERO), min, max);
            n.dot(nearest) <= h + self.margin(min.abs().max(max.abs()), h) + self.lost
        })
    }

    /// Whether a box lies behind all faces.
    fn holds(&self, min: DVec3, max: DVec3) -> bool {
        self.faces.iter().all(|&(n, h)| {
            let farthest = DVec3::select(n.cmpge(DVec3::ZERO), max, min);
            n.dot(farthest) <= h - self.margin(min.abs().max(max.abs()), h)
        })
    }

    /// What the distance of a point from a face may be off by.
    fn margin(&self, p: DVec3, h: f64) -> f64 {
        DISTANCE * (p.abs().max_element() + h.abs())
    }

    /// The greatest coordinate.
    fn reach(&self) -> f64 {
        self.vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
    }

    fn corner_bounds(&self) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.vertices.iter().fold(start, |(min, max), &v| (min.min(v), max.max(v)))
    }
}

fn size_of_hull(points: &[DVec3]) -> f64 {
    let min = points.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
    let max = points.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
    (max - min).max_element()
}

fn corners(min: DVec3, max: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        DVec3::new(
            if i & 1 == 0 { min.x } else { max.x },
            if i & 2 == 0 { min.y } else { max.y },
            if i & 4 == 0 { min.z } else { max.z },
        )
    })
}

/// The cells of a box between `lo` and `hi` that pass a test which the cells of each row pass in one run.
fn filtered(
    grid: &Grid,
    (min, max): (DVec3, DVec3),
    (lo, hi): (IVec3, IVec3),
    passes: impl Fn(DVec3, DVec3) -> bool,
    out: &mut dyn FnMut(CellRun),
) {
    let (a, b) = grid.cover(min, max);
    let (lo, hi) = (a.max(lo), b.min(hi));
    for z in lo.z..=hi.z {
        for y in lo.y..=hi.y {
            let test = |x: &i32| {
                let (a, b) = grid.cell_bounds(IVec3::new(*x, y, z));
                passes(a, b)
            };
            if let Some(x0) = (lo.x..=hi.x).find(test) {
                let x1 = (x0..=hi.x).rev().find(test).unwrap_or(x0);
                out(CellRun { x0, x1, y, z });
            }
        }
    }
}

impl Shape for Convex {
    fn bounds(&self) -> (DVec3, DVec3) {
        let (min, max) = self.corner_bounds();
        (min - self.lost, max + self.lost)
    }

    fn touched(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        self.touched_rows(grid, IVec3::ZERO, grid.dims() - 1, out);
    }

    fn opaque(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        self.opaque_rows(grid, IVec3::ZERO, grid.dims() - 1, out);
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        self.holds(min, max)
    }

    fn contains_point(&self, point: DVec3) -> bool {
        self.faces.iter().all(|&(n, h)| n.dot(point) <= h + self.margin(point, h) + self.lost)
    }
}

impl Rows for Convex {
    fn touched_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), |min, max| self.near(min, max), out);
    }

    fn opaque_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), |min, max| self.holds(min, max), out);
    }

    fn misses(&self, min: DVec3, max: DVec3) -> bool {
        !self.near(min, max)
    }
}

impl Obb {
    /// Centre, half-axes as columns, and the margin of coordinates.
    pub(crate) fn parts(&self) -> (DVec3, DMat3, f64) {
        let (c, half) = (self.center.as_dvec3(), self.half.as_dvec3());
        let turn = DMat3::from_quat(self.rotation.as_dquat().normalize());
        let axes = DMat3::from_cols(turn.x_axis * half.x, turn.y_axis * half.y, turn.z_axis * half.z);
        (c, axes, 16.0 * f64::EPSILON * (c.abs().max_element() + half.max_element()))
    }

    /// Unit axes.
    pub(crate) fn turn(&self) -> DMat3 {
        DMat3::from_quat(self.rotation.as_dquat().normalize())
    }

    /// Asks whether no face keeps a box out.
    fn near(&self) -> impl Fn(DVec3, DVec3) -> bool {
        let (c, _, margin) = self.parts();
        let (turn, half) = (self.turn(), self.half.as_dvec3());
        move |min: DVec3, max: DVec3| {
            let (d, reach) = ((min + max) * 0.5 - c, (max - min) * 0.5);
            let slack = margin + 16.0 * f64::EPSILON * max.abs().max(min.abs()).max_element();
            (0..3).all(|i| turn.col(i).dot(d).abs() <= half[i] + turn.col(i).abs().dot(reach) + slack)
        }
    }

    /// Asks whether a box lies behind all faces.
    fn holds(&self) -> impl Fn(DVec3, DVec3) -> bool {
        let (c, _, margin) = self.parts();
        let (turn, half) = (self.turn(), self.half.as_dvec3());
        move |min: DVec3, max: DVec3| {
            let slack = margin + 16.0 * f64::EPSILON * max.abs().max(min.abs()).max_element();
            corners(min, max).iter().all(|&p| (0..3).all(|i| turn.col(i).dot(p - c).abs() <= half[i] - slack))
        }
    }
}

impl Shape for Obb {
    fn bounds(&self) -> (DVec3, DVec3) {
        let (c, axes, margin) = self.parts();
        let reach = axes.x_axis.abs() + axes.y_axis.abs() + axes.z_axis.abs() + margin;
        (c - reach, c + reach)
    }

    fn touched(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        self.touched_rows(grid, IVec3::ZERO, grid.dims() - 1, out);
    }

    fn opaque(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        self.opaque_rows(grid, IVec3::ZERO, grid.dims() - 1, out);
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        self.holds()(min, max)
    }

    fn contains_point(&self, point: DVec3) -> bool {
        let (c, _, margin) = self.parts();
        let (turn, half) = (self.turn(), self.half.as_dvec3());
        let slack = margin + 16.0 * f64::EPSILON * point.abs().max_element();
        (0..3).all(|i| turn.col(i).dot(point - c).abs() <= half[i] + slack)
    }
}

impl Rows for Obb {
    fn touched_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), self.near(), out);
    }

    fn opaque_rows(&self, grid: &Grid, lo: IVec3, hi: IVec3, out: &mut dyn FnMut(CellRun)) {
        filtered(grid, self.bounds(), (lo, hi), self.holds(), out);
    }

    fn misses(&self, min: DVec3, max: DVec3) -> bool {
        !self.near()(min, max)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::{Quat, UVec3};

    use super::*;
    use crate::grid::GridSpec;

    fn random(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*state >> 8) as f32 / (1 << 24) as f32
    }

    #[test]
    fn hulls_hold_their_points_and_close() {
        let mut state = 1;
        for n in [4, 5, 8, 12, 20, 30] {
            for _ in 0..10 {
                let points: Vec<Vec3> = (0..n)
                    .map(|_| Vec3::new(random(&mut state), random(&mut state), random(&mut state)) * 7.0)
                    .collect();
                let hull = Convex::from_points(&points).unwrap();
                assert!(points.iter().all(|p| hull.contains_point(p.as_dvec3())));
                assert_eq!(hull.vertices.len() + hull.faces.len(), hull.edges.len() + 2);
            }
        }
    }

    #[test]
    fn a_cube_is_the_same_from_points_and_from_planes() {
        let points: Vec<Vec3> = corners(DVec3::ZERO, DVec3::ONE).iter().map(|p| p.as_vec3()).collect();
        let planes: Vec<Plane> = Vec3::AXES
            .iter()
            .flat_map(|&n| [Plane { normal: n, offset: 0.0 }, Plane { normal: -n * 2.0, offset: 2.0 }])
            .collect();
        for cube in [Convex::from_points(&points).unwrap(), Convex::from_planes(&planes).unwrap()] {
            assert_eq!((cube.vertices.len(), cube.faces.len(), cube.edges.len()), (8, 6, 12));
            assert!(cube.contains_box(DVec3::splat(0.01), DVec3::splat(0.99)));
            assert!(!cube.contains_box(DVec3::splat(0.01), DVec3::splat(1.01)));
        }
    }

    #[test]
    fn refuses_what_is_no_solid() {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.3, 0.2, 0.0)];
        assert!(Convex::from_points(&flat).is_err());
        assert!(Convex::from_points(&[Vec3::ZERO; 8]).is_err());
        assert!(Convex::from_points(&[Vec3::NAN; 4]).is_err());
        assert!(Convex::from_points(&[Vec3::X; 3]).is_err());
        let up = Plane { normal: Vec3::Y, offset: 1.0 };
        assert!(Convex::from_planes(&[up; 4]).is_err());
        assert!(Convex::from_planes(&[Plane { normal: Vec3::ZERO, offset: 1.0 }; 4]).is_err());
    }

    #[test]
    fn cells_of_turned_boxes_agree_with_points() {
        let grid = Grid::new(&GridSpec { min: Vec3::ZERO, cell: 0.5, dims: UVec3::splat(20) }).unwrap();
        let mut state = 5;
        for _ in 0..20 {
            let center = Vec3::new(random(&mut state), random(&mut state), random(&mut state)) * 10.0;
            let half = Vec3::new(random(&mut state), random(&mut state), random(&mut state)) * 3.0 + 0.1;
            let rotation =
                Quat::from_euler(glam::EulerRot::XYZ, random(&mut state) * 6.0, random(&mut state), 1.0);
            let boxed = Obb { center, half, rotation };
            let points: Vec<Vec3> = corners(-half.as_dvec3(), half.as_dvec3())
                .iter()
                .map(|p| center + rotation * p.as_vec3())
                .collect();
            let hull = Convex::from_points(&points).unwrap();
            let shapes: [&dyn Shape; 2] = [&boxed, &hull];
            for shape in shapes {
                let (mut touched, mut opaque) = (BTreeSet::new(), BTreeSet::new());
                shape.touched(&grid, &mut |r| touched.extend(r.cells().map(|c| c.to_array())));
                shape.opaque(&grid, &mut |r| opaque.extend(r.cells().map(|c| c.to_array())));
                for i in 0..8000 {
                    let cell = glam::IVec3::new(i % 20, i / 20 % 20, i / 400);
                    let (min, max) = grid.cell_bounds(cell);
                    let inside = |p: DVec3| {
                        let d = rotation.as_dquat().inverse() * (p - center.as_dvec3());
                        d.abs().cmple(half.as_dvec3()).all()
                    };
                    if opaque.contains(&cell.to_array()) {
                        assert!(corners(min + 1e-5, max - 1e-5).iter().all(|&p| inside(p)));
                    }
                    let t = DVec3::new(0.31, 0.57, 0.77);
                    if inside(min + (max - min) * t) {
                        assert!(touched.contains(&cell.to_array()));
                    }
                }
            }
        }
    }
}
