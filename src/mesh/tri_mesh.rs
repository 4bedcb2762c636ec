//! Triangle meshes, checked and prepared once.

use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

use glam::{DVec3, Vec3};

use crate::error::{Error, finite3};
use crate::geometry::Aabb;
use crate::grid::Grid;
use crate::heap::in_arc;
use crate::mesh::cells::{CachedCells, CellCache};
use crate::mesh::convex::convex_solid;
use crate::mesh::index::Index;
use crate::mesh::inner::{Inner, inner_solid};
use crate::mesh::parts;
use crate::mesh::preparation::{Facing, MeshOptions, Progress};
use crate::mesh::shell::{MeshShells, may_have_shells, open_shells};
use crate::mesh::surface::{Surface, Topology, Welded};
use crate::shape::convex::Convex;

/// The most triangles of a mesh: three edges for each, twice, are numbered by 32 bits.
const MAX_TRIANGLES: usize = 1 << 29;

/// Refuses more triangles than can be numbered.
fn check_size(triangles: usize) -> Result<(), Error> {
    match triangles {
        0..=MAX_TRIANGLES => Ok(()),
        _ => Err(Error::MeshTooLarge { triangles, max: MAX_TRIANGLES }),
    }
}

/// A triangle mesh, checked and prepared once, to serve as bounds and as occluder.
///
/// # Use
///
/// [`TriMesh::new`] takes positions and triangles in world units, open or closed. Objects share it
/// by an `Arc`: as it is, for geometry that stands in world space, or as an
/// [`Instance`](crate::Instance) with a transform for each object. [`TriMesh::bounds_only`] makes a
/// mesh that is tested and hides nothing, and [`TriMesh::prepare`] takes
/// [`MeshOptions`](crate::MeshOptions) and tells its progress. [`TriMesh::write`] and
/// [`TriMesh::read`] store what was prepared.
///
/// ```
/// use std::sync::Arc;
///
/// use casca::{Instance, ObjectDesc, Query, Scene, Sphere, TriMesh, View};
/// use glam::{Affine3A, UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// // A square of 8 by 8 units across x: two triangles that hide from both sides.
/// let corners = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)];
/// let positions = corners.map(|(y, z)| Vec3::new(0.0, y, z)).to_vec();
/// let square = Arc::new(TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])?);
/// assert!(square.occludes() && !square.is_closed());
///
/// let mut scene = Scene::new(1.0)?;
/// let at = Affine3A::from_translation(Vec3::splat(8.0));
/// let wall = Instance::new(square, at)?;
/// let wall = scene.insert(ObjectDesc::fixed(wall.clone()).occluder(wall))?;
/// let ball = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(12.0, 8.0, 8.0), 0.5)))?;
/// let mut query = Query::new();
/// let pvs = query.run(&scene, &View::omnidirectional(Vec3::new(4.0, 8.0, 8.0))?);
/// assert!(pvs.contains(wall) && !pvs.contains(ball));
/// # Ok(())
/// # }
/// ```
///
/// # Cost
///
/// Preparation sorts the triangles a few times: about a second for a million, once; half to four
/// microseconds for each triangle of small meshes. A mesh takes 24 to 225 bytes a triangle, and one
/// of a few triangles 1 to 7 kB ([`TriMesh::memory_bytes`]). A query draws it as patches of
/// triangles that face nearly one way, by their outlines: large flat parts cost little, foliage
/// much.
///
/// # Guarantees
///
/// It hides no more than its triangles do, wherever these are and however they are wound: what an
/// outline simplifies is a margin when it is drawn. The same triangles give the same mesh on every
/// machine and with any number of threads. Triangles of no area hide nothing and are kept.
///
/// # Pitfalls
///
/// - Transparent and alpha-tested triangles must not occlude: leave them out of the occluder.
/// - Skinned meshes change their triangles: give them boxes as bounds
///   ([`crate::Scene::set_bounds`]), and a simple solid as occluder.
/// - One mesh for a whole level is one object, visible as soon as any part of it is. Cut it up.
#[derive(Debug, Clone)]
pub struct TriMesh {
    pub(crate) positions: Arc<[Vec3]>,
    pub(crate) triangles: Arc<[[u32; 3]]>,
    pub(crate) bounds: Aabb,
    pub(crate) closed: bool,
    /// Whether it can have opaque cells.
    pub(crate) solid: bool,
    /// Whether it may hide others: else its surface is empty.
    pub(crate) occludes: bool,
    pub(crate) surface: Surface,
    pub(crate) parts: Vec<Convex>,
    /// A solid hardly smaller than the mesh, if that is convex and can be seen from outside.
    convex: Option<Convex>,
    /// A solid inside the mesh, if that is closed but has no hardly smaller one.
    inner: Option<Inner>,
    /// Solids in convex pieces that are open on one side.
    shells: MeshShells,
    pub(crate) middle: DVec3,
    /// Made when it is first asked.
    pub(crate) index: OnceLock<Index>,
    pub(crate) cells: CellCache,
}

impl TriMesh {
    /// Takes positions in world units and triangles as indices of three positions, and prepares
    /// them as [`MeshOptions::default`] says. Vertices at equal positions count as one.
    ///
    /// Costs a few sorts of the triangles: about a second for a million.
    ///
    /// # Errors
    /// Refuses an empty mesh, one of more than 2^29 triangles, positions that are not finite and
    /// indices of missing vertices.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        Self::prepare(positions, triangles, &MeshOptions::default(), &mut |_| ControlFlow::Continue(()))
    }

    /// As [`TriMesh::new`], for an object that hides nothing: the mesh is prepared to be tested
    /// only (see [`MeshOptions::occludes`]).
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
        let how = MeshOptions { occludes: false, ..MeshOptions::default() };
        Self::prepare(positions, triangles, &how, &mut |_| ControlFlow::Continue(()))
    }

    /// As [`TriMesh::new`], prepared as asked. `progress` is told the share of the work that is
    /// done, from 0 to 1, on the thread that called. Where it answers [`ControlFlow::Break`], the
    /// preparation ends: soon, but not at once.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use casca::{Error, MeshOptions, TriMesh};
    /// use glam::Vec3;
    ///
    /// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    /// let late = |share: f32| if share < 0.5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    /// let mesh = TriMesh::prepare(corners, vec![[0, 1, 2]], &MeshOptions::default(), &mut { late });
    /// assert_eq!(mesh.err(), Some(Error::Cancelled));
    /// ```
    ///
    /// # Errors
    /// As [`TriMesh::new`]; also settings that are not finite or out of their range, and
    /// [`Error::Cancelled`] if `progress` ended it.
    pub fn prepare(
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        how: &MeshOptions,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Self, Error> {
        check_size(triangles.len())?;
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= positions.len()) {
                return Err(Error::MeshIndex { triangle, vertex, vertices: positions.len() });
            }
        }
        positions.iter().try_for_each(|&p| finite3("a mesh position", p))?;
        let corners = triangles.iter().flatten().map(|&v| positions[v as usize]);
        let bounds = Aabb::from_points(corners).ok_or(Error::EmptyMesh)?;
        let rules = how.rules((bounds.max.as_dvec3() - bounds.min.as_dvec3()).length())?;
        let mut progress = Progress::new(progress);
        progress.tell(0.0)?;
        let welded = Welded::new(&positions, &triangles);
        let topology = welded.topology;
        progress.tell(0.2)?;
        let surface = match how.occludes {
            true => Surface::of(&welded, &rules, &mut progress.part(0.2, 0.9))?,
            false => Surface::default(),
        };
        let parts = parts::parts(&positions, &triangles);
        let Welded { first, .. } = welded;
        progress.tell(1.0)?;
        let flags = (topology, how.occludes);
        Ok(Self::from_prepared(positions, triangles, &first, bounds, flags, surface, parts))
    }

    /// The mesh from its prepared parts; the rest of its fields follow from those. `first` names
    /// the first position that is equal to each; the flag says whether it hides others.
    pub(crate) fn from_prepared(
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        first: &[u32],
        bounds: Aabb,
        (topology, occludes): (Topology, bool),
        mut surface: Surface,
        parts: Vec<Convex>,
    ) -> Self {
        let closed = topology.closed;
        let alike = topology.alike && occludes;
        let solid = closed && occludes && (!surface.front || alike);
        surface.outward = if alike { signed_volume(&positions, &triangles).signum() } else { 0.0 };
        let from_outside = !surface.front || surface.outward > 0.0;
        let convex =
            from_outside.then(|| convex_solid(&positions, &triangles, surface.outward, 0.0)).flatten();
        let inner = match convex {
            None if from_outside => {
                inner_solid(&positions, &triangles, bounds, surface.outward, surface.front)
            }
            _ => None,
        };
        let shells = match occludes && !closed && !surface.front && may_have_shells(&triangles) {
            true => open_shells(&positions, &triangles, first),
            false => MeshShells::default(),
        };
        let middle = middle_of(&parts);
        let positions: Arc<[Vec3]> = positions.into();
        surface.positions = positions.clone();
        let triangles: Arc<[[u32; 3]]> = triangles.into();
        let (index, cells) = (OnceLock::new(), CellCache::default());
        Self {
            positions,
            triangles,
            bounds,
            closed,
            solid,
            occludes,
            surface,
            parts,
            convex,
            inner,
            shells,
            middle,
            index,
            cells,
        }
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

    /// Whether it was prepared to hide others (see [`MeshOptions::occludes`]).
    pub fn occludes(&self) -> bool {
        self.occludes
    }

    /// From which sides its triangles hide (see [`MeshOptions::facing`]).
    pub fn facing(&self) -> Facing {
        if self.surface.front { Facing::Front } else { Facing::Both }
    }

    /// Bytes on the heap. Some of them are taken only once they are
    /// needed: an index of the triangles, when it is first asked whether something lies inside.
    pub fn memory_bytes(&self) -> usize {
        in_arc::<[Vec3; 0]>()
            + size_of_val(&*self.positions)
            + in_arc::<[[u32; 3]; 0]>()
            + size_of_val(&*self.triangles)
            + self.surface.bytes()
            + self.parts.capacity() * size_of::<Convex>()
            + self.convex.as_ref().map_or(0, Convex::memory_bytes)
            + self.inner.as_ref().map_or(0, |inner| inner.solid.memory_bytes())
            + self.shells.solids.capacity() * size_of::<Convex>()
            + self.parts.iter().chain(&self.shells.solids).map(Convex::memory_bytes).sum::<usize>()
            + self.index.get().map_or(0, Index::bytes)
            + self.cells.bytes()
    }

    /// How many patches of triangles are kept for hiding, without the groups that they are drawn in
    /// from afar.
    pub fn patches(&self) -> usize {
        self.surface.leaves()
    }

    /// How many sides the outlines of all patches have. Drawing the mesh as an occluder costs the
    /// sides that are in sight, not its triangles; from afar, those of groups of patches, which are
    /// fewer.
    pub fn sides(&self) -> usize {
        self.surface.sides.len()
    }

    /// Convex solids that together contain the mesh.
    pub(crate) fn parts(&self) -> &[Convex] {
        &self.parts
    }

    /// A point of the largest of those.
    pub(crate) fn middle(&self) -> DVec3 {
        self.middle
    }

    /// A solid inside the mesh and hardly smaller, to be drawn in place of the triangles for eyes
    /// outside.
    pub(crate) fn convex(&self) -> Option<&Convex> {
        self.convex.as_ref()
    }

    /// Solids inside convex pieces that are open on one side: each line through one meets the mesh,
    /// within the hull of that piece.
    pub(crate) fn shells(&self) -> &MeshShells {
        &self.shells
    }

    /// A solid inside the mesh that may be much smaller, to be drawn in place of the triangles from
    /// afar.
    pub(crate) fn inner(&self) -> Option<&Inner> {
        self.inner.as_ref()
    }

    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }

    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize].as_dvec3())
    }

    pub(crate) fn all_corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        (0..self.triangles.len() as u32).map(|t| self.corners(t))
    }

    pub(crate) fn index(&self) -> &Index {
        let corners = |t: u32| self.triangles[t as usize].map(|v| self.positions[v as usize]);
        self.index.get_or_init(|| Index::new(self.triangles.len(), &corners))
    }

    /// While the result lives, the mesh's cells in a grid are found once, and then known.
    pub(crate) fn cache_cells(&self, grid: &Grid) -> Arc<CachedCells> {
        self.cells.cache(grid)
    }
}

/// Six times the volume inside a closed surface: positive if its triangles run counter-clockwise
/// seen from outside.
fn signed_volume(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let Some(&first) = positions.first() else { return 0.0 };
    let at = |v: u32| positions[v as usize].as_dvec3() - first.as_dvec3();
    triangles.iter().map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2])))).sum()
}

/// A point of the first, which is the largest.
fn middle_of(parts: &[Convex]) -> DVec3 {
    parts.first().map_or(DVec3::ZERO, Convex::middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_triangles_than_can_be_numbered_are_refused() {
        assert_eq!(check_size(MAX_TRIANGLES), Ok(()));
        let triangles = MAX_TRIANGLES + 1;
        assert_eq!(check_size(triangles), Err(Error::MeshTooLarge { triangles, max: MAX_TRIANGLES }));
        let numbered = MAX_TRIANGLES as u64 * 3 * 2;
        assert!(numbered < u64::from(u32::MAX), "edges in both directions have 32 bits");
    }
}
