//! The opacity matrices O and Os, for each mask of layers apart.
//!
//! A view on some layers must not be told that a cell is opaque for the sake of an object that it
//! does not show. So the cells that occluders fill are kept apart by the layers of their objects,
//! and solids are joined only with solids on the same layers. A scene whose occluders are all on
//! the same layers has one part, as if there were no layers.

use std::num::NonZeroU8;

use glam::IVec3;

use crate::grid::mask::Mask;
use crate::matrix::bits::{BitMatrix, OpacityMatrix};
use crate::matrix::counts::OpaqueCells;
use crate::object::ALL_LAYERS;
use crate::scene::reports::Overdue;

/// Occluders on more masks of layers than this at a time fill no cells. Each part takes a word for
/// each 64x64x64 cells of the grid and matrix, and each query asks all parts that its view shows.
pub(crate) const MOST_PARTS: usize = 16;

/// The place of a part in the list of a scene, counted from 1: an option of it is a byte, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct OpacityPart(NonZeroU8);

impl OpacityPart {
    fn new(at: usize) -> Self {
        Self(NonZeroU8::MIN.saturating_add(at as u8))
    }

    fn at(self) -> usize {
        usize::from(self.0.get()) - 1
    }
}

/// The opaque cells of the occluders with one mask of layers.
#[derive(Clone)]
pub(crate) struct LayerOpacity {
    layers: u64,
    /// How many occluders are in it. Without any it can be given to another mask.
    occluders: u32,
    /// Those that are reported on expiry: while any is overdue, O is Os.
    pub(super) on_expiry: Overdue,
    /// Os, the opaque cells of static objects.
    pub(super) fixed: OpaqueCells,
    /// The cells that listed dynamic objects add to Os to make O.
    pub(super) moving: OpaqueCells,
    /// Those cells of Os that several objects fill together, and none alone.
    pub(super) joint: BitMatrix,
}

impl LayerOpacity {
    fn new(layers: u64) -> Self {
        let (fixed, moving, joint) = Default::default();
        Self { layers, occluders: 0, on_expiry: Overdue::default(), fixed, moving, joint }
    }

    /// The layers that its occluders are on.
    pub(crate) fn layers(&self) -> u64 {
        self.layers
    }

    /// Os: the opaque cells of static objects.
    #[inline]
    pub(crate) fn fixed(&self) -> &OpacityMatrix {
        self.fixed.bits()
    }

    /// The opaque cells of listed dynamic objects, also of those of unknown place.
    pub(crate) fn moving(&self) -> &OpacityMatrix {
        self.moving.bits()
    }

    /// As [`LayerOpacity::moving`], unless the place of one of those is unknown.
    pub(crate) fn known_moving(&self) -> Option<&OpacityMatrix> {
        (self.on_expiry.count() == 0).then_some(self.moving.bits())
    }

    /// Whether a cell is opaque.
    pub(crate) fn is_opaque(&self, cell: IVec3) -> bool {
        self.fixed().get(cell) || self.known_moving().is_some_and(|o| o.get(cell))
    }

    /// Static occluders fill a cell together.
    pub(super) fn join_fixed(&mut self, cell: IVec3) {
        self.fixed.set(cell);
        self.joint.set(cell);
    }

    /// Static occluders fill these cells of a brick together no longer.
    pub(super) fn part_fixed(&mut self, brick: IVec3, mask: &Mask) {
        self.fixed.take(brick, mask);
        self.joint.clear_mask(brick, mask);
    }

    fn bytes(&self) -> usize {
        self.fixed.bytes() + self.moving.bytes() + self.joint.bytes()
    }
}

/// The opaque cells of a scene: never without a part.
#[derive(Clone)]
pub(super) struct Opacity(Vec<LayerOpacity>);

impl Opacity {
    pub(super) fn new() -> Self {
        Self(vec![LayerOpacity::new(ALL_LAYERS)])
    }

    pub(super) fn parts(&self) -> &[LayerOpacity] {
        &self.0
    }

    pub(super) fn part_mut(&mut self, part: OpacityPart) -> &mut LayerOpacity {
        &mut self.0[part.at()]
    }

    /// The part for an occluder on some layers, which is now in it; none if no view shows it, or if
    /// there are too many masks.
    pub(super) fn join(&mut self, layers: u64) -> Option<OpacityPart> {
        if layers == 0 {
            return None;
        }
        let of_mask = self.0.iter().position(|part| part.layers == layers);
        let idle = || self.0.iter().position(|part| part.occluders == 0);
        let at = of_mask.or_else(idle).unwrap_or(self.0.len());
        if at == MOST_PARTS {
            return None;
        }
        if at == self.0.len() {
            self.0.push(LayerOpacity::new(layers));
        } else if self.0[at].layers != layers {
            self.0[at] = LayerOpacity::new(layers);
        }
        self.0[at].occluders += 1;
        Some(OpacityPart::new(at))
    }

    /// An occluder leaves its part. Its cells are cleared.
    pub(super) fn leave(&mut self, part: OpacityPart) {
        self.part_mut(part).occluders -= 1;
    }

    /// The clock moves.
    pub(super) fn clock_moved(&mut self) {
        self.0.iter_mut().for_each(|part| part.on_expiry.clock_moved());
    }

    /// How many occluders of unknown place there are.
    #[cfg(test)]
    pub(super) fn overdue(&self) -> usize {
        self.0.iter().map(|part| part.on_expiry.count()).sum()
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<LayerOpacity>() + self.0.iter().map(LayerOpacity::bytes).sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_given_to_another_mask_when_its_last_occluder_left() {
        let mut opacity = Opacity::new();
        let one = opacity.join(1).unwrap();
        assert_eq!((opacity.join(1), opacity.parts().len()), (Some(one), 1), "the idle part is used");
        let two = opacity.join(2).unwrap();
        assert!(one != two && opacity.join(0).is_none());
        opacity.leave(one);
        assert_ne!(opacity.join(4), Some(one), "one occluder is left");
        opacity.leave(one);
        assert_eq!(opacity.join(8), Some(one));
        assert_eq!(opacity.part_mut(one).layers(), 8);
    }

    #[test]
    fn so_many_masks_have_parts() {
        let mut opacity = Opacity::new();
        let parts: Vec<_> = (0..MOST_PARTS as u32).map(|bit| opacity.join(1 << bit).unwrap()).collect();
        assert!(opacity.join(1 << 40).is_none());
        assert_eq!(opacity.join(1), Some(parts[0]));
        opacity.leave(parts[5]);
        assert_eq!(opacity.join(1 << 40), Some(parts[5]));
    }
}
