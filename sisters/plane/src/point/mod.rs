//! Exact visibility from a point.
//!
//! 1. [`walk`]: the cells around the eye are walked in chessboard shells, front to back (thesis,
//!    section 3.3.3). The objects in them are found, and the sides of their occluders. Walls close
//!    directions ([`covers`]); only cells in open directions ([`shells`]) are visited, so that the
//!    cost follows the visible part of the scene.
//! 2. [`envelope`]: the nearest wall in each direction, by exact comparisons ([`wall`]).
//! 3. [`region`]: each object found is compared with the visible region.
//!
//! [`Query::run`] says what is visible.

mod arcs;
mod covers;
mod envelope;
mod outline;
mod region;
mod shells;
mod walk;
mod wall;

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2};
use crate::geometry::{Block, Segment, Shape};
use crate::point::arcs::{Arcs, Circle};
use crate::point::envelope::Envelope;
use crate::point::region::Region;
use crate::point::walk::Walk;
use crate::point::wall::{Around, NOBODY};
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::view::View;

/// Finds the objects that a view can see.
///
/// A query keeps its memory and its last result: use one for each view and run it again every
/// frame. Any number of queries can run on one scene at the same time, each in its own thread.
#[derive(Debug, Clone, Default)]
pub struct Query {
    pvs: Pvs,
    walk: Walk,
    envelope: Envelope,
    view: Option<(View, Circle)>,
    /// By place in the walk: whether the object is seen, if its walls tell.
    shown: Vec<Option<bool>>,
    /// Where the polygon of a view without a range ends.
    extent: Option<Block>,
}

impl Query {
    /// A query that never ran.
    pub fn new() -> Self {
        Self::default()
    }

    /// Finds the objects that can be seen from the eye: all of them, and no others. The result
    /// stays in the query ([`Query::pvs`]).
    ///
    /// Occluders are closed sets. A point is visible if it lies in the closure of the set of points
    /// that a set of directions of positive angle reaches. So
    /// - rays that only graze do not count, and two walls that touch in a point let nothing
    ///   through;
    /// - the border of the visible region belongs to it: a wall is visible, and an object behind it
    ///   that touches it where it is visible;
    /// - a wall through the eye hides nothing, as it covers no angle; along it one sees both of its
    ///   sides;
    /// - from the border of a solid one sees nothing in the directions into it; on the seam between
    ///   two solids, nothing at all;
    /// - a solid that surrounds the eye hides nothing ([`crate::Stats::eye_in_occluder`]).
    ///
    /// Comparisons are exact for all finite coordinates. Only discs are rounded: as occluders to
    /// the polygon inside ([`crate::Disc::polygon`]), as bounds outwards by about 1e-14 of their
    /// coordinates, as is the end of a range.
    ///
    /// Costs the cells and objects in sight, and for the n sides of occluders found there O(n log
    /// n) comparisons, even if they cross. An eye more than 2^24 cells away from the grid costs all
    /// objects. The walk follows the thesis (section 3.3.3); the nearest sides are found as by
    /// Hershberger 1989 ("Finding the upper envelope of n line segments in O(n log n) time").
    pub fn run(&mut self, scene: &Scene, view: &View) -> &Pvs {
        // Taken out, for the region borrows the rest.
        let mut pvs = std::mem::take(&mut self.pvs);
        pvs.reset(scene.slot_count());
        let (circle, arcs) = self.start(view);
        self.extent = Some(extent(scene, view.eye()));
        self.walk.run(scene, view, &circle, &arcs, &mut pvs.stats);
        let around = Around::new(&circle, &self.walk.walls);
        self.envelope.build(&around, &arcs, &self.walk.blocked);
        pvs.stats.pieces = self.envelope.steps.len() as u32;
        mark_shown(&mut self.shown, &self.walk, &self.envelope, view);
        let region = self.region(view, &circle);
        for ((&slot, &own), &shown) in self.walk.found.iter().zip(&self.walk.own).zip(&self.shown) {
            pvs.stats.objects_tested += 1;
            let meets = || match self.walk.walls.get(own as usize) {
                Some(wall) => region.meets_wall(wall),
                None => scene.object(slot).is_some_and(|object| region.meets(&object.bounds)),
            };
            if shown.unwrap_or_else(meets) {
                pvs.push(scene.id(slot));
            }
        }
        self.pvs = pvs;
        &self.pvs
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }

    fn start(&mut self, view: &View) -> (Circle, Arcs) {
        let circle = Circle::new(view.eye());
        self.view = Some((*view, circle));
        let arcs = match view.sides() {
            Some([first, last]) => arcs::between(&circle, first, last).collect(),
            None => arcs::whole(&circle),
        };
        (circle, arcs)
    }

    fn region<'a>(&'a self, view: &View, circle: &'a Circle) -> Region<'a> {
        let around = Around::new(circle, &self.walk.walls);
        Region::new(around, &self.envelope, view.range())
    }

    /// Whether a point can be seen by the view of the last run: whether it belongs to the visible
    /// region, as [`Query::run`] defines it. Exact, but for the end of a range. `false` before the
    /// first run, and for points that are not finite. Costs the logarithm of the number of sides in
    /// sight.
    pub fn sees_point(&self, point: Vec2) -> bool {
        let sees = |(view, circle): &(View, Circle)| self.region(view, circle).contains(point.as_dvec2());
        point.is_finite() && self.view.as_ref().is_some_and(sees)
    }

    /// Whether any point of a shape can be seen by the view of the last run, as
    /// [`Query::sees_point`] says. Exact, but for discs and for the end of a range: these are
    /// larger by their rounding. `false` before the first run. Costs the sides in sight in the
    /// directions of the shape.
    ///
    /// # Errors
    /// Refuses shapes that are not finite or inverted, or have a negative radius.
    pub fn sees(&self, shape: impl Into<Shape>) -> Result<bool, Error> {
        let shape = shape.into();
        shape.check("the shape")?;
        Ok(self.view.as_ref().is_some_and(|(view, circle)| self.region(view, circle).meets(&shape)))
    }

    /// The visible region of the last run as a polygon: its corners, counterclockwise, rounded to
    /// single precision. Empty if nothing is seen. Costs the sides in sight.
    ///
    /// The polygon is star-shaped around the eye. The eye is a corner of it unless one sees in all
    /// directions. Where nothing stops the eye, the polygon ends at the range of the view: at
    /// chords around the circle, which leave it by 0.13% of the range at most. Without a range it
    /// ends a cell beyond the rectangle around the grid, all objects and the eye.
    ///
    /// ```
    /// use casca_plane::{GridSpec, ObjectDesc, Query, Scene, Segment, View};
    /// use glam::{UVec2, Vec2};
    ///
    /// # fn main() -> Result<(), casca_plane::Error> {
    /// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(8) })?;
    /// let wall = Segment::new(Vec2::new(2.0, 4.0), Vec2::new(6.0, 4.0));
    /// scene.insert(ObjectDesc::new(wall).occluder(wall))?;
    /// let mut query = Query::new();
    /// query.run(&scene, &View::sector(Vec2::new(4.0, 2.0), Vec2::Y, 0.5)?);
    /// assert!(query.sees_point(Vec2::new(4.0, 4.0)) && !query.sees_point(Vec2::new(4.0, 4.1)));
    /// // The eye and two points of the wall.
    /// assert_eq!(query.polygon().len(), 3);
    /// # Ok(())
    /// # }
    /// ```
    pub fn polygon(&self) -> Vec<Vec2> {
        match (&self.view, &self.extent) {
            (Some((view, circle)), Some(extent)) => {
                let whole = view.direction().is_none();
                outline::polygon(&self.region(view, circle), whole, view.range(), extent)
            }
            _ => Vec::new(),
        }
    }
}

/// A block around the grid, the objects and the eye, with room for a cell.
fn extent(scene: &Scene, eye: DVec2) -> Block {
    let grid = Block { min: scene.grid.min, max: scene.grid.max() }.with(eye);
    let outer = scene.outer.iter().filter_map(|&slot| scene.object(slot));
    let Block { min, max } = outer.fold(grid, |all, object| {
        let block = object.bounds.block();
        all.with(block.min).with(block.max)
    });
    let room = scene.grid.cell;
    Block { min: min - room, max: max + room }
}

/// Marks the objects of which walls tell whether they are seen, without a comparison: seen if a wall
/// that is a side of the object is the nearest somewhere. Not with a range, which may end before it.
fn mark_shown(shown: &mut Vec<Option<bool>>, walk: &Walk, envelope: &Envelope, view: &View) {
    shown.clear();
    shown.resize(walk.found.len(), None);
    let owner = |number: u32| walk.walls.get(number as usize).map_or(NOBODY, |wall| wall.owner) as usize;
    for &wall in envelope.hidden.iter().filter(|&&wall| walk.own.get(owner(wall)) == Some(&wall)) {
        shown[owner(wall)] = Some(false);
    }
    for step in envelope.steps.iter().filter(|_| view.range().is_none()) {
        shown.get_mut(owner(step.wall)).into_iter().for_each(|shown| *shown = Some(true));
    }
}

/// The corners of the region that an eye sees between walls, up to `range` from it, in world units:
/// counter-clockwise around the eye, see [`Query::polygon`]. Costs all
/// walls within the range: of many walls, a [`Scene`](crate::Scene) looks only at those in sight.
///
/// ```
/// use casca_plane::glam::Vec2;
/// use casca_plane::{Segment, visible_region};
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let wall = Segment::new(Vec2::new(-1.0, 2.0), Vec2::new(1.0, 2.0));
/// let corners = visible_region(&[wall], Vec2::ZERO, 10.0)?;
/// assert!(corners.iter().all(|at| at.length() < 10.5 && (at.x.abs() > 0.9 || at.y < 2.1)));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Refuses walls and an eye that are not finite, and a range that is not a positive number.
pub fn visible_region(walls: &[Segment], eye: Vec2, range: f32) -> Result<Vec<Vec2>, Error> {
    let view = View::all_round(eye)?.with_range(range)?;
    walls.iter().flat_map(|wall| [wall.a, wall.b]).try_for_each(|end| finite2("the end of a wall", end))?;
    let mut query = Query::new();
    let (circle, arcs) = query.start(&view);
    query.extent = Some(Block::EMPTY.with(view.eye()));
    query.walk.take(walls, &view);
    query.envelope.build(&Around::new(&circle, &query.walk.walls), &arcs, &[]);
    Ok(query.polygon())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_kinds_are_refused_or_answered() {
        let wall = |a: f32, b: f32| Segment::new(Vec2::splat(a), Vec2::new(b, a));
        for bad in [f32::NAN, f32::INFINITY] {
            assert!(visible_region(&[wall(bad, 1.0)], Vec2::ZERO, 1.0).is_err());
            assert!(visible_region(&[], Vec2::splat(bad), 1.0).is_err());
            assert!(visible_region(&[], Vec2::ZERO, bad).is_err());
        }
        assert!(visible_region(&[], Vec2::ZERO, -1.0).is_err());
        // Near and far, with ranges of all sizes.
        for eye in [0.0, 1.0, 5e6, 1e9, -3e38] {
            for range in [1e-45, 1e-3, 10.0, 1e30, f32::MAX] {
                for far in [1.0, 1e9, f32::MAX] {
                    let corners = visible_region(&[wall(-far, far)], Vec2::splat(eye), range);
                    assert!(corners.is_ok(), "{eye} {range} {far}: {corners:?}");
                }
            }
        }
        // Walls on both sides of the eye, and through it.
        /// From nothing to almost the greatest float.
        const FAR: [f32; 4] = [0.0, 1e-20, 1.0, 1e30];
        for far in FAR {
            let corners = visible_region(&[wall(1.0, 2.0), wall(far, -far)], Vec2::ZERO, 3.0).unwrap();
            assert!(corners.len() >= 2, "{far}");
        }
    }
}
