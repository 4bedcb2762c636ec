//! Patches of surfaces ready to be drawn.

use glam::DVec3;

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::mesh::surface::{PatchIndex, PatchNumber, PatchOutline, PatchSide, Surface};

/// A patch to be drawn, relative to the origin of the rays.
#[derive(Debug, Clone)]
pub(crate) struct Drawable<'a> {
    pub(crate) surface: &'a Surface,
    /// Where the surface stands, if it is an instance.
    pub(crate) placement: Option<&'a Placement>,
    pub(crate) patch: PatchIndex,
    /// The number of the patch in the order of first drawing.
    pub(crate) id: u32,
    /// Its number among all patches of the scene. Those of one surface follow each other.
    pub(crate) number: PatchNumber,
    /// Patches of other surfaces at the open sides of this one: (side, number of the patch, whether
    /// the two run along it in opposite directions), in order of sides.
    pub(crate) links: &'a [(u32, PatchNumber, bool)],
    /// A box around it.
    pub(crate) block: Block,
    /// All of it lies where `lo <= normal . x <= hi`.
    pub(crate) normal: DVec3,
    pub(crate) slab: (f64, f64),
    /// Whether its lower side counts as turned to the eye, so that its winding numbers change sign.
    pub(crate) turned: bool,
    /// Whether every triangle of it is known to be turned to the eye with the same side. Without
    /// meaning where the eye may not go from its place.
    pub(crate) faces_eye: bool,
    /// Its points may be this far from where the surface says.
    pub(crate) error: f64,
}

impl<'a> Drawable<'a> {
    /// The patch beyond a side of its outline, which is given with its number: the number of the
    /// patch, and whether the two run along the side in opposite directions.
    #[inline]
    pub(crate) fn beyond(&self, number: u32, side: &PatchSide) -> Option<(PatchNumber, bool)> {
        let twin = side.twin();
        if twin != PatchIndex::NONE {
            return Some((self.number.base(self.patch).of(twin), side.opposite()));
        }
        if self.links.is_empty() {
            return None;
        }
        let link = self.links.get(self.links.partition_point(|l| l.0 < number))?;
        (link.0 == number).then_some((link.1, link.2))
    }

    /// The sides of its outline, with their numbers.
    #[inline]
    pub(crate) fn outline(&self) -> PatchOutline<'a> {
        self.surface.outline(self.patch)
    }

    /// Its number among all patches of the scene, and those of its parts.
    pub(crate) fn numbers(&self) -> std::ops::Range<PatchNumber> {
        let next = self.surface.next(self.patch);
        self.number..self.number.base(self.patch).of(next)
    }
}
