//! Magnifying: undecided pixels are drawn again, eight times as fine.
//!
//! A target that a few uncovered pixels show is tested in those pixels once more, against the patches of triangles
//! that reach into them, drawn together at a finer pitch. Edges then touch pixels an eighth as wide, and patches of
//! different batches leave no seams.

use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::components::draw_surfaces;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::scratch::SurfaceScratch;
use crate::occlusion::target::{FaceTarget, Target};
use crate::occlusion::tiles::TILE;

/// A target with more uncovered pixels than this on one face is taken to be visible.
const PIXELS: usize = 16;

/// So is one whose uncovered pixels are farther apart than this.
const ACROSS: i64 = 8;

/// A patch counts once more for this many sides.
const SIDES: u64 = 32;

/// How many times finer.
const FINER: i64 = TILE;

/// An uncovered pixel and its square.
type OpenPixel = (i64, i64, Rect);

/// The finer buffer, reused from target to target.
#[derive(Debug, Clone, Default)]
pub(crate) struct Magnifier {
    buffer: Option<FaceBuffer>,
    scratch: SurfaceScratch,
    found: Vec<u32>,
    open: Vec<OpenPixel>,
}

impl Magnifier {
    /// Whether a target that pixels show is hidden after all.
    ///
    /// `drawable` gives a patch by its number in the order of first drawing. The patches drawn are taken from
    /// `budget`; when it is spent, the pixels decide. `patches` is greater than all numbers of patches.
    pub(crate) fn hides<'a>(
        &mut self,
        buffers: &OcclusionBuffers,
        target: &Target,
        patches: usize,
        budget: &mut u32,
        drawable: impl Fn(u32) -> Option<Drawable<'a>>,
    ) -> bool {
        if buffers.is_close(target.bounds()) {
            return false;
        }
        for buffer in buffers.faces() {
            let Some(on_face) = target.on_face(buffer.face()) else { continue };
            let pixels = match self.find_open(buffer, &on_face) {
                Open::Nothing => continue,
                Open::TooMuch => return false,
                Open::Within(pixels) => pixels,
            };
            find_patches(buffer, &pixels, on_face.near, &mut self.found);
            let batch: Vec<Drawable<'a>> = self.found.iter().filter_map(|&id| drawable(id)).collect();
            let cost = batch.iter().map(|d| 1 + d.outline().len() as u64 / SIDES).sum::<u64>();
            if cost == 0 || cost > u64::from(*budget) {
                return false;
            }
            *budget -= cost as u32;
            let fine = self.buffer.get_or_insert_with(|| FaceBuffer::new(*buffer.face()));
            fine.clear_finer(buffer, &pixels, FINER);
            draw_surfaces(fine, &batch, buffers.origin(), buffers.near_limit(), patches, &mut self.scratch);
            if sees_open(fine, on_face, &self.open) {
                return false;
            }
        }
        true
    }

    /// Collects the uncovered pixels that a target may touch.
    fn find_open(&mut self, buffer: &FaceBuffer, target: &FaceTarget) -> Open {
        let open = &mut self.open;
        open.clear();
        buffer.uncovered(target, |x, y, rect| {
            open.push((x, y, *rect));
            open.len() > PIXELS
        });
        if open.len() > PIXELS {
            return Open::TooMuch;
        }
        let around = open
            .iter()
            .fold(PixelRect::EMPTY, |all, &(x, y, _)| all.join(&PixelRect { x: (x, x + 1), y: (y, y + 1) }));
        if around.is_empty() {
            Open::Nothing
        } else if around.x.1 - around.x.0 > ACROSS || around.y.1 - around.y.0 > ACROSS {
            Open::TooMuch
        } else {
            Open::Within(around)
        }
    }
}

/// The uncovered pixels of a target on one face.
enum Open {
    Nothing,
    /// So many, or so far apart, that the target is taken to be visible.
    TooMuch,
    Within(PixelRect),
}

/// Whether the finer buffer sees a target in one of the pixels.
fn sees_open(fine: &FaceBuffer, mut target: FaceTarget, open: &[OpenPixel]) -> bool {
    let whole = target.rect;
    open.iter().any(|(_, _, rect)| {
        let Some(part) = whole.intersect(rect) else { return false };
        target.rect = part;
        fine.sees(&target)
    })
}

/// Finds the drawn patches that may reach into a rectangle of pixels, and may hide targets nowhere nearer than
/// `near`.
fn find_patches(buffer: &FaceBuffer, pixels: &PixelRect, near: f32, found: &mut Vec<u32>) {
    found.clear();
    buffer.patches().for_around(pixels, |patch| {
        if patch.pixels.overlaps(pixels) && patch.near > near {
            found.push(patch.id);
        }
    });
    found.sort_unstable();
    found.dedup();
}
