//! Offsets of planes of given directions, so that each triangle of a sample lies beyond one and
//! much room is left.

use std::f64::consts::PI;
use std::sync::LazyLock;

use glam::{DMat3, DVec3, Vec3};

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

/// Some triangles of a mesh.
pub(super) struct Sample {
    corners: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Sample {
    /// Triangles that share corners.
    pub(super) fn new<'a>(positions: &[Vec3], triangles: impl Iterator<Item = &'a [u32; 3]>) -> Self {
        const NONE: u32 = u32::MAX;
        let mut numbers = vec![NONE; positions.len()];
        let mut corners = Vec::new();
        let mut number = |v: u32| {
            let number = &mut numbers[v as usize];
            if *number == NONE {
                *number = corners.len() as u32;
                corners.push(positions[v as usize].as_dvec3());
            }
            *number
        };
        let triangles = triangles.map(|t| t.map(&mut number)).collect();
        Self { corners, triangles }
    }

    /// Adds a triangle.
    pub(super) fn push(&mut self, corners: [DVec3; 3]) {
        let first = self.corners.len() as u32;
        self.corners.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    /// How many triangles there are.
    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// The corners of all triangles.
    pub(super) fn corners(&self) -> &[DVec3] {
        &self.corners
    }
}

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
    pub(super) fn of(frame: &Frame, center: DVec3, sample: &Sample) -> Option<Self> {
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

/// A number for each direction; those beyond the last one are of no use.
type Row = [f32; MOST];

/// As many numbers are compared at once.
const LANES: usize = 8;

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
    fn new(directions: &[DVec3], center: DVec3, inverse: &DMat3, sample: &Sample) -> Self {
        let mut axes = [[0.0; MOST]; 3];
        for (i, d) in directions.iter().enumerate() {
            (axes[0][i], axes[1][i], axes[2][i]) = (d.x as f32, d.y as f32, d.z as f32);
        }
        let mut greatest = [0.0; MOST];
        let along = |p: DVec3| -> Row {
            let p = (*inverse * (p - center)).as_vec3();
            std::array::from_fn(|i| axes[0][i] * p.x + axes[1][i] * p.y + axes[2][i] * p.z)
        };
        let rows: Vec<Row> = sample.corners.iter().map(|p| along(*p)).collect();
        for row in &rows {
            for i in 0..MOST {
                greatest[i] = greater(greatest[i], row[i]);
            }
        }
        let least = sample.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| &rows[v as usize]);
            std::array::from_fn(|i| lesser(a[i], lesser(b[i], c[i])))
        });
        Self { count: directions.len(), least: least.collect(), greatest }
    }

    /// The share of the offset that a triangle leaves in the direction in which it leaves most, and
    /// the shares in all directions.
    #[inline]
    fn most(&self, row: &Row, offsets: &Row) -> (f32, Row) {
        let shares: Row = std::array::from_fn(|i| row[i] / offsets[i]);
        let mut most = [f32::NEG_INFINITY; LANES];
        let (whole, rest) = shares[..self.count].as_chunks::<LANES>();
        for chunk in whole {
            most = std::array::from_fn(|i| greater(chunk[i], most[i]));
        }
        (most.iter().chain(rest).fold(f32::NEG_INFINITY, |most, &share| greater(share, most)), shares)
    }

    /// Offsets of planes such that each triangle lies beyond one; `None` if that leaves no room
    /// around the origin.
    fn offsets(&self) -> Option<Vec<f32>> {
        let mut offsets = self.greatest;
        // The deepest dents first: the planes that they need may suffice for others.
        let rank = |(row, t): (&Row, u32)| {
            // Numbers in the order of `total_cmp`.
            let bits = self.most(row, &offsets).0.to_bits() as i32;
            let order = (bits ^ ((bits >> 31) as u32 >> 1) as i32) as u32 ^ 1 << 31;
            u64::from(order) << 32 | u64::from(t)
        };
        let mut order: Vec<u64> = self.least.iter().zip(0..).map(rank).collect();
        order.sort_unstable();
        for t in order {
            let row = &self.least[t as u32 as usize];
            let (most, shares) = self.most(row, &offsets);
            if most.is_nan() || most <= 0.0 {
                return None;
            }
            if most < 1.0 {
                let at = shares.iter().position(|&share| share == most)?;
                offsets[at] = lesser(offsets[at], row[at]);
            }
        }
        self.widen(&mut offsets);
        Some(offsets[..self.count].to_vec())
    }

    /// Moves each plane outwards as far as the others allow.
    fn widen(&self, offsets: &mut Row) {
        // The extents along each direction, one after another.
        let triangles = self.least.len();
        let columns: Vec<f32> =
            (0..self.count).flat_map(|i| self.least.iter().map(move |row| row[i])).collect();
        let column = |i: usize| &columns[i * triangles..][..triangles];
        // The planes that each triangle lies beyond, as bits.
        let mut sides = vec![0u32; triangles];
        for (i, offset) in offsets[..self.count].iter().enumerate() {
            for (extent, sides) in column(i).iter().zip(&mut sides) {
                *sides |= u32::from(extent >= offset) << i;
            }
        }
        for i in (0..SWEEPS).flat_map(|_| 0..self.count) {
            let others = !(1u32 << i);
            let mut least = [self.greatest[i]; LANES];
            let mut find = |extents: &[f32], sides: &[u32]| {
                for ((least, extent), sides) in least.iter_mut().zip(extents).zip(sides) {
                    let extent = if sides & others == 0 { *extent } else { f32::INFINITY };
                    *least = lesser(extent, *least);
                }
            };
            let (extents, rest) = column(i).as_chunks::<LANES>();
            let (own, other) = sides.as_chunks::<LANES>();
            extents.iter().zip(own).for_each(|(extents, sides)| find(extents, sides));
            find(rest, other);
            let offset = least.into_iter().fold(self.greatest[i], lesser);
            offsets[i] = offset;
            for (extent, sides) in column(i).iter().zip(&mut sides) {
                *sides = *sides & others | u32::from(*extent >= offset) << i;
            }
        }
    }
}

/// Directions in which the volume is measured: a spiral with equal steps of height (Vogel 1979).
static SPIRAL: LazyLock<[DVec3; RAYS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let z = 1.0 - (2 * i + 1) as f64 / RAYS as f64;
        let (sin, cos) = (i as f64 * (3.0 - 5f64.sqrt()) * PI).sin_cos();
        DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
    })
});

/// About the volume and the middle of the solid between planes around the origin.
fn measure(directions: &[DVec3], offsets: &[f32]) -> (f64, DVec3) {
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    let share = 4.0 * PI / RAYS as f64;
    // Missing planes are far away.
    let mut planes = [[0.0; MOST], [0.0; MOST], [0.0; MOST], [f64::INFINITY; MOST]];
    for (i, (d, offset)) in directions.iter().zip(offsets).enumerate() {
        (planes[0][i], planes[1][i], planes[2][i], planes[3][i]) = (d.x, d.y, d.z, f64::from(*offset));
    }
    let [x, y, z, far] = &planes;
    for ray in SPIRAL.iter() {
        // The nearest plane that it passes, as one over the distance.
        let nearness: [f64; MOST] =
            std::array::from_fn(|i| (x[i] * ray.x + y[i] * ray.y + z[i] * ray.z) / far[i]);
        let mut most = [0.0; LANES];
        for chunk in nearness.as_chunks::<LANES>().0 {
            most = std::array::from_fn(|i| greater(chunk[i], most[i]));
        }
        let length = 1.0 / most.into_iter().fold(0.0, f64::max);
        volume += share * length.powi(3) / 3.0;
        moment += ray * (share * length.powi(4) / 4.0);
    }
    (volume, moment / volume)
}
