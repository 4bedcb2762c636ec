//! Occlusion buffers as images, for debugging.

use glam::Vec3;

use crate::occlusion::OcclusionBuffers;
use crate::occlusion::tiles::TILE;

/// What one side of the view cube (or the plane of parallel rays) covers, inside the view.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct OcclusionImage {
    /// Direction in which the side looks.
    pub direction: Vec3,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row, along the second and first axis of the side (see [`crate::matrix`]): the depth along
    /// `direction` from which on everything in the pixel is hidden. Infinite for pixels that are
    /// open, 0 for those outside the view. For parallel rays it counts from a
    /// point in front of the scene.
    pub depth: Vec<f32>,
}

impl OcclusionBuffers {
    /// All sides that the view looks through.
    pub(crate) fn images(&self) -> Vec<OcclusionImage> {
        let image = |b: &crate::occlusion::FaceBuffer| {
            let ((x0, x1), (y0, y1)) = (b.px, b.py);
            let mut depth = Vec::new();
            for y in y0..y1 {
                for x in x0..x1 {
                    let tile = &b.tiles[((y / TILE - b.ty) * b.nx + x / TILE - b.tx) as usize];
                    let near = tile.nearness((y % TILE * TILE + x % TILE) as u32);
                    depth.push(if near == f32::NEG_INFINITY {
                        f32::INFINITY
                    } else if near == f32::INFINITY {
                        0.0
                    } else if b.face.parallel {
                        -near
                    } else {
                        1.0 / near
                    });
                }
            }
            OcclusionImage {
                direction: b.face.forward.as_vec3(),
                width: (x1 - x0) as usize,
                height: (y1 - y0) as usize,
                depth,
            }
        };
        self.faces.iter().filter(|b| b.active).map(image).collect()
    }
}
