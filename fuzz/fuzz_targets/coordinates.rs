//! Points as fuzz targets make them.

use arbitrary::Arbitrary;
use glam::Vec3;

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

/// Three of them.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub struct Point(Coordinate, Coordinate, Coordinate);

impl Point {
    pub fn value(self) -> Vec3 {
        Vec3::new(self.0.value(), self.1.value(), self.2.value())
    }
}
