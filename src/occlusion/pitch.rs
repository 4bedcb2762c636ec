//! How finely the faces of a view are divided.

use glam::DVec3;

use crate::occlusion::tiles::TILE;

/// The most pixels along a whole face, of which only a window is kept.
const MAX_PIXELS: i64 = 1 << 20;

/// A window is taken to be at least this wide, on faces of width 2, to choose the size of pixels.
const NARROWEST: f64 = 1e-6;

/// How finely faces are divided.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pitch {
    /// Pixels along a face that spans 90 degrees.
    pub(crate) pixels: f64,
    /// The longer side of the largest window has at least this many.
    pub(crate) least: f64,
    /// Targets nearer than this are never taken to be hidden.
    pub(crate) nearest: f64,
    /// The radius of the scene: half the width of the plane of parallel rays.
    pub(crate) radius: f64,
    /// The middle of that plane.
    pub(crate) middle: DVec3,
}

impl Pitch {
    /// The pixels along each face, a multiple of [`TILE`], if the widest window has this width on a
    /// face of width 2.
    pub(crate) fn pixels_of_face(&self, widest: f64, parallel: bool) -> i64 {
        let widest = widest.max(NARROWEST);
        let enough = self.least * 2.0 / widest;
        let pixels = if parallel { self.pixels * 2.0 / widest } else { self.pixels };
        let pixels = (pixels.max(enough).min(MAX_PIXELS as f64) / TILE as f64).ceil() as i64 * TILE;
        pixels.max(TILE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_views_get_enough_pixels() {
        let pitch = Pitch { pixels: 360.0, least: 128.0, nearest: 0.01, radius: 9.0, middle: DVec3::ZERO };
        assert_eq!(pitch.pixels_of_face(2.0, false), 360);
        assert_eq!(pitch.pixels_of_face(0.1, false), 2560);
        assert_eq!(pitch.pixels_of_face(0.1, true), 7200);
        assert_eq!(pitch.pixels_of_face(0.0, true), MAX_PIXELS);
        assert_eq!(Pitch { pixels: 0.5, least: 0.0, ..pitch }.pixels_of_face(2.0, false), TILE);
    }
}
