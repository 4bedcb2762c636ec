//! Rounding margins and tolerances: every one of them, with its name and the reason why it
//! suffices.
//!
//! Occluders are rounded inwards and targets outwards, so that an error of rounding can only make
//! more visible. Each constant says which operations it covers. Those that only choose between two
//! correct ways (a limit of cost, a heuristic) stay beside the code that uses them.

pub(crate) mod mesh;
pub(crate) mod occlusion;
pub(crate) mod place;
pub(crate) mod query;
pub(crate) mod scene;
pub(crate) mod shape;
pub(crate) mod view;

/// The lesser of two numbers; the second one if they are not ordered. Quicker than `min` of floats,
/// which treats NaN in another way.
#[inline(always)]
pub(crate) fn lesser<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The greater of two numbers; the second one if they are not ordered.
#[inline(always)]
pub(crate) fn greater<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
