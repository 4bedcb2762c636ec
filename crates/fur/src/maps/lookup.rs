//! Directions and places in maps (thesis, section 5.1 and algorithm 5). Its sphere maps (algorithm
//! 6) are left out: nothing draws them, and they stretch towards one pole, where cube maps do not.

use glam::Vec3;

use crate::numeric::NO_SUM;

/// A place on a cube map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubePlace {
    /// The face: +x, -x, +y, -y, +z, -z are 0 to 5.
    pub face: u8,
    /// From left to right, 0 to 1.
    pub u: f32,
    /// From top to bottom, 0 to 1.
    pub v: f32,
}

/// Where a direction of any length meets a cube map (algorithm 5): the face of the largest
/// component, of equal ones the first of x, y and z. `None` if the direction is zero or not finite.
pub fn cube_uv(direction: Vec3) -> Option<CubePlace> {
    let size = direction.abs();
    let largest = size.max_element();
    if !direction.is_finite() || largest == 0.0 {
        return None;
    }
    let axis = (0..3).find(|&axis| size[axis] == largest)?;
    let back = direction[axis] < 0.0;
    let Vec3 { x, y, z } = direction / largest;
    let (u, v) = match (axis, back) {
        (0, false) => (-z, -y),
        (0, true) => (z, -y),
        (1, false) => (x, z),
        (1, true) => (x, -z),
        (_, false) => (x, -y),
        (_, true) => (-x, -y),
    };
    Some(CubePlace { face: 2 * axis as u8 + u8::from(back), u: (u + 1.0) * 0.5, v: (v + 1.0) * 0.5 })
}

/// The direction of a place on a cube map: the inverse of [`cube_uv`], of length 1. Faces above 5
/// count as 5.
pub fn cube_direction(place: CubePlace) -> Vec3 {
    let (u, v) = (2.0 * place.u - 1.0, 2.0 * place.v - 1.0);
    let direction = match place.face {
        0 => Vec3::new(1.0, -v, -u),
        1 => Vec3::new(-1.0, -v, u),
        2 => Vec3::new(u, 1.0, v),
        3 => Vec3::new(u, -1.0, -v),
        4 => Vec3::new(u, -v, 1.0),
        _ => Vec3::new(-u, -v, -1.0),
    };
    direction.normalize_or_zero()
}

/// The direction by which the thesis looks fur up: that of `normal + position / |position|`, for a
/// unit normal. `None` where both cancel, as on the inner equator of a torus around the origin, at
/// the origin itself and for values that are not finite.
pub fn fur_direction(normal: Vec3, position: Vec3) -> Option<Vec3> {
    let sum = normal + position.try_normalize()?;
    (sum.length() > NO_SUM).then(|| sum.try_normalize()).flatten()
}

/// [`fur_direction`], or the normal where it has no value.
pub fn fur_direction_or_normal(normal: Vec3, position: Vec3) -> Vec3 {
    fur_direction(normal, position).unwrap_or(normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::dice;

    #[test]
    fn cube_places_lead_back_to_their_directions() {
        let mut random = dice(1);
        let mut faces = [0; 6];
        for _ in 0..100_000 {
            let direction = random.direction();
            let place = cube_uv(direction * (1.0 + random.next() as f32)).unwrap();
            faces[usize::from(place.face)] += 1;
            assert!((0.0..=1.0).contains(&place.u) && (0.0..=1.0).contains(&place.v));
            assert!(cube_direction(place).distance(direction) < 1e-6, "{direction}");
        }
        assert!(faces.iter().all(|&n| (16_000..17_400).contains(&n)), "{faces:?}");
        // The table of the thesis; of equal components x counts, then y.
        assert_eq!(cube_uv(Vec3::ONE), Some(CubePlace { face: 0, u: 0.0, v: 0.0 }));
        assert_eq!(cube_uv(Vec3::new(0.5, -1.0, 1.0)), Some(CubePlace { face: 3, u: 0.75, v: 0.0 }));
    }

    #[test]
    fn directions_have_values_where_normal_and_position_cancel() {
        // A point of the inner equator of a torus around the origin.
        assert_eq!(fur_direction(Vec3::NEG_X, Vec3::X * 2.0), None);
        assert_eq!(fur_direction_or_normal(Vec3::NEG_X, Vec3::X * 2.0), Vec3::NEG_X);
        assert_eq!(fur_direction(Vec3::Y, Vec3::ZERO), None);
        assert!(
            fur_direction(Vec3::Y, Vec3::X).unwrap().distance(Vec3::new(1.0, 1.0, 0.0).normalize()) < 1e-6
        );
        for x in [f32::NAN, f32::INFINITY] {
            assert_eq!(fur_direction(Vec3::splat(x), Vec3::X), None);
            assert_eq!(fur_direction(Vec3::X, Vec3::splat(x)), None);
            assert_eq!(cube_uv(Vec3::new(x, 1.0, 0.0)), None);
        }
        assert_eq!(cube_uv(Vec3::ZERO), None);
    }
}
