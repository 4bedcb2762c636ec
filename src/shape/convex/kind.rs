//! Convex solids as a kind of shape.

use glam::{DVec3, Vec3};

use crate::error::Error;
use crate::geometry::body::Body;
use crate::heap::in_arc;
use crate::shape::convex::Convex;
use crate::shape::kind::Kind;
use crate::shape::traits::Rows;

impl Kind for Convex {
    fn same(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }

    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        self.translated(offset).map(Some)
    }

    fn shared(&self, out: &mut dyn FnMut(*const u8, usize)) {
        out(std::ptr::from_ref(self).cast(), in_arc::<Self>() + self.memory_bytes());
    }

    fn rows(&self) -> Option<&dyn Rows> {
        Some(self)
    }

    /// Only eyes known exactly see it whole.
    fn inner(&self, origin: DVec3, shrink: f64) -> Option<Body> {
        (shrink == 0.0).then(|| Body::Polytope(self.seen_from(origin)))
    }
}
