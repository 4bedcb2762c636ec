//! Margins of occlusion buffers: silhouettes, depths, coverage.
//!
//! Points are relative to the origin of the rays. They come from single precision and are
//! subtracted in double precision, so their relative error is a few times 2^-53, about 1e-16.

/// Widening of rectangles on a face, and of the frustum's half-planes there.
///
/// Covers the transforms to a face (three products and sums of values up to 2) and the division by
/// depth: a few times 1e-16 each. The margin is a millionth of a usual pixel, so it costs nothing.
pub(crate) const DIRECTION: f64 = 1e-9;

/// Sine of the angle below which a plane of a parallel view counts as running along the rays.
///
/// A plane that is steeper bounds no directions and is left out, which makes the window wider. The
/// distance by which a plane of less slope shifts over the depth of the scene is added to its
/// offset.
pub(crate) const PLANE_ALONG_RAYS: f64 = 1e-6;

/// Widening of targets, and narrowing of occluders, in pixels.
///
/// Covers `(u + 1) * per_unit` and its inverse: two roundings of numbers up to 2^20 pixels,
/// 2.4e-10.
pub(crate) const PIXEL: f64 = 1e-6;

/// A half-plane `a u + b v + c >= 0` with a smaller `|a|` bounds no columns of a row of pixels; the
/// row is then decided as a whole. Larger ones are divided by.
pub(crate) const HALF_PLANE_SLOPE: f64 = 1e-12;

/// Such a row lies outside if the half-plane is below minus this: `|a u| <= 1e-12` for all its
/// columns, and sums of three terms up to 2 err by less than 1e-15.
pub(crate) const HALF_PLANE_OUTSIDE: f64 = 1e-11;

/// A plane whose normal is nearer than this to a right angle with parallel rays (the cosine) has no
/// depth: the quotient would keep fewer than seven digits.
pub(crate) const PLANE_EDGE_ON: f64 = 1e-9;

/// A plane nearer to the eye than this has no nearness: its quotients would overflow.
pub(crate) const SMALLEST_DIVISOR: f64 = 1e-300;

/// A plane whose distance from the eye is less than this share of the coordinates of its shape is
/// not used.
///
/// The distance is a sum of products of those coordinates: it then keeps a relative error below
/// 1e-8, which [`NEARNESS`] covers.
pub(crate) const PLANE_NEAR_EYE: f64 = 1e-7;

/// A vertex counts as in front of the eye on a face if its depth is more than this share of its
/// other coordinates: the quotients then stay below 1e6 and keep ten digits.
pub(crate) const VERTEX_DEPTH: f64 = 1e-6;

/// Margin of the conic of a sphere, scaled so that its terms are at most about 3: sums of ten of
/// them err by less than this.
pub(crate) const CONIC: f64 = 1e-13;

/// A rectangle around a sphere's conic is computed if the depth of its centre is more than this
/// above its radius, both as shares of its distance: the divisor is then at least 1e-6 of the terms
/// in it.
pub(crate) const CONIC_HORIZON: f64 = 1e-3;

/// A sphere whose conic has a smaller leading coefficient (of terms up to 1) is close to a parabola
/// on a face, and is not drawn there: the roots of the conic would keep less than half of their
/// digits. About one sphere in a million is.
pub(crate) const CONIC_PARABOLA: f64 = 1e-6;

/// The roots of a conic are known to this share of the inverse of its leading coefficient, on faces
/// of width 2.
///
/// A root is the sum of a product and a square root, both up to 2, over that coefficient: six
/// roundings err by less than 3e-15. The square under the root errs by less than [`CONIC`], which
/// is taken off first.
pub(crate) const CHORD_ROUNDING: f64 = 1e-14;

/// Added to a number below 2^31, this leaves the nearest integer in the lowest bits: 1.5 times
/// 2^52, in which the last place counts ones.
pub(crate) const NEAREST_INTEGER: f64 = 6_755_399_441_055_744.0;

/// The same for single precision and numbers below 2^22: 1.5 times 2^23.
pub(crate) const NEAREST_INTEGER_SINGLE: f32 = 12_582_912.0;

/// Directions this close to the outline of a ball (squared sine of half the chord, as a share) get
/// no depth: the root would keep less than half of its digits.
pub(crate) const BALL_OUTLINE: f64 = 1e-9;

/// A ball is entered at a depth only if the square of the tangent from the eye is more than this
/// share of the squared distance along the ray: the difference of squares then keeps ten digits.
pub(crate) const BALL_NEAR_EYE: f64 = 1e-6;

/// A plane that touches a ball is used if its distance from the eye is more than this share of the
/// distance of the centre, which is a term of it: ten digits stay.
pub(crate) const TANGENT_NEAR_EYE: f64 = 1e-6;

/// The eye is outside a sphere if its distance is more than this share above the radius:
/// coordinates are known to 1e-16 of their size, and the sine of the silhouette to 1e-10.
pub(crate) const SPHERE_AROUND_EYE: f64 = 1e-6;

/// A plane is behind another one if it is so by this share of their coefficients.
///
/// Planes whose distance passes [`PLANE_NEAR_EYE`] are known to 1e-9 of their coefficients; the
/// difference of two doubles that.
pub(crate) const PLANE_BEHIND_PLANE: f64 = 1e-8;

/// A solid inside a shell is scaled up by this share more, to contain the shell: sums of three
/// products and a root err by less than 1e-15 of the coordinates.
pub(crate) const BEHIND: f64 = 1e-9;

/// Relative rounding of a nearness to single precision, beside one step of its last digit.
///
/// A part in 2^22: twice the spacing of single precision, and ten times the error of the nearness
/// itself.
pub(crate) const NEARNESS: f32 = 2.4e-7;

/// Pixels by which an edge of a patch is widened on each side.
///
/// Covers the division by depth and the scaling to pixels (2^20 at most, so 1e-9), and steps of
/// `x += slope` over the rows of an edge.
pub(crate) const EDGE: f64 = 1e-5;

/// Coordinates of pixels along an edge err by less than this share of those of its ends: sixteen
/// roundings.
pub(crate) const EDGE_ROUNDING: f64 = 4e-15;

/// An edge with more columns than this for one row marks all of its pixels as touched: multiplying
/// by its slope would magnify errors too much. In double, and in single precision.
pub(crate) const EDGE_FLAT: f64 = 1e4;
pub(crate) const FLAT: f32 = 1024.0;

/// Edges are drawn as they are if the magnitudes of their coordinates in pixels sum to less than
/// this, others only near the area: edges are drawn in single precision.
pub(crate) const FAR_PIXEL: f32 = 65_536.0;

/// An edge that reaches farther is cut: the part is drawn that lies within this many times its width,
/// and this many pixels more, of the area.
///
/// The width grows by [`WIDTH_ROUNDINGS`] of [`PROJECTED`] of the sum of four coordinates of that
/// part, below a part in 40,000 of the greatest: that is less, while areas lie within 500,000 pixels.
pub(crate) const FAR_WIDTHS: f64 = 1.5;
pub(crate) const FAR_ASIDE: f64 = 16.0;

/// The width of a piece of an edge grows by this many times the rounding of its coordinates: once for
/// these, with room for the rounding of the widths themselves.
pub(crate) const WIDTH_ROUNDINGS: f64 = 3.0;

/// Coordinates of pixels in single precision, and the columns that an edge passes, err by less than
/// this share of the magnitudes of the coordinates of its ends and of the middle of the face.
///
/// With e = 2^-24: the eye is subtracted in two parts, each of which errs by e of the difference
/// (where the first difference loses digits it is exact). A quotient of two such coordinates, a
/// product and a sum take 8 e. The slope of an edge and a column on it take five more roundings of
/// differences of coordinates, 10 e. Together 18 e, below 32 e.
pub(crate) const PROJECTED: f32 = 1.0 / (1 << 19) as f32;

/// Points that are turned in single precision lie within this share of the lengths in the sum: six
/// roundings of 2^-24, of a matrix, its products and three sums.
pub(crate) const PLACED: f64 = 1.0 / (1 << 21) as f64;

/// Pieces of edges are known to this share of the greatest coordinates of the edge's ends, over the
/// depth of the piece.
///
/// With e = 2^-24: two roundings of each coordinate move a point of the face by 4 e; the pixels of
/// the ends themselves, which are in single precision, err by 16 e, and others are rounded to it,
/// by 2 e. Together 22 e, below 32 e.
pub(crate) const PIECE_ROUNDING: f64 = 1.0 / (1 << 19) as f64;

/// Points of a face move by at most this many times the slack of a point over its depth: twice, and
/// room for the rounding of slacks and quotients in single precision, below 1e-6.
pub(crate) const SLACK_ROOM: f32 = 2.001;

/// A patch is drawn if it is farther from the eye than this many times the near limit and the error
/// of its points together.
///
/// Let n be the limit and s the error along each axis. A point nearer than 8 (n + s) may be cut at
/// the limit, or move without bound on the face. One farther away has a depth of at least 8 (n + s)
/// / sqrt(3) > 4 (n + s): it is not cut, and a straight edge that is less deep than 2 s somewhere
/// leaves the face together with the chain that it replaces.
pub(crate) const CLEARANCE: f64 = 8.0;

/// Objects nearer than this many times the distance that the eye may go are visible without a test.
///
/// Frusta grow by one such distance at this depth, so that an eighth more of the width is drawn.
/// Nothing rests on the exact value: larger numbers make more objects visible, smaller ones the
/// buffers wider.
pub(crate) const NEAREST_IN_REACHES: f64 = 8.0;

/// Parallel rays start this many times the radius of the scene before its middle, so that depths
/// are positive and of one magnitude: from 3 to 5 radii, which [`MAX_DEPTH`] bounds.
pub(crate) const MIDDLE_DEPTH: f64 = 4.0;

/// All of the scene is nearer to that start than this many times its radius.
pub(crate) const MAX_DEPTH: f64 = 6.0;

/// Pixels beyond this number are cut off before they become whole: far outside of any window (2^20
/// pixels), far inside of the range of 64 bits.
pub(crate) const FARTHEST_PIXEL: f64 = 1e9;

/// A half width in pixels that reaches across any area that edges are drawn in: areas are narrower
/// than [`FAR_PIXEL`].
pub(crate) const ACROSS_AREA: f32 = 1e6;

/// A patch that hides from all eyes within the reach is farther from the eye than this many
/// reaches, beside the distance that all patches keep.
///
/// Of a patch that all eyes lie on one side of, it is enough that the outline is: nothing else of
/// it is drawn. Let no point of an outline be nearer than D, and let it be known to s along each
/// axis. A point of it within the reach r of a ray is drawn within R = r + sqrt(3) s of a point of
/// the ray, which is farther away than D - R - sqrt(3) s. Its share along the axis of the face is 1
/// / sqrt(3) at least, so the depth of the drawn point is more than (D - R - sqrt(3) s) / sqrt(3) -
/// R. That is above the near limit n if D is at least sqrt(3) n + 2.8 r + 7 s; it is 8 n + 8 s + 3
/// r.
pub(crate) const REACH_CLEARANCE: f64 = 3.0;

/// A point of an outline at depth z that lies within the reach r of a ray of the face comes within
/// this many times r / z of it along each axis of the face: sqrt(1 + u^2) with |u| <= 1, and room
/// for rounding in single precision.
pub(crate) const REACH_ROOM: f32 = 1.4143;

/// Silhouettes are turned inwards for an eye that may go as far as r by the sine r / d, for an edge
/// at the distance d. This is added to the sine: planes of cones of directions are known to
/// [`CONE_MARGIN`](crate::numeric::shape::CONE_MARGIN).
pub(crate) const REACH_SINE: f64 = 1e-8;

/// Edges with a greater sine are too near: the cosine would keep fewer digits than its sine.
pub(crate) const REACH_STEEPEST: f64 = 0.99;

/// A piece of a rim that is shorter on the face has no direction: that of a longer one is known to
/// 1e-9.
pub(crate) const RIM_SHORTEST: f64 = 1e-6;

/// The slab of a patch whose normal is nearer than this to a right angle with parallel rays (the
/// cosine) does not bound its depth; its box does.
pub(crate) const SLAB_EDGE_ON: f64 = 1e-3;

/// Rounds a nearness to single precision, upwards by at least [`NEARNESS`].
#[inline]
pub(crate) fn above(near: f64) -> f32 {
    let n = near as f32;
    (n + n.abs() * NEARNESS).next_up()
}

/// Rounds a nearness to single precision, downwards by at least [`NEARNESS`].
#[inline]
pub(crate) fn below(near: f64) -> f32 {
    let n = (near as f32).min(f32::MAX);
    (n - n.abs() * NEARNESS).next_down()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearness_is_rounded_outwards_at_all_sizes() {
        for exponent in -140..127 {
            for factor in [1.0, 1.0 + 1e-9, 1.3, 1.999_999_9] {
                for near in [factor * 2f64.powi(exponent), -factor * 2f64.powi(exponent)] {
                    assert!(f64::from(above(near)) > near && f64::from(below(near)) < near, "{near}");
                    if near.abs() > 1e-30 {
                        assert!(f64::from(above(near)) - near < 5e-7 * near.abs(), "{near}");
                        assert!(near - f64::from(below(near)) < 5e-7 * near.abs(), "{near}");
                    }
                }
            }
        }
        assert_eq!(above(f64::INFINITY), f32::INFINITY);
        assert!(below(f64::INFINITY) < f32::MAX);
        assert!(above(f64::NAN).is_nan());
    }
}
