//! The one test of boxes against the frustum that all structures use.

use glam::{Vec3, Vec4, Vec4Swizzles};

use casca_scenes::world::Camera;

/// What the test lets through beyond the frustum, in metres: more than it rounds.
const MARGIN: f32 = 1e-3;

/// The half-spaces that bound a view, with normals of length 1 that point inwards.
pub(super) struct Frustum([Vec4; 6]);

impl Frustum {
    pub(super) fn of(camera: &Camera) -> Self {
        let m = camera.view_projection();
        let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
        let planes = [w + x, w - x, w + y, w - y, z, w - z];
        Self(planes.map(|p| p / p.xyz().length().max(f32::MIN_POSITIVE) + Vec4::W * MARGIN))
    }

    /// Whether a box may meet the frustum. True for a box wherever it is true for one inside it.
    pub(super) fn meets(&self, min: Vec3, max: Vec3) -> bool {
        self.0.iter().all(|p| {
            let n = p.xyz();
            let far = Vec3::select(n.cmpge(Vec3::ZERO), max, min);
            far.x * n.x + far.y * n.y + far.z * n.z + p.w >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_meet_the_frustum_or_not() {
        let f = Frustum::of(&Camera::look_at(Vec3::ZERO, Vec3::X, 90.0, 1.0, 1.0, 100.0));
        let meets = |x: f32, y: f32, z: f32| {
            let c = Vec3::new(x, y, z);
            f.meets(c - 0.5, c + 0.5)
        };
        assert!(meets(10.0, 0.0, 0.0) && meets(10.0, 9.9, 0.0) && meets(50.0, 0.0, -50.2));
        assert!(!meets(-10.0, 0.0, 0.0) && !meets(10.0, 12.0, 0.0) && !meets(101.0, 0.0, 0.0));
        assert!(!meets(0.2, 0.0, 0.0) && meets(0.6, 0.0, 0.0) && !meets(50.0, 0.0, 52.0));
    }
}
