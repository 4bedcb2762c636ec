//! Coordinates as fuzz targets make them.

use arbitrary::Arbitrary;

/// A coordinate: mostly near the grid, sometimes anything at all.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub enum Coordinate {
    Near(u16),
    OnFace(u8),
    Any(f32),
}

impl Coordinate {
    pub fn value(self) -> f32 {
        match self {
            Self::Near(v) => f32::from(v) / 2048.0 - 4.0,
            Self::OnFace(v) => f32::from(v % 25),
            Self::Any(v) => v,
        }
    }
}
