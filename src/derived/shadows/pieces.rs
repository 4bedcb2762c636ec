//! Pieces: the parts of receivers that the camera may see and the light may reach.

use smallvec::SmallVec;

use crate::derived::shadows::light::Lamp;
use crate::geometry::Block;
use crate::numeric::shape::{OCCLUDER_ROUNDING, REGION};
use crate::pvs::Pvs;
use crate::query::receivers::{BoxPart, ReceiverScratch};
use crate::query::sight::Sight;
use crate::scene::{Object, Scene};

/// Parts are not cut that appear smaller than this: longest edge over distance, 0.05 is about three
/// degrees.
const SMALLEST: f64 = 0.05;

/// Nor along edges shorter than this many cells.
const SHORTEST: f64 = 1.0;

/// The boxes of all receivers together are cut at most this often, the largest in the picture
/// first.
const MOST_CUTS: usize = 2048;

/// Appends boxes that together contain every point that the camera sees, of objects in its set, and
/// that one of the lights reaches; false if such a point may be anywhere.
pub(super) fn find_pieces(
    scene: &Scene,
    receivers: &Pvs,
    sight: Option<Sight>,
    lamps: &[Lamp],
    scratch: &mut ReceiverScratch,
) -> bool {
    let ReceiverScratch { parts, pieces, .. } = scratch;
    parts.clear();
    let Some(sight) = sight else { return true };
    let cell = scene.grid().cell_size();
    let size =
        |block: &Block| (block.max - block.min).max_element() / distance(&sight, block, scene).max(cell);
    for &id in receivers.visible() {
        let Ok(object) = scene.find(id) else { continue };
        if scene.is_unlocated(id.slot()) {
            return false;
        }
        for block in visible_boxes(object, &sight) {
            let Some(block) = lit(lamps, &block).filter(|block| sight.may_see(block)) else { continue };
            parts.push(BoxPart { size: size(&block), slot: id.slot(), block });
        }
    }
    let mut cuts = 0;
    while let Some(part) = parts.pop() {
        let edges = part.block.max - part.block.min;
        let axis = edges.max_position();
        // What is not a number is not cut.
        let large = part.size > SMALLEST && edges[axis] > SHORTEST * cell;
        if !large || cuts == MOST_CUTS {
            pieces.push(part.block);
            continue;
        }
        cuts += 1;
        let object = scene.object(part.slot);
        for half in halves(&part.block, axis) {
            let Some(block) = lit(lamps, &half) else { continue };
            if sight.may_see(&block) && reaches_into(object, &block) {
                parts.push(BoxPart { size: size(&block), block, ..part });
            }
        }
    }
    true
}

/// A box around the parts of a box that the lights may reach; `None` if none of them reaches it.
fn lit(lamps: &[Lamp], block: &Block) -> Option<Block> {
    lamps.iter().filter_map(|lamp| lamp.lit(block)).reduce(Block::join)
}

/// Boxes that together contain all visible points of an object whose place is known.
///
/// For a solid box seen from outside, these are the sides that rays may run into, with a little
/// thickness for the rounding of applications. The whole box of a ground would reach below the foot
/// of a wall, into pixels that only the ground itself covers, at a depth that tiles know roughly:
/// the buffers would leave it undecided far behind the wall.
fn visible_boxes(object: &Object, sight: &Sight) -> SmallVec<[Block; 3]> {
    if let Some(volume) = object.unreported_volume() {
        return SmallVec::from_iter([*volume]);
    }
    let block = object.bounds().block();
    let solid = object.bounds().kind().as_block().is_some()
        && object.occluder().is_some_and(|o| o.kind().as_block() == Some(block) && !sight.may_start_in(o));
    if !solid {
        return SmallVec::from_iter([block]);
    }
    let thickness = OCCLUDER_ROUNDING * block.min.abs().max(block.max.abs()).max_element();
    let mut sides = SmallVec::new();
    for axis in 0..3 {
        let (low, high) = (block.min[axis], block.max[axis]);
        if sight.may_enter(axis, -1.0, low) {
            let mut side = block;
            side.max[axis] = high.min(low + thickness);
            sides.push(side);
        }
        if sight.may_enter(axis, 1.0, high) {
            let mut side = block;
            side.min[axis] = low.max(high - thickness);
            sides.push(side);
        }
    }
    sides
}

/// Both halves of a box, cut across an axis. They share the cut.
fn halves(block: &Block, axis: usize) -> [Block; 2] {
    let middle = (block.min[axis] + block.max[axis]) * 0.5;
    let (mut low, mut high) = (*block, *block);
    (low.max[axis], high.min[axis]) = (middle, middle);
    [low, high]
}

/// How far a box is from the eye. For parallel rays, as if from an eye that sees the whole scene.
fn distance(sight: &Sight, block: &Block, scene: &Scene) -> f64 {
    match sight.view.eye() {
        Some(eye) => block.distance_from(eye),
        None => {
            let (min, max) = scene.extent();
            (max - min).max_element()
        }
    }
}

/// Whether geometry of an object may lie in a part of its box; in doubt, yes.
fn reaches_into(object: &Object, block: &Block) -> bool {
    if object.unreported_volume().is_some() {
        return true;
    }
    let by = REGION * (1.0 + block.min.abs().max(block.max.abs()).max_element());
    let around = Block { min: block.min - by, max: block.max + by };
    object.bounds().kind().may_meet(&[], &around)
}
