//! A town of 1 km by 1 km: streets 14 m wide around blocks of four houses. Up is +y, and a crossing
//! is at the origin.

use casca_points::PointCloud;
use glam::{Vec3, vec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// From crossing to crossing, in metres.
const BLOCK: f32 = 50.0;
const STREET: f32 = 14.0;
/// The side of a house.
const LOT: f32 = (BLOCK - STREET) / 2.0;
/// Blocks along each side of the town.
const BLOCKS: i32 = 20;
/// How far points lie off the surface, at most.
const NOISE: f32 = 0.01;
/// Walls lie this far inside the surface: deeper than the noise, so that they hide no point of it.
const INSET: f32 = 0.05;

/// A parallelogram. Points on it are `corner + s u + t v`.
struct Face {
    corner: Vec3,
    u: Vec3,
    v: Vec3,
    colour: Vec3,
    windows: bool,
}

pub struct Town {
    faces: Vec<Face>,
    /// The area of all faces up to each.
    areas: Vec<f64>,
    houses: Vec<(Vec3, Vec3)>,
    random: Pcg64Mcg,
}

impl Town {
    pub fn new(seed: u64) -> Self {
        let random = Pcg64Mcg::seed_from_u64(seed);
        let mut town = Self { faces: Vec::new(), areas: Vec::new(), houses: Vec::new(), random };
        let blocks = -BLOCKS / 2..BLOCKS / 2;
        for (x, z) in blocks.clone().flat_map(|x| blocks.clone().map(move |z| (x, z))) {
            town.block(vec3(x as f32, 0.0, z as f32) * BLOCK);
        }
        // The streets behind the last blocks: the middle of the town is a crossing, too.
        let (far, near) =
            (BLOCK * BLOCKS as f32 / 2.0 - STREET / 2.0, -BLOCK * BLOCKS as f32 / 2.0 - STREET / 2.0);
        let (across, along) = (STREET, BLOCK * BLOCKS as f32);
        for (x, z, u, v) in [(far, near, across, along + across), (near, far, along, across)] {
            town.face(vec3(x, 0.0, z), Vec3::X * u, Vec3::Z * v, Vec3::splat(0.45), false);
        }
        let mut sum = 0.0;
        town.areas = town
            .faces
            .iter()
            .map(|f| {
                sum += f64::from(f.u.cross(f.v).length());
                sum
            })
            .collect();
        town
    }

    /// A crossing, the streets towards +x and +z, and the houses between them.
    fn block(&mut self, at: Vec3) {
        let (wide, long) = (STREET, BLOCK - STREET);
        for (x, z, along, across) in [(0.0, 0.0, BLOCK, wide), (0.0, wide, wide, long)] {
            let corner = at + vec3(x - wide / 2.0, 0.0, z - wide / 2.0);
            self.face(corner, Vec3::X * along, Vec3::Z * across, Vec3::splat(0.45), false);
        }
        let heights: [f32; 4] = std::array::from_fn(|_| 7.0 + 15.0 * self.unit());
        for (i, &height) in heights.iter().enumerate() {
            let low = at + vec3(wide / 2.0 + LOT * (i % 2) as f32, 0.0, wide / 2.0 + LOT * (i / 2) as f32);
            let colour = vec3(0.6 + 0.4 * self.unit(), 0.5 + 0.3 * self.unit(), 0.4 + 0.3 * self.unit());
            let (x, z) = (Vec3::X * LOT, Vec3::Z * LOT);
            self.face(low + Vec3::Y * height, x, z, vec3(0.55, 0.25, 0.2), false);
            // A wall to the house beside it shows only above that one.
            let (beside_x, beside_z) = (heights[i ^ 1], heights[i ^ 2]);
            let is_east = i % 2 == 1;
            let is_north = i / 2 == 1;
            for (corner, along, base) in [
                (low, z, if is_east { beside_x } else { 0.0 }),
                (low + x, z, if is_east { 0.0 } else { beside_x }),
                (low, x, if is_north { beside_z } else { 0.0 }),
                (low + z, x, if is_north { 0.0 } else { beside_z }),
            ] {
                if base < height {
                    self.face(corner + Vec3::Y * base, along, Vec3::Y * (height - base), colour, true);
                }
            }
            self.houses.push((low, low + x + z + Vec3::Y * height));
        }
    }

    fn face(&mut self, corner: Vec3, u: Vec3, v: Vec3, colour: Vec3, windows: bool) {
        self.faces.push(Face { corner, u, v, colour, windows });
    }

    /// From 0 to 1.
    fn unit(&mut self) -> f32 {
        (self.random.next_u32() >> 8) as f32 / (1 << 24) as f32
    }

    /// The next points of the scan, spread evenly over all surfaces.
    pub fn scan(&mut self, count: usize) -> PointCloud {
        let mut cloud = PointCloud::default();
        let all = self.areas.last().copied().unwrap_or(0.0);
        for _ in 0..count {
            let at = self.random.next_u32() as f64 / 2_f64.powi(32) * all;
            let (s, t, noise) = (self.unit(), self.unit(), self.unit());
            let face = &self.faces[self.areas.partition_point(|&sum| sum <= at)];
            let normal = face.u.cross(face.v).normalize();
            let (along, up) = (s * face.u.length() / 3.0, t * face.v.length() / 3.0);
            let window =
                face.windows && (0.3..0.7).contains(&along.fract()) && (0.3..0.8).contains(&up.fract());
            let colour =
                if window { vec3(0.2, 0.25, 0.35) } else { face.colour } * (0.75 + 0.25 * normal.x.abs());
            cloud
                .positions
                .push(face.corner + face.u * s + face.v * t + normal * (2.0 * noise - 1.0) * NOISE);
            cloud.colours.push((colour * 255.0).to_array().map(|c| c as u8));
        }
        cloud
    }

    /// The boxes inside the houses, one on each line: least and greatest corner.
    pub fn walls(&self) -> String {
        let wall = |&(low, high): &(Vec3, Vec3)| {
            let (low, high) = (low + INSET, high - INSET);
            format!("{} {} {} {} {} {}\n", low.x, low.y, low.z, high.x, high.y, high.z)
        };
        self.houses.iter().map(wall).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_of_the_scan_is_inside_a_wall_and_a_crossing_is_in_the_middle() {
        let mut town = Town::new(1);
        let points = town.scan(2000).positions;
        let inside = |p: Vec3| {
            town.houses.iter().any(|&(low, high)| p.cmpgt(low + INSET).all() && p.cmplt(high - INSET).all())
        };
        assert!(!points.iter().any(|&p| inside(p)));
        assert!(inside(vec3(10.0, 3.0, 10.0)) && town.walls().lines().count() == 1600);
        let low = town.faces.iter().fold(Vec3::INFINITY, |low, face| low.min(face.corner));
        let high =
            town.faces.iter().fold(Vec3::NEG_INFINITY, |high, face| high.max(face.corner + face.u + face.v));
        assert_eq!((low.x + high.x, low.z + high.z), (0.0, 0.0));
    }
}
