//! Occluders around the eye and before the near plane: through those one sees.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::grid::cell_box::{CellBox, volume};
use crate::grid::clip;
use crate::object::Occluder;
use crate::scene::Scene;
use crate::view::{View, cut};

/// Beyond this many cells before the near plane all occluders are asked instead.
const MOST_CELLS: u64 = 4096;

/// After this many questions to the objects of single bricks, all objects are asked once instead.
const MOST_ASKED: usize = 4096;

/// Whether a point may lie inside an occluder that is in the matrices and that views of some
/// layers show.
pub(crate) fn inside_occluder(scene: &Scene, point: DVec3, layers: u64) -> bool {
    let cell = scene.grid().cell_of(point);
    let around = Block { min: point, max: point };
    let contains = |slot| {
        let occluder = shown_occluder(scene, slot, layers);
        occluder.is_some_and(|o| o.block().may_meet(&around) && o.kind().contains_point(point))
    };
    scene.always().iter().copied().any(contains)
        || scene.is_opaque(cell, layers)
        || scene.id_matrix().in_brick(cell >> 3i32).any(contains)
}

/// The occluder of an object that views of some layers show.
fn shown_occluder(scene: &Scene, slot: Slot, layers: u64) -> Option<&Occluder> {
    let object = scene.object(slot);
    object.occluder().filter(|_| object.layers & layers != 0)
}

/// Whether an occluder, or an opaque cell, that the view `region` shows may touch it. `region`
/// is convex and lies inside the box `around`.
pub(crate) fn occluder_touches(scene: &Scene, region: &View, around: &Block) -> bool {
    let layers = region.layers();
    let touches =
        |slot: Slot| shown_occluder(scene, slot, layers).is_some_and(|o| cut::may_meet(o, region, around));
    let always = || scene.always().iter().any(|&slot| touches(slot));
    let (lo, hi) = scene.grid().cover(around.min, around.max);
    let Some((lo, hi)) = clip(lo, hi) else { return always() };
    let anywhere = || scene.living().any(|(slot, _)| touches(slot));
    if volume(lo, hi) > MOST_CELLS {
        return anywhere();
    }
    if always() {
        return true;
    }
    let mut asked = 0;
    let opaque =
        |c| scene.is_opaque(c, layers) && region.may_see_block(&Block::new(scene.grid().cell_bounds(c)));
    if (CellBox { lo, hi }).cells().any(opaque) {
        return true;
    }
    for brick in (CellBox { lo, hi }).bricks().cells() {
        if scene.id_matrix().in_brick(brick).inspect(|_| asked += 1).any(touches) {
            return true;
        }
        // Objects that share many of these bricks would be asked again in each.
        if asked > scene.len().max(MOST_ASKED) {
            return anywhere();
        }
    }
    false
}
