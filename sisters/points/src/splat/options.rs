//! The parameters of the splat operator.

/// The size of squares: half of a side, in units of the world.
///
/// A square faces the camera, has the depth of its point everywhere, and covers the pixels whose centres are
/// in it, at least the point's own and at most 1025 in a row. Too small squares let hidden points show
/// through the gaps between them, too large ones hide visible points beside silhouettes.
/// The radius `R` of the thesis is `R * (width / fov_y) / (height / (2 tan(fov_y / 2)))` here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Radius<'a> {
    /// The same for all points; at least 0.
    Same(f32),
    /// One for each point.
    Each(&'a [f32]),
}

/// How far behind the depth image a point may be and still be visible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bias {
    /// A part of the way from the image to the far plane, in the depths of a graphics processor; at
    /// least 0, less than 1. The thesis has 0.05. At the depth `z` this is
    /// `z far / ((1 - part) far + part z) - z` in the world.
    Window(f32),
    /// A length in the world; at least 0.
    World(f32),
}

/// The change of the depth image before points are tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// No change.
    None,
    /// The largest depth of 3x3 pixels, which makes squares smaller at inner silhouettes. A pixel
    /// beside one without points stays as it is, so that the outer silhouette does not shrink.
    #[default]
    Max,
    /// The smallest depth of 3x3 pixels, except beside pixels without points. The thesis' text asks
    /// for it; it hides more points that are visible.
    Min,
}

/// The parameters of the operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplatOptions<'a> {
    /// The size of squares.
    pub radius: Radius<'a>,
    /// The tolerance of the test.
    pub bias: Bias,
    /// The change of the depth image.
    pub filter: Filter,
    /// Whether squares are taken as parts of surfaces that may slant. A square is at the depth of
    /// its point everywhere, so that on a surface seen at a grazing angle it hides its neighbours:
    /// ground and facades of a street lose a third of their visible points. With it, the tolerance
    /// grows by the depth that the surface gains over half a square, as the depth image around the
    /// point has it: on each axis the lesser of the slopes to both sides, and none where one rises
    /// and the other falls. Costs four more pixels for each point behind the depth image.
    pub slopes: bool,
}

impl SplatOptions<'_> {
    /// Whether the parameters serve for so many points. The operators ask by themselves.
    ///
    /// # Errors
    /// [`SplatError`] names the parameter at fault.
    pub fn check(&self, count: usize) -> Result<(), SplatError> {
        let good = |radius: f32| radius >= 0.0 && radius.is_finite();
        let radii = match &self.radius {
            Radius::Same(radius) => std::slice::from_ref(radius),
            Radius::Each(radii) if radii.len() == count => radii,
            Radius::Each(radii) => return Err(SplatError::Radii { radii: radii.len(), points: count }),
        };
        if let Some(index) = radii.iter().position(|&radius| !good(radius)) {
            return Err(SplatError::Radius { index, radius: radii[index] });
        }
        match self.bias {
            Bias::Window(part) if (0.0..1.0).contains(&part) => Ok(()),
            Bias::World(length) if good(length) => Ok(()),
            bias => Err(SplatError::Bias { bias }),
        }
    }
}

/// Why points have no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplatError {
    /// A coordinate is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    PointNotFinite {
        /// The first such point.
        index: usize,
    },
    /// A radius that is negative, infinite or not a number.
    #[error("the radius of point {index} is {radius}, and must be finite and at least 0")]
    Radius {
        /// The first such point; 0 if all have the same radius.
        index: usize,
        /// Its radius.
        radius: f32,
    },
    /// There is not one radius for each point.
    #[error("{radii} radii for {points} points")]
    Radii {
        /// The number of radii.
        radii: usize,
        /// The number of points.
        points: usize,
    },
    /// A part that is not from 0 to below 1, or a length that is not from 0 to below infinity.
    #[error("the bias is {bias:?}: a part must be at least 0 and below 1, a length at least 0 and finite")]
    Bias {
        /// The given bias.
        bias: Bias,
    },
}
