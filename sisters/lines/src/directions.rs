//! Directions in 32 bits, as devices have them: points of an octahedron, unfolded to a square
//! (Meyer et al. 2010, "On floating-point normal vectors").

use glam::{Vec2, Vec3};

/// A direction as two numbers of 16 bits with signs, from -32767 to 32767. Zero becomes the
/// direction z.
pub fn coded(way: Vec3) -> u32 {
    let sum = way.abs().element_sum();
    let flat = if sum > 0.0 { way / sum } else { Vec3::Z };
    let fold = |p: Vec2| (1.0 - Vec2::new(p.y, p.x).abs()) * Vec2::ONE.copysign(p);
    let at = flat.truncate();
    let at = if flat.z < 0.0 { fold(at) } else { at };
    let part = |v: f32| u32::from((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    part(at.x) | part(at.y) << 16
}

/// The unit direction of a code; any number is one.
pub fn decoded(code: u32) -> Vec3 {
    let part = |bits: u32| (f32::from(bits as u16 as i16) / 32767.0).max(-1.0);
    let [x, y] = [part(code), part(code >> 16)];
    let z = 1.0 - x.abs() - y.abs();
    let back = (-z).max(0.0);
    Vec3::new(x - back.copysign(x), y - back.copysign(y), z).normalize_or(Vec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sets::random::Random;

    #[test]
    fn codes_of_directions_are_near_them() {
        let mut random = Random::new(2);
        let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
        let any = || Vec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0) as f32));
        for way in axes.into_iter().chain(std::iter::repeat_with(any).take(4000)) {
            let way = way.normalize();
            assert!(decoded(coded(way)).distance(way) < 8e-5, "{way} {}", decoded(coded(way)));
        }
        assert_eq!(decoded(coded(Vec3::ZERO)), Vec3::Z);
        assert!((0..=u32::MAX).step_by(77_777).all(|code| (decoded(code).length() - 1.0).abs() < 1e-5));
    }
}
