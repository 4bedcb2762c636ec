//! Triangle meshes: touched cells from the triangles, opaque cells from slices
//! and parity (thesis, section 3.4.1).
//!
//! Cells that no triangle touches lie wholly inside or wholly outside a closed
//! mesh, and so do all cells reached from them without crossing the surface. Such
//! a component is opaque if the lines along x through the middles of *all*
//! its rows count an odd number of crossings: a wrong count on one line can
//! only make it transparent.
//!
//! Where triangles hide from their front only, the triangles must be wound alike, and the component must have
//! a positive winding number: then a ray from where it is zero passes a front.

use std::sync::{Arc, OnceLock};

use glam::{DVec3, Vec3};

use crate::error::{Error, finite3, not_negative};
use crate::geometry::{Aabb, Block};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::mesh::cells::{Held, Holder, SurfaceCells};
use crate::mesh::index::Index;
use crate::mesh::parts;
use crate::mesh::raster::margin;
use crate::mesh::surface::{Rules, Surface};
use crate::shape::Shape;
use crate::shape::convex::Convex;

/// How the triangles of a [`TriMesh`] are prepared for hiding.
///
/// ```
/// use casca::{Preparation, TriMesh};
/// use glam::Vec3;
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut how = Preparation::default();
/// how.tolerance = Some(0.002);
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let mesh = TriMesh::prepare(corners, faces, &how, &mut |_| ())?;
/// assert!(mesh.is_closed());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Preparation {
    /// How far the outlines of patches may leave the edges of triangles, in world units. What
    /// they leave is added as a margin when they are drawn: larger is faster, and hides less near
    /// outlines. Without a number, a 2000th of the mesh's diagonal.
    pub tolerance: Option<f32>,
    /// Patches of a smaller radius hide nothing, in world units. Without a number, a 1000th of the
    /// mesh's diagonal.
    pub least_radius: Option<f32>,
    /// The greatest angle between the triangles of a patch and its first one, in degrees, up to 80. Without a
    /// number, 80, or 40 for triangles that hide from their front only: a patch of those hides only where
    /// all of it is seen from the front.
    pub max_angle: Option<f32>,
    /// From which side triangles hide.
    pub facing: Facing,
    /// Whether the mesh will hide others. One that will not is prepared faster and takes less memory, but
    /// serves as bounds only: as an occluder it is refused.
    pub occludes: bool,
}

/// From which side triangles hide what is behind them: where the renderer draws them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Facing {
    /// From both sides.
    #[default]
    Both,
    /// From the side where their corners run counter-clockwise: for renderers that leave out
    /// triangles seen from behind.
    Front,
}

impl Default for Preparation {
    fn default() -> Self {
        Self { tolerance: None, least_radius: None, max_angle: None, facing: Facing::Both, occludes: true }
    }
}

impl Preparation {
    /// The rules for a mesh of a diagonal.
    fn rules(&self, diagonal: f64) -> Result<Rules, Error> {
        let length = |what, given: Option<f32>, share: f64| match given {
            Some(v) => not_negative(what, f64::from(v)).map(|()| f64::from(v)),
            None => Ok(diagonal * share),
        };
        let degrees = f64::from(self.max_angle.unwrap_or(match self.facing {
            Facing::Both => 80.0,
            Facing::Front => 40.0,
        }));
        if !(0.0..=80.0).contains(&degrees) {
            let what = "the greatest angle of a patch in degrees";
            return Err(Error::Setting { what, value: degrees, min: 0.0, max: 80.0 });
        }
        Ok(Rules {
            tolerance: length("the tolerance of outlines", self.tolerance, 1.0 / 2000.0)?,
            least: length("the least radius of a patch", self.least_radius, 1.0 / 1000.0)?,
            cosine: degrees.to_radians().cos(),
            front: self.facing == Facing::Front,
        })
    }
}

/// A triangle mesh in world space, checked and prepared once.
#[derive(Debug, Clone)]
pub struct TriMesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) bounds: Aabb,
    pub(crate) closed: bool,
    /// Whether it can have opaque cells.
    pub(crate) solid: bool,
    /// Whether it may hide others: else its surface is empty.
    pub(crate) occludes: bool,
    pub(crate) surface: Surface,
    pub(crate) parts: Vec<Convex>,
    pub(crate) middle: DVec3,
    /// Made when it is first asked.
    pub(crate) index: OnceLock<Index>,
    pub(crate) cells: Holder,
}

impl TriMesh {
    /// Takes positions in world units and triangles as indices of three
    /// positions, and prepares them as [`Preparation::default`] says. Vertices at equal positions count as one.
    ///
    /// Costs a few sorts of the triangles: about a second for a million.
    ///
    /// # Errors
    /// Refuses an empty mesh, positions that are not finite and indices of missing vertices.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        Self::prepare(positions, triangles, &Preparation::default(), &mut |_| ())
    }

    /// As [`TriMesh::new`], for an object that hides nothing: the mesh is prepared to be tested only (see
    /// [`Preparation::occludes`]).
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use casca::{ObjectDesc, TriMesh};
    /// use glam::Vec3;
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let pane = TriMesh::bounds_only(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
    /// assert!(!pane.occludes());
    /// let desc = ObjectDesc::fixed(Arc::new(pane));
    /// # let _ = desc;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`TriMesh::new`].
    pub fn bounds_only(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        let how = Preparation { occludes: false, ..Preparation::default() };
        Self::prepare(positions, triangles, &how, &mut |_| ())
    }

    /// As [`TriMesh::new`], prepared as asked; `progress` is told what share of the work is done.
    ///
    /// # Errors
    /// As [`TriMesh::new`]; also settings that are not finite or out of their range.
    pub fn prepare(
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        how: &Preparation,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, Error> {
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= positions.len()) {
                return Err(Error::MeshIndex { triangle, vertex, vertices: positions.len() });
            }
        }
        positions.iter().try_for_each(|&p| finite3("a mesh position", p))?;
        let corners = triangles.iter().flatten().map(|&v| positions[v as usize]);
        let bounds = Aabb::from_points(corners).ok_or(Error::EmptyMesh)?;
        let rules = how.rules((bounds.max.as_dvec3() - bounds.min.as_dvec3()).length())?;
        let closed = is_closed(&positions, &triangles);
        progress(0.2);
        let surface = match how.occludes {
            true => Surface::new(&positions, &triangles, &rules),
            false => Surface::default(),
        };
        progress(0.7);
        let parts = parts::parts(&positions, &triangles);
        progress(1.0);
        Ok(Self::from_prepared(positions, triangles, bounds, (closed, how.occludes), surface, parts))
    }

    /// The mesh from what was prepared, and what follows from that. Says whether it is closed, and whether it
    /// hides others.
    pub(crate) fn from_prepared(
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        bounds: Aabb,
        (closed, occludes): (bool, bool),
        surface: Surface,
        parts: Vec<Convex>,
    ) -> Self {
        let front = surface.front.is_some();
        let solid = closed && occludes && (!front || is_wound_alike(&positions, &triangles));
        let middle = middle_of(&parts);
        let (index, cells) = (OnceLock::new(), Holder::default());
        Self { positions, triangles, bounds, closed, solid, occludes, surface, parts, middle, index, cells }
    }

    /// The positions given.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// The triangles given.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The box of all corners of triangles.
    pub fn aabb(&self) -> Aabb {
        self.bounds
    }

    /// Whether every edge belongs to exactly two triangles, so that the mesh
    /// has an inside. Others make no opaque cells.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Whether it was prepared to hide others (see [`Preparation::occludes`]).
    pub fn occludes(&self) -> bool {
        self.occludes
    }

    /// Bytes that it holds on the heap. Some of them are taken only once they are
    /// needed: an index of the triangles, when it is first asked whether something lies inside.
    pub fn memory_bytes(&self) -> usize {
        self.positions.capacity() * size_of::<Vec3>()
            + self.triangles.capacity() * size_of::<[u32; 3]>()
            + self.surface.bytes()
            + self.parts.capacity() * size_of::<Convex>()
            + self.parts.iter().map(Convex::memory_bytes).sum::<usize>()
            + self.index.get().map_or(0, Index::bytes)
    }

    /// How many patches of triangles are kept for hiding.
    pub fn patches(&self) -> usize {
        self.surface.patches.len()
    }

    /// How many sides the outlines of all patches have: what drawing them costs, where triangles cost
    /// others.
    pub fn sides(&self) -> usize {
        self.surface.sides.len()
    }

    /// Convex solids that together hold the mesh.
    pub(crate) fn parts(&self) -> &[Convex] {
        &self.parts
    }

    /// A point of the largest of those.
    pub(crate) fn middle(&self) -> DVec3 {
        self.middle
    }

    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize].as_dvec3())
    }

    fn all_corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        (0..self.triangles.len() as u32).map(|t| self.corners(t))
    }

    fn index(&self) -> &Index {
        let corners = |t: u32| self.triangles[t as usize].map(|v| self.positions[v as usize]);
        self.index.get_or_init(|| Index::new(self.triangles.len(), &corners))
    }

    /// The block of grid cells that holds the mesh, and its surface there.
    fn surface_cells(&self, grid: &Grid) -> Option<Arc<SurfaceCells>> {
        self.cells.get(grid, || SurfaceCells::new(self.all_corners(), grid, self.bounds()))
    }

    /// While the result lives, the mesh's cells in a grid are found once, and then known.
    pub(crate) fn hold_cells(&self, grid: &Grid) -> Arc<Held> {
        self.cells.hold(grid)
    }

    /// The greatest margin of its triangles.
    fn greatest_margin(&self) -> f64 {
        let (min, max) = self.bounds();
        margin(&[min, max, max])
    }

    /// Whether triangles may meet a box.
    pub(crate) fn surface_meets(&self, block: &Block) -> bool {
        let (min, max) = (block.min, block.max);
        self.index().any_in_box((min, max), self.greatest_margin(), |t| {
            let t = self.corners(t);
            triangle_meets_box(&t, (min, max), margin(&t))
        })
    }

    /// Where the line along `axis` through `point` crosses the mesh before that: how often, and the sum of
    /// the changes of the winding number.
    fn crossings_before(&self, axis: usize, point: DVec3) -> (u32, i32) {
        let (mut count, mut winding) = (0, 0);
        let (mut min, mut max) = (point, point);
        min[axis] = f64::NEG_INFINITY;
        max[axis] = point[axis];
        // Triangles that are left out would give no crossing, or one that comes later.
        self.index().any_in_box((min, max), self.greatest_margin(), |t| {
            if let Some((_, change)) = crossing(&self.corners(t), axis, point).filter(|c| c.0 < point[axis]) {
                (count, winding) = (count + 1, winding + change);
            }
            false
        });
        (count, winding)
    }

    /// Whether what lies beyond crossings of a line is behind the mesh's triangles as seen
    /// from outside.
    fn is_behind(&self, (count, winding): (u32, i32)) -> bool {
        count % 2 == 1 && (winding > 0 || self.surface.front.is_none())
    }
}

/// A point of the first, which is the largest.
pub(crate) fn middle_of(parts: &[Convex]) -> DVec3 {
    parts.first().map_or(DVec3::ZERO, Convex::middle)
}

/// Whether each edge, by position, has two triangles. Triangles with two equal
/// corners are passed over.
pub(crate) fn is_closed(positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let key = |v: u32| positions[v as usize].to_array().map(|c| (c + 0.0).to_bits());
    let mut edges = Vec::with_capacity(triangles.len() * 3);
    for t in triangles {
        let [a, b, c] = t.map(key);
        if a == b || b == c || c == a {
            continue;
        }
        edges.extend([(a.min(b), a.max(b)), (b.min(c), b.max(c)), (c.min(a), c.max(a))]);
    }
    edges.sort_unstable();
    !edges.is_empty() && edges.chunk_by(|a, b| a == b).all(|same| same.len() == 2)
}

/// Whether the two triangles at each edge of a closed mesh run along it in opposite directions.
pub(crate) fn is_wound_alike(positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let key = |v: u32| positions[v as usize].to_array().map(|c| (c + 0.0).to_bits());
    let mut edges = Vec::with_capacity(triangles.len() * 3);
    for t in triangles {
        let [a, b, c] = t.map(key);
        if a != b && b != c && c != a {
            edges.extend([(a, b), (b, c), (c, a)]);
        }
    }
    edges.sort_unstable();
    edges.windows(2).all(|w| w[0] != w[1])
}

/// Separating-axis test of a triangle against a closed box widened by `margin`.
pub(crate) fn triangle_meets_box(t: &[DVec3; 3], (min, max): (DVec3, DVec3), margin: f64) -> bool {
    let center = (min + max) * 0.5;
    let half = (max - min) * 0.5 + margin;
    let [a, b, c] = t.map(|p| p - center);
    let apart = |axis: DVec3| {
        let (pa, pb, pc) = (axis.dot(a), axis.dot(b), axis.dot(c));
        let reach = axis.abs().dot(half);
        pa.min(pb).min(pc) > reach || pa.max(pb).max(pc) < -reach
    };
    let (ab, bc, ca) = (b - a, c - b, a - c);
    if [DVec3::X, DVec3::Y, DVec3::Z].into_iter().any(apart) || apart(ab.cross(bc)) {
        return false;
    }
    ![ab, bc, ca].into_iter().any(|e| {
        apart(DVec3::new(0.0, -e.z, e.y))
            || apart(DVec3::new(e.z, 0.0, -e.x))
            || apart(DVec3::new(-e.y, e.x, 0.0))
    })
}

/// Where the line along `axis` through `point` crosses the triangle, and by how much that
/// changes the winding number. Each edge
/// is judged from its two ends in a fixed order, so that triangles which share
/// it agree, and crossings of a closed mesh come in pairs whatever is rounded.
fn crossing(t: &[DVec3; 3], axis: usize, point: DVec3) -> Option<(f64, i32)> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (pu, pv) = (point[u], point[v]);
    let above = t.map(|p| p[v] > pv);
    if above[0] == above[1] && above[1] == above[2] {
        return None;
    }
    let mut winding = 0;
    for i in 0..3 {
        let j = (i + 1) % 3;
        if above[i] != above[j] {
            let (a, b) = if above[i] { (t[j], t[i]) } else { (t[i], t[j]) };
            let at = a[u] + (pv - a[v]) / (b[v] - a[v]) * (b[u] - a[u]);
            if at > pu {
                winding += if above[i] { 1 } else { -1 };
            }
        }
    }
    if winding == 0 {
        return None;
    }
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let along = (normal[u] * (t[0][u] - pu) + normal[v] * (t[0][v] - pv)) / normal[axis] + t[0][axis];
    let (lo, hi) = (t[0].min(t[1]).min(t[2])[axis], t[0].max(t[1]).max(t[2])[axis]);
    Some((if along.is_nan() { lo } else { along.clamp(lo, hi) }, winding))
}

impl Shape for TriMesh {
    fn bounds(&self) -> (DVec3, DVec3) {
        (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3())
    }

    fn touched(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        if let Some(cells) = self.surface_cells(grid) {
            cells.runs.iter().for_each(|&run| out(run));
        }
    }

    fn opaque(&self, grid: &Grid, out: &mut dyn FnMut(CellRun)) {
        if !self.solid {
            return;
        }
        let Some(cells) = self.surface_cells(grid) else { return };
        let crossed = cells.crossings(self.all_corners(), grid, |t, point| crossing(t, 0, point));
        cells.inside(grid, &crossed, |count, winding| self.is_behind((count, winding)), out);
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        let block = Block { min, max };
        if !self.solid || !Block::from(self.bounds).contains(&block) || self.surface_meets(&block) {
            return false;
        }
        let middle = (min + max) * 0.5;
        (0..3).all(|axis| self.is_behind(self.crossings_before(axis, middle)))
    }

    fn contains_point(&self, point: DVec3) -> bool {
        if !self.closed || !Block::from(self.bounds).contains_point(point) {
            return false;
        }
        (0..3).any(|axis| {
            let (count, winding) = self.crossings_before(axis, point);
            count % 2 == 1 || winding != 0 && self.surface.front.is_some()
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::{IVec3, Quat, UVec3};

    use super::*;
    use crate::grid::GridSpec;

    /// A box as twelve triangles.
    fn cuboid(min: Vec3, max: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corner = |i: u32| {
            let pick = |bit: u32, axis: usize| if i >> bit & 1 == 0 { min[axis] } else { max[axis] };
            Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        ((0..8).map(corner).collect(), triangles)
    }

    fn cells(shape: &dyn Shape, grid: &Grid, opaque: bool) -> BTreeSet<[i32; 3]> {
        let mut set = BTreeSet::new();
        let mut add = |run: CellRun| run.cells().for_each(|c| assert!(set.insert(c.to_array())));
        if opaque {
            shape.opaque(grid, &mut add)
        } else {
            shape.touched(grid, &mut add)
        }
        set
    }

    fn grid(cells: u32) -> Grid {
        Grid::new(&GridSpec { min: Vec3::ZERO, cell: 10.0 / cells as f32, dims: UVec3::splat(cells) })
            .unwrap()
    }

    #[test]
    fn a_closed_box_has_the_cells_of_the_box() {
        let (min, max) = (Vec3::new(1.3, 2.2, 3.1), Vec3::new(7.9, 8.0, 9.3));
        let (p, t) = cuboid(min, max);
        let mesh = TriMesh::new(p, t).unwrap();
        assert!(mesh.is_closed());
        let g = grid(20);
        let (opaque, of_box) = (cells(&mesh, &g, true), cells(&Aabb::new(min, max), &g, true));
        assert!(opaque.is_subset(&of_box) && opaque.len() * 10 > of_box.len() * 6, "{}", opaque.len());
        for c in &of_box {
            let (lo, hi) = g.cell_bounds(IVec3::from_array(*c));
            assert_eq!(mesh.contains_box(lo, hi), opaque.contains(c), "{c:?}");
        }
        assert!(cells(&mesh, &g, false).is_disjoint(&opaque));
        assert!(mesh.contains_point(DVec3::splat(5.0)) && !mesh.contains_point(DVec3::splat(1.0)));
    }

    #[test]
    fn a_hollow_shell_is_not_solid() {
        let (mut p, mut t) = cuboid(Vec3::splat(1.0), Vec3::splat(9.0));
        let (q, u) = cuboid(Vec3::splat(3.0), Vec3::splat(7.0));
        p.extend(q);
        t.extend(u.iter().map(|c| c.map(|v| v + 8)));
        let mesh = TriMesh::new(p, t).unwrap();
        let opaque = cells(&mesh, &grid(40), true);
        assert!(!opaque.is_empty() && !opaque.contains(&[20, 20, 20]));
        assert!(opaque.contains(&[8, 20, 20]));
    }

    #[test]
    fn an_open_box_touches_only() {
        let (p, mut t) = cuboid(Vec3::splat(1.0), Vec3::splat(9.0));
        t.pop();
        let mesh = TriMesh::new(p, t).unwrap();
        assert!(!mesh.is_closed());
        assert!(cells(&mesh, &grid(20), true).is_empty());
        assert!(!cells(&mesh, &grid(20), false).is_empty());
        assert!(!mesh.contains_point(DVec3::splat(5.0)));
    }

    /// A box turned about its middle.
    fn turned(center: Vec3, half: Vec3, turn: Quat) -> TriMesh {
        let (p, t) = cuboid(-half, half);
        TriMesh::new(p.iter().map(|&p| center + turn * p).collect(), t).unwrap()
    }

    /// A ring of square section around an axis along y.
    fn ring(n: u32) -> TriMesh {
        let section = [(2.0, 4.1), (3.9, 4.1), (3.9, 5.9), (2.0, 5.9)];
        let point = |i: u32, k: usize| {
            let angle = i as f32 / n as f32 * std::f32::consts::TAU;
            let (r, y) = section[k];
            Vec3::new(5.0 + r * angle.cos(), y, 5.0 + r * angle.sin())
        };
        let p = (0..n).flat_map(|i| (0..4).map(move |k| point(i, k))).collect();
        let at = |i: u32, k: u32| i % n * 4 + k % 4;
        let quad = |i: u32, k: u32| {
            let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
            [[a, b, c], [a, c, d]]
        };
        TriMesh::new(p, (0..n).flat_map(|i| (0..4).flat_map(move |k| quad(i, k))).collect()).unwrap()
    }

    #[test]
    fn cells_inside_are_those_of_the_solid() {
        // Inside the grid, out of it on every side, and around it.
        let mut centers = vec![(Vec3::splat(5.0), 3.0), (Vec3::splat(5.0), 30.0)];
        for axis in Vec3::AXES {
            centers.extend([-1.0, 11.0].map(|at| (Vec3::splat(5.0) * (1.0 - axis) + at * axis, 4.0)));
        }
        let mut count = 0;
        for (i, &(center, size)) in centers.iter().enumerate() {
            let half = Vec3::new(0.8, 1.0, 1.2) * size;
            let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, 0.5).normalize(), 0.3 + i as f32);
            let mesh = turned(center, half, turn);
            let g = grid(30);
            let (opaque, of_box) =
                (cells(&mesh, &g, true), cells(&crate::geometry::Obb::new(center, half, turn), &g, true));
            // Corners are rounded to single precision, so single cells may differ.
            let differ = opaque.symmetric_difference(&of_box).count();
            assert!(differ * 200 <= of_box.len(), "{center} {size}: {differ} of {}", of_box.len());
            assert!(opaque.is_disjoint(&cells(&mesh, &g, false)));
            for c in opaque.iter().chain(&of_box).step_by(7) {
                let (lo, hi) = g.cell_bounds(IVec3::from_array(*c));
                assert_eq!(mesh.contains_box(lo, hi), opaque.contains(c), "{c:?}");
            }
            count += opaque.len();
        }
        assert!(count > 30_000, "{count}");
    }

    #[test]
    fn cells_in_a_hole_are_not_inside() {
        let (mesh, g) = (ring(200), grid(40));
        let (opaque, touched) = (cells(&mesh, &g, true), cells(&mesh, &g, false));
        for i in 0..64_000 {
            let cell = IVec3::new(i % 40, i / 40 % 40, i / 1600);
            let (lo, hi) = g.cell_bounds(cell);
            let far = (hi - 5.0).abs().max((lo - 5.0).abs());
            let near = (lo - 5.0).max(5.0 - hi).max(DVec3::ZERO);
            let (most, least) = (far.with_y(0.0).length(), near.with_y(0.0).length());
            // The ring's sides are chords: they leave circles by less than this.
            let room = 0.01;
            let inside = least > 2.0 + room && most < 3.9 - room && lo.y > 4.11 && hi.y < 5.89;
            let outside = most < 2.0 - room || least > 3.9 + room || hi.y < 4.09 || lo.y > 5.91;
            let named = [opaque.contains(&cell.to_array()), touched.contains(&cell.to_array())];
            match (inside, outside) {
                (true, _) => assert_eq!(named, [true, false], "{cell}"),
                (_, true) => assert_eq!(named, [false, false], "{cell}"),
                _ => {}
            }
            assert_eq!(mesh.surface_meets(&Block::new((lo, hi))), named[1], "{cell}");
            assert_eq!(mesh.contains_box(lo, hi), named[0], "{cell}");
            let at = (lo + hi) * 0.5;
            assert!(!named[0] || mesh.contains_point(at));
            assert!(!outside || !mesh.contains_point(at));
        }
        assert!(opaque.len() > 2000, "{}", opaque.len());
    }

    #[test]
    fn cells_are_held_for_one_grid_only() {
        let (mesh, g) = (ring(20), grid(20));
        let held = mesh.hold_cells(&g);
        let one = mesh.surface_cells(&g).unwrap();
        assert!(Arc::ptr_eq(&one, &mesh.surface_cells(&g).unwrap()));
        let other = mesh.surface_cells(&grid(30)).unwrap();
        assert!(other.runs.len() > one.runs.len());
        drop(held);
        let again = mesh.surface_cells(&g).unwrap();
        assert!(!Arc::ptr_eq(&one, &again) && one.runs == again.runs);
    }

    #[test]
    fn what_is_bounds_only_hides_nothing_and_takes_less() {
        let full = Arc::new(ring(200));
        let bounds = TriMesh::bounds_only(full.positions.clone(), full.triangles.clone()).unwrap();
        let bounds = Arc::new(bounds);
        assert!(full.occludes() && !bounds.occludes() && bounds.is_closed());
        assert_eq!((bounds.patches(), bounds.sides()), (0, 0));
        assert!(bounds.memory_bytes() < full.memory_bytes());
        let g = grid(20);
        assert_eq!(cells(&*bounds, &g, false), cells(&*full, &g, false));
        assert!(cells(&*bounds, &g, true).is_empty());

        let spec = GridSpec { min: Vec3::ZERO, cell: 0.5, dims: UVec3::splat(20) };
        let mut scene = crate::scene::Scene::new(&spec).unwrap();
        let place = glam::Affine3A::from_rotation_y(0.2);
        let instance = crate::mesh::instance::Instance::new(bounds.clone(), place).unwrap();
        let id = scene.insert(crate::object::ObjectDesc::dynamic(instance.clone())).unwrap();
        for occluder in [crate::object::Occluder::from(bounds.clone()), instance.clone().into()] {
            let desc = crate::object::ObjectDesc::fixed(bounds.clone()).occluder(occluder.clone());
            assert_eq!(scene.insert(desc).unwrap_err(), Error::BoundsOnly);
            assert_eq!(scene.update(id, instance.clone(), Some(occluder)), Err(Error::BoundsOnly));
        }
        assert!(scene.insert(crate::object::ObjectDesc::fixed(bounds)).is_ok());
    }

    #[test]
    fn memory_counts_what_is_held() {
        let mesh = ring(2000);
        let before = mesh.memory_bytes();
        assert!(before > mesh.positions.len() * 12 + mesh.triangles.len() * 12 + mesh.sides() * 33);
        assert!(mesh.contains_point(DVec3::new(8.0, 5.0, 5.0)));
        assert!(mesh.memory_bytes() > before + mesh.triangles.len() * 4);
    }

    #[test]
    fn refuses_broken_meshes() {
        assert_eq!(TriMesh::new(vec![], vec![]).unwrap_err(), Error::EmptyMesh);
        let one = vec![Vec3::ZERO; 3];
        let missing = TriMesh::new(one.clone(), vec![[0, 1, 3]]).unwrap_err();
        assert_eq!(missing, Error::MeshIndex { triangle: 0, vertex: 3, vertices: 3 });
        assert!(TriMesh::new(vec![Vec3::NAN; 3], vec![[0, 1, 2]]).is_err());
        let point = TriMesh::new(one, vec![[0, 1, 2]]).unwrap();
        assert!(!point.is_closed());
        assert_eq!(cells(&point, &grid(10), false).len(), 1);
    }
}
