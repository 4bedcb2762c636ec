//! Offsets of planes of given directions, so that each triangle of a sample lies beyond one and
//! much room is left.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::geometry::plane::HalfSpace;
use crate::mesh::inner::frames::Frame;
use crate::numeric::mesh::INNER_FIT;
use crate::numeric::{greater, lesser};

/// The most directions of a frame: planes are numbered by the bits of a word.
const MOST: usize = u32::BITS as usize;

/// How often each plane is moved outwards as far as the others allow.
const SWEEPS: usize = 2;

/// Directions in which the volume is measured.
const RAYS: usize = 96;

/// Planes around a point.
pub(super) struct Fit {
    pub(super) center: DVec3,
    /// Relative to the center.
    pub(super) planes: Vec<HalfSpace>,
    /// About the volume between them, and the middle of that.
    pub(super) volume: f64,
    pub(super) middle: DVec3,
}

impl Fit {
    /// Planes of a frame around a point; `None` if the triangles leave no room around it.
    pub(super) fn of(frame: &Frame, center: DVec3, sample: &[[DVec3; 3]]) -> Option<Self> {
        let inverse = frame.axes.inverse();
        let directions = &frame.directions[..frame.directions.len().min(MOST)];
        let offsets = Extents::new(directions, center, &inverse, sample).offsets()?;
        let (volume, middle) = measure(directions, &offsets);
        let turn = inverse.transpose();
        let planes = directions.iter().zip(&offsets).map(|(&d, offset)| {
            let normal = turn * d;
            let length = normal.length();
            HalfSpace { normal: -normal / length, offset: f64::from(*offset) * INNER_FIT / length }
        });
        Some(Self {
            center,
            planes: planes.collect(),
            volume: volume * frame.axes.determinant().abs(),
            middle: center + frame.axes * middle,
        })
    }
}

/// A number for each direction.
type Row = [f32; MOST];

/// How far triangles lie from the origin, along each direction.
struct Extents {
    /// Number of directions.
    count: usize,
    /// The least extent of each triangle.
    least: Vec<Row>,
    /// The greatest extent of all.
    greatest: Row,
}

impl Extents {
    fn new(directions: &[DVec3], center: DVec3, inverse: &DMat3, sample: &[[DVec3; 3]]) -> Self {
        let mut axes = [[0.0; MOST]; 3];
        for (i, d) in directions.iter().enumerate() {
            (axes[0][i], axes[1][i], axes[2][i]) = (d.x as f32, d.y as f32, d.z as f32);
        }
        let mut greatest = [0.0; MOST];
        let along = |p: DVec3| -> Row {
            let p = (*inverse * (p - center)).as_vec3();
            std::array::from_fn(|i| axes[0][i] * p.x + axes[1][i] * p.y + axes[2][i] * p.z)
        };
        let mut least = Vec::with_capacity(sample.len());
        for t in sample {
            let [a, b, c] = t.map(along);
            let row: Row = std::array::from_fn(|i| lesser(a[i], lesser(b[i], c[i])));
            for i in 0..MOST {
                greatest[i] = greater(greatest[i], greater(a[i], greater(b[i], c[i])));
            }
            least.push(row);
        }
        Self { count: directions.len(), least, greatest }
    }

    /// The direction in which a triangle takes the least share of the offset, and the share that is
    /// left.
    fn best(&self, row: &Row, offsets: &Row) -> (usize, f32) {
        let mut best = (0, f32::NEG_INFINITY);
        for i in 0..self.count {
            let share = row[i] / offsets[i];
            if share > best.1 {
                best = (i, share);
            }
        }
        best
    }

    /// Offsets of planes such that each triangle lies beyond one; `None` if that leaves no room
    /// around the origin.
    fn offsets(&self) -> Option<Vec<f32>> {
        let mut offsets = self.greatest;
        // The deepest dents first: the planes that they need may suffice for others.
        let mut order: Vec<(f32, u32)> =
            self.least.iter().zip(0..).map(|(row, t)| (self.best(row, &offsets).1, t)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, t) in order {
            let row = &self.least[t as usize];
            let (at, share) = self.best(row, &offsets);
            if share.is_nan() || share <= 0.0 {
                return None;
            }
            offsets[at] = lesser(offsets[at], row[at]);
        }
        self.widen(&mut offsets);
        Some(offsets[..self.count].to_vec())
    }

    /// Moves each plane outwards as far as the others allow.
    fn widen(&self, offsets: &mut Row) {
        let beyond = |row: &Row, offsets: &Row| {
            (0..self.count).fold(0u32, |bits, i| bits | u32::from(row[i] >= offsets[i]) << i)
        };
        let mut sides: Vec<u32> = self.least.iter().map(|row| beyond(row, offsets)).collect();
        for i in (0..SWEEPS).flat_map(|_| 0..self.count) {
            let needed = self.least.iter().zip(&sides).filter(|(_, sides)| **sides & !(1 << i) == 0);
            offsets[i] = needed.fold(self.greatest[i], |least, (row, _)| lesser(least, row[i]));
            for (row, sides) in self.least.iter().zip(&mut sides) {
                *sides = *sides & !(1 << i) | u32::from(row[i] >= offsets[i]) << i;
            }
        }
    }
}

/// About the volume and the middle of the solid between planes around the origin.
fn measure(directions: &[DVec3], offsets: &[f32]) -> (f64, DVec3) {
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    let share = 4.0 * PI / RAYS as f64;
    for i in 0..RAYS {
        // A spiral with equal steps of height (Vogel 1979).
        let z = 1.0 - (2 * i + 1) as f64 / RAYS as f64;
        let (sin, cos) = (i as f64 * (3.0 - 5f64.sqrt()) * PI).sin_cos();
        let ray = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
        // The nearest plane that it passes, as one over the distance.
        let nearness = directions.iter().zip(offsets).map(|(d, offset)| d.dot(ray) / f64::from(*offset));
        let length = 1.0 / nearness.fold(0.0, f64::max);
        volume += share * length.powi(3) / 3.0;
        moment += ray * (share * length.powi(4) / 4.0);
    }
    (volume, moment / volume)
}
