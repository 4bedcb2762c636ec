//! A small moving object that waits to be decided, and the frustum that its brick is compared with.

use casca_slots::Id;
use glam::DVec3;
use smallvec::SmallVec;

use crate::grid::Grid;
use crate::id::ObjectId;
use crate::view::View;

/// A small moving object whose brick is in sight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mover {
    pub(super) id: Id,
    /// How many other candidates were found before.
    pub(super) after: u32,
    /// The middle of its box. Rounding may take it out of the object by as much as single precision
    /// tells: a point that is seen only leaves an object in the set.
    pub(super) middle: [f32; 3],
}

impl Mover {
    /// Its id.
    pub(super) fn id(&self) -> ObjectId {
        ObjectId(self.id)
    }

    /// Whether it was found before another candidate of such a place.
    pub(super) fn is_before(&self, place: usize) -> bool {
        self.after as usize <= place
    }
}

/// The frustum as it is compared with the bricks around a brick, all 3x3x3 of them.
#[derive(Debug, Clone, Default)]
pub(super) struct Frustum {
    /// Half the edge length of the bricks together.
    pub(super) half: f64,
    /// How far from its place the eye may be.
    pub(super) near: f64,
    /// The bricks lie inside of a plane if the coordinate of their middle along its normal is not
    /// less than this.
    pub(super) planes: SmallVec<[(DVec3, f64); 6]>,
}

impl Frustum {
    /// For a view of a grid of bricks.
    pub(super) fn begin(&mut self, view: &View, bricks: &Grid) {
        let half = 1.5 * bricks.cell_size();
        let corners = bricks.min().abs().max(bricks.max().abs());
        let largest = corners.max_element() + half;
        self.half = half;
        self.near = view.eye_room();
        self.planes.clear();
        self.planes.extend(view.planes.iter().map(|plane| {
            let across = half * plane.normal.abs().element_sum();
            (plane.normal, across + 2.0 * plane.margin(largest) - plane.offset)
        }));
    }
}
