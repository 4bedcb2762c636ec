//! The kernels, and the errors of their parameters.

use crate::hull::MAX_POINTS;

/// The function that turns near points into far ones.
///
/// A larger radius, or a gamma nearer to 0, makes more points visible: fewer are falsely hidden in
/// hollows, and more are falsely visible through gaps between points. The best value depends on the
/// distance between points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// A point at distance `r` goes to the distance `2 R - r`, where `R` is `10^log10_radius` times
    /// the largest distance of a point from the eye. The value is at least 0; 2 to 3.5 are usual.
    Relative {
        /// The decimal logarithm of the radius, as a multiple of the largest distance.
        log10_radius: f64,
    },
    /// The same with `R` in units of the points' coordinates. It must not be less than the largest
    /// distance.
    Absolute {
        /// The radius of the sphere around the eye in which all points lie.
        radius: f64,
    },
    /// A point at distance `r` goes to the distance `r^gamma`. Gamma is below 0; -0.001 is usual.
    Exponential {
        /// The exponent.
        gamma: f64,
    },
}

/// Why points have no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HprError {
    /// A coordinate is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    PointNotFinite {
        /// The first such point.
        index: usize,
    },
    /// A coordinate of the eye is infinite or not a number.
    #[error("the eye has a coordinate that is not finite")]
    EyeNotFinite,
    /// The difference of a point and the eye is more than a double can hold.
    #[error("point {index} is too far from the eye")]
    TooFar {
        /// The first such point.
        index: usize,
    },
    /// There are more points than indices.
    #[error("{count} points are too many: at most {}", MAX_POINTS - 1)]
    TooMany {
        /// The number of points.
        count: usize,
    },
    /// A logarithm below 0 or above 300, or not a number.
    #[error("log10_radius is {log10_radius}, and must be from 0 to 300")]
    LogRadius {
        /// The given value.
        log10_radius: f64,
    },
    /// A radius that is not finite, or less than the largest distance of a point.
    #[error(
        "the radius is {radius}, and must be finite and at least {farthest}, the largest distance of a point from the eye"
    )]
    Radius {
        /// The given value.
        radius: f64,
        /// The largest distance of a point from the eye.
        farthest: f64,
    },
    /// An exponent that is not below 0, or not finite.
    #[error("gamma is {gamma}, and must be finite and below 0")]
    Gamma {
        /// The given value.
        gamma: f64,
    },
}
