//! Visibility by single rays, in double precision. A ray that is nearly stopped counts as stopped,
//! so that a ray that gets through proves that its end is visible.

use glam::DVec2;

/// Rays stop this far before rectangles, in world units: far more than rounding.
const NEAR: f64 = 1e-6;

/// A closed rectangle.
#[derive(Debug, Clone, Copy)]
pub struct Box2 {
    pub min: DVec2,
    pub max: DVec2,
}

impl Box2 {
    pub fn around(center: DVec2, half: DVec2) -> Self {
        Self { min: center - half, max: center + half }
    }

    /// Whether a point is inside, on the border, or near it.
    pub fn holds(&self, p: DVec2) -> bool {
        p.cmpge(self.min - NEAR).all() && p.cmple(self.max + NEAR).all()
    }

    /// Whether the way from one point to another comes near.
    pub fn stops(&self, from: DVec2, to: DVec2) -> bool {
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            let (step, lo, hi) = (to[axis] - from[axis], self.min[axis] - NEAR, self.max[axis] + NEAR);
            if step.abs() < 1e-12 {
                if from[axis] < lo || from[axis] > hi {
                    return false;
                }
                continue;
            }
            let (a, b) = ((lo - from[axis]) / step, (hi - from[axis]) / step);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
        first <= last
    }
}

#[test]
fn rays_and_rectangles() {
    let wall = Box2 { min: DVec2::new(1.0, 0.0), max: DVec2::new(2.0, 5.0) };
    assert!(wall.stops(DVec2::new(0.0, 1.0), DVec2::new(3.0, 2.0)));
    assert!(wall.stops(DVec2::new(0.0, 5.0), DVec2::new(3.0, 5.0)));
    assert!(!wall.stops(DVec2::new(0.0, 5.1), DVec2::new(3.0, 5.1)));
    assert!(!wall.stops(DVec2::new(0.0, 1.0), DVec2::new(0.9, 2.0)));
    assert!(wall.stops(DVec2::new(1.5, -1.0), DVec2::new(1.5, 9.0)));
    assert!(wall.holds(DVec2::new(1.0, 5.0)) && !wall.holds(DVec2::new(0.9, 3.0)));
}
