//! Views of all eyes in a box.

use glam::DVec3;
use smallvec::SmallVec;

use crate::error::Error;
use crate::geometry::{Aabb, Room};
use crate::numeric::shape::REGION;
use crate::view::{Origin, View};

impl View {
    /// All of space around a view cell, a box of eyes: the result of a query has all that can be
    /// seen from anywhere in it, in every direction and however far.
    ///
    /// The box may be flat, or a point. Everything that a box of eyes sees, but for objects that
    /// meet it, its surface sees too: where sets of large boxes are needed, the views of many small
    /// parts of its six sides together have the smaller sets.
    ///
    /// As with a [reach](View::with_reach) of half its diagonal, which is less tight, occluders
    /// hide less around their outlines. Those that meet the box hide nothing. Triangles that are
    /// nearer to its middle than about three times that reach hide if the box lies on one side of
    /// them and the outline of their patch is farther away. [`View::with_reach`] makes the box a
    /// ball. Any result for the box holds for eyes in it ([`crate::Pvs::is_valid_for`]).
    ///
    /// # Errors
    /// Refuses a box that is inverted or not finite.
    pub fn of_cell(cell: Aabb) -> Result<Self, Error> {
        cell.check("the view cell")?;
        let (min, max) = (cell.min.as_dvec3(), cell.max.as_dvec3());
        let at = (min + max) * 0.5;
        // Rounding may not leave eyes outside.
        let grow = if min == max { 0.0 } else { REGION };
        let half = (max - min) * 0.5 * (1.0 + grow) + at.abs() * grow;
        let view = Self::bounded(Origin::Eye { at, error: 0.0 }, SmallVec::new());
        Ok(Self { room: Room::cuboid(half, half.length() * (1.0 + grow)), ..view })
    }

    /// How far from its place the eye may go.
    pub(crate) fn room(&self) -> &Room {
        &self.room
    }

    /// How far from its place the eye may be along each axis: as far as it is not known, and as it
    /// may go.
    pub(crate) fn eye_box(&self) -> DVec3 {
        match self.origin {
            Origin::Eye { error, .. } => self.room.half() + error,
            Origin::Direction(_) => DVec3::ZERO,
        }
    }
}
