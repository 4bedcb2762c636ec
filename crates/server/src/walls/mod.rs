//! Walls: upright or level rectangles of the level that nothing sees or goes through.
//!
//! - **They hide.** Let an eye be anywhere in a convex set E on one side of a wall, and a point
//!   anywhere in a box T on the other side. The points that the wall hides from one eye are a
//!   convex set, and so are the eyes from which it hides one point: cones behind the wall. So all
//!   of T is hidden from all of E if the cone of each corner of T holds E. No eye or entity needs
//!   to be sampled, and the wall does not shrink.
//! - **They stop.** Where a wall covers all of the cross section of the box around an eye or an
//!   entity, neither gets to its other side: the box ends there.

mod find;
mod rectangles;
mod tree;
mod wall;

use casca::glam::DVec3;
use casca::{ObjectId, Scene};

use find::find;
use tree::Tree;
use wall::Wall;
pub(crate) use wall::{Eyes, Span};

/// The walls of a level.
#[derive(Debug, Default)]
pub(crate) struct Walls {
    walls: Vec<Wall>,
    tree: Tree,
}

/// Each wall may make another one stop a box that did not: so often they are asked.
const ROUNDS: usize = 3;

impl Walls {
    /// The walls of a level, but for the objects that `leaves_out` tells. Costs some passes over
    /// all triangles.
    pub(crate) fn of(level: &Scene, leaves_out: impl Fn(ObjectId) -> bool) -> Self {
        Self::new(find(level, leaves_out))
    }

    fn new(mut walls: Vec<Wall>) -> Self {
        let tree = Tree::new(&mut walls);
        Self { walls, tree }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.walls.len()
    }

    /// Whether one of them lies between two places.
    pub(crate) fn part(&self, from: DVec3, to: DVec3) -> bool {
        self.tree.along(from, to, |i| self.walls[i].meets(from, to))
    }

    /// The part of a box that can be reached from a part of it.
    pub(crate) fn reached(&self, from: &Span, mut span: Span) -> Span {
        for _ in 0..ROUNDS {
            let mut changed = false;
            self.tree.touching(&span.clone(), |i| changed |= self.walls[i].stops(from, &mut span));
            if !changed {
                break;
            }
        }
        span
    }

    /// Whether one of the walls hides all of a box from all eyes. `hint` is the wall that did so
    /// last time, which is tried first; it decides nothing.
    pub(crate) fn hide(&self, eyes: &Eyes, target: &Span, hint: &mut u32) -> bool {
        if self.walls.get(*hint as usize).is_some_and(|wall| wall.hides(eyes, target)) {
            return true;
        }
        let (from, to) = ((eyes.span.min + eyes.span.max) * 0.5, (target.min + target.max) * 0.5);
        self.tree.along(from, to, |i| {
            let wall = &self.walls[i];
            let hides = wall.meets(from, to) && wall.hides(eyes, target);
            if hides {
                *hint = i as u32;
            }
            hides
        })
    }
}

#[cfg(test)]
mod tests;
