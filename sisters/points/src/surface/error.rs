//! What surfaces refuse.

use crate::cloud::LengthError;
use crate::hull::MAX_POINTS;

/// Why there is no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A coordinate of a position or of the origin is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    PointNotFinite {
        /// The first such point.
        index: usize,
    },
    /// A coordinate of the eye is infinite or not a number.
    #[error("the eye has a coordinate that is not finite")]
    EyeNotFinite,
    /// There are more points than indices.
    #[error("{count} points are too many: at most {MAX_POINTS}")]
    TooMany {
        /// The number of points.
        count: usize,
    },
    /// An attribute that not all points have.
    #[error(transparent)]
    Length(#[from] LengthError),
}
