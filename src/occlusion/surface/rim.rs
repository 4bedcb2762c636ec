//! The rims of components, for an eye that may go some way: pixels that the eye may see past a rim are marked.
//!
//! A ray of a pixel that keeps farther than the reach from every point of a rim passes the same triangles, counted with
//! signs, as the segments from all places of the eye to a point of the ray. So the pixels are marked that contain a ray within the
//! reach of a side of the rim.

use glam::DVec3;

use crate::numeric::occlusion::{EDGE, PIECE_ROUNDING, RIM_SHORTEST};
use crate::occlusion::surface::deep::{Cut, DeepSides};
use crate::occlusion::surface::raster::Raster;
use crate::occlusion::surface::scratch::WholeSide;

/// The depths of a piece of a side differ at most by the first factor where its strip is wider than so many pixels, elsewhere
/// by the second one. Strips narrower than the least width are not divided.
const STEP_WIDE: f64 = 1.25;
const STEP: f64 = 2.0;
const WIDE: f64 = 2.0;
const NARROW: f64 = 0.25;

/// Draws the sides of rims.
pub(super) struct Rims {
    pub(super) sides: DeepSides,
    /// How far the eye may go.
    pub(super) reach: f64,
}

impl Rims {
    /// Marks the pixels with rays that come within the reach of a side. Points of the side that are less deep than the near limit
    /// are not near any ray of the face: see [`REACH_CLEARANCE`](crate::numeric::occlusion::REACH_CLEARANCE).
    pub(super) fn draw(&self, raster: &mut Raster, side: &WholeSide) {
        let [mut p, mut q] = side.ends;
        let limit = self.sides.limit;
        if p.z < limit && q.z < limit {
            return;
        }
        match self.sides.cut(side.ends) {
            Some(Cut { at, leaves: true }) => q = at,
            Some(Cut { at, leaves: false }) => p = at,
            None => {}
        }
        let (near, far) = if p.z > q.z { (q, p) } else { (p, q) };
        let [a, b] = side.ends.map(|end| end.abs().max_element());
        let rounding = PIECE_ROUNDING * (a + b);
        // The slack bounds each coordinate.
        let reach = self.reach + 3f64.sqrt() * side.slack;
        let mut start = near;
        loop {
            let end = start.z * step(reach / start.z * self.sides.per_unit);
            let is_last = end.is_nan() || end >= far.z;
            let mut stop = far;
            if !is_last {
                stop = near + (far - near) * ((end - near.z) / (far.z - near.z));
                stop.z = end;
            }
            self.piece(raster, start, stop, reach, rounding);
            if is_last {
                break;
            }
            start = stop;
        }
    }

    /// Draws a piece of a side, from its lesser to its greater depth.
    ///
    /// Let a point at depth z lie within the reach r of a ray through p = (u, v). Then it lies at p + d on the face, with
    /// d = A x / z, where |x| <= r and A has the rows (1, 0, -u) and (0, 1, -v). Along a unit vector n that is at most
    /// r / z sqrt(1 + (n . p)^2).
    fn piece(&self, raster: &mut Raster, start: DVec3, stop: DVec3, reach: f64, rounding: f64) {
        let per_unit = self.sides.per_unit;
        let ratio = reach / start.z;
        let ([u0, v0], [u1, v1]) = ([start, stop].map(|p| [p.x / p.z, p.y / p.z])).into();
        let length = (u1 - u0).hypot(v1 - v0);
        // How far the line of the piece passes from the middle of the face.
        let beside = if length > RIM_SHORTEST { (u0 * v1 - u1 * v0).abs() / length } else { f64::INFINITY };
        let most = [u0, v0, u1, v1].map(f64::abs).into_iter().fold(0.0, f64::max);
        let unsure = EDGE + rounding / start.z * per_unit;
        let across = widening(ratio, beside, 2f64.sqrt()) * per_unit + 2f64.sqrt() * unsure;
        let around = widening(ratio, most, 1.0) * per_unit + unsure;
        raster.strip(self.sides.pixel(start), self.sides.pixel(stop), across, around);
    }
}

/// How far points of the face move along a direction, for points of space that move by `ratio` of their depth: the rays are
/// those of the face, where that coordinate is at most `most`, and the points have up to `at` of it.
fn widening(ratio: f64, at: f64, most: f64) -> f64 {
    // A ray is no farther than that from the point: sqrt(1 + most^2) is less than two.
    let coordinate = (at + 2.0 * ratio).min(most);
    ratio * (1.0 + coordinate * coordinate).sqrt()
}

/// The ratio of the depths of a piece whose strip is so many pixels wide.
fn step(wide: f64) -> f64 {
    match wide {
        wide if wide > WIDE => STEP_WIDE,
        wide if wide > NARROW => STEP,
        _ => f64::INFINITY,
    }
}
