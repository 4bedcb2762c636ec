//! Points on the triangles of a mesh.

use std::collections::HashMap;

use glam::{IVec3, Vec3};
use rand::RngExt;

use casca_scenes::random::{Generator, generator};
use casca_scenes::world::Mesh;

/// A point of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Its place, rounded to single precision.
    pub point: Vec3,
    /// The triangle it lies on.
    pub triangle: u32,
}

/// Random discs that do not overlap fill 0.547 of a plane at most. At this share most tries
/// succeed, and no large holes are left.
const FILL: f64 = 0.45;
/// Tries for each point, before evenly spaced points are given up.
const TRIES: usize = 15;

/// Draws points from the triangles of a mesh, each piece of area as likely as any other of its
/// size.
pub struct Sampler<'a> {
    mesh: &'a Mesh,
    /// The area of the triangles up to and with each.
    areas: Vec<f64>,
}

impl<'a> Sampler<'a> {
    /// `None` if the mesh has no area, or one that is not finite.
    pub fn new(mesh: &'a Mesh) -> Option<Self> {
        let mut sum = 0.0;
        let mut areas = Vec::with_capacity(mesh.triangles.len());
        for &corners in &mesh.triangles {
            let [a, b, c] = corners.map(|v| mesh.positions[v as usize].as_dvec3());
            sum += (b - a).cross(c - a).length() / 2.0;
            areas.push(sum);
        }
        (sum > 0.0 && sum.is_finite()).then_some(Self { mesh, areas })
    }

    /// The area of all triangles.
    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// A random point.
    pub fn draw(&self, random: &mut Generator) -> Sample {
        let at = random.random::<f64>() * self.area();
        let triangle = self.areas.partition_point(|&area| area <= at).min(self.areas.len() - 1);
        let [a, b, c] = self.mesh.triangles[triangle].map(|v| self.mesh.positions[v as usize].as_dvec3());
        let (mut u, mut v) = (random.random::<f64>(), random.random::<f64>());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        Sample { point: (a + (b - a) * u + (c - a) * v).as_vec3(), triangle: triangle as u32 }
    }

    /// `count` points that keep a distance from each other, as by a careful scan; fewer where the
    /// mesh has no room for so many.
    ///
    /// Random points are thrown, and those too near to an earlier one are dropped (Cook 1986,
    /// "Stochastic Sampling in Computer Graphics").
    pub fn evenly(&self, count: usize, seed: u64) -> Vec<Sample> {
        let mut random = generator(seed, 0x5a3_b1e5);
        // Discs of half the distance around the points fill the given share.
        let distance = (4.0 * FILL * self.area() / (std::f64::consts::PI * count.max(1) as f64)).sqrt();
        // Cells twice as wide: the neighbours of a point are in the eight around the nearest corner
        // of cells.
        let place = |p: Vec3| p.as_dvec3() / (2.0 * distance);
        let mut cells: HashMap<IVec3, Vec<Vec3>> = HashMap::new();
        let mut samples = Vec::with_capacity(count);
        for _ in 0..count.saturating_mul(TRIES) {
            if samples.len() == count {
                break;
            }
            let sample = self.draw(&mut random);
            let at = place(sample.point);
            let corner = (at - 0.5).floor().as_ivec3();
            let near = |p: &Vec3| f64::from(p.distance(sample.point)) < distance;
            if !around(corner).any(|c| cells.get(&c).is_some_and(|points| points.iter().any(near))) {
                cells.entry(at.floor().as_ivec3()).or_default().push(sample.point);
                samples.push(sample);
            }
        }
        samples
    }
}

/// The eight cells around the greatest corner of one.
fn around(cell: IVec3) -> impl Iterator<Item = IVec3> {
    (0..8).map(move |i| cell.saturating_add(IVec3::new(i & 1, i >> 1 & 1, i >> 2)))
}
