//! Every margin against rounding and every numeric limit of this crate, with its reason.
//!
//! What the library is judged by errs so that a doubt is no accusation: an object counts as seen
//! only if nothing within these margins could hide it.

#[cfg(feature = "attack")]
pub(crate) mod attack;
pub(crate) mod baselines;
pub(crate) mod oracle;
