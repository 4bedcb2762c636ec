//! The roles of objects in a view from above, and their colours.

use casca_scenes::world::{Object, Shape};
use casca_tools::pictures::palette::{self, rgba};

use crate::scene::overlays::LOST;

/// Whether an object is drawn, or the reason why it is not; grounds and ceilings are set apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Found visible and drawn.
    Drawn,
    /// Visible, but not drawn. Only methods that promise nothing lose objects.
    Lost,
    /// In the frustum, found hidden and left out.
    Culled,
    /// Outside the frustum.
    Outside,
    /// The ground under everything, which has a quiet colour.
    Ground,
    /// A ceiling, taken off so that one sees in.
    Ceiling,
}

/// The roles that culling gives, with their colours and names in legends.
pub const COUNTED: [(Role, [u8; 4], &str); 4] = [
    (Role::Drawn, rgba(palette::DRAWN, 255), "visible, drawn"),
    (Role::Lost, LOST, "visible, lost"),
    (Role::Culled, rgba(palette::CULLED, 255), "hidden, culled"),
    (Role::Outside, rgba(palette::OUTSIDE, 255), "outside the frustum"),
];

impl Role {
    /// The colour of objects in this role.
    pub fn colour(self) -> [u8; 4] {
        COUNTED.iter().find(|known| known.0 == self).map_or(rgba(palette::GROUND, 255), |known| known.1)
    }

    /// Wide flat boxes are grounds or ceilings, the others keep the role that culling gave them.
    pub fn of(object: &Object, given: Self, eye: glam::Vec3, extent: glam::Vec3) -> Self {
        match object.shape {
            Shape::Box { min, max } if (max - min).cmpgt(0.5 * extent).bitmask() & 0b101 == 0b101 => {
                if max.y <= eye.y {
                    Self::Ground
                } else if min.y >= eye.y {
                    Self::Ceiling
                } else {
                    given
                }
            }
            _ => given,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn wide_flat_boxes_are_ground_below_the_eye_and_ceilings_above() {
        let role = |min: Vec3, max: Vec3| {
            let shape = Shape::Box { min, max };
            let (name, motion) = (String::new(), casca_scenes::world::Motion::Static);
            let object = Object { name, shape, motion, occludes: true, tested: true };
            Role::of(&object, Role::Drawn, Vec3::new(5.0, 2.0, 5.0), Vec3::new(10.0, 4.0, 10.0))
        };
        assert_eq!(role(Vec3::ZERO, Vec3::new(10.0, 0.2, 10.0)), Role::Ground);
        assert_eq!(role(Vec3::Y * 3.0, Vec3::new(10.0, 3.2, 10.0)), Role::Ceiling);
        assert_eq!(role(Vec3::ZERO, Vec3::new(10.0, 3.0, 0.2)), Role::Drawn, "a wall");
        assert_eq!(role(Vec3::ZERO, Vec3::splat(10.0)), Role::Drawn, "around the eye");
    }
}
