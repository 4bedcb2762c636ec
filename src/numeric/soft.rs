//! Constants of soft visibility: estimates on the cells of a grid.

/// A full opacity as a whole number: opacities of the pyramid are whole multiples of 2^-15.
///
/// A power of two, so that 1 and its halves are exact. Each level rounds once, by 2^-16 at most,
/// and adds the errors of two children at most.
pub(crate) const ONE: u32 = 1 << 15;

/// A march ends where less light than this is left.
///
/// The old rule of the cones ends there (Villegas 2016 and its program: opacity of 0.9999); a
/// picture of 8 bits cannot show less.
pub(crate) const DARK: f64 = 1e-4;

/// A direction whose share along an axis is smaller crosses hardly any planes of that axis: one at
/// most inside a grid of 8192 cells.
pub(crate) const ALONG: f64 = 1e-6;

/// A slab that reaches beyond the end of a march by less than this many cells is whole.
///
/// Positions in a grid of 8192 cells are rounded by 2^-39 at most. The march may end on the border
/// of the grid, and so do slabs.
pub(crate) const CUT: f64 = 1e-6;

/// A slab that is more opaque than this is opaque.
///
/// Opacities are multiples of 2^-15. Their interpolation has weights whose sum rounds to 1 - 2^-53;
/// without this margin, the power by which slabs count at grazing angles would let a quarter of the
/// light through there.
pub(crate) const FULLY: f64 = 1.0 - 1.0 / (1 << 17) as f64;

/// Slabs of a level are chosen where the logarithm of the cone's radius in cells, plus this, passes
/// the level.
///
/// Interpolation between cells of length L spreads a point by L / sqrt(6), and a disc of radius r
/// spreads by r / 2: equal for L = 1.22 r, whose logarithm to base 2 is 0.29; a half rounds to the
/// nearest level.
pub(crate) const SLAB_LEVEL: f64 = 0.79;

/// Rays from a point on a surface start this many cells away along the normal.
///
/// A cell is sqrt(3) cells long from corner to corner. A point farther from a plane is in no cell
/// that the plane touches.
pub(crate) const OFF_SURFACE: f64 = 1.733;

/// Turns the points of a spiral: the golden angle in radians, under which no two points line up
/// (Vogel 1979).
pub(crate) const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Steps of a point through a unit cube which fills it evenly: powers of the root of x^4 = x + 1
/// (Roberts 2018).
pub(crate) const EVEN_STEPS: [f64; 3] =
    [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_6];

/// A walk may stray from its line into cells that are this far from it, in cells.
///
/// Near the origin of the world positions are rounded by 2^-38 cells at most. A grid may lie 2^28
/// cells from the origin: there they are rounded by about 2^-24 cells, which is 6e-8.
pub(crate) const STRAY: f64 = 1e-6;

/// A cell whose middle is a whole cell from a point counts this much for it.
///
/// A point on a surface may be just there, with an open cell in front that has no other weight. The
/// weights of others are in sum 1.
pub(crate) const LEAST_WEIGHT: f64 = 1e-6;

/// For each ray of a cell, a brick is compared with so many that changed at most before it is
/// walked in without comparing.
///
/// A comparison takes some divisions on each axis. A brick on a floor holds hundreds of cells near
/// the surface, and a walk from each takes several steps at least: beyond about a thousand
/// comparisons, one walk from each cell costs less.
pub(crate) const COMPARED: usize = 1024;
