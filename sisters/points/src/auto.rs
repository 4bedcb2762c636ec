//! Settings of the operators that need no hand.

use crate::spacing::automatic_radius;
use crate::splat::{Bias, Filter, Radius, SplatError, SplatOptions};
use glam::{DVec3, Vec3};

/// The radius of the flipping sphere, as a multiple of the largest distance and of the largest
/// distance over the splat radius. With it points are hidden that lie about the distance of two
/// points behind others; on the bunny of Tavares 2009 it is 10^3.
const FLIP: f64 = 4.0;

/// The tolerance of the splat operator in radii, for what slopes do not explain: noise and curves.
/// Of 0.7, 1, 1.5, 2 and 3.5 the least two had the fewest errors on the scenes called tuned of the
/// example `accuracy`; the larger of them allows for more noise.
const TOLERANCE: f32 = 1.0;

/// The settings of [`hpr`](crate::hpr) and [`splat`](crate::splat) by the distances between points.
/// [`surface`](crate::surface) needs none, and has fewer errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutoSettings {
    /// Half the side of a point's square, in units of the positions.
    pub radius: f32,
}

impl AutoSettings {
    /// Measures a cloud, as [`automatic_radius`] does.
    ///
    /// # Errors
    /// [`SplatError::PointNotFinite`].
    pub fn new(points: &[Vec3]) -> Result<Self, SplatError> {
        Ok(Self { radius: automatic_radius(points)? })
    }

    /// The options of the splat operator.
    pub fn splats(&self) -> SplatOptions<'static> {
        let bias = Bias::World((TOLERANCE * self.radius).min(f32::MAX));
        SplatOptions { radius: Radius::Same(self.radius), bias, filter: Filter::Max, slopes: true }
    }

    /// The logarithm of the radius of hidden point removal from an eye.
    pub fn log10_radius(&self, points: &[DVec3], eye: DVec3) -> f64 {
        let farthest = points.iter().fold(0.0, |most: f64, p| most.max(p.distance(eye)));
        let log10_radius = (FLIP * farthest / f64::from(self.radius)).log10().clamp(0.0, 10.0);
        // A cloud has no spacing if all points are at one place.
        if log10_radius.is_nan() { 3.0 } else { log10_radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_follow_the_spacing_and_the_distance() {
        let square: Vec<Vec3> = (0..2500).map(|i| Vec3::new((i % 50) as f32, (i / 50) as f32, 0.0)).collect();
        let auto = AutoSettings::new(&square).unwrap();
        // The sixth nearest neighbour is a diagonal away, at borders two steps.
        assert!((0.7..1.1).contains(&auto.radius), "{auto:?}");
        assert_eq!(auto.splats().bias, Bias::World(auto.radius));
        let log10 = AutoSettings { radius: 0.5 }.log10_radius(&[DVec3::ZERO, DVec3::X], DVec3::X * -124.0);
        assert_eq!(log10, 3.0);
        // A cloud of one place has settings, too.
        let auto = AutoSettings::new(&[Vec3::ONE; 3]).unwrap();
        assert_eq!(auto.log10_radius(&[DVec3::ONE], DVec3::ONE), 3.0);
        assert_eq!(auto.splats().check(3), Ok(()));
    }
}
