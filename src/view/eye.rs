//! The eye of a camera: found from a matrix, or given and compared with the matrix.

use glam::{DMat3, DVec3, DVec4};

use crate::error::Error;
use crate::numeric::view::{CANCELLED, EYE_REFUSED, EYE_ROUNDING, FLAT_VOLUME, SIGHT};

/// Where the view rays start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Origin {
    /// At a point, known to within `error` world units along each axis.
    Eye { at: DVec3, error: f64 },
    /// Infinitely far away: all rays run along this direction.
    Direction(DVec3),
}

/// How far a camera sees, as far as that limits the coordinates that its matrix was made from;
/// else 0.
pub(crate) fn sight(at: DVec3, depths: [DVec4; 2], w: DVec4) -> f64 {
    let distance = |plane: DVec4| {
        let length = plane.truncate().length();
        let known = length > CANCELLED * w.truncate().length();
        if known { (plane.truncate().dot(at) + plane.w).abs() / length } else { f64::INFINITY }
    };
    let [a, b] = depths.map(distance);
    let sight = a.max(b).min(SIGHT * a.min(b));
    if sight.is_finite() { sight } else { 0.0 }
}

/// How far a given eye may be from the matrix's along each axis (0 where rounding explains it), and
/// how far it lies beside the planes that contain the matrix's. In the matrix's eye x, y and w of
/// clip space are zero; one that is off by a rounding lies next to these planes, however unsure it
/// is where they meet.
pub(crate) fn check_eye(at: DVec3, rows: [DVec4; 3], sight: f64) -> Result<(f64, f64), Error> {
    let (mut sure, mut beside) = (true, 0f64);
    let mut refused = None;
    for row in rows {
        let length = row.truncate().length();
        let (off, far) = ((row.truncate().dot(at) + row.w).abs() / length, row.w.abs() / length);
        // A row without direction says nothing.
        if !off.is_finite() || !far.is_finite() {
            continue;
        }
        let coordinates = at.length() + far;
        let allowed = EYE_REFUSED * (coordinates + sight);
        sure &= off <= EYE_ROUNDING * coordinates;
        if off > allowed && off > refused.map_or(0.0, |r: (f64, f64)| r.0) {
            refused = Some((off, allowed));
        }
        beside = beside.max(off);
    }
    let [x, y, w] = rows;
    let found = || match find_eye(x, y, w) {
        Ok(Origin::Eye { at, .. }) => Some(at),
        _ => None,
    };
    if let Some((off, allowed)) = refused {
        return Err(Error::EyeMismatch { given: at, found: found().unwrap_or(DVec3::NAN), off, allowed });
    }
    let unsure = || found().map_or(at.length() + sight, |found| (found - at).length());
    Ok((if sure { 0.0 } else { unsure() }, beside))
}

/// The eye of a perspective camera: where x, y and w of clip space are all zero.
pub(crate) fn find_eye(x: DVec4, y: DVec4, w: DVec4) -> Result<Origin, Error> {
    let [a, b, c] = [x, y, w].map(|row| {
        let length = row.truncate().length();
        if length > 0.0 { row / length } else { row }
    });
    let m = DMat3::from_cols(a.truncate(), b.truncate(), c.truncate()).transpose();
    if m.determinant().abs() < FLAT_VOLUME {
        return Err(Error::Matrix("it maps space to a plane, a line or a point"));
    }
    let inverse = m.inverse();
    let at = inverse * -DVec3::new(a.w, b.w, c.w);
    if !at.is_finite() {
        return Err(Error::Matrix("its eye is not at a finite point"));
    }
    // Each of the three planes may be off by its rounding; the more askew they meet, the farther
    // their point is off.
    let spread: f64 = inverse.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
    let error = spread * EYE_ROUNDING * at.length();
    Ok(Origin::Eye { at, error })
}
