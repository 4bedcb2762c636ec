//! Points of bricks, in memory and in files.

use crate::numeric::unit;
use glam::{IVec3, Vec3};

/// Bytes of a point in a file.
pub(super) const POINT: u64 = 20;

/// The greatest number of ten bits with a sign.
const MOST: f32 = 511.0;
const BITS: u32 = 10;

/// A unit vector, or zero for none, as three numbers of ten bits: right within 0.1 degrees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct PackedNormal(u32);

impl PackedNormal {
    /// Vectors of other lengths are taken by their direction; those that are not finite are none.
    pub fn new(normal: Vec3) -> Self {
        let axes = (unit(normal) * MOST).round().as_ivec3().to_array();
        let bits = |axis: usize| (axes[axis] as u32 & ((1 << BITS) - 1)) << (BITS * axis as u32);
        Self(bits(0) | bits(1) | bits(2))
    }

    /// The vector.
    pub fn unpacked(self) -> Vec3 {
        // To the upper end and back, which spreads the sign.
        let axis = |axis: u32| (self.0 << (32 - BITS * (axis + 1))) as i32 >> (32 - BITS);
        IVec3::new(axis(0), axis(1), axis(2)).as_vec3().normalize_or_zero()
    }
}

/// A point of a brick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BrickPoint {
    pub position: Vec3,
    pub colour: [u8; 3],
    pub normal: PackedNormal,
}

impl BrickPoint {
    pub fn to_bytes(self) -> [u8; POINT as usize] {
        let [x, y, z] = self.position.to_array().map(f32::to_le_bytes);
        let [r, g, b] = self.colour;
        let mut bytes = [0; POINT as usize];
        bytes[..4].copy_from_slice(&x);
        bytes[4..8].copy_from_slice(&y);
        bytes[8..12].copy_from_slice(&z);
        bytes[12..15].copy_from_slice(&[r, g, b]);
        bytes[16..].copy_from_slice(&self.normal.0.to_le_bytes());
        bytes
    }

    pub fn from_bytes(bytes: &[u8]) -> Self {
        let word = |at: usize| std::array::from_fn(|i| bytes[at + i]);
        Self {
            position: Vec3::from([0, 4, 8].map(|at| f32::from_le_bytes(word(at)))),
            colour: [bytes[12], bytes[13], bytes[14]],
            normal: PackedNormal(u32::from_le_bytes(word(16))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::sphere;

    #[test]
    fn normals_are_kept_within_a_tenth_of_a_degree() {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        for normal in axes.chain(sphere(5_000).into_iter().map(|n| n.as_vec3().normalize())) {
            let kept = PackedNormal::new(normal).unpacked();
            assert!(kept.is_normalized() && kept.angle_between(normal).to_degrees() < 0.1, "{normal} {kept}");
            let long = PackedNormal::new(normal * 7.0);
            assert_eq!(long, PackedNormal::new(normal));
        }
        for none in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY)] {
            assert_eq!(PackedNormal::new(none).unpacked(), Vec3::ZERO);
        }
        // Whatever a file has.
        assert!((0..=u32::MAX).step_by(99_991).all(|bits| PackedNormal(bits).unpacked().is_finite()));
    }
}
