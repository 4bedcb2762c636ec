//! Constants of soft visibility: estimates on the cells of a grid.

/// A full opacity as a whole number: opacities of the pyramid are whole multiples of 2^-15.
///
/// A power of two, so that the opacity 2^-l of a thin wall seen along it is exact down to level 15. Each level rounds once, by 2^-16 at most.
pub(crate) const ONE: u32 = 1 << 15;

/// A march ends where less light than this is left.
///
/// The old rule of the cones ends there (Villegas 2016 and its program: opacity of 0.9999); a picture of 8 bits cannot show less.
pub(crate) const DARK: f64 = 1e-4;

/// A direction whose share along an axis is smaller crosses no planes of that axis inside a grid of 8192 cells.
pub(crate) const ALONG: f64 = 1e-6;

/// Rays from a point on a surface start this many cells away along the normal.
///
/// A cell is sqrt(3) cells long from corner to corner. A point farther from a plane is in no cell that the plane touches.
pub(crate) const OFF_SURFACE: f64 = 1.733;

/// Turns the points of a spiral: the golden angle in radians, under which no two points line up (Vogel 1979).
pub(crate) const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Steps of a point through a unit cube which fills it evenly: powers of the root of x^4 = x + 1 (Roberts 2018).
pub(crate) const EVEN_STEPS: [f64; 3] =
    [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_6];
