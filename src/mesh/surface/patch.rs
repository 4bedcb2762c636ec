//! Patches, their sides and clusters: the prepared surface of a mesh.

use glam::{DVec3, Vec3};

use crate::geometry::Block;

/// No patch, or none that can be told.
pub(crate) const NONE: u32 = u32::MAX;

/// A side of a patch's outline: straight, in place of a chain of edges of triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Side {
    pub(crate) from: Vec3,
    pub(crate) to: Vec3,
    /// No point of the chain is farther from it.
    pub(crate) slack: f32,
    /// The patch on the other side, if there is just one.
    pub(crate) twin: u32,
    /// Whether that runs along it in the opposite direction, so that the two cancel.
    pub(crate) opposite: bool,
}

/// Neighbouring triangles of nearly one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Patch {
    /// Its outline: a range of the list of sides.
    pub(crate) first: u32,
    pub(crate) last: u32,
    /// All of it lies where `lo <= normal . x <= hi`.
    pub(crate) normal: DVec3,
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    /// A box around it.
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
    /// The greatest slack of its sides.
    pub(crate) slack: f32,
}

/// Patches that lie together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cluster {
    pub(crate) first: u32,
    pub(crate) last: u32,
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

/// The outlines of triangles, to hide other objects with.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Surface {
    pub(crate) sides: Vec<Side>,
    pub(crate) patches: Vec<Patch>,
    pub(crate) clusters: Vec<Cluster>,
    /// If triangles hide from their front only, the sine of the greatest angle in a patch.
    pub(crate) front: Option<f64>,
    /// Sides with one patch only, and a number that tells their chains apart.
    pub(crate) open: Vec<(u32, u64)>,
}

/// How triangles become patches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rules {
    /// Outlines may leave the edges of triangles by this.
    pub(crate) tolerance: f64,
    /// The greatest angle between the normals of a patch and its first triangle, as a cosine.
    pub(crate) cosine: f64,
    /// Patches of a smaller radius are left out.
    pub(crate) least: f64,
    /// Whether triangles hide from their front only.
    pub(crate) front: bool,
}

impl Surface {
    /// Bytes on the heap.
    pub(crate) fn bytes(&self) -> usize {
        self.sides.capacity() * size_of::<Side>()
            + self.patches.capacity() * size_of::<Patch>()
            + self.clusters.capacity() * size_of::<Cluster>()
            + self.open.capacity() * size_of::<(u32, u64)>()
    }

    /// The sides of a patch.
    pub(crate) fn outline(&self, patch: &Patch) -> &[Side] {
        &self.sides[patch.first as usize..patch.last as usize]
    }
}

/// About half the width of a box.
pub(crate) fn radius(min: Vec3, max: Vec3) -> f64 {
    f64::from((max - min).length()) * 0.5
}

/// The greatest slack of sides.
pub(crate) fn slack(sides: &[Side]) -> f32 {
    sides.iter().map(|s| s.slack).fold(0.0, f32::max)
}

impl Patch {
    pub(crate) fn block(&self) -> Block {
        Block { min: self.min.as_dvec3(), max: self.max.as_dvec3() }
    }
}

impl Cluster {
    /// The cluster of a range of patches.
    pub(crate) fn new(first: u32, last: u32, patches: &[Patch]) -> Self {
        let own = &patches[first as usize..last as usize];
        Self {
            first,
            last,
            min: own.iter().fold(Vec3::INFINITY, |m, p| m.min(p.min)),
            max: own.iter().fold(Vec3::NEG_INFINITY, |m, p| m.max(p.max)),
        }
    }

    pub(crate) fn block(&self) -> Block {
        Block { min: self.min.as_dvec3(), max: self.max.as_dvec3() }
    }
}
