//! Rounding margins, each with its reason.

/// Margins of the cell method.
pub(crate) mod cell {
    /// The region of a view is widened by this many cells.
    ///
    /// Far more than the rounding of sums of three products of coordinates up to 2^21 cells (about 1e-9), far less than a cell.
    pub(crate) const REGION: f64 = 1e-6;

    /// A half-plane whose value changes by less than this from cell to cell is not divided by: it is decided at the ends of
    /// the row. Larger slopes give quotients of which [`REGION`] still covers the rounding.
    pub(crate) const REGION_SLOPE: f64 = 1e-9;
}
