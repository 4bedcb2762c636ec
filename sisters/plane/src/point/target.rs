//! Discs as targets: compared with the pieces of the visible region by distances, which are rounded
//! outwards.

use glam::DVec2;

use crate::geometry::{Disc, orient, point_along};
use crate::numeric::{DISTANCE, TILT};
use crate::point::envelope::{BLOCKED, OPEN, Piece};
use crate::point::wall::Around;

/// Points whose directions enclose those to a disc, for an eye outside of it: the first and the
/// last counterclockwise.
pub(crate) fn sides(eye: DVec2, disc: &Disc) -> [DVec2; 2] {
    let to = disc.center.as_dvec2() - eye;
    let half = (f64::from(disc.radius) / to.length()).min(1.0).asin() + TILT;
    let direction = to.normalize_or(DVec2::X);
    [-half, half].map(|angle| point_along(eye, DVec2::from_angle(angle).rotate(direction)))
}

/// Whether a disc meets a piece of the region, as far as `range`; in doubt, yes.
pub(crate) fn meets(around: &Around, range: f64, disc: &Disc, piece: &Piece) -> bool {
    if piece.wall == BLOCKED {
        return false;
    }
    let eye = around.eye;
    let center = disc.center.as_dvec2() - eye;
    let wall = (piece.wall != OPEN).then(|| around.wall(piece.wall));
    let [from, to] = [&piece.from, &piece.to].map(|along| around.vague(along).v.normalize_or(DVec2::X));
    let faces = |p: DVec2| from.perp_dot(p) >= 0.0 && p.perp_dot(to) >= 0.0;
    let before = wall.is_none_or(|wall| orient(wall.a, wall.b, disc.center.as_dvec2()) >= 0.0);
    let off = center.length();
    if faces(center) && before && off <= range {
        return true;
    }
    let radius = f64::from(disc.radius);
    // Beyond this distance nothing touches the disc.
    let far = range.min((off + radius) * (1.0 + DISTANCE));
    let (ends, doubt) = match wall {
        Some(wall) => {
            let [a, b] = [&piece.from, &piece.to].map(|along| around.hit(wall, along));
            ([a.0 - eye, b.0 - eye], a.1 + b.1)
        }
        None => ([from * far, to * far], 0.0),
    };
    let mut nearest = [from, to].into_iter().zip(ends).fold(f64::INFINITY, |nearest, (side, end)| {
        nearest.min(distance(center, DVec2::ZERO, side * end.length().min(far)))
    });
    if wall.is_some()
        && let Some([a, b]) = inside_circle(ends[0], ends[1], range + doubt)
    {
        nearest = nearest.min(distance(center, a, b));
    }
    // The nearest point of the circle that ends the range.
    let rim = center * (range / off);
    if off > range && faces(rim) && wall.is_none_or(|wall| orient(wall.a, wall.b, eye + rim) >= 0.0) {
        nearest = nearest.min(off - range);
    }
    nearest <= radius * (1.0 + DISTANCE) + doubt + DISTANCE * (off + eye.length())
}

/// The part of a segment inside a circle around the origin.
pub(crate) fn inside_circle(a: DVec2, b: DVec2, range: f64) -> Option<[DVec2; 2]> {
    let along = b - a;
    let squared = along.length_squared();
    if a.length().max(b.length()) <= range || squared == 0.0 {
        return (a.length() <= range).then_some([a, b]);
    }
    let middle = -a.dot(along) / squared;
    let off = (a + along * middle).length();
    let half = ((range * range - off * off).max(0.0) / squared).sqrt();
    let (first, last) = ((middle - half).clamp(0.0, 1.0), (middle + half).clamp(0.0, 1.0));
    (off <= range && middle + half >= 0.0 && middle - half <= 1.0)
        .then(|| [first, last].map(|at| a + along * at))
}

/// The distance of a point from a segment.
pub(crate) fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let at = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    // Where the ends are the same, the quotient is not a number.
    let nearest = if at.is_nan() { a } else { a + along * at };
    (p - nearest).length().min((p - a).length()).min((p - b).length())
}
