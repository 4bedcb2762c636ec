//! A scan of a furnished house, made by rules: what the program shows without a file.
//!
//! All surfaces are sampled at the same distance between points, also those inside: from outside, a
//! scan shows both at once.

use casca_points::PointCloud;
use glam::{Vec2, Vec3, vec2, vec3};

type Colour = [u8; 3];

/// Outer measures in metres; the middle of the floor is at the origin, and the front faces +z.
const WIDTH: f32 = 9.0;
const DEPTH: f32 = 6.0;
const STOREY: f32 = 2.7;
/// The thickness of outer walls.
const WALL: f32 = 0.35;
/// From the eaves to the ridge.
const ROOF: f32 = 1.9;
/// Openings of the front: left, bottom, width and height from its left lower corner.
const OPENINGS: [[f32; 4]; 6] = [
    [0.8, 0.9, 1.5, 1.2],
    [3.9, 0.0, 1.2, 2.2],
    [6.7, 0.9, 1.5, 1.2],
    [0.8, 3.6, 1.5, 1.2],
    [3.75, 3.6, 1.5, 1.2],
    [6.7, 3.6, 1.5, 1.2],
];

/// The house, with points about `spacing` metres apart.
pub fn scan(spacing: f32) -> PointCloud {
    let mut scan = Scan { cloud: PointCloud::default(), spacing };
    scan.outside();
    scan.inside();
    scan.furniture();
    scan.cloud
}

struct Scan {
    cloud: PointCloud,
    spacing: f32,
}

impl Scan {
    /// Samples a parallelogram where `paint` gives a colour, by metres along `u` and `v`. Its
    /// normal is `u x v`.
    fn sheet(&mut self, corner: Vec3, [u, v]: [Vec3; 2], paint: impl Fn(Vec2) -> Option<Colour>) {
        let normal = u.cross(v);
        let count = (normal.length() / (self.spacing * self.spacing)) as u32;
        for i in 0..count {
            // The sequence R2 of Roberts 2018: even, and without the lines of a grid.
            let at = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3]
                .map(|step: f64| (0.5 + f64::from(i) * step).fract() as f32);
            let Some(colour) = paint(vec2(at[0] * u.length(), at[1] * v.length())) else { continue };
            self.cloud.positions.push(corner + u * at[0] + v * at[1]);
            self.cloud.normals.push(normal.normalize());
            self.cloud.colours.push(colour);
        }
    }

    /// Five sides of a box that stands on its lower side.
    fn block(&mut self, low: Vec3, size: Vec3, colour: Colour) {
        let [x, y, z] = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z];
        let sides =
            [(low + z, [x, y]), (low + x, [-x, y]), (low, [z, y]), (low + x + z, [-z, y]), (low + y, [z, x])];
        for (corner, edges) in sides {
            self.sheet(corner, edges, |_| Some(colour));
        }
    }

    fn outside(&mut self) {
        let (w, d, h) = (WIDTH / 2.0, DEPTH / 2.0, 2.0 * STOREY);
        let (along, across, up) = (Vec3::X * WIDTH, Vec3::Z * DEPTH, Vec3::Y * (h + ROOF));
        // Front and back end below the roof.
        let top = h - 0.15;
        let stone = |p| tiled(p, [0.6, 0.3], [[204, 180, 140], [140, 122, 98]]);
        self.sheet(vec3(-w, 0.0, d), [along, up], |p| (p.y < top && !is_open(p)).then(|| stone(p)));
        self.sheet(vec3(w, 0.0, -d), [-along, up], |p| (p.y < top).then(|| stone(p)));
        // Side walls go up to the ridge.
        let gable = |p: Vec2| (p.y < h + ROOF * (1.0 - (p.x / d - 1.0).abs())).then(|| stone(p));
        self.sheet(vec3(-w, 0.0, -d), [across, up], gable);
        self.sheet(vec3(w, 0.0, d), [-across, up], gable);
        for side in [1.0, -1.0] {
            let slope = vec3(0.0, ROOF, -d * side) * 1.12;
            let eaves = vec3(-side * (w + 0.3), h + ROOF, 0.0) - slope;
            self.sheet(eaves, [Vec3::X * side * (WIDTH + 0.6), slope], |p| {
                Some(tiled(p, [0.3, 0.35], [[176, 76, 60], [120, 48, 40]]))
            });
        }
        let lawn = |p: Vec2| ((p.y - 4.0).abs() > d || (p.x - 6.0).abs() > w).then_some([104, 148, 76]);
        self.sheet(vec3(-6.0, 0.0, 4.0), [Vec3::X * 12.0, Vec3::NEG_Z * 8.0], lawn);
    }

    fn inside(&mut self) {
        let (w, d) = (WIDTH / 2.0 - WALL, DEPTH / 2.0 - WALL);
        let (along, across, up) = (Vec3::X * 2.0 * w, Vec3::Z * 2.0 * d, Vec3::Y * (STOREY - 0.1));
        for (floor, paint) in [(0.0, [240, 150, 60]), (STOREY, [60, 170, 190])] {
            let wall = |_| Some(paint);
            self.sheet(vec3(-w, floor, -d), [along, up], wall);
            self.sheet(vec3(w, floor, d), [-along, up], |p| {
                (!is_open(vec2(WIDTH - WALL - p.x, p.y + floor))).then_some(paint)
            });
            let plank = |p| Some(tiled(p, [2.0, 0.3], [[172, 128, 84], [120, 84, 52]]));
            self.sheet(vec3(-w, floor, d), [along, -across], plank);
            self.sheet(vec3(-w, floor + up.y, -d), [along, across], |_| Some([236, 232, 224]));
            // Outer walls, and two between rooms, from both sides.
            for x in [-w, -1.45, 1.55] {
                self.sheet(vec3(x, floor, d), [-across, up], wall);
                self.sheet(vec3(-x, floor, -d), [across, up], wall);
            }
        }
    }

    fn furniture(&mut self) {
        let blocks: [([f32; 3], [f32; 3], Colour); 10] = [
            // A table with two stools, a sofa, two cupboards.
            ([-3.7, 0.0, -0.6], [1.4, 0.75, 0.9], [150, 60, 40]),
            ([-3.2, 0.0, 0.6], [0.4, 0.45, 0.4], [40, 60, 150]),
            ([-3.2, 0.0, -1.3], [0.4, 0.45, 0.4], [40, 60, 150]),
            ([1.9, 0.0, -2.6], [2.2, 0.9, 0.8], [170, 30, 90]),
            ([3.4, 0.0, -0.9], [0.7, 2.0, 1.6], [40, 120, 70]),
            ([-0.5, 0.0, -2.6], [1.0, 1.9, 0.4], [110, 60, 150]),
            // Beds, a shelf, a desk.
            ([-4.0, STOREY, -1.8], [1.6, 0.5, 2.1], [200, 40, 50]),
            ([2.4, STOREY, -1.8], [1.6, 0.5, 2.1], [40, 70, 190]),
            ([-0.8, STOREY, -2.6], [1.6, 1.8, 0.4], [190, 120, 30]),
            ([1.7, STOREY, 1.2], [0.6, 0.8, 1.2], [90, 60, 40]),
        ];
        for (low, size, colour) in blocks {
            self.block(Vec3::from(low), Vec3::from(size), colour);
        }
    }
}

/// Whether a place of the front belongs to a window or the door.
fn is_open(p: Vec2) -> bool {
    OPENINGS.iter().any(|&[x, y, w, h]| p.x > x && p.x < x + w && p.y > y && p.y < y + h)
}

/// Tiles in rows, every other row shifted, with joints of another colour.
fn tiled(p: Vec2, [width, height]: [f32; 2], [tile, joint]: [Colour; 2]) -> Colour {
    let row = p.y / height;
    let column = p.x / width + 0.5 * (row.floor() % 2.0);
    if column.fract() * width < 0.05 || row.fract() * height < 0.05 { joint } else { tile }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_spread_at_the_spacing_and_the_same_each_time() {
        let cloud = scan(0.2);
        assert!(cloud.check().is_ok() && cloud == scan(0.2));
        let finer = scan(0.1).len() as f64 / cloud.len() as f64;
        assert!((3.8..4.2).contains(&finer), "{finer}");
    }
}
