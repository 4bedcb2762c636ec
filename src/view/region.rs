//! Regions: the part of a view inside a box, by its corners.

use glam::DVec3;

use crate::geometry::clip::{clip, sides_of_box};
use crate::numeric::view::CLIP;
use crate::view::View;

impl View {
    /// Whether all points that `other` sees inside the box from `min` to `max` lie in
    /// this view's half-spaces. Exact up to rounding; in doubt, no.
    pub(crate) fn contains(&self, other: &Self, min: DVec3, max: DVec3) -> bool {
        let mut shared = self.planes.iter().map(|plane| other.planes.contains(plane));
        if shared.all(|shared| shared) {
            return true;
        }
        let corners = other.corners(min, max);
        let reach = min.abs().max(max.abs()).max_element();
        self.planes.iter().all(|plane| {
            other.planes.contains(plane) || corners.iter().all(|&c| plane.distance(c) >= plane.margin(reach))
        })
    }

    /// The corners of the view's half-spaces clipped to a box, and some points of its surface: the
    /// region lies in their hull. Rounded outwards.
    pub(crate) fn corners(&self, min: DVec3, max: DVec3) -> Vec<DVec3> {
        let reach = min.abs().max(max.abs()).max_element();
        let mut faces = sides_of_box(min, max);
        for plane in &self.planes {
            let slack = CLIP * (reach + plane.offset.abs());
            clip(&mut faces, plane, slack);
        }
        faces.concat()
    }
}
