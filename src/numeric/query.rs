//! Margins of the walks: direction masks, frustum in cells.
