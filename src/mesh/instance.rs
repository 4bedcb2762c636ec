//! Instances: meshes under a transform. An instance moves by its transform; the prepared mesh is
//! shared.

use crate::error::Error;
use crate::geometry::offset::Offset;
use crate::geometry::placement::Placement;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::{Part, Polytope};
use crate::geometry::{Aabb, Block};
use crate::grid::Grid;
use crate::heap::in_arc;
use crate::mesh::tri_mesh::TriMesh;
use crate::numeric::mesh::MOST_GROWTH;
use crate::numeric::shape::{LENGTH_OF_ERROR, MOST_PULL};
use crate::shape::convex::Convex;
use crate::shape::kind::Kind;
use crate::shape::{Shape, Which};
use std::sync::{Arc, OnceLock};

use glam::{Affine3A, DVec3, IVec3, Vec3, Vec3A};

/// A mesh turned, scaled and moved: the way to move one without preparing it again. Its cells are
/// those of its bounding box, and none of them is opaque.
///
/// ```
/// use std::sync::Arc;
///
/// use casca::{Instance, ObjectDesc, TriMesh};
/// use glam::{Affine3A, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let leaf = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
/// let door = Instance::new(Arc::new(leaf), Affine3A::from_rotation_y(0.5))?;
/// let desc = ObjectDesc::dynamic(door.clone()).occluder(door);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Instance {
    /// Apart, so that shapes stay small.
    inner: Arc<InstanceData>,
}

#[derive(Debug)]
struct InstanceData {
    mesh: Arc<TriMesh>,
    transform: Affine3A,
    placement: Placement,
    /// What is not known of the offset of that.
    error: f64,
    block: Block,
    solids: Solids,
}

/// The solids of an instance as placed, each kind found when a query first asks for it: moving
/// instances are new in each frame, and most instances are hidden and never asked.
///
/// They are relative to the middle of the instance's box, so that moving them to the eye rounds no
/// more than subtracting it from each corner would.
#[derive(Debug, Default)]
struct Solids {
    /// With the distance by which the mesh reaches beyond its faces at most.
    convex: OnceLock<Option<Box<(Polytope, f64)>>>,
    inner: OnceLock<Option<Box<Polytope>>>,
    /// As of convex meshes.
    shells: OnceLock<Box<[(Polytope, f64)]>>,
    parts: OnceLock<Box<[Polytope]>>,
}

impl Solids {
    /// Bytes on the heap, but for the lists of polytopes of many faces.
    fn memory_bytes(&self) -> usize {
        let convex = self.convex.get().is_some_and(Option::is_some);
        let inner = self.inner.get().is_some_and(Option::is_some);
        let parts = self.parts.get().map_or(0, |parts| parts.len());
        let shells = self.shells.get().map_or(0, |shells| shells.len());
        (usize::from(convex) + usize::from(inner) + parts + shells) * size_of::<Polytope>()
    }
}

impl Instance {
    /// The mesh under a transform.
    ///
    /// Costs the corners of the solids that the mesh is tested by: some tens.
    ///
    /// # Errors
    /// Refuses transforms that are not finite, or lead to coordinates that are not in single
    /// precision.
    pub fn new(mesh: Arc<TriMesh>, transform: Affine3A) -> Result<Self, Error> {
        Self::carried(mesh, transform, &Offset::NONE)
    }

    /// The mesh under a transform, in coordinates that differ by an offset from those that it leads
    /// to. The offset is not rounded to single precision; [`Instance::transform`] is.
    ///
    /// # Errors
    /// As [`Instance::new`].
    pub(crate) fn carried(
        mesh: Arc<TriMesh>,
        mut transform: Affine3A,
        offset: &Offset,
    ) -> Result<Self, Error> {
        let vertices = || mesh.parts().iter().flat_map(|part| part.vertices());
        let largest = vertices().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        let placement = Placement::new("a mesh as transformed", transform, largest, offset)?;
        transform.translation = placement.affine.translation.as_vec3a();
        let Placement { affine, error, .. } = placement;
        let block = Block::around(vertices().map(|v| affine.transform_point3(v))).grown(error);
        let solids = Solids::default();
        Ok(Self {
            inner: Arc::new(InstanceData { mesh, transform, placement, error: offset.error, block, solids }),
        })
    }

    /// The mesh.
    pub fn mesh(&self) -> &Arc<TriMesh> {
        &self.inner.mesh
    }

    /// From the space of the mesh to world space.
    pub fn transform(&self) -> Affine3A {
        self.inner.transform
    }

    /// The same mesh, moved by an offset in world units, rounded to single precision.
    ///
    /// # Errors
    /// As [`Instance::new`].
    pub fn translated(&self, offset: Vec3) -> Result<Self, Error> {
        let mut transform = self.inner.transform;
        transform.translation += Vec3A::from(offset);
        Self::new(self.inner.mesh.clone(), transform)
    }

    /// The box of its triangles in world units, rounded outwards; with room for a renderer that
    /// transforms their corners in single precision. Infinite where it ends beyond the range of
    /// that. Costs the triangles.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use casca::{Instance, TriMesh};
    /// use glam::{Affine3A, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let leaf = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
    /// let leaf = Instance::new(Arc::new(leaf), Affine3A::from_scale(Vec3::splat(2.0)))?;
    /// assert!(leaf.aabb().contains(Vec3::X * 2.0) && leaf.aabb().max.max_element() < 2.001);
    /// # Ok(())
    /// # }
    /// ```
    pub fn aabb(&self) -> Aabb {
        self.least_block().grown(self.inner.placement.error).to_aabb()
    }

    /// What is not known of the offset of its placement.
    pub(crate) fn error(&self) -> f64 {
        self.inner.error
    }

    pub(crate) fn placement(&self) -> &Placement {
        &self.inner.placement
    }

    /// The place that its solids are relative to.
    fn middle(&self) -> DVec3 {
        (self.inner.block.min + self.inner.block.max) * 0.5
    }

    /// The solids that it is tested by, relative to an origin.
    fn parts_from(&self, origin: DVec3) -> impl Iterator<Item = Polytope> {
        let Placement { affine, error, .. } = self.inner.placement;
        self.inner.mesh.parts().iter().map(move |part| {
            let placed = self.placed(part, origin, f64::max);
            // Room for single precision: all faces move out by as much at least.
            let scaled = placed.map(|p| (1.0 + 2.0 * error / p.depth, p));
            match scaled.filter(|(scale, _)| (1.0..MOST_GROWTH).contains(scale)) {
                Some((scale, placed)) => placed.scaled(scale),
                // Flattened, or thin: only its box is known.
                None => {
                    let corners = part.vertices().map(|v| affine.transform_point3(v) - origin);
                    Polytope::block(&Block::around(corners).grown(error))
                }
            }
        })
    }

    /// The solids that it is tested by, relative to its middle.
    fn placed_parts(&self) -> &[Polytope] {
        self.inner.solids.parts.get_or_init(|| self.parts_from(self.middle()).collect())
    }

    /// A solid inside the mesh and hardly smaller, relative to an origin, if the mesh is convex;
    /// with a distance by which the mesh reaches beyond its faces at most.
    pub(crate) fn convex_from(&self, origin: DVec3) -> Option<(Part<'_>, f64)> {
        let convex = self.inner.mesh.convex()?;
        let place = || self.solid_from(convex, self.middle()).map(Box::new);
        let (solid, beyond) = self.inner.solids.convex.get_or_init(place).as_deref()?;
        Some((solid.part(self.middle(), origin), *beyond))
    }

    /// A solid inside the mesh that may be much smaller, relative to an origin.
    pub(crate) fn inner_from(&self, origin: DVec3) -> Option<Part<'_>> {
        let inner = self.inner.mesh.inner()?;
        let place = || Some(Box::new(self.solid_from(&inner.solid, self.middle())?.0));
        let solid = self.inner.solids.inner.get_or_init(place).as_deref()?;
        Some(solid.part(self.middle(), origin))
    }

    /// Solids inside pieces that are open on one side, relative to an origin; with distances by
    /// which the pieces reach beyond their faces at most.
    pub(crate) fn shells_from(&self, origin: DVec3) -> impl Iterator<Item = (Part<'_>, f64)> {
        let place = || {
            let shells = self.inner.mesh.shells().solids.iter();
            shells.filter_map(|shell| self.solid_from(shell, self.middle())).collect()
        };
        let placed = self.inner.solids.shells.get_or_init(place);
        placed.iter().map(move |(solid, beyond)| (solid.part(self.middle(), origin), *beyond))
    }

    /// A convex solid inside the mesh as placed, relative to an origin.
    fn solid_from(&self, convex: &Convex, origin: DVec3) -> Option<(Polytope, f64)> {
        let (mesh, placement) = (&self.inner.mesh, &self.inner.placement);
        // Unequal scales turn no front away from a ray that enters; a mirror turns all.
        if mesh.surface().front && placement.mirrors {
            return None;
        }
        let placed = self.placed(convex, origin, f64::min)?;
        // A ball of the pull times the depth around each point as pulled lies in the solid as
        // placed.
        let room = LENGTH_OF_ERROR * placement.error;
        let pull = room / placed.depth;
        if !(0.0..MOST_PULL).contains(&pull) {
            return None;
        }
        let farthest = placed.polytope.vertices.iter().map(|v| v.distance(placed.center)).fold(0.0, f64::max);
        let beyond = convex.lost * placement.growth + 2.0 * room + pull * farthest;
        Some((placed.scaled(1.0 - pull), beyond))
    }

    /// A convex solid of the mesh as placed, relative to an origin. Its faces pass through the
    /// corner that `choose` takes: the outermost one (the greatest offset) or the innermost one.
    /// `None` if the transform flattens space, or leaves the middle not clearly inside.
    fn placed(&self, part: &Convex, origin: DVec3, choose: fn(f64, f64) -> f64) -> Option<PlacedConvex> {
        let Placement { affine, normals, .. } = self.inner.placement;
        let normals = normals?;
        let mut polytope = part.seen_from(DVec3::ZERO);
        for v in &mut polytope.vertices {
            *v = affine.transform_point3(*v) - origin;
        }
        let center = polytope.vertices.iter().sum::<DVec3>() / polytope.vertices.len().max(1) as f64;
        for face in &mut polytope.faces {
            *face = HalfSpace { normal: (normals * face.normal).normalize_or_zero(), offset: f64::NAN };
        }
        for &[a, b, f, g] in &polytope.edges {
            for (face, v) in [(f, a), (f, b), (g, a), (g, b)] {
                let face = &mut polytope.faces[usize::from(face)];
                let own = -face.normal.dot(polytope.vertices[usize::from(v)]);
                // The first corner takes the place of no number.
                face.offset = if face.offset.is_nan() { own } else { choose(face.offset, own) };
            }
        }
        let mut depth = f64::INFINITY;
        for face in &polytope.faces {
            let distance = face.distance(center);
            // Also if it is NaN, which `min` would ignore.
            if distance.is_nan() || distance <= 0.0 {
                return None;
            }
            depth = depth.min(distance);
        }
        Some(PlacedConvex { polytope, center, depth })
    }
}

/// A convex solid as placed.
struct PlacedConvex {
    polytope: Polytope,
    /// The mean of its corners.
    center: DVec3,
    /// How far that is from the nearest face.
    depth: f64,
}

impl PlacedConvex {
    /// The solid, scaled about its center.
    fn scaled(self, scale: f64) -> Polytope {
        let Self { mut polytope, center, .. } = self;
        for v in &mut polytope.vertices {
            *v = center + (*v - center) * scale;
        }
        for face in &mut polytope.faces {
            let middle = -face.normal.dot(center);
            face.offset = middle + (face.offset - middle) * scale;
        }
        polytope
    }
}

impl Shape for Instance {
    fn bounds(&self) -> (DVec3, DVec3) {
        (self.inner.block.min, self.inner.block.max)
    }

    fn contains_box(&self, _: DVec3, _: DVec3) -> bool {
        false
    }

    fn contains_point(&self, _: DVec3) -> bool {
        false
    }

    /// It fills none, as its mesh may be open.
    fn corners(&self, grid: &Grid, which: Which) -> Option<(IVec3, IVec3)> {
        let (min, max) = self.bounds();
        Some(if which == Which::Touched { grid.cover(min, max) } else { (IVec3::ONE, IVec3::ZERO) })
    }

    fn fills(&self, min: DVec3, max: DVec3) -> bool {
        Block::new(self.bounds()).contains(&Block { min, max })
    }
}

impl PartialEq for Instance {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(self.mesh(), other.mesh()) && self.placement() == other.placement()
    }
}

impl Kind for Instance {
    fn check_hides(&self) -> Result<(), Error> {
        self.mesh().check_hides()
    }

    fn same(&self, other: &Self) -> bool {
        self == other
    }

    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        self.translated(offset).map(Some)
    }

    fn shared(&self, out: &mut dyn FnMut(*const u8, usize)) {
        out(Arc::as_ptr(&self.inner).cast(), in_arc::<InstanceData>() + self.inner.solids.memory_bytes());
        self.mesh().shared(out);
    }

    fn least_block(&self) -> Block {
        let affine = &self.inner.placement.affine;
        let corners = self.mesh().all_corners().flatten().map(|p| affine.transform_point3(p));
        Block::around(corners)
    }

    fn is_solid(&self) -> bool {
        false
    }

    fn middle_of_parts(&self) -> Option<DVec3> {
        Some(self.placement().affine.transform_point3(self.mesh().middle()))
    }

    fn all_parts(&self, origin: DVec3, test: &mut dyn FnMut(&Part) -> bool) -> Option<bool> {
        Some(self.placed_parts().iter().all(|part| test(&part.part(self.middle(), origin))))
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::random::Random;

    /// A ball of eight triangles.
    fn octahedron() -> Arc<TriMesh> {
        let corners = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        Arc::new(TriMesh::new(corners.to_vec(), faces.to_vec()).unwrap())
    }

    /// Whether two polytopes are the same but for the rounding of coordinates of this size.
    fn alike(a: &Polytope, b: &Polytope, largest: f64) -> bool {
        let near = |v: f64| v.abs() <= 1e-14 * largest;
        a.edges == b.edges
            && a.vertices.len() == b.vertices.len()
            && a.vertices.iter().zip(&b.vertices).all(|(p, q)| near((*p - *q).abs().max_element()))
            && a.faces.len() == b.faces.len()
            && a.faces.iter().zip(&b.faces).all(|(f, g)| f.normal == g.normal && near(f.offset - g.offset))
    }

    #[test]
    fn solids_placed_once_are_those_placed_for_each_eye() {
        let mesh = octahedron();
        let mut random = Random::new(5);
        for _ in 0..50 {
            let turn = Quat::from_axis_angle(Vec3::ONE.normalize(), random.next() as f32 * 6.0);
            let scale = 0.1 + 3.0 * random.next() as f32;
            let at = random.point(1000.0).as_vec3();
            let place = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn, at);
            let instance = Instance::new(mesh.clone(), place).unwrap();
            for _ in 0..4 {
                let eye = random.point(1000.0);
                let direct = instance.solid_from(mesh.convex().unwrap(), eye).unwrap();
                let kept = instance.convex_from(eye).unwrap();
                assert!(
                    alike(&kept.0.polytope(), &direct.0, 3000.0) && (kept.1 - direct.1).abs() < 1e-11,
                    "{place:?}"
                );
                let parts: Vec<Polytope> = instance.parts_from(eye).collect();
                let mut asked = 0;
                let all = instance.all_parts(eye, &mut |part| {
                    asked += 1;
                    alike(&part.polytope(), &parts[asked - 1], 3000.0)
                });
                assert_eq!((all, asked), (Some(true), parts.len()));
            }
        }
    }
}
