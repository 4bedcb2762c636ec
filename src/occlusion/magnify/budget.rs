//! The work that a query may still do for undecided pixels.

use std::sync::atomic::{AtomicU32, Ordering};

/// The work that a query may still do. Targets that come after it is used up are less well
/// examined.
#[derive(Debug)]
pub(crate) struct Budget<'a> {
    /// Directions and squares.
    pub(crate) squares: u64,
    /// Patches drawn again.
    pub(crate) patches: Purse<'a>,
}

/// How many patches may still be drawn again.
#[derive(Debug)]
pub(crate) enum Purse<'a> {
    Own(u32),
    /// Shared by threads that look ahead.
    #[cfg_attr(not(feature = "rayon"), allow(dead_code, reason = "there are none"))]
    Shared(&'a AtomicU32),
}

impl Purse<'_> {
    /// How many are left.
    pub(crate) fn left(&self) -> u32 {
        match self {
            Self::Own(left) => *left,
            Self::Shared(left) => left.load(Ordering::Relaxed),
        }
    }

    /// Whether a cost is left.
    #[cfg(feature = "rayon")]
    pub(super) fn holds(&self, cost: u32) -> bool {
        cost <= self.left()
    }

    /// Takes a cost, if that much is left. If not, the rest is lost: so what a target gets depends
    /// on those before it only through one place where the budget ends.
    pub(super) fn take(&mut self, cost: u32) -> bool {
        match self {
            Self::Own(left) => {
                let rest = left.checked_sub(cost);
                *left = rest.unwrap_or(0);
                rest.is_some()
            }
            Self::Shared(left) => {
                let rest = left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                    Some(left.saturating_sub(cost))
                });
                rest.is_ok_and(|before| cost <= before)
            }
        }
    }
}
