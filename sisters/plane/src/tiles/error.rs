//! Errors of tile layers and of fields of view.

/// Why a tile layer, or the options of a field of view, were refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TileError {
    /// A number that must be finite is not.
    #[error("{what} must be finite, not {value}")]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number that must be greater than zero is not.
    #[error("{what} must be greater than zero, not {value}")]
    NotPositive {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number is too large.
    #[error("{what} must be at most {limit}, not {value}")]
    TooLarge {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The greatest value that is allowed.
        limit: f64,
    },
    /// A direction without length.
    #[error("{what} must not be zero")]
    NoDirection {
        /// The argument.
        what: &'static str,
    },
    /// A grid of other dimensions than those of the map.
    #[error("the tiles are {found_width} by {found_height}, but those of the map {width} by {height}")]
    Dimensions {
        /// The columns of the grid.
        found_width: u32,
        /// The rows of the grid.
        found_height: u32,
        /// The columns of the map.
        width: u32,
        /// The rows of the map.
        height: u32,
    },
    /// A tile that the grid does not have.
    #[error("the tile ({x}, {y}) lies outside of the grid of {width} by {height} tiles")]
    Outside {
        /// The column.
        x: u32,
        /// The row.
        y: u32,
        /// The columns of the grid.
        width: u32,
        /// The rows of the grid.
        height: u32,
    },
}

/// A number, if it is finite.
pub(super) fn finite(what: &'static str, value: f64) -> Result<f64, TileError> {
    if value.is_finite() { Ok(value) } else { Err(TileError::NotFinite { what, value }) }
}

/// A number, if it is greater than zero; infinity is.
pub(super) fn positive(what: &'static str, value: f64) -> Result<f64, TileError> {
    match value {
        value if value > 0.0 => Ok(value),
        value if value.is_nan() => Err(TileError::NotFinite { what, value }),
        value => Err(TileError::NotPositive { what, value }),
    }
}

/// A number whose magnitude is at most `limit`.
pub(super) fn within(what: &'static str, value: f64, limit: f64) -> Result<f64, TileError> {
    if value.abs() <= limit { Ok(value) } else { Err(TileError::TooLarge { what, value, limit }) }
}
