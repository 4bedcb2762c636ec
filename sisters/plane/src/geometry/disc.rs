//! Discs.

use std::f64::consts::TAU;

use glam::{DVec2, Vec2};

use crate::numeric::INSIDE_DISC;

/// Number of sides of the polygon by which a disc hides others.
pub const DISC_SIDES: usize = 32;

/// A solid disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Centre in world units.
    pub center: Vec2,
    /// Radius in world units, not negative.
    pub radius: f32,
}

impl Disc {
    /// The disc around a centre.
    pub const fn new(center: Vec2, radius: f32) -> Self {
        Self { center, radius }
    }

    /// The corners of the polygon by which the disc hides others, counterclockwise. All lie inside
    /// the disc, by less than two millionths of the radius or two roundings of their coordinates.
    pub fn polygon(&self) -> [Vec2; DISC_SIDES] {
        std::array::from_fn(|i| {
            let (sin, cos) = (TAU * i as f64 / DISC_SIDES as f64).sin_cos();
            let offset = f64::from(self.radius) * (1.0 - INSIDE_DISC) * DVec2::new(cos, sin);
            Vec2::new(toward(self.center.x, offset.x), toward(self.center.y, offset.y))
        })
    }
}

/// A coordinate plus an offset, rounded to single precision towards the coordinate.
fn toward(coordinate: f32, offset: f64) -> f32 {
    let rounded = (f64::from(coordinate) + offset) as f32;
    if (f64::from(rounded) - f64::from(coordinate)).abs() <= offset.abs() {
        rounded
    } else if offset > 0.0 {
        rounded.next_down()
    } else {
        rounded.next_up()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polygon_lies_inside() {
        let huge = f32::MAX;
        for (x, radius) in [(0.0, 1.0), (1000.1, 0.01), (-3e7, 5.0), (7.0, 0.0), (huge, huge), (1e-40, 1e-42)]
        {
            let disc = Disc::new(Vec2::new(x, -x), radius);
            for corner in disc.polygon() {
                assert!(corner.is_finite());
                let off = (corner.as_dvec2() - disc.center.as_dvec2()).length();
                assert!(off <= f64::from(radius), "{x} {radius} {off}");
                let rounding = 2.0 * f64::from(f32::EPSILON * x.abs() + f32::from_bits(1));
                if x != huge {
                    assert!(off >= f64::from(radius) * (1.0 - 2e-6) - 2.0 * rounding, "{x} {radius} {off}");
                }
            }
        }
    }
}
