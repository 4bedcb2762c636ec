//! Views of a scene, orthographic and perspective, and the columns of space behind their pixels.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::numeric::{AROUND, DOT_ROOM, LEAST_NEAR, UPRIGHT};

/// The greatest number of pixels of a view in one direction.
pub const MOST_PIXELS: u32 = 8192;

/// How a view projects. Pixels are square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// Parallel rays; half the height of the picture, in units of the scene.
    Orthographic {
        /// Half the height, greater than 0.
        half_height: f64,
    },
    /// Rays from the eye.
    Perspective {
        /// The vertical field of view in radians, between 0 and pi.
        fov_y: f64,
    },
}

/// Why a view was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ViewError {
    /// The eye is at the target or not finite, or the upward direction points along the view.
    #[error("the eye, the target and the upward direction give no view")]
    NoDirection,
    /// The picture has no area, or a side of more than [`MOST_PIXELS`].
    #[error("a picture of {0} x {1} pixels: each side must have 1 to {MOST_PIXELS}")]
    Size(u32, u32),
    /// The height or the angle of the lens.
    #[error("a lens of {0}: half heights are positive and finite, angles lie between 0 and pi")]
    Lens(f64),
    /// The nearest and the farthest depth.
    #[error("depths from {0} to {1}: they must be finite and increase, from above 0 in perspective")]
    Depths(f64, f64),
}

/// A view: where its pixels are and which columns of space lie behind them.
///
/// Eye space has x to the right, y upwards and z towards the viewer; the *depth* of a point is -z.
/// Pixel (0, 0) is at the upper left. Scenes of millions of units are fine: points go through eye
/// space in double precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    eye_from_world: DAffine3,
    lens: Lens,
    depths: [f64; 2],
    size: [u32; 2],
    /// Pixels per unit, at depth 1 in perspective.
    scale: f64,
}

impl View {
    fn new(
        eye_from_world: DAffine3,
        lens: Lens,
        depths: [f64; 2],
        size: [u32; 2],
    ) -> Result<Self, ViewError> {
        if !size.iter().all(|s| (1..=MOST_PIXELS).contains(s)) {
            return Err(ViewError::Size(size[0], size[1]));
        }
        let half = f64::from(size[1]) / 2.0;
        let (scale, value, least) = match lens {
            Lens::Orthographic { half_height } => (half / half_height, half_height, f64::NEG_INFINITY),
            Lens::Perspective { fov_y } if fov_y < std::f64::consts::PI => {
                (half / (fov_y / 2.0).tan(), fov_y, 0.0)
            }
            Lens::Perspective { fov_y } => (f64::NAN, fov_y, 0.0),
        };
        if !(value > 0.0 && scale > 0.0 && scale.is_finite()) {
            return Err(ViewError::Lens(value));
        }
        let [near, far] = depths;
        // The square of the range must not overflow.
        if !(near > least && near < far && near.abs().max(far.abs()) < 1e150) {
            return Err(ViewError::Depths(near, far));
        }
        Ok(Self { eye_from_world, lens, depths, size, scale })
    }

    /// A view from an eye towards a target; `depths` are the nearest and the farthest depth.
    ///
    /// # Errors
    /// If eye, target and upward direction give no view, or another value is out of its range.
    pub fn look_at(
        [eye, target, up]: [Vec3; 3],
        lens: Lens,
        depths: [f64; 2],
        size: [u32; 2],
    ) -> Result<Self, ViewError> {
        let [eye, target, up] = [eye, target, up].map(|v: Vec3| v.as_dvec3());
        Self::towards([eye, eye - target, up], lens, depths, size)
    }

    /// A view from an eye against the direction `back`.
    fn towards(
        [eye, back, up]: [DVec3; 3],
        lens: Lens,
        depths: [f64; 2],
        size: [u32; 2],
    ) -> Result<Self, ViewError> {
        let no = ViewError::NoDirection;
        let back = back.try_normalize().ok_or(no)?;
        let right = up.cross(back).try_normalize().filter(|_| eye.is_finite()).ok_or(no)?;
        let turn = DMat3::from_cols(right, back.cross(right), back).transpose();
        Self::new(DAffine3::from_mat3_translation(turn, turn * -eye), lens, depths, size)
    }

    /// A view that holds all of a box, as seen from the direction `from`; a degenerate box is given
    /// some room.
    ///
    /// # Errors
    /// As [`Self::look_at`].
    pub fn around(
        [min, max]: [Vec3; 2],
        from: Vec3,
        fov_y: Option<f64>,
        size: [u32; 2],
    ) -> Result<Self, ViewError> {
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        let (middle, radius) = ((min + max) / 2.0, (max - min).length() / 2.0);
        let room = middle.abs().max_element() * DOT_ROOM;
        let radius = [radius, room, DOT_ROOM].into_iter().find(|&r| r > 0.0).unwrap_or(DOT_ROOM);
        let away = from.as_dvec3().try_normalize().ok_or(ViewError::NoDirection)?;
        let up = if away.y.abs() < UPRIGHT { DVec3::Y } else { DVec3::Z };
        let r = radius * AROUND;
        let aspect = (f64::from(size[0]) / f64::from(size[1].max(1))).min(1.0);
        let (lens, distance) = match fov_y {
            None => (Lens::Orthographic { half_height: r / aspect }, r),
            Some(fov_y) => (Lens::Perspective { fov_y }, r / ((fov_y / 2.0).tan() * aspect).atan().sin()),
        };
        let least = if fov_y.is_some() { r * LEAST_NEAR } else { -r * LEAST_NEAR };
        let depths = [(distance - r).max(least), distance + r];
        Self::towards([middle + away * distance, away, up], lens, depths, size)
    }

    /// The same view with a picture of another height in pixels, and of the same shape to a pixel.
    ///
    /// # Errors
    /// If a side has no pixel, or more than [`MOST_PIXELS`].
    pub fn with_height(&self, height: u32) -> Result<Self, ViewError> {
        let width = (f64::from(self.size[0]) * f64::from(height) / f64::from(self.size[1])).round() as u32;
        Self::new(self.eye_from_world, self.lens, self.depths, [width, height])
    }

    /// The picture moved by so many pixels to the right and downwards over the scene.
    pub fn moved_by_pixels(&self, x: f64, y: f64) -> Self {
        let step = match self.lens {
            Lens::Orthographic { .. } => DVec3::new(x, -y, 0.0) / self.scale,
            // Perspective has no such motion; points in the middle of the depths move so.
            Lens::Perspective { .. } => {
                DVec3::new(x, -y, 0.0) / self.scale * (self.depths[0] + self.depths[1]) / 2.0
            }
        };
        let moved = DAffine3::from_translation(-step) * self.eye_from_world;
        Self { eye_from_world: moved, ..*self }
    }

    /// The view turned to the right by an angle in radians, about the eye's y axis.
    pub fn turned(&self, angle: f64) -> Self {
        let turn = DAffine3::from_mat3(DMat3::from_rotation_y(angle));
        Self { eye_from_world: turn * self.eye_from_world, ..*self }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The nearest and the farthest depth.
    pub fn depths(&self) -> [f64; 2] {
        self.depths
    }

    /// The lens.
    pub fn lens(&self) -> Lens {
        self.lens
    }

    /// The rotation and translation from the world into eye space.
    pub fn eye_from_world(&self) -> DAffine3 {
        self.eye_from_world
    }

    /// Whether rays come from one eye.
    pub fn is_perspective(&self) -> bool {
        matches!(self.lens, Lens::Perspective { .. })
    }

    /// A point of the world in eye space.
    pub fn to_eye(&self, world: Vec3) -> DVec3 {
        self.eye_from_world.transform_point3(world.as_dvec3())
    }

    /// A point of eye space in the world.
    pub fn to_world(&self, eye: Vec3) -> DVec3 {
        self.eye_from_world.inverse().transform_point3(eye.as_dvec3())
    }

    /// The side of a pixel at a depth, in units of the scene.
    pub fn pixel_size(&self, depth: f64) -> f64 {
        if self.is_perspective() { depth / self.scale } else { 1.0 / self.scale }
    }

    /// The direction away from the viewer at a point of eye space, of length 1.
    pub fn away(&self, eye: Vec3) -> Vec3 {
        let along = match self.is_perspective() {
            // The squares of small and large coordinates fit into double precision only.
            true => eye.as_dvec3().normalize_or(DVec3::NEG_Z).as_vec3(),
            false => Vec3::NEG_Z,
        };
        if along.z > 0.0 { Vec3::NEG_Z } else { along }
    }

    /// Homogeneous pixel coordinates (x, y, w): the point is at (x / w, y / w) if w > 0.
    pub fn project(&self, eye: DVec3) -> DVec3 {
        let w = if self.is_perspective() { -eye.z } else { 1.0 };
        let [middle_x, middle_y] = self.size.map(|s| f64::from(s) / 2.0);
        DVec3::new(middle_x * w + self.scale * eye.x, middle_y * w - self.scale * eye.y, w)
    }

    /// The pixel that a point of eye space is behind, if it lies in the picture.
    pub fn pixel(&self, eye: Vec3) -> Option<[u32; 2]> {
        let p = self.project(eye.as_dvec3());
        let (x, y) = ((p.x / p.z).floor(), (p.y / p.z).floor());
        let inside =
            p.z > 0.0 && x >= 0.0 && y >= 0.0 && x < f64::from(self.size[0]) && y < f64::from(self.size[1]);
        inside.then_some([x as u32, y as u32])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singular_views_are_refused_with_the_cause() {
        let lens = Lens::Orthographic { half_height: 1.0 };
        let look = [Vec3::Z, Vec3::ZERO, Vec3::Y];
        let new = |lens, depths, size| View::look_at(look, lens, depths, size).unwrap_err();
        let depths = [1.0, 2.0];
        let nowhere = View::around([Vec3::NAN; 2], Vec3::Z, None, [9, 9]);
        assert_eq!(nowhere, Err(ViewError::NoDirection));
        for size in [[0, 9], [9, 0], [MOST_PIXELS + 1, 9]] {
            assert_eq!(new(lens, depths, size), ViewError::Size(size[0], size[1]));
        }
        for value in [0.0, -1.0, f64::INFINITY, 1e-320] {
            let lens = Lens::Orthographic { half_height: value };
            assert_eq!(new(lens, depths, [9, 9]), ViewError::Lens(value));
        }
        for fov_y in [0.0, 3.2, f64::INFINITY] {
            assert_eq!(new(Lens::Perspective { fov_y }, depths, [9, 9]), ViewError::Lens(fov_y));
        }
        let eye = Lens::Perspective { fov_y: 1.0 };
        for (lens, depths) in
            [(lens, [2.0, 2.0]), (lens, [0.0, 1e300]), (eye, [0.0, 1.0]), (eye, [-1.0, 1.0])]
        {
            assert_eq!(new(lens, depths, [9, 9]), ViewError::Depths(depths[0], depths[1]));
        }
        for triple in
            [[Vec3::X, Vec3::X, Vec3::Y], [Vec3::Y, Vec3::ZERO, Vec3::Y], [Vec3::NAN, Vec3::ZERO, Vec3::Y]]
        {
            assert_eq!(View::look_at(triple, lens, depths, [9, 9]), Err(ViewError::NoDirection));
        }
    }

    #[test]
    fn boxes_of_any_unit_fill_their_picture() {
        for unit in [1e-30, 1e-12, 1.0, 1e12, 1e30] {
            for fov_y in [None, Some(0.8)] {
                let side = Vec3::splat(unit as f32);
                let view = View::around([-side, side], Vec3::ONE, fov_y, [40, 30]).unwrap();
                let corner = view.pixel(view.to_eye(Vec3::new(side.x, -side.y, -side.z)).as_vec3()).unwrap();
                assert!(corner[0] > 25 || corner[1] > 25, "{unit}: {corner:?}");
                assert!(view.away(Vec3::splat(-unit as f32)).z < -0.5 && view.depths()[1] < 12.0 * unit);
            }
        }
        for place in [Vec3::ZERO, Vec3::splat(1e-20), Vec3::splat(1e20)] {
            let view = View::around([place; 2], Vec3::Z, None, [9, 9]).unwrap();
            assert_eq!(view.pixel(view.to_eye(place).as_vec3()), Some([4, 4]));
        }
    }

    #[test]
    fn points_are_behind_their_pixels_in_both_lenses() {
        for (lens, pixel) in [
            (Lens::Orthographic { half_height: 3.0 }, [9, 2]),
            (Lens::Perspective { fov_y: 2.0 * 0.5f64.atan() }, [10, 2]),
        ] {
            let view =
                View::look_at([Vec3::Z * 5.0, Vec3::ZERO, Vec3::Y], lens, [1.0, 9.0], [16, 12]).unwrap();
            let world = Vec3::new(0.8, 1.7 - f32::from(view.is_perspective()) * 0.6, 1.0);
            let eye = view.to_eye(world);
            assert_eq!((view.pixel(eye.as_vec3()), eye.z), (Some(pixel), -4.0), "{lens:?}");
            assert!(view.to_world(eye.as_vec3()).distance(world.as_dvec3()) < 1e-6);
            let higher = view.with_height(36).unwrap();
            assert_eq!(higher.size(), [48, 36]);
            assert!((higher.pixel_size(4.0) * 3.0 - view.pixel_size(4.0)).abs() < 1e-12);
            let (beside, moved) = (view.to_eye(Vec3::X), view.moved_by_pixels(1.0, 0.0).to_eye(Vec3::X));
            assert!(((beside - moved).x - view.pixel_size(5.0)).abs() < 1e-12);
            assert_eq!(view.pixel(Vec3::new(99.0, 0.0, -4.0)), None);
        }
    }
}
