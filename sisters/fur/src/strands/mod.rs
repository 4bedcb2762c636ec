//! Where strands stand: a rule that needs no texture coordinates and has no singularities.
//!
//! Space is cut into cubic cells, in object space. Each cell holds a few points, placed by a hash
//! of its number, which repeats after [`PERIOD`] cells. A point within a thin slab around the surface
//! is the root of a strand, which stands along the normal. The points are equally dense everywhere,
//! so that strands are equally dense on any surface, whatever its shape, its place and its triangles.
//! All that a fragment needs are the position and the normal of the base mesh, how it bends, and a
//! [table](Fur::table) of the points; [`roots`] lists the strands of a mesh one by one, for ray
//! tracers.

mod fur;
mod lean;
mod roots;
mod table;

pub use fur::{Fur, hash, unit};
pub use lean::{Forces, Lean};

pub use crate::numeric::{MAX_PER_CELL, PERIOD, TEXELS};
pub use roots::{Root, roots};
