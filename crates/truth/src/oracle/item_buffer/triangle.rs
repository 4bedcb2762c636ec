//! Triangles, as functions of pixels.

use glam::DVec3;

use super::pixel_rays::PixelRays;

/// A triangle's functions, affine in pixel coordinates: value at (0, 0) and
/// steps in x and y.
pub(super) struct TriangleSetup {
    /// On which side of each edge a ray passes. For the same edge of a
    /// neighbour exactly the negative.
    pub(super) edges: [[f64; 3]; 3],
    /// The depth of the plane is `number` over `over`.
    pub(super) number: [f64; 3],
    pub(super) over: [f64; 3],
    /// Least and greatest depth of the corners.
    pub(super) depths: [f64; 2],
    /// Whether a corner lies before the near plane.
    pub(super) behind: bool,
}

impl TriangleSetup {
    #[inline]
    pub(super) fn new(rays: &PixelRays, corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        if normal == DVec3::ZERO {
            return None;
        }
        let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            if rays.perspective {
                let side = p.cross(q);
                rays.step.map(|step| side.dot(step))
            } else {
                let (start, step) = (rays.start[0], rays.step[0]);
                let across = (p - q).cross(step);
                [step.dot((p - start).cross(q - start)), rays.start[1].dot(across), rays.start[2].dot(across)]
            }
        });
        let over = if rays.perspective {
            rays.step.map(|step| normal.dot(step))
        } else {
            [normal.dot(rays.step[0]), 0.0, 0.0]
        };
        let number = if rays.perspective {
            [normal.dot(a), 0.0, 0.0]
        } else {
            [normal.dot(a - rays.start[0]), -normal.dot(rays.start[1]), -normal.dot(rays.start[2])]
        };
        let depths = corners.map(|corner| rays.depth(corner));
        let near = depths[0].min(depths[1]).min(depths[2]);
        let far = depths[0].max(depths[1]).max(depths[2]);
        Some(Self { edges, number, over, depths: [near, far], behind: near < rays.near })
    }

    /// Whether the triangle surely misses a rectangle of pixels.
    pub(super) fn misses(&self, x: [usize; 2], y: [usize; 2]) -> bool {
        let mut negative = false;
        let mut positive = false;
        for [e, ex, ey] in self.edges {
            let values =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| e + y[j] as f64 * ey + x[i] as f64 * ex);
            negative |= values.iter().all(|&v| v < 0.0);
            positive |= values.iter().all(|&v| v > 0.0);
        }
        negative && positive
    }
}
