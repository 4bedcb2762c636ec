//! A grid of ambient cubes (Mitchell, McTaggart & Green, *Shading in Valve's Source Engine*, 2006), in
//! the form that Bevy's `IrradianceVolume` reads.

use glam::{IVec3, UVec3, Vec3};

use crate::{Backs, BakeError};

/// What surfaces along each axis face, in the order of [`Probes::cubes`].
const FACES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
/// Texels along a side of a texture of three dimensions that each device takes.
const MOST_SIDE: f32 = 2048.0;
/// Probes that a grid has at most: rays of each of them are many.
const MOST_PROBES: f32 = (1 << 20) as f32;

/// Light in the open, at the middles of the cells of a box.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Probes {
    /// Cells along x, y and z.
    pub counts: UVec3,
    /// The least corner of the box, in metres.
    pub min: Vec3,
    /// Its greatest corner, in metres.
    pub max: Vec3,
    /// By cell, along x first and along z last: what matt white surfaces there scatter that face x, -x,
    /// y, -y, z and -z.
    pub cubes: Vec<[Vec3; 6]>,
}

impl Probes {
    /// Probes in a box, so far from each other at most, and without light.
    ///
    /// # Errors
    /// Devices would not take them.
    pub fn new((min, max): (Vec3, Vec3), spacing: f32) -> Result<Self, BakeError> {
        let counts = ((max - min) / spacing).ceil().max(Vec3::ONE);
        let sides = counts * Vec3::new(1.0, 2.0, 3.0);
        let over = sides.max_element() / MOST_SIDE;
        let over = over.max((counts.element_product() / MOST_PROBES).cbrt());
        if over.is_nan() || over > 1.0 {
            // A little more, since counts are rounded upwards.
            return Err(BakeError::Probes(counts.to_array(), spacing * over * 1.01));
        }
        let counts = counts.as_uvec3();
        let cubes = vec![[Vec3::ZERO; 6]; counts.element_product() as usize];
        Ok(Self { counts, min, max, cubes })
    }

    /// Where the probe of a cell is.
    pub fn place(&self, number: usize) -> Vec3 {
        let UVec3 { x, y, .. } = self.counts;
        let number = number as u32;
        let cell = UVec3::new(number % x, number / x % y, number / (x * y));
        self.min + (self.max - self.min) * (cell.as_vec3() + 0.5) / self.counts.as_vec3()
    }

    /// All points and normals that are to be lit, in the order of [`Self::cubes`].
    pub(crate) fn questions(&self) -> Vec<(Vec3, Vec3)> {
        let places = (0..self.cubes.len()).map(|i| self.place(i));
        places.flat_map(|p| FACES.map(|face| (p, face))).collect()
    }

    /// Gives the probes within solids the mean of those beside them that are not: what moves is lit by
    /// eight at once.
    pub(crate) fn fill(&mut self, backs: &Backs) {
        let buried: Vec<bool> = (0..self.cubes.len()).map(|i| backs.is_buried(self.place(i), None)).collect();
        let n = self.counts.as_ivec3();
        for i in (0..self.cubes.len()).filter(|i| buried[*i]) {
            let cell = IVec3::new(i as i32 % n.x, i as i32 / n.x % n.y, i as i32 / (n.x * n.y));
            let steps = (0..27).map(|k| IVec3::new(k % 3, k / 3 % 3, k / 9) - 1 + cell);
            let near = steps.filter(|c| c.cmpge(IVec3::ZERO).all() && c.cmplt(n).all());
            let near = near.map(|c| ((c.z * n.y + c.y) * n.x + c.x) as usize).filter(|j| !buried[*j]);
            let near: Vec<[Vec3; 6]> = near.map(|j| self.cubes[j]).collect();
            let sum = |face: usize| near.iter().map(|cube| cube[face]).sum::<Vec3>();
            self.cubes[i] = std::array::from_fn(|face| sum(face) / near.len().max(1) as f32);
        }
    }

    /// The texture: its size, and its texels. It has twice as many cells along y and three times as many
    /// along z. As Bevy's shader reads it: x lies before y and that before z, and surfaces that face the
    /// least corner lie behind those that face the greatest.
    pub fn texture(&self) -> (UVec3, Vec<Vec3>) {
        let UVec3 { x, y, z } = self.counts;
        let size = UVec3::new(x, 2 * y, 3 * z);
        let texel = |i: u32| {
            let (s, t, p) = (i % x, i / x % size.y, i / (x * size.y));
            self.cubes[(((p % z) * y + t % y) * x + s) as usize][(2 * (p / z) + t / y) as usize]
        };
        (size, (0..size.element_product()).map(texel).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the shader of Bevy 0.20 reads at a voxel for a surface that faces along an axis.
    #[test]
    fn the_texture_is_laid_out_as_the_shader_reads_it() {
        let mut probes = Probes::new((Vec3::ZERO, Vec3::new(2.0, 3.0, 4.0)), 1.0).unwrap();
        for (i, cube) in probes.cubes.iter_mut().enumerate() {
            *cube = std::array::from_fn(|face| Vec3::new(i as f32, face as f32, 0.0));
        }
        let (size, texels) = probes.texture();
        assert_eq!((size, texels.len()), (UVec3::new(2, 6, 12), 144));
        for i in 0..24 {
            let unit = (probes.place(i) - probes.min) / (probes.max - probes.min);
            let stp = unit * Vec3::new(2.0, 3.0, 4.0);
            for (face, normal) in FACES.into_iter().enumerate() {
                let axis = face / 2;
                let uvw = stp / size.as_vec3()
                    + Vec3::new(0.0, if normal[axis] < 0.0 { 0.5 } else { 0.0 }, axis as f32 / 3.0);
                let at = (uvw * size.as_vec3()).floor().as_uvec3();
                let texel = texels[((at.z * size.y + at.y) * size.x + at.x) as usize];
                assert_eq!(texel, Vec3::new(i as f32, face as f32, 0.0));
            }
        }
        for spacing in [crate::SPACINGS.0, 0.01, f32::MIN_POSITIVE] {
            let why = Probes::new((Vec3::ZERO, Vec3::splat(20.0)), spacing).unwrap_err();
            let BakeError::Probes(_, fit) = why else { panic!("{why}") };
            assert!(Probes::new((Vec3::ZERO, Vec3::splat(20.0)), fit).is_ok() || spacing < 1e-9, "{fit}");
        }
    }
}
