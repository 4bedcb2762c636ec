//! Light gathered from voxels: by cones through a pyramid with six directional channels (Villegas 2016; Crassin et al. 2011), or by exact
//! walks to single voxels.

use std::f32::consts::TAU;

use casca::soft::CellHit;
use glam::{IVec3, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use super::voxels::{OFF, Sides, Voxels};

/// How light is gathered above a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gather {
    /// By cones that share the cosine-weighted hemisphere equally.
    Cones {
        /// How many, 1 to 4096.
        count: u32,
        /// Step in diameters of the cone.
        step: f32,
        /// Whether the opacity of a sample is that of a step's length, and not of a cell's.
        corrected: bool,
    },
    /// By exact walks through the cells along so many directions, 1 to 4096, which are turned at random from place to place.
    Walks(u32),
}

/// Directions that are followed from one point at most.
const MOST: u32 = 4096;
/// Cones are no wider than this: of a tangent of 1, 90 degrees.
const WIDEST: f32 = 1.0;
/// The least cosine that is divided by: cones of smaller ones are as wide as cones may be.
const LEAST_COS: f32 = 1e-3;
/// Cells from the start of a cone to its first sample.
const FIRST: f32 = 0.5;
/// Steps are no shorter than this, in cells.
const SHORTEST: f32 = 0.125;
/// Cones end so many times the size of the grid away: beyond, those of a tangent of 1 would never leave it.
const FARTHEST: f32 = 2.0;
/// Cones end where less light than this passes.
const DARK: f32 = 1e-3;
/// The angle between one direction and the next, as a share of the circle, that spreads any number of them evenly.
const GOLDEN: f32 = 0.381_966;

/// A level of the pyramid: by direction of rays (axis times two, plus one for downwards), premultiplied colour and opacity.
struct Level {
    n: i32,
    faces: [Vec<Vec4>; 6],
}

/// Light of voxels, and the pyramid above it.
pub struct LightVolume<'a> {
    voxels: &'a Voxels,
    sides: Sides,
    sky: Vec3,
    levels: Vec<Level>,
}

impl<'a> LightVolume<'a> {
    /// Builds the pyramid: pairs of cells front to back in each direction, and the mean of four of them. O(n³).
    pub fn new(voxels: &'a Voxels, sides: Sides, sky: Vec3) -> Self {
        let mut volume = Self { voxels, sides, sky, levels: Vec::new() };
        let mut n = voxels.n;
        while n > 1 {
            n = (n + 1) / 2;
            let faces = std::array::from_fn(|face| {
                let cell = |i| {
                    let i = i as i32;
                    volume.mean(IVec3::new(i % n, i / n % n, i / n / n) * 2, face)
                };
                (0..(n * n * n) as usize).into_par_iter().map(cell).collect()
            });
            volume.levels.push(Level { n, faces });
        }
        volume
    }

    /// The eight cells from `low` on the last level, as one.
    fn mean(&self, low: IVec3, face: usize) -> Vec4 {
        let (axis, down) = (face / 2, face % 2);
        let level = self.levels.len();
        let mut sum = Vec4::ZERO;
        for k in 0..4 {
            let mut at = low;
            at[(axis + 1) % 3] += k % 2;
            at[(axis + 2) % 3] += k / 2;
            let (mut front, mut back) = (at, at);
            if down == 0 {
                back[axis] += 1
            } else {
                front[axis] += 1
            }
            let front = self.fetch(level, front, face, along(face));
            sum += front + self.fetch(level, back, face, along(face)) * (1.0 - front.w);
        }
        sum / 4.0
    }

    /// A cell of a level, for rays of a direction.
    fn fetch(&self, level: usize, c: IVec3, face: usize, direction: Vec3) -> Vec4 {
        let Some(held) = level.checked_sub(1).map(|l| &self.levels[l]) else {
            let voxel = self.voxels.at(c);
            return voxel.map_or(Vec4::ZERO, |v| self.seen(v, direction).extend(1.0));
        };
        let inside = c.cmpge(IVec3::ZERO).all() && c.cmplt(IVec3::splat(held.n)).all();
        if inside { held.faces[face][((c.z * held.n + c.y) * held.n + c.x) as usize] } else { Vec4::ZERO }
    }

    fn seen(&self, voxel: usize, direction: Vec3) -> Vec3 {
        self.sides[voxel][self.voxels.side(voxel, direction)]
    }

    /// Interpolated between the cells of a level around a point in cells.
    fn smooth(&self, level: usize, p: Vec3, face: usize, direction: Vec3) -> Vec4 {
        let at = p / (1u32 << level) as f32 - 0.5;
        let (low, share) = (at.floor(), at - at.floor());
        let mut sum = Vec4::ZERO;
        for k in 0..8 {
            let high = IVec3::new(k & 1, k >> 1 & 1, k >> 2);
            let near = high.as_vec3();
            let weight = (near * share + (Vec3::ONE - near) * (Vec3::ONE - share)).element_product();
            sum += self.fetch(level, low.as_ivec3() + high, face, direction) * weight;
        }
        sum
    }

    /// Premultiplied colour and opacity on a level, for rays of a unit direction.
    fn sample(&self, level: usize, p: Vec3, d: Vec3) -> Vec4 {
        if level == 0 {
            return self.smooth(0, p, 0, d);
        }
        let channel = |axis: usize| {
            let face = 2 * axis + usize::from(d[axis] < 0.0);
            self.smooth(level, p, face, d) * (d[axis] * d[axis])
        };
        channel(0) + channel(1) + channel(2)
    }

    /// The light that a cone from a point in cells gathers.
    pub fn cone(&self, apex: Vec3, d: Vec3, tan: f32, step: f32, corrected: bool) -> Vec3 {
        let (mut light, mut passes, mut t) = (Vec3::ZERO, 1.0, FIRST);
        let n = self.voxels.n as f32;
        loop {
            let p = apex + d * t;
            // A wide cone has cells beside it where its axis has left the grid. Also ends where numbers are not finite.
            let wide = tan * t;
            if !(p.min_element() >= -wide && p.max_element() <= n + wide && t < FARTHEST * n) {
                return light + self.sky * passes;
            }
            // The level whose cells are as wide as the cone's radius.
            let wanted = (tan * t).max(1.0).log2().min(self.levels.len() as f32);
            let low = wanted as usize;
            let mut found = self.sample(low, p, d);
            if wanted > low as f32 {
                found = found.lerp(self.sample(low + 1, p, d), wanted - low as f32);
            }
            let length = (2.0 * tan * t * step).max(SHORTEST);
            if corrected && found.w > 0.0 {
                let opacity = 1.0 - (1.0 - found.w.min(1.0)).powf(length / wanted.exp2());
                found *= opacity / found.w;
            }
            light += found.xyz() * passes;
            passes *= 1.0 - found.w.min(1.0);
            if passes < DARK {
                return light;
            }
            t += length;
        }
    }

    /// The cosine-weighted mean of the light that arrives at a surface; `turn`, 0 to 1, turns the directions.
    pub fn gather(&self, point: Vec3, normal: Vec3, how: Gather, turn: f32) -> Vec3 {
        match how {
            Gather::Cones { count, step, corrected } => {
                let count = count.clamp(1, MOST);
                let apex = self.voxels.to_cells(point) + normal * OFF;
                let cones = directions(normal, count, 0.0).map(|d| {
                    // As wide as its share of the hemisphere: the density of directions is cos / pi.
                    let cos = 1.0 - (0.5 / (count as f32 * d.dot(normal).max(LEAST_COS))).min(1.0);
                    let tan = ((1.0 - cos * cos).sqrt() / cos.max(LEAST_COS)).min(WIDEST);
                    self.cone(apex, d, tan, step, corrected)
                });
                cones.sum::<Vec3>() / count as f32
            }
            Gather::Walks(count) => {
                let count = count.clamp(1, MOST);
                let start = point + normal * (OFF * self.voxels.cell);
                let far = 2.0 * self.voxels.n as f32 * self.voxels.cell;
                let walks = directions(normal, count, turn).map(|d| {
                    match self.voxels.soft.first_hit(start, start + d * far) {
                        Ok(Some(CellHit { cell, .. })) => {
                            self.voxels.at(cell).map_or(Vec3::ZERO, |v| self.seen(v, d))
                        }
                        _ => self.sky,
                    }
                });
                walks.sum::<Vec3>() / count as f32
            }
        }
    }

    /// The light of the next bounce: that which each side of each voxel gathers and reflects.
    pub fn bounce(&self, how: Gather) -> Sides {
        self.voxels.sides(|v, from, normal| {
            v.albedo * self.gather(from - normal * (OFF * self.voxels.cell), normal, how, turn_of(v.point))
        })
    }
}

/// The unit vector along an axis that a channel is for.
fn along(face: usize) -> Vec3 {
    [Vec3::X, Vec3::Y, Vec3::Z][face / 2] * if face.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// A share of the circle that differs from place to place, for noise without a pattern.
pub(super) fn turn_of(point: Vec3) -> f32 {
    let bits = point
        .to_array()
        .iter()
        .fold(0u32, |h, c| (h ^ c.to_bits()).wrapping_mul(0x9e37_79b1).rotate_left(13));
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// Directions around a normal with a density in proportion to the cosine, evenly spread.
fn directions(normal: Vec3, count: u32, turn: f32) -> impl Iterator<Item = Vec3> {
    let (x, y) = normal.any_orthonormal_pair();
    (0..count).map(move |k| {
        let square = (k as f32 + 0.5) / count as f32;
        let (s, c) = (TAU * (k as f32 * GOLDEN + turn).fract()).sin_cos();
        ((x * c + y * s) * square.sqrt() + normal * (1.0 - square).sqrt()).normalize()
    })
}
