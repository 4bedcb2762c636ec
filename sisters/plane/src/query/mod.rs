//! Queries: the memory of one view, and its last result.

mod region;

use glam::Vec2;

use crate::error::Error;
use crate::geometry::Shape;
use crate::point::Sight;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::view::View;

pub use region::visible_region;

/// Finds the objects that a view can see.
///
/// A query keeps its memory and its last result: use one for each view and run it again every
/// frame. Any number of queries can run on one scene at the same time, each in its own thread.
#[derive(Debug, Clone, Default)]
pub struct Query {
    pvs: Pvs,
    sight: Sight,
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
        let pvs = &mut self.pvs;
        pvs.reset(scene.slot_count());
        (pvs.scene, pvs.revision, pvs.view) = (scene.tag(), scene.revision(), Some(*view));
        self.sight.run(scene, view, pvs);
        pvs
    }

    /// Whether a point can be seen by the view of the last run: whether it belongs to the visible
    /// region, as [`Query::run`] defines it. Exact, but for the end of a range. `false` before the
    /// first run, and for points that are not finite. Costs the logarithm of the number of sides in
    /// sight.
    pub fn sees_point(&self, point: Vec2) -> bool {
        self.sight.sees_point(point.as_dvec2())
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
        Ok(self.sight.sees(&shape))
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
        self.sight.polygon()
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }
}
