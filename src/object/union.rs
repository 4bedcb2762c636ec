//! Unions of solids.

use crate::geometry::Block;
use crate::object::Occluder;

/// A block is cut into pieces at this many boxes, at most.
const BUDGET: u32 = 64;

/// Whether the union of solids wholly contains a block; in doubt, no.
///
/// Boxes are cut off exactly, so walls of abutting boxes are solid across their
/// seams; the rest must lie inside one of the other solids.
pub(crate) fn union_contains(block: &Block, solids: &[&Occluder]) -> bool {
    fn covered(block: &Block, solids: &[&Occluder], budget: &mut u32) -> bool {
        if solids.iter().any(|s| s.kind().contains_box(block.min, block.max)) {
            return true;
        }
        if *budget == 0 {
            return false;
        }
        *budget -= 1;
        let cutter = solids.iter().find_map(|s| s.kind().as_block().filter(|b| b.overlaps(block)));
        let Some(cut) = cutter else { return false };
        // Slabs of the block outside the box, axis by axis; the rest lies inside it.
        let mut rest = *block;
        for axis in 0..3 {
            if rest.min[axis] < cut.min[axis] {
                let mut slab = rest;
                slab.max[axis] = cut.min[axis];
                rest.min[axis] = cut.min[axis];
                if !covered(&slab, solids, budget) {
                    return false;
                }
            }
            if rest.max[axis] > cut.max[axis] {
                let mut slab = rest;
                slab.min[axis] = cut.max[axis];
                rest.max[axis] = cut.max[axis];
                if !covered(&slab, solids, budget) {
                    return false;
                }
            }
        }
        true
    }
    covered(block, solids, &mut { BUDGET })
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::geometry::{Aabb, Sphere};

    #[test]
    fn abutting_boxes_are_solid_across_their_seam() {
        let a = Occluder::from(Aabb::new(Vec3::ZERO, Vec3::new(0.37, 2.0, 2.0)));
        let b = Occluder::from(Aabb::new(Vec3::new(0.37, 0.0, 0.0), Vec3::splat(2.0)));
        let gap = Occluder::from(Aabb::new(Vec3::new(0.3701, 0.0, 0.0), Vec3::splat(2.0)));
        let block = Block { min: DVec3::splat(0.1), max: DVec3::splat(1.0) };
        assert!(!union_contains(&block, &[&a]));
        assert!(union_contains(&block, &[&a, &b]));
        assert!(!union_contains(&block, &[&a, &gap]));
        let ball = Occluder::from(Sphere::new(Vec3::splat(0.5), 0.9));
        assert!(union_contains(&block, &[&a, &gap, &ball]));
        let thin = Block { min: DVec3::splat(0.1), max: DVec3::new(1.9, 0.2, 0.2) };
        let low = Occluder::from(Sphere::new(Vec3::new(1.2, 0.1, 0.1), 0.9));
        assert!(union_contains(&thin, &[&a, &low]));
    }
}
