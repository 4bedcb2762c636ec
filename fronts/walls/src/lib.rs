//! The walls of a level: upright or level rectangles that nothing sees or goes through.
//!
//! - **They hide.** Let an eye be anywhere in a convex set E on one side of a wall, and a point
//!   anywhere in a box T on the other side. The points that the wall hides from one eye are a
//!   convex set, and so are the eyes from which it hides one point: cones behind the wall. So all
//!   of T is hidden from all of E if the cone of each corner of T holds E. No eye or point needs
//!   to be sampled, and the wall does not shrink, as occluders do for [`casca::View::with_reach`].
//! - **They hide together.** If no wall alone hides T from E, one of the two is divided where that
//!   helps a wall between them most, and each part is asked about: [`Walls::hide_in_parts`].
//! - **They stop.** Where a wall covers all of the cross section of the box around an eye or an
//!   entity, neither gets to its other side: the box ends there.
//!
//! ```
//! use casca::glam::{DVec3, Vec3};
//! use casca::{Aabb, ObjectDesc, Scene};
//! use casca_walls::{Eyes, Span, Walls};
//!
//! # fn main() -> Result<(), casca::Error> {
//! let field = Aabb::new(Vec3::ZERO, Vec3::splat(32.0));
//! let mut level = Scene::new(1.0)?;
//! let wall = Aabb::new(Vec3::new(10.0, 0.0, 4.0), Vec3::new(10.5, 6.0, 28.0));
//! level.insert(ObjectDesc::fixed(wall).occluder(wall))?;
//!
//! let walls = Walls::of(&level, 0.5);
//! // Two metres of a street, and a car behind the wall.
//! let eyes = Eyes::cuboid(Span { min: DVec3::new(2.0, 1.0, 15.0), max: DVec3::new(4.0, 2.0, 17.0) });
//! let car = |z| Span { min: DVec3::new(14.0, 0.0, z), max: DVec3::new(16.0, 1.5, z + 4.0) };
//! let mut hint = 0;
//! assert!(walls.hide(&eyes, &car(14.0), 0.0, &mut hint));
//! assert!(!walls.hide(&eyes, &car(40.0), 0.0, &mut hint));
//! # Ok(())
//! # }
//! ```
//!
//! # Limits
//!
//! Walls are rectangles of what the sides of boxes, or triangles of meshes, cover in a plane across
//! an axis. Round, turned and slanted occluders are left to casca's queries. Static objects count
//! that are on all layers. What lies in the plane of a wall may be on either side of it: the wall
//! neither hides it nor stops it, and hides nothing from it. Planes in which corners have more than
//! 1,500 coordinates along an axis are left out, since their lattice is too large.
#![deny(missing_docs)]

mod find;
mod region;
mod tree;
mod wall;

use casca::Scene;
use casca::glam::DVec3;

use find::find;
use tree::Tree;
use wall::{Cut, Wall};
pub use wall::{Eyes, Span};

/// The walls of a level.
#[derive(Debug, Default)]
pub struct Walls {
    walls: Vec<Wall>,
    tree: Tree,
}

/// Each wall may make another one stop a box that did not: so often they are asked.
const ROUNDS: usize = 3;

/// Eyes and a target are divided up to so often together: in 4,096 parts each if that goes along
/// one axis.
const MOST_DIVISIONS: u32 = 24;

/// What is known of the walls on the segment between the middles of eyes and a target.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Found {
    /// There is none.
    None,
    /// None hides all of the target from all eyes; this is the largest.
    Between(usize),
    /// One hides all of the target from all eyes.
    Hides,
}

impl Walls {
    /// The walls of a level that are at least `least_side` wide and high, in world units. Costs some
    /// passes over all triangles.
    pub fn of(level: &Scene, least_side: f32) -> Self {
        Self::new(find(level, least_side))
    }

    fn new(mut walls: Vec<Wall>) -> Self {
        let tree = Tree::new(&mut walls);
        Self { walls, tree }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.walls.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.walls.is_empty()
    }

    /// Whether one of them lies between two places. One that a place lies in the plane of is only
    /// touched; between two of an axis that are touched is what they bound.
    pub fn part(&self, from: DVec3, to: DVec3) -> bool {
        let mut touched = [None; 3];
        self.tree.along(from, to, |i| {
            let wall = &self.walls[i];
            let touches = [from, to].into_iter().any(|p| wall.holds(&Span { min: p, max: p }));
            let mut before = || touched[wall.axis].replace(wall.at);
            wall.meets(from, to) && (!touches || before().is_some_and(|at| at != wall.at))
        })
    }

    /// The part of a box that can be reached from a part of it.
    pub fn reached(&self, from: &Span, mut span: Span) -> Span {
        for _ in 0..ROUNDS {
            let mut changed = false;
            self.tree.touching(&span.clone(), |i| changed |= self.walls[i].stops(from, &mut span));
            if !changed {
                break;
            }
        }
        span
    }

    /// Whether one wall hides all of a box from all eyes. Only walls count that are `apart` or more
    /// before the box, in world units: 0 lets a box count whose side lies in the wall; give more
    /// for boxes around walls and around things that hang on them. `hint` is the wall that hid
    /// something last time, and is tried first; it decides nothing. Costs a walk over the tree of
    /// walls, some hundred nanoseconds to some microseconds.
    pub fn hide(&self, eyes: &Eyes, target: &Span, apart: f64, hint: &mut u32) -> bool {
        self.ask(eyes, target, apart, hint) == Found::Hides
    }

    fn ask(&self, eyes: &Eyes, target: &Span, apart: f64, hint: &mut u32) -> Found {
        if self.walls.get(*hint as usize).is_some_and(|wall| wall.hides(eyes, target, apart)) {
            return Found::Hides;
        }
        let (from, to) = (eyes.span().middle(), target.middle());
        let mut found = Found::None;
        self.tree.along(from, to, |i| {
            let wall = &self.walls[i];
            if !wall.meets(from, to) || wall.holds(eyes.span()) || wall.holds(target) {
                return false;
            }
            if wall.hides(eyes, target, apart) {
                (*hint, found) = (i as u32, Found::Hides);
                return true;
            }
            if !matches!(found, Found::Between(largest) if self.walls[largest].area() >= wall.area()) {
                found = Found::Between(i);
            }
            false
        });
        found
    }

    /// Whether walls hide all of a box from all eyes of another one, each part by a wall of its
    /// own. Up to `most` parts are asked about, as [`Walls::hide`] does; where that is not enough,
    /// the answer is `false`.
    pub fn hide_in_parts(&self, eyes: &Span, target: &Span, apart: f64, most: u32, hint: &mut u32) -> bool {
        let mut open = vec![(*eyes, *target, 0)];
        for _ in 0..most {
            let Some((eyes, target, divisions)) = open.pop() else { return true };
            let wall = match self.ask(&Eyes::cuboid(eyes), &target, apart, hint) {
                Found::Hides => continue,
                Found::Between(wall) if divisions < MOST_DIVISIONS => &self.walls[wall],
                // However they are divided, no wall hides one middle from the other.
                Found::None | Found::Between(_) => return false,
            };
            let Cut { of_eyes, axis, at } = wall.cut(&eyes, &target, apart);
            if of_eyes {
                open.extend(eyes.divided(axis, at).map(|part| (part, target, divisions + 1)));
            } else {
                open.extend(target.divided(axis, at).map(|part| (eyes, part, divisions + 1)));
            }
        }
        open.is_empty()
    }
}

#[cfg(test)]
mod tests;
