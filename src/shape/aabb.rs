//! Axis-aligned boxes: exact, since cell planes are exact.

use glam::{DVec3, IVec3, Vec3};

use crate::error::Error;
use crate::geometry::body::Body;
use crate::geometry::{Aabb, Block};
use crate::grid::Grid;
use crate::shape::kind::Kind;
use crate::shape::{Shape, Which};

impl Shape for Aabb {
    fn bounds(&self) -> (DVec3, DVec3) {
        (self.min.as_dvec3(), self.max.as_dvec3())
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        Block::from(*self).contains(&Block { min, max })
    }

    fn contains_point(&self, point: DVec3) -> bool {
        Block::from(*self).contains_point(point)
    }

    fn corners(&self, grid: &Grid, which: Which) -> Option<(IVec3, IVec3)> {
        let (min, max) = self.bounds();
        Some(match which {
            Which::Touched => grid.cover(min, max),
            Which::Opaque => grid.inside(min, max).unwrap_or((IVec3::ONE, IVec3::ZERO)),
        })
    }
}

impl Kind for Aabb {
    fn is_centered(&self) -> bool {
        true
    }

    fn check(&self, what: &'static str) -> Result<(), Error> {
        Aabb::check(self, what)
    }

    fn same(&self, other: &Self) -> bool {
        self == other
    }

    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        Ok(Some(Aabb::new(self.min + offset, self.max + offset)))
    }

    fn as_block(&self) -> Option<Block> {
        Some(Block::from(*self))
    }

    fn inner(&self, origin: DVec3, shrink: f64) -> Option<Body<'_>> {
        let b = Block::from(*self);
        let b = Block { min: b.min - origin + shrink, max: b.max - origin - shrink };
        b.min.cmplt(b.max).all().then_some(Body::Block(b))
    }
}
