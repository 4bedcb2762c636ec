//! Exact visibility, for tests and measurements. Shares no code with the
//! library.
//!
//! - [`ItemBuffer`] tells what is seen through the centres of pixels.
//! - [`RayOracle`] looks at points on the surfaces of single objects, and so
//!   finds what is seen between the centres of pixels.
//! - [`Oracle`] uses both to judge a set of potentially visible objects.
//! - [`Seen`] reads from a file itself what of its objects stops rays.
//! - [`tree`] is their hierarchy of what stops rays, which sisters use, too.

mod files;
mod frustum;
mod geometry;
mod item_buffer;
mod rays;
mod sample;
#[cfg(test)]
mod tests;
pub mod tree;

use glam::DVec3;
use rayon::prelude::*;

pub use files::Seen;
pub use frustum::{Frustum, Viewpoint};
use geometry::Primitive;
pub use item_buffer::{ItemBuffer, NONE};
pub use rays::{ProbeReport, RayOracle, Sighting};

use casca_scenes::world::{Camera, Object, Shape};

/// Pixels of an object through which a sighting is confirmed, at most.
const CONFIRM_PIXELS: usize = 64;

/// How much an [`Oracle`] looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OracleOptions {
    /// Pixels in a row of the item buffer.
    pub width: usize,
    /// Rows of the item buffer; 0 for none.
    pub height: usize,
    /// Rays to each object left out by the set.
    pub samples_per_object: usize,
    /// Objects looked at by rays in one frame, at most. If more are left out,
    /// the frames take turns.
    pub max_candidates: usize,
    /// Seed of the points looked at.
    pub seed: u64,
}

impl Default for OracleOptions {
    fn default() -> Self {
        Self { width: 1920, height: 1080, samples_per_object: 8, max_candidates: usize::MAX, seed: 1 }
    }
}

/// What found an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FoundBy {
    /// A pixel of the item buffer, confirmed by a ray.
    ItemBuffer,
    /// A ray to a point on the object.
    Ray,
}

/// A visible object that the set lacks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FalseNegative {
    /// The object.
    pub object: usize,
    /// Where the ray starts: on the near plane.
    pub origin: DVec3,
    /// The point that is seen. For a solid that holds the eye, the eye.
    pub target: DVec3,
    /// What found it.
    pub found_by: FoundBy,
}

/// The judgement on one frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameVerdict {
    /// The exactly visible set as far as sampled: tested objects seen in the
    /// item buffer or by a ray, ascending.
    pub exact: Vec<usize>,
    /// Rays shot at objects.
    pub rays: u64,
    /// Rays of the item buffer: its pixels.
    pub item_rays: u64,
    /// Objects left out that rays were meant for: tested, not seen in the
    /// item buffer, not in the set and maybe in the frustum.
    pub candidates: usize,
    /// Visible objects that the set lacks, beyond the doubt of rounding;
    /// ascending.
    pub false_negatives: Vec<FalseNegative>,
    /// Objects that the item buffer shows and the set lacks, where no ray
    /// past slightly grown occluders confirms it; ascending.
    pub unconfirmed: Vec<usize>,
}

/// Judges sets of potentially visible objects.
pub struct Oracle {
    options: OracleOptions,
    buffer: ItemBuffer,
    rays: RayOracle,
    frame: u64,
    /// Where the next frame's turn starts.
    turn: usize,
}

impl Oracle {
    /// An oracle for these objects as they are now.
    pub fn new(objects: &[Object], options: OracleOptions) -> Self {
        Self {
            options,
            buffer: ItemBuffer::new(options.width, options.height),
            rays: RayOracle::new(objects),
            frame: 0,
            turn: 0,
        }
    }

    /// The item buffer of the last frame.
    pub fn buffer(&self) -> &ItemBuffer {
        &self.buffer
    }

    /// The rays, with the objects as they were in the last frame.
    pub fn rays(&self) -> &RayOracle {
        &self.rays
    }

    /// Judges the set `pvs`, which tells whether it holds an object. `moved`
    /// are the objects that have another shape than in the frame before.
    pub fn frame(
        &mut self,
        objects: &[Object],
        moved: &[usize],
        camera: &Camera,
        pvs: &dyn Fn(usize) -> bool,
    ) -> FrameVerdict {
        self.rays.update(objects, moved);
        self.buffer.update(objects, moved);
        self.buffer.draw(&self.rays, objects, camera);
        let frustum = Frustum::new(camera);
        let options = self.options;

        let mut exact = Vec::new();
        let mut missing = Vec::new();
        let mut left_out = Vec::new();
        for (i, object) in objects.iter().enumerate().filter(|(_, object)| object.tested) {
            let seen = self.buffer.visible()[i] > 0;
            if seen {
                exact.push(i);
            }
            if pvs(i) {
                continue;
            }
            if seen {
                missing.push(i);
            } else if self.may_be_in_view(&frustum, object) {
                left_out.push(i);
            }
        }

        let mut false_negatives = Vec::new();
        let mut unconfirmed = Vec::new();
        for (object, found) in self.confirm(objects, &frustum, &missing) {
            let Some((origin, target)) = found else {
                unconfirmed.push(object);
                continue;
            };
            false_negatives.push(FalseNegative { object, origin, target, found_by: FoundBy::ItemBuffer });
        }

        let candidates = left_out.len();
        if candidates > options.max_candidates {
            let from = self.turn % candidates;
            self.turn = from + options.max_candidates;
            left_out.rotate_left(from);
            left_out.truncate(options.max_candidates);
        }
        let seed = options.seed.wrapping_add(self.frame.wrapping_mul(0xd134_2543_de82_ef95));
        self.frame += 1;
        let report = self.rays.probe_camera(objects, &frustum, &left_out, options.samples_per_object, seed);
        for &Sighting { object, origin, target } in &report.seen {
            exact.push(object);
            false_negatives.push(FalseNegative { object, origin, target, found_by: FoundBy::Ray });
        }
        exact.sort_unstable();
        false_negatives.sort_unstable_by_key(|found| found.object);
        FrameVerdict {
            exact,
            rays: report.rays,
            item_rays: (options.width * options.height) as u64,
            candidates,
            false_negatives,
            unconfirmed,
        }
    }

    fn may_be_in_view(&self, frustum: &Frustum, object: &Object) -> bool {
        if let Shape::Sphere { center, radius } = object.shape {
            return frustum.may_meet_sphere(center.as_dvec3(), f64::from(radius));
        }
        let (min, max) = self.rays.meshes.bounds(&object.shape);
        min.cmple(max).all() && frustum.may_meet_box(min, max)
    }

    /// For each object in `missing` the ends of a ray that surely sees it.
    fn confirm(
        &self,
        objects: &[Object],
        frustum: &Frustum,
        missing: &[usize],
    ) -> Vec<(usize, Option<(DVec3, DVec3)>)> {
        missing
            .par_iter()
            .map(|&object| {
                if self.buffer.holding_eye().contains(&(object as u32)) {
                    return (object, Some((frustum.eye(), frustum.eye())));
                }
                let shape = &objects[object].shape;
                let is_mesh = matches!(shape, Shape::Mesh { .. });
                let pixels = self.buffer.pixels_of(object);
                // Spread over all of them.
                let stride = pixels.len().div_ceil(CONFIRM_PIXELS).max(1);
                let found = pixels.step_by(stride).find_map(|pixel| {
                    let (origin, step) = self.buffer.pixel_ray(frustum, pixel);
                    let target = origin + step * enter_shape(shape, origin, step)?;
                    (frustum.surely_contains(target)
                        && self.rays.surely_sees(origin, target, object, is_mesh))
                    .then_some((origin, target))
                });
                (object, found)
            })
            .collect()
    }
}

/// Where a ray first enters a shape.
fn enter_shape(shape: &Shape, origin: DVec3, step: DVec3) -> Option<f64> {
    (0..geometry::primitive_count(shape) as u32)
        .filter_map(|triangle| Primitive::of(shape, triangle).enter(origin, step, false))
        .min_by(f64::total_cmp)
}
