//! All that the library asks of a kind of shape besides cells.

use glam::{DVec3, Vec3};

use crate::error::Error;
use crate::geometry::Block;
use crate::geometry::body::Body;
use crate::geometry::extent::Extent;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::Polytope;
use crate::shape::Shape;
use crate::shape::traits::Rows;

/// A kind of bounds or occluders. Answers that a kind does not give are those of its bounding box.
pub(crate) trait Kind: Shape {
    /// The shape behind a reference or an `Arc`.
    fn as_kind(&self) -> &dyn Kind
    where
        Self: Sized,
    {
        self
    }

    /// Refuses values that are no shape; `what` names the shape in the error.
    fn check(&self, _what: &'static str) -> Result<(), Error> {
        Ok(())
    }

    /// Refuses shapes that can hide nothing.
    fn check_hides(&self) -> Result<(), Error> {
        Ok(())
    }

    /// Whether both are the same shape at the same place.
    fn same(&self, other: &Self) -> bool
    where
        Self: Sized;

    /// The shape moved by an offset in world units; `None` if it stays where it is.
    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error>
    where
        Self: Sized;

    /// The part of it that several objects may share: its place in memory, and its bytes.
    fn shared(&self) -> Option<(*const u8, usize)> {
        None
    }

    /// The shape, if it can be asked for single rows of cells.
    fn rows(&self) -> Option<&dyn Rows> {
        None
    }

    /// A box around the shape.
    fn block(&self) -> Block {
        Block::new(self.bounds())
    }

    /// The box, if the shape is exactly a box along the axes.
    fn as_block(&self) -> Option<Block> {
        None
    }

    /// Whether it has an inside that points can lie in.
    fn is_solid(&self) -> bool {
        true
    }

    /// Whether it may have points in each of the half-spaces; in doubt, yes.
    fn may_reach(&self, planes: &[HalfSpace]) -> bool {
        self.block().may_reach(planes)
    }

    /// Whether it may meet the common part of half-spaces, which lies in the box `around`; in doubt, yes.
    fn may_meet(&self, planes: &[HalfSpace], around: &Block) -> bool {
        let block = self.block();
        around.meets(&block) && block.may_reach(planes)
    }

    /// Its extent along axes at right angles.
    fn extent(&self, axes: &[DVec3; 3]) -> Extent {
        self.block().extent(axes)
    }

    /// How far its nearest point is from an eye; not positive for an eye inside.
    fn distance_from(&self, eye: DVec3) -> f64 {
        self.block().distance_from(eye)
    }

    /// The least coordinate of its points along a direction.
    fn distance_along(&self, direction: DVec3) -> f64 {
        self.block().distance_along(direction)
    }

    /// Centre and radius of a ball around it.
    fn ball(&self) -> (DVec3, f64) {
        self.block().ball()
    }

    /// A solid around it, relative to an origin of which each coordinate is known to within `grow`.
    fn outer(&self, origin: DVec3, grow: f64) -> Body {
        let b = self.block();
        Body::Block(Block { min: b.min - origin - grow, max: b.max - origin + grow })
    }

    /// A solid inside of it, relative to an origin of which each coordinate is known to within `shrink`; `None` if
    /// no such solid is left, and for shapes that are drawn by their triangles.
    fn inner(&self, _origin: DVec3, _shrink: f64) -> Option<Body> {
        None
    }

    /// A point of its largest part, if it has parts (see [`Kind::all_parts`]).
    fn middle_of_parts(&self) -> Option<DVec3> {
        None
    }

    /// Whether all convex parts that together contain it pass a test, relative to an origin that is known exactly;
    /// `None` if it has no parts.
    fn all_parts(&self, _origin: DVec3, _test: &mut dyn FnMut(Polytope) -> bool) -> Option<bool> {
        None
    }
}
