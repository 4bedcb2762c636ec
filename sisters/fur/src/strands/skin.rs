//! The skin below a point of a layer, as far as it bends.

use glam::{Mat3, Vec3};

use crate::numeric::LEAST_LEAN;

/// The skin below a point of a layer, in object space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skin {
    /// The point of the base mesh.
    pub position: Vec3,
    /// The unit normal there, interpolated between vertices.
    pub normal: Vec3,
    /// The unit normal of the triangle, on the same side; zero where the skin is as flat as its
    /// normal says.
    pub plane: Vec3,
    /// How the normal changes along the triangle, for each unit of the way; zero for flat skin.
    pub slope: Mat3,
}

impl Skin {
    /// Flat skin: strands next to each other are parallel.
    pub const fn flat(position: Vec3, normal: Vec3) -> Self {
        Self { position, normal, plane: Vec3::ZERO, slope: Mat3::ZERO }
    }

    /// The skin at a point of a triangle, whose normals are interpolated between its corners;
    /// `weights` are those of the corners and add up to 1. Flat where the triangle has no area.
    pub fn of_triangle(corners: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3]) -> Self {
        let mix = |of: [Vec3; 3]| of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2];
        let sum = mix(normals);
        let (normal, long) = (sum.normalize_or_zero(), sum.length());
        let [u, v] = [corners[1] - corners[0], corners[2] - corners[0]];
        let across = u.cross(v);
        let area = across.length_squared();
        if !(area > 0.0 && long > 0.0) {
            return Self::flat(mix(corners), normal);
        }
        // The normal of length 1 changes by the part across it.
        let change = |n: Vec3| (n - normal * n.dot(normal)) / long;
        let (along_u, along_v) = (v.cross(across) / area, across.cross(u) / area);
        let [du, dv] = [change(normals[1] - normals[0]), change(normals[2] - normals[0])];
        let column = |i: usize| du * along_u[i] + dv * along_v[i];
        Self {
            position: mix(corners),
            normal,
            plane: across * (across.dot(normal).signum() / area.sqrt()),
            slope: Mat3::from_cols(column(0), column(1), column(2)),
        }
    }

    /// The vector whose product with a way from the point is the height of its end above the
    /// triangle, along the normal.
    #[inline]
    pub(crate) fn lift(&self) -> Vec3 {
        let lean = self.normal.dot(self.plane);
        if lean > LEAST_LEAN { self.plane / lean } else { self.normal }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_ball_is_one_over_its_radius() {
        let r = 3.0;
        let normals =
            [[0.1f32, 0.0], [0.0, 0.1], [-0.1, -0.1]].map(|[x, y]| Vec3::new(x, y, 1.0).normalize());
        let skin = Skin::of_triangle(normals.map(|n| n * r), normals, [0.3, 0.3, 0.4]);
        for way in [Vec3::X, Vec3::Y, Vec3::new(0.6, -0.8, 0.0)] {
            let way = way - skin.plane * way.dot(skin.plane);
            assert!((skin.slope * way).distance(way / r) < 0.05 / r, "{way}");
        }
        assert!(skin.plane.distance(Vec3::Z) < 0.05 && (skin.normal.length() - 1.0).abs() < 1e-6);
        // Triangles without area, and normals that cancel, are flat.
        let none = Skin::of_triangle([Vec3::X; 3], normals, [0.3, 0.3, 0.4]);
        assert_eq!((none.slope, none.plane), (Mat3::ZERO, Vec3::ZERO));
        let odd = Skin::of_triangle(normals, [Vec3::Z, Vec3::NEG_Z, Vec3::ZERO], [0.5, 0.5, 0.0]);
        assert_eq!((odd.slope, odd.normal), (Mat3::ZERO, Vec3::ZERO));
    }
}
