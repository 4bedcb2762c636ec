//! Light gathered from voxels: by cones through a pyramid with six directional channels (Villegas
//! 2016; Crassin et al. 2011), or by exact walks to single voxels.

use std::f32::consts::TAU;

use casca::soft::CellHit;
use glam::{IVec3, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use super::voxels::{Lit, OFF, Sides, Voxels};
use casca_scenes::lit::Material;

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
    /// By exact walks through the cells along so many directions, 1 to 4096, which are turned at
    /// random from place to place.
    Walks(u32),
}

/// A point of a surface that is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// The point, in world units.
    pub point: Vec3,
    /// The unit normal on the side that is looked at.
    pub normal: Vec3,
    /// The unit direction of the look, towards the surface.
    pub look: Vec3,
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
/// Cones end so many times the size of the grid away: beyond, those of a tangent of 1 would never
/// leave it.
const FARTHEST: f32 = 2.0;
/// Cones end where less light than this passes.
const DARK: f32 = 1e-3;
/// The angle between one direction and the next, as a share of the circle, that spreads any number
/// of them evenly.
const GOLDEN: f32 = 0.381_966;

/// A level of the pyramid: by direction of rays (axis times two, plus one for downwards),
/// premultiplied colour and opacity.
struct Level {
    n: i32,
    faces: [Vec<Vec4>; 6],
}

/// The exponent of the cosine that the density of directions of diffuse light is in proportion to.
const LAMBERT: f32 = 1.0;

/// Light of voxels, and the pyramid above it.
pub struct LightVolume<'a> {
    voxels: &'a Voxels,
    sides: Sides,
    sky: Vec3,
    levels: Vec<Level>,
}

impl<'a> LightVolume<'a> {
    /// Builds the pyramid: pairs of cells front to back in each direction, and the mean of four of
    /// them. O(n³).
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
            // A wide cone has cells beside it where its axis has left the grid. Also ends where
            // numbers are not finite.
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

    /// The cosine-weighted mean of the light that arrives at a surface; `turn`, 0 to 1, turns the
    /// directions.
    ///
    /// # Errors
    /// If the library refuses a walk: points must be finite.
    pub fn gather(&self, point: Vec3, normal: Vec3, how: Gather, turn: f32) -> Lit {
        match how {
            Gather::Cones { count, step, corrected } => {
                let count = count.clamp(1, MOST);
                let apex = self.voxels.to_cells(point) + normal * OFF;
                let cones = directions(normal, count, LAMBERT, 0.0).map(|d| {
                    // As wide as its share of the hemisphere: the density of directions is cos /
                    // pi.
                    let cos = 1.0 - (0.5 / (count as f32 * d.dot(normal).max(LEAST_COS))).min(1.0);
                    let tan = ((1.0 - cos * cos).sqrt() / cos.max(LEAST_COS)).min(WIDEST);
                    self.cone(apex, d, tan, step, corrected)
                });
                Ok(cones.sum::<Vec3>() / count as f32)
            }
            Gather::Walks(count) => {
                let count = count.clamp(1, MOST);
                let start = point + normal * (OFF * self.voxels.cell);
                let walks = directions(normal, count, LAMBERT, turn).map(|d| self.walk(start, d));
                Ok(walks.sum::<Lit>()? / count as f32)
            }
        }
    }

    /// The light that arrives at a point from a unit direction, by an exact walk.
    fn walk(&self, start: Vec3, d: Vec3) -> Lit {
        let far = FARTHEST * self.voxels.n as f32 * self.voxels.cell;
        let light = match self.voxels.soft.first_hit(start, start + d * far)? {
            Some(CellHit { cell, .. }) => self.voxels.at(cell).map_or(Vec3::ZERO, |v| self.seen(v, d)),
            None => self.sky,
        };
        Ok(light)
    }

    /// The light that a surface scatters towards the eye: the diffuse part, and the lobe around the
    /// mirror direction.
    ///
    /// # Errors
    /// As [`Self::gather`].
    pub fn scattered(&self, at: &Spot, material: &Material, how: Gather) -> Lit {
        let turn = turn_of(at.point);
        let diffuse = match material.albedo.max_element() > 0.0 {
            true => material.albedo * self.gather(at.point, at.normal, how, turn)?,
            false => Vec3::ZERO,
        };
        Ok(diffuse + self.glossy(at, material, how, turn)?)
    }

    /// The light of the lobe of the path tracer (Lafortune & Willems 1994), by a single cone or by
    /// walks as dense as the lobe.
    ///
    /// The cone has an even density of directions and the mean cosine to the axis of a lobe of
    /// exponent n, which is (n + 1) / (n + 2): the cosine of half its angle is n / (n + 2).
    fn glossy(&self, at: &Spot, material: &Material, how: Gather, turn: f32) -> Lit {
        let mirror = at.look - at.normal * (2.0 * at.look.dot(at.normal));
        let facing = mirror.dot(at.normal);
        if material.specular.max_element() <= 0.0 || facing <= 0.0 {
            return Ok(Vec3::ZERO);
        }
        let n = material.exponent() as f32;
        let light = match how {
            Gather::Cones { step, corrected, .. } => {
                let tan = (2.0 * (n + 1.0).sqrt() / n).min(WIDEST);
                let apex = self.voxels.to_cells(at.point) + at.normal * OFF;
                // Of the lobe, head-on, the factor (n + 2) / (n + 1) and the mean cosine make 1.
                self.cone(apex, mirror, tan, step, corrected) * facing
            }
            Gather::Walks(count) => {
                let count = count.clamp(1, MOST);
                let start = at.point + at.normal * (OFF * self.voxels.cell);
                let walks = directions(mirror, count, n, turn).map(|d| match d.dot(at.normal) {
                    cos if cos > 0.0 => Ok(self.walk(start, d)? * cos),
                    _ => Ok(Vec3::ZERO),
                });
                walks.sum::<Lit>()? * ((n + 2.0) / (n + 1.0) / count as f32)
            }
        };
        Ok(material.specular * light)
    }

    /// The light of the next bounce: that which each side of each voxel gathers and reflects
    /// diffusely, with a quarter of the cones or walks, since pixels take the mean of many voxels.
    /// Voxels have no lobes: how bright these are depends on the eye.
    ///
    /// # Errors
    /// As [`Self::gather`].
    pub fn bounce(&self, how: Gather) -> Result<Sides, casca::Error> {
        let how = match how {
            Gather::Cones { count, step, corrected } => {
                Gather::Cones { count: count.div_ceil(4), step, corrected }
            }
            Gather::Walks(count) => Gather::Walks(count.div_ceil(4)),
        };
        self.voxels.sides(|v, point, normal| Ok(v.albedo * self.gather(point, normal, how, turn_of(point))?))
    }
}

/// The unit vector along an axis that a channel is for.
fn along(face: usize) -> Vec3 {
    [Vec3::X, Vec3::Y, Vec3::Z][face / 2] * if face.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// A share of the circle that differs from place to place, for noise without a pattern.
fn turn_of(point: Vec3) -> f32 {
    let bits = point
        .to_array()
        .iter()
        .fold(0u32, |h, c| (h ^ c.to_bits()).wrapping_mul(0x9e37_79b1).rotate_left(13));
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// Directions around a unit axis with a density in proportion to a power of the cosine to it,
/// evenly spread.
fn directions(axis: Vec3, count: u32, exponent: f32, turn: f32) -> impl Iterator<Item = Vec3> {
    let (x, y) = axis.any_orthonormal_pair();
    (0..count).map(move |k| {
        let share = (k as f32 + 0.5) / count as f32;
        let cos = (1.0 - share).powf(1.0 / (exponent + 1.0));
        let (s, c) = (TAU * (k as f32 * GOLDEN + turn).fract()).sin_cos();
        ((x * c + y * s) * (1.0 - cos * cos).max(0.0).sqrt() + axis * cos).normalize()
    })
}
