//! Surfaces: triangles prepared to hide objects behind them.
//!
//! A surface is a set of *patches*: neighbouring triangles of nearly one direction, of which only
//! the outline is kept. That is safe by algebra: if the outline of any
//! set of triangles winds around a direction, then rays in that direction meet at least one of the
//! triangles. Open, closed, crossing, degenerate or inconsistently wound triangles need no care;
//! they can only make winding numbers vanish. Edges inside a patch cancel, and so do the
//! outlines of two neighbouring patches where both are drawn.
//!
//! Patches form a [`tree`]: groups of them have outlines of their own, so that rolling ground can
//! be drawn in few pieces from afar and triangle by triangle underfoot.
//!
//! Outlines are simplified between the points where three patches touch. The chain of edges that a
//! straight edge stands for stays within a known distance of it, so that winding numbers farther
//! away than that are the same (Douglas & Peucker 1973 for the chains; the choice of patches after
//! Coorg & Teller 1997 and the design of occluders in dPVS, Aila 2000).

mod build;
mod chain;
mod equal;
mod facets;
mod gather;
mod groups;
mod grow;
mod halves;
mod index;
mod patch;
mod position;
pub(crate) mod seams;
mod split;
mod tree;
mod weld;

pub(crate) use equal::first_of_equals;
pub(crate) use index::{PatchIndex, PatchNumber};
pub(crate) use patch::{Beyond, EDGE, Patch, PatchOutline, PatchSide, Rules, Surface, slack};
pub(crate) use position::key;
pub(crate) use weld::{Topology, Welded};
