//! Occlusion buffers as images, for debugging.

use glam::Vec3;

use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::face_buffer::FaceBuffer;

/// For each pixel of a side of the view cube (or of the plane of parallel rays), the depth beyond
/// which everything is hidden, as far as the view looks through that side.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct OcclusionImage {
    /// Direction in which the side looks, of length one.
    pub direction: Vec3,
    /// Pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Row by row: the depth along `direction`, in world units, beyond which everything in the
    /// pixel is hidden. Infinite for open pixels, 0 for pixels outside the view. For parallel rays
    /// it counts from a point in front of the scene.
    pub depth: Vec<f32>,
}

impl OcclusionBuffers {
    /// The images of all sides that the view looks through.
    pub(crate) fn images(&self) -> Vec<OcclusionImage> {
        self.faces().map(image).collect()
    }
}

fn image(buffer: &FaceBuffer) -> OcclusionImage {
    let (window, face) = (buffer.window(), buffer.face());
    let ((x0, x1), (y0, y1)) = (window.pixels().x, window.pixels().y);
    let depth = |near: f32| match near {
        f32::NEG_INFINITY => f32::INFINITY,
        f32::INFINITY => 0.0,
        near if face.parallel => -near,
        near => 1.0 / near,
    };
    let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y)));
    OcclusionImage {
        direction: face.forward.as_vec3(),
        width: (x1 - x0) as usize,
        height: (y1 - y0) as usize,
        depth: pixels.map(|(x, y)| depth(buffer.coverage().nearness(window, x, y))).collect(),
    }
}
