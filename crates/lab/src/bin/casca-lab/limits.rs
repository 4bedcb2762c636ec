//! The limits of numbers on the command line.

use std::ops::RangeInclusive;

/// Frames that can be walked: as many as a file may give.
pub const FRAMES: RangeInclusive<i64> = 1..=100_000;
/// Widths of item buffers in pixels. The largest takes 2 GB.
pub const WIDTHS: RangeInclusive<i64> = 16..=16_384;
/// Rays to one object, at most.
pub const MOST_SAMPLES: i64 = 10_000;
