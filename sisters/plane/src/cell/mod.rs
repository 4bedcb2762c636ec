//! The cell method: the objects that can be seen from anywhere in the viewer's cell (thesis,
//! section 3.3).
//!
//! # The chain rule
//!
//! Cells have whole coordinates relative to the viewer's cell V; a cell c is the closed square of
//! the points within half a cell of c along both axes. A cell *blocks* if it is opaque, that is, if
//! occluders contain all of it, or if it is hidden. It is *hidden* if each way from a point of V to
//! a point of it meets an opaque cell on the way.
//!
//! Draw a line from the centre of each blocking cell to the centres of its blocking neighbours
//! along the axes. Those lines are the *chains*.
//!
//! **Rule.** If the way from the centre of V to the centre of c meets a chain before it reaches c,
//! then c is hidden.
//!
//! *Proof.* Let the way meet a chain in q = tc, t < 1, on the line between the centres a and b of
//! two neighbours that block (a = b for a single cell). Take a point v of V and a point c + d of c.
//! The way between them is at t in tc + (1-t)v + td = q + e, and e is a mean of v and d, so it lies
//! within half a cell of q along both axes. The cells a and b share a side, so all points within
//! half a cell of a point between their centres lie in a or in b. If that cell is opaque, the way
//! meets an opaque cell. If it is hidden, the way to q + e has met one before. As t < 1, both lie
//! before c + d. ∎
//!
//! Hidden cells count as blocking once they are found, nearest shells first, so that nothing is
//! concluded from itself. Nothing is asked of the shape of a chain. These are cases of the rule:
//!
//! - *The lattice rule* of the 3D twin: the cells of a side of shell k around the point c k/m
//!   block, so c in shell m is hidden.
//! - *Straight extended occluders* (thesis, section 3.3.4): a row or a column of blocking cells,
//!   also where it leads away from the viewer through many shells.
//! - *L-shaped extended occluders*, across two sides of a shell: the row and the column share the
//!   cell at the corner, so the way to c meets one of them if c lies between the rays through the
//!   ends. The thesis asks that the corner points to the viewer. That makes the polygon behind the
//!   cap convex, so that it can be filled as one; the proof does not need it.
//!
//! # Two ways to apply it
//!
//! [`caps`] is the thesis' way: an opaque cell that is in sight grows to an L, and the cells behind
//! it are set in H one by one. It applies the rule to some chains: those that the fixed order of
//! steps finds.
//!
//! [`walk`] applies it to all chains, with a [direction mask](directions) for each side of the
//! shells. Let y be a place along a side, and m a shell. Two neighbours that both block are of one
//! of two kinds:
//!
//! - Both are on one side of one shell, at y and y + 1. They block the directions from y/m to (y +
//!   1)/m for all cells of farther shells.
//! - They are at the same place y, on the shells m - 1 and m. They block the directions from y/m to
//!   y/(m - 1) for all cells of farther shells: the way to such a cell meets their chain between
//!   the depths m - 1 and m. Of the cells of shell m itself, that at |y| + 1 is the first behind
//!   the chain. Its direction (|y| + 1)/m is not beyond |y|/(m - 1) only if |y| = m - 1: then it is
//!   on the diagonal, straight behind the cell of shell m - 1, which hides it alone.
//!
//! So a cell of shell m is hidden by the rule if and only if its direction is in the mask when the
//! shells before it have been added. The masks hide every cell that [`caps`] hides, and more. Tests
//! compare both, and the masks with the rule applied to each pair.
//!
//! # Objects
//!
//! An object is listed in every cell that shares a point with its bounds, and cells are closed. If
//! a point p is the limit of points that an eye in V reaches, then one cell with p contains
//! infinitely many of them. It is not hidden, and the walk finds the object there. The way from V
//! to a point of the grid stays in the grid, if V is in it, and in the region of the view, which is
//! convex and contains V.

mod caps;
mod directions;
mod map;
mod marks;
mod options;
mod region;
mod run;
mod walk;
mod words;

#[cfg(test)]
mod tests;

pub(crate) use map::CellMap;
pub use options::{CellOptions, Fusion};
pub(crate) use region::Region;
pub(crate) use run::{CellScratch, is_in_occluder, run};
pub(crate) use walk::{Hiding, Walk};
