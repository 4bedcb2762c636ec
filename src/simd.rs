//! Functions compiled for the vectors of several processors, of which the best are chosen at run
//! time.
//!
//! [`vectorized`] calls a function with a token of `fearless_simd`, which tells the vectors that
//! the function may use. What it calls is compiled for them, too, as far as it is inlined: loops
//! over arrays of eight numbers become vector instructions, and the innermost loops name those.
//! Products and sums are never contracted, so that all copies give the same results; a test of the
//! rasteriser compares them.

use std::sync::LazyLock;

use fearless_simd::Level;

/// The vectors of this processor.
static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// The best vectors of this processor.
#[inline]
pub(crate) fn level() -> Level {
    *LEVEL
}

/// Evaluates an expression, compiled for the vectors of this processor, of which it is given a
/// token.
macro_rules! vectorized {
    ($simd:ident => $run:expr) => {
        ::fearless_simd::dispatch!($crate::simd::level(), $simd => $run)
    };
}

pub(crate) use vectorized;
