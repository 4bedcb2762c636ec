//! The triangles of objects, in cells.

use std::sync::Arc;

use glam::{DVec3, IVec3, Vec3};

use crate::clip::{Polygon, cross, inside, point_of};
use crate::input::{Material, Object, Triangle};
use crate::lattice::Lattice;
use crate::numeric::{FARTHEST, LEAST_AREA, SEAL};
use crate::texture::{Skin, Texture};

/// A triangle in cells.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    pub(crate) corners: [DVec3; 3],
    /// Unit normal of the front.
    pub(crate) normal: DVec3,
    pub(crate) area: f64,
    pub(crate) material: u32,
    pub(crate) object: u32,
    /// Of its material.
    pub(crate) albedo: Vec3,
    pub(crate) emits: bool,
    /// Its texture, if it has one.
    pub(crate) skin: Option<Arc<Skin>>,
}

impl Surface {
    /// One without a texture.
    pub(crate) fn new(corners: [DVec3; 3], material: u32, object: u32, of: &Material) -> Option<Self> {
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let area = 0.5 * cross.length();
        let normal = cross.try_normalize().filter(|_| area > LEAST_AREA && area.is_finite())?;
        let (albedo, emits) = (of.albedo, of.emits());
        Some(Self { corners, normal, area, material, object, albedo, emits, skin: None })
    }

    /// The barycentric coordinates of the second and the third corner at a point in its plane.
    pub(crate) fn shares(&self, point: DVec3) -> [f64; 2] {
        let [a, b, c] = self.corners;
        // Shares of the area.
        [(point - a).cross(c - a), (b - a).cross(point - a)].map(|v| v.dot(self.normal) / (2.0 * self.area))
    }

    /// The albedo of a part of it, without holes, and the share of the part that is solid.
    pub(crate) fn over(&self, part: impl FnOnce() -> Polygon, key: u64) -> (Vec3, f32) {
        let Some(skin) = &self.skin else { return (self.albedo, 1.0) };
        let part = part();
        let area = 0.5 * cross(&part).length();
        let at = |share: f64, across| self.shares(point_of(&part, share * area, across));
        let (mean, solid) = skin.texture.over(skin.uv, area / self.area, key, at);
        (mean * self.albedo, solid)
    }

    /// The mean albedo of what is solid of it, and the share of that.
    pub(crate) fn mean(&self) -> (Vec3, f32) {
        self.skin.as_ref().map_or((self.albedo, 1.0), |skin| (skin.mean * self.albedo, skin.solid))
    }

    /// Whether it is the same triangle.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let kind = |s: &Self| (s.material, s.object, s.skin.as_ref().map(|skin| skin.uv));
        self.corners == other.corners && kind(self) == kind(other)
    }

    /// How far barycentric coordinates on it may be below 0: [`SEAL`] beyond its edges.
    pub(crate) fn slack(&self) -> [f64; 3] {
        let [a, b, c] = self.corners;
        // A height on an edge is twice the area over its length.
        [b.distance(c), c.distance(a), a.distance(b)].map(|edge| SEAL * edge / (2.0 * self.area))
    }

    pub(crate) fn polygon(&self) -> Polygon {
        self.corners.into_iter().collect()
    }

    /// The polygon in cells of which so many are along an edge of one of the grid.
    pub(crate) fn scaled(&self, fine: f64) -> Polygon {
        self.corners.into_iter().map(|p| p * fine).collect()
    }
}

/// Triangles that were not taken, or not whole.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Left out: those with a corner that is not finite or more than 2^30 cells away, where single
    /// precision places no plane; without an area; and wholly outside of the grid.
    pub left_out: usize,
    /// Of which only the part inside of the grid counts.
    pub cut: usize,
}

/// The triangles of objects that can be lit.
pub(crate) fn surfaces(
    objects: &[Object],
    (materials, textures): (&[Material], &[Texture]),
    lattice: &Lattice,
    skipped: &mut Skipped,
) -> Vec<Surface> {
    let mut all = Vec::new();
    for (object, o) in (0..).zip(objects) {
        for (i, t) in o.triangles.iter().enumerate() {
            let material = &materials[t.material as usize];
            let Some((mut surface, is_cut)) = surface(t, object, material, lattice) else {
                skipped.left_out += 1;
                continue;
            };
            skipped.cut += usize::from(is_cut);
            let texture = material.texture.zip(o.uv.get(i));
            surface.skin = texture.map(|(t, uv)| Arc::new(Skin::new(&textures[t as usize], *uv)));
            all.push(surface);
        }
    }
    all
}

/// A triangle that can be lit, and whether a part of it lies outside of the grid.
fn surface(t: &Triangle, object: u32, of: &Material, lattice: &Lattice) -> Option<(Surface, bool)> {
    let corners = t.corners.map(|p| lattice.cells(p));
    // Not true of NaN.
    let is_near = |p: &DVec3| p.abs().cmple(DVec3::splat(FARTHEST)).all();
    if !corners.iter().all(is_near) {
        return None;
    }
    let surface = Surface::new(corners, t.material, object, of)?;
    let high = lattice.dims.as_dvec3();
    let is_in = |p: &DVec3| p.cmpge(DVec3::ZERO).all() && p.cmple(high).all();
    let is_cut = !corners.iter().all(is_in);
    let is_outside = is_cut && inside(&surface.polygon(), IVec3::ZERO, lattice.dims, 0.0).is_empty();
    (!is_outside).then_some((surface, is_cut))
}
