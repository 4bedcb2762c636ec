//! Patches of surfaces ready to be drawn.

use glam::DVec3;

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::mesh::surface::{NONE, Outline, Side, Surface};

/// A patch to be drawn, relative to the origin of the rays.
#[derive(Clone)]
pub(crate) struct Drawable<'a> {
    pub(crate) surface: &'a Surface,
    /// Where the surface stands, if it is an instance.
    pub(crate) placement: Option<&'a Placement>,
    pub(crate) patch: u32,
    /// The number of the patch in the order of first drawing. Without meaning where `again` is set.
    pub(crate) id: u32,
    /// Its number among all patches of the scene. Those of one surface follow each other.
    pub(crate) number: u32,
    /// Patches of other surfaces at the open sides of this one: (side, number of the patch, whether the two run
    /// along it in opposite directions), in order of sides.
    pub(crate) links: &'a [(u32, u32, bool)],
    /// A box around it.
    pub(crate) block: Block,
    /// All of it lies where `lo <= normal . x <= hi`.
    pub(crate) normal: DVec3,
    pub(crate) slab: (f64, f64),
    /// Whether it was drawn before, and only its seams with patches that were not are new.
    pub(crate) again: bool,
    /// Whether its lower side counts as turned to the eye, so that its winding numbers change sign.
    pub(crate) turned: bool,
    /// Its points may be this far from where the surface says.
    pub(crate) error: f64,
}

impl<'a> Drawable<'a> {
    /// The sides of its outline, and of the patch beyond each: its number, and whether the two run along the side
    /// in opposite directions.
    pub(crate) fn sides(&self) -> impl Iterator<Item = (&'a Side, Option<(u32, bool)>)> {
        let base = self.number - self.patch;
        let outline = self.outline();
        let first = outline.clone().next().map_or(0, |(index, _)| index);
        let mut links = self.links[self.links.partition_point(|l| l.0 < first)..].iter().peekable();
        outline.map(move |(index, side)| {
            if side.twin != NONE {
                return (side, Some((base + side.twin, side.opposite)));
            }
            while links.next_if(|l| l.0 < index).is_some() {}
            (side, links.next_if(|l| l.0 == index).map(|l| (l.1, l.2)))
        })
    }

    /// The sides of its outline, with their numbers.
    #[inline]
    pub(crate) fn outline(&self) -> Outline<'a> {
        self.surface.outline(self.patch)
    }

    /// Its number among all patches of the scene, and those of its parts.
    pub(crate) fn numbers(&self) -> std::ops::Range<u32> {
        let next = self.surface.patches[self.patch as usize].next;
        self.number..self.number + (next - self.patch)
    }
}
