//! The rims of components, for an eye that may go some way: pixels that the eye may see past a rim
//! are marked.
//!
//! A ray of a pixel that keeps farther than the reach from every point of a rim passes the same
//! triangles, counted with signs, as the segments from all places of the eye to a point of the ray.
//! So the pixels are marked that contain a ray within the reach of a side of the rim.

use glam::DVec3;

use crate::geometry::Room;
use crate::numeric::occlusion::{EDGE, PIECE_ROUNDING, RIM_SHORTEST};
use crate::occlusion::surface::deep::{Cut, DeepSides};
use crate::occlusion::surface::raster::Raster;
use crate::occlusion::surface::sides::WholeSide;

/// The depths of a piece of a side differ at most by the first factor where its strip is wider than
/// `WIDE` pixels, elsewhere by the second one. Strips narrower than `NARROW` are not divided.
const STEP_WIDE: f64 = 1.25;
const STEP: f64 = 2.0;
const WIDE: f64 = 2.0;
const NARROW: f64 = 0.25;

/// Draws the sides of rims.
pub(super) struct Rims {
    pub(super) sides: DeepSides,
    /// Where the eye may go, along the axes of the face.
    pub(super) room: Room,
}

impl Rims {
    /// The same in pixels that are finer by a factor.
    pub(super) fn finer(&self, by: f64) -> Self {
        Self { sides: self.sides.finer(by), room: self.room }
    }

    /// Marks the pixels with rays that come within the reach of a side. Points of the side that are
    /// less deep than the near limit are not near any ray of the face: see
    /// [`REACH_CLEARANCE`](crate::numeric::occlusion::REACH_CLEARANCE).
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
        let room = self.room.grown(side.slack);
        let mut start = near;
        loop {
            let end = start.z * step(room.radius() / start.z * self.sides.per_unit);
            let is_last = end.is_nan() || end >= far.z;
            let mut stop = far;
            if !is_last {
                stop = near + (far - near) * ((end - near.z) / (far.z - near.z));
                stop.z = end;
            }
            self.piece(raster, start, stop, &room, rounding);
            if is_last {
                break;
            }
            start = stop;
        }
    }

    /// Draws a piece of a side, from its lesser to its greater depth.
    ///
    /// Let a point at depth z be off a ray through p = (u, v) by x, a point of the room. Then it
    /// lies at p + d on the face, with d = A x / z, where A has the rows (1, 0, -u) and (0, 1, -v).
    /// Along a unit vector n that is as far as the room goes along (n, -n . p), over z.
    fn piece(&self, raster: &mut Raster, start: DVec3, stop: DVec3, room: &Room, rounding: f64) {
        let per_unit = self.sides.per_unit;
        let ratio = room.radius() / start.z;
        let ([u0, v0], [u1, v1]) = ([start, stop].map(|p| [p.x / p.z, p.y / p.z])).into();
        let length = ((u1 - u0) * (u1 - u0) + (v1 - v0) * (v1 - v0)).sqrt();
        let most = [u0, v0, u1, v1].map(f64::abs).into_iter().fold(0.0, f64::max);
        let unsure = EDGE + rounding / start.z * per_unit;
        let normal = (length > RIM_SHORTEST).then(|| [(v0 - v1) / length, (u1 - u0) / length]);
        let wide = match normal {
            Some([u, v]) => {
                // No ray is farther than that from the point: sqrt(1 + 2) is less than two. So
                // less, so still less.
                let line = u * u0 + v * v0;
                let first = widening(room, start.z, [u, v], (line, 2.0 * ratio), 2f64.sqrt());
                widening(room, start.z, [u, v], (line, first), 2f64.sqrt())
            }
            None => ratio * 3f64.sqrt(),
        };
        let along = |normal| widening(room, start.z, normal, (0.0, most + 2.0 * ratio), 1.0);
        let across = wide * per_unit + 2f64.sqrt() * unsure;
        let around = along([1.0, 0.0]).max(along([0.0, 1.0])) * per_unit + unsure;
        raster.strip(self.sides.pixel(start), self.sides.pixel(stop), across, around);
    }
}

/// How far points of the face move along a direction, for points of space at some depth that move
/// in a room: the rays are those of the face, where that coordinate is at most `most`, and no
/// farther than `by` from `at`.
fn widening(room: &Room, depth: f64, [u, v]: [f64; 2], (at, by): (f64, f64), most: f64) -> f64 {
    let aside = room.aside(DVec3::new(u, v, (at.abs() + by).min(most)));
    let there = |c: f64, by: f64| room.way.dot(DVec3::new(u, v, -c)).abs() + room.way.z.abs() * by;
    (aside + there(at, by).min(there(0.0, most))) / depth
}

/// The ratio of the depths of a piece whose strip is this many pixels wide.
fn step(wide: f64) -> f64 {
    match wide {
        wide if wide > WIDE => STEP_WIDE,
        wide if wide > NARROW => STEP,
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::surface::raster::{Area, COLUMNS};
    use crate::random::Random;

    /// The distance of a ray from an edge, from many points of that.
    fn distance([p, q]: [DVec3; 2], ray: DVec3) -> f64 {
        let ray = ray.normalize();
        let far = |i: i32| {
            let y = p.lerp(q, f64::from(i) / 400.0);
            (y - ray * y.dot(ray).max(0.0)).length()
        };
        (0..=400).map(far).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn every_pixel_with_a_ray_within_the_reach_of_a_side_is_marked_and_few_others() {
        const SIZE: i64 = 256;
        let half = SIZE as f64 / 2.0;
        let area = Area { x: 0, y: 0, nx: SIZE / COLUMNS, ny: SIZE / 8 };
        let mut random = Random::new(9);
        let (mut checked, mut marked, mut near) = (0, 0, 0);
        for round in 0..120 {
            let reach = [0.02, 0.1, 0.4][round % 3];
            let slack = if round % 5 == 0 { 0.03 } else { 0.0 };
            let limit = 0.01;
            // Every second room is a box within the ball, or goes along a way in it.
            let is_box = round % 2 == 1;
            let edges = random.point(1.0).abs().normalize() * reach;
            let way = random.point(1.0).normalize() * reach * 0.9;
            let room = match round % 4 {
                1 => Room::cuboid(edges, reach),
                3 => Room::along_way(way, reach * 0.1),
                _ => Room::ball(reach),
            };
            let clearance = 8.0 * (limit + slack) + 3.0 * reach;
            let ends = [random.point(6.0), random.point(6.0) + DVec3::Z * 6.0];
            if (0..=400).any(|i| ends[0].lerp(ends[1], f64::from(i) / 400.0).length() < clearance) {
                continue;
            }
            let sides = DeepSides { per_unit: half, middle: (half, half), limit, finer: 1.0 };
            let mut raster = Raster::default();
            raster.begin(area, (0, 0));
            let side = WholeSide { group: 0, lane: 0, ends, pixels: [(0.0, 0.0); 2], slack };
            Rims { sides, room }.draw(&mut raster, &side);
            let is_marked = |x: i64, y: i64| {
                let block = (y / 8 * area.nx + x / COLUMNS) as usize;
                raster.marks(block).open()[y as usize % 8] >> (x % COLUMNS) & 1 == 1
            };
            for _ in 0..3000 {
                let by = match round % 4 {
                    1 => room.half() * random.point(1.5).clamp(-DVec3::ONE, DVec3::ONE),
                    3 => way * random.within(-1.0, 1.0) + random.point(1.0).normalize_or_zero() * reach * 0.1,
                    _ => random.point(1.0).normalize_or_zero() * reach,
                };
                let by = by * 0.9999 + random.point(slack);
                let x = ends[0].lerp(ends[1], random.within(0.0, 1.0)) + by;
                let (u, v) = (x.x / x.z, x.y / x.z);
                if x.z > 0.0 && u.abs() < 1.0 && v.abs() < 1.0 {
                    checked += 1;
                    let pixel = |c: f64| (c * half + half) as i64;
                    assert!(is_marked(pixel(u), pixel(v)), "{round}: {x} {ends:?}");
                }
            }
            if slack > 0.0 || is_box {
                continue;
            }
            for (x, y) in (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE)) {
                let middle = |c: i64| (c as f64 + 0.5) / half - 1.0;
                marked += u32::from(is_marked(x, y));
                near += u32::from(distance(ends, DVec3::new(middle(x), middle(y), 1.0)) <= reach);
            }
        }
        assert!(checked > 20_000 && near > 10_000, "{checked} {near}");
        assert!(marked < near * 8 / 5, "{marked} {near}");
    }
}
