//! Which kinds of shapes can be asked for single rows of cells.

use crate::object::{Bounds, Occluder};
use crate::shape::pieces::Parts;
use crate::shape::traits::Rows;

impl Parts for Bounds {
    fn rows(&self) -> Option<&dyn Rows> {
        match self {
            Self::Sphere(s) => Some(s),
            Self::Box(b) => Some(b),
            Self::Oriented(b) => Some(b),
            Self::Instance(i) => Some(i),
            Self::Mesh(_) => None,
        }
    }
}

impl Parts for Occluder {
    fn rows(&self) -> Option<&dyn Rows> {
        match self {
            Self::Sphere(s) => Some(s),
            Self::Box(b) => Some(b),
            Self::Oriented(b) => Some(b),
            Self::Convex(c) => Some(&**c),
            Self::Instance(i) => Some(i),
            Self::Mesh(_) => None,
        }
    }
}
