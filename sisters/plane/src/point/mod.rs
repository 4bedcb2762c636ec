//! Exact visibility from a point.
//!
//! 1. [`walk`]: the cells around the eye are walked in chessboard shells, front to back (thesis,
//!    section 3.3.3). The objects in them are found, and the sides of their occluders. Walls close
//!    directions ([`covers`]); only cells in open directions ([`shells`]) are visited, so that the
//!    cost follows the visible part of the scene.
//! 2. [`envelope`]: the nearest wall in each direction, by exact comparisons ([`wall`]).
//! 3. [`region`]: each object found is compared with the visible region.
//!
//! # What is visible
//!
//! Occluders are closed sets. A point is visible if it lies in the closure of the set of points
//! that a set of directions of positive angle reaches. So rays that only graze do not count, two
//! walls that touch in a point let nothing through, and a wall that the eye lies on, which covers
//! no angle, hides nothing. From the border of a solid one cannot see into it. A solid that
//! surrounds the eye hides nothing.

mod arcs;
mod blocked;
mod bounds;
mod covers;
mod envelope;
mod layers;
mod outline;
mod region;
mod shells;
mod target;
mod walk;
mod wall;

#[cfg(test)]
mod tests;

use glam::{DVec2, Vec2};

use crate::geometry::Shape;
use crate::geometry::block::Block;
use crate::point::arcs::{Arcs, Circle};
use crate::point::bounds::Bounds;
use crate::point::envelope::Envelope;
use crate::point::region::Region;
use crate::point::walk::Walk;
use crate::point::wall::Around;
use crate::pvs::Pvs;
use crate::scene::{Object, Scene};
use crate::view::View;

/// The memory of a query: the visible region of its last run.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sight {
    walk: Walk,
    envelope: Envelope,
    bounds: Bounds,
    view: Option<(View, Circle)>,
    /// By place in the walk: whether a wall that is all of an object is the nearest somewhere.
    shown: Vec<bool>,
    /// A block around the grid, the objects and the eye, with room for a cell.
    extent: Option<Block>,
}

impl Sight {
    /// Finds the visible region and the objects that meet it.
    pub(crate) fn run(&mut self, scene: &Scene, view: &View, pvs: &mut Pvs) {
        let (circle, arcs) = self.start(scene, view);
        self.walk.run(scene, view, &circle, &arcs, &mut pvs.stats);
        let around = Around::new(&circle, &self.walk.walls);
        self.envelope.build(&around, &arcs, &self.walk.blocked);
        pvs.stats.segments = self.walk.walls.len() as u32;
        pvs.stats.pieces = self.envelope.steps.len() as u32;
        mark_shown(&mut self.shown, &self.walk, &self.envelope, view);
        // Blocks around the pieces cost as much as to compare something with each.
        let rest = self.walk.found.iter().zip(&self.shown).filter(|(_, shown)| !**shown);
        let rest = rest.filter_map(|(&slot, _)| scene.object(slot));
        let share: f64 = rest.map(|object| share_of_turn(circle.eye, &object.bounds.block())).sum();
        self.bounds.clear();
        if share > 1.0 {
            self.bounds.build(&around, self.envelope.pieces());
        }
        let region = self.region(view, &circle);
        for (&slot, &shown) in self.walk.found.iter().zip(&self.shown) {
            pvs.stats.objects_tested += 1;
            let meets = |object: &Object| region.meets(&object.bounds);
            if shown || scene.object(slot).is_some_and(meets) {
                pvs.push(scene.id(slot));
            }
        }
    }

    fn start(&mut self, scene: &Scene, view: &View) -> (Circle, Arcs) {
        let circle = Circle::new(view.eye());
        self.view = Some((*view, circle));
        let grid = Block { min: scene.grid().min(), max: scene.grid().max() }.with(view.eye());
        let outer = scene.outer().iter().filter_map(|&slot| scene.object(slot));
        let Block { min, max } = outer.fold(grid, |all, object| {
            let block = object.bounds.block();
            all.with(block.min).with(block.max)
        });
        let room = scene.grid().cell_size();
        self.extent = Some(Block { min: min - room, max: max + room });
        let arcs = match view.sides() {
            Some([first, last]) => arcs::between(&circle, first, last).collect(),
            None => arcs::whole(&circle),
        };
        (circle, arcs)
    }

    fn region<'a>(&'a self, view: &View, circle: &'a Circle) -> Region<'a> {
        let around = Around::new(circle, &self.walk.walls);
        Region::new(around, &self.envelope, &self.bounds, view.range())
    }

    /// Whether a point belongs to the visible region; `false` before the first run.
    pub(crate) fn sees_point(&self, point: DVec2) -> bool {
        point.is_finite()
            && self.view.as_ref().is_some_and(|(view, circle)| self.region(view, circle).contains(point))
    }

    /// Whether a shape meets the visible region; `false` before the first run.
    pub(crate) fn sees(&self, shape: &Shape) -> bool {
        self.view.as_ref().is_some_and(|(view, circle)| self.region(view, circle).meets(shape))
    }

    /// The corners of the visible region.
    pub(crate) fn polygon(&self) -> Vec<Vec2> {
        match (&self.view, &self.extent) {
            (Some((view, circle)), Some(extent)) => {
                let whole = view.direction().is_none();
                outline::polygon(&self.region(view, circle), whole, view.range(), extent)
            }
            _ => Vec::new(),
        }
    }
}

/// Marks the objects of which some wall is the nearest somewhere, and all of the object: they are
/// seen, and need no comparison. Not with a range, which may end before them.
fn mark_shown(shown: &mut Vec<bool>, walk: &Walk, envelope: &Envelope, view: &View) {
    shown.clear();
    shown.resize(walk.found.len(), false);
    if view.range().is_some() {
        return;
    }
    for step in &envelope.steps {
        let wall = walk.walls.get(step.wall as usize);
        let owner = wall.and_then(|wall| shown.get_mut(wall.owner as usize));
        owner.into_iter().for_each(|shown| *shown = true);
    }
}

/// About which share of a turn something in a block takes up.
fn share_of_turn(eye: DVec2, block: &Block) -> f64 {
    let off = (eye.clamp(block.min, block.max) - eye).length();
    let size = (block.max - block.min).length();
    // Not a number where the eye touches a point.
    let share = size / (size + 6.0 * off);
    if share.is_nan() { 1.0 } else { share }
}
