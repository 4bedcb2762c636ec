//! Magnifying: what pixels leave undecided is drawn again, eight times as fine.
//!
//! A target that a few uncovered pixels show is tested in those pixels once more, against the patches
//! of triangles that reach into them, drawn together at a finer pitch: silhouettes are then a
//! pixel wide that is an eighth as wide, and no seam stays between patches of different batches.

use crate::occlusion::face::Rect;
use crate::occlusion::surface::{Drawable, SurfaceScratch};
use crate::occlusion::target::Target;
use crate::occlusion::tiles::TILE;
use crate::occlusion::{BIN, FaceBuffer, OcclusionBuffers};

/// A target with this many uncovered pixels on one face is taken to be visible.
const PIXELS: usize = 16;

/// So is one whose uncovered pixels lie farther apart than this.
const ACROSS: i64 = 8;

/// A patch with this many sides counts as two.
const SIDES: u64 = 32;

/// How many times finer.
const FINER: i64 = TILE;

/// The buffer that is drawn again, reused from target to target.
#[derive(Debug, Default)]
pub(crate) struct Magnifier {
    buffer: Option<FaceBuffer>,
    scratch: SurfaceScratch,
    found: Vec<u32>,
    open: Vec<(i64, i64, Rect)>,
}

impl Magnifier {
    /// Whether a target that pixels show is hidden after all. `drawable` gives patches by the order in which they
    /// were drawn first. Takes the patches drawn from `budget`; when it is spent, the pixels decide.
    pub(crate) fn hides<'a>(
        &mut self,
        buffers: &OcclusionBuffers,
        target: &Target,
        patches: usize,
        budget: &mut u32,
        drawable: &dyn Fn(u32) -> Option<Drawable<'a>>,
    ) -> bool {
        if buffers.is_close(target.bounds()) {
            return false;
        }
        for b in buffers.faces.iter().filter(|b| b.active) {
            let Some(mut on_face) = target.on_face(&b.face) else { continue };
            self.open.clear();
            let open = &mut self.open;
            b.uncovered(&on_face, |x, y, rect| {
                open.push((x, y, *rect));
                open.len() > PIXELS
            });
            if open.len() > PIXELS {
                return false;
            }
            let Some(&(x, y, _)) = open.first() else { continue };
            let (px, py) = open.iter().fold(((x, x + 1), (y, y + 1)), |(px, py), &(x, y, _)| {
                ((px.0.min(x), px.1.max(x + 1)), (py.0.min(y), py.1.max(y + 1)))
            });
            if px.1 - px.0 > ACROSS || py.1 - py.0 > ACROSS {
                return false;
            }
            b.patches_in(px, py, on_face.near, &mut self.found);
            let batch: Vec<Drawable<'a>> = self.found.iter().filter_map(|&id| drawable(id)).collect();
            // Long outlines count as several patches.
            let cost = batch
                .iter()
                .map(|d| 1 + d.surface.outline(&d.surface.patches[d.patch as usize]).len() as u64 / SIDES);
            let cost = cost.sum::<u64>();
            if cost == 0 || cost > u64::from(*budget) {
                return false;
            }
            *budget -= cost as u32;
            let fine = self.buffer.get_or_insert_with(|| FaceBuffer::new(b.face));
            fine.face = b.face;
            fine.halves.clone_from(&b.halves);
            let window =
                Rect { u0: b.border(px.0), v0: b.border(py.0), u1: b.border(px.1), v1: b.border(py.1) };
            fine.clear(Some(window), (b.per_unit * 2.0).round() as i64 * FINER);
            fine.draw_surfaces(&batch, buffers.origin, buffers.nearest * 0.5, patches, &mut self.scratch);
            let whole = on_face.rect;
            for (_, _, rect) in open.iter() {
                let Some(part) = whole.meet(rect) else { continue };
                on_face.rect = part;
                let mut seen = false;
                fine.uncovered(&on_face, |_, _, _| {
                    seen = true;
                    true
                });
                if seen {
                    return false;
                }
            }
        }
        true
    }
}

impl FaceBuffer {
    /// The patches drawn that may reach into a range of pixels, and may hide what is nowhere nearer than `near`.
    fn patches_in(&self, px: (i64, i64), py: (i64, i64), near: f32, found: &mut Vec<u32>) {
        found.clear();
        let bins = (self.nx - 1) / BIN + 1;
        let bin = |p: i64, first: i64| (p / TILE - first) / BIN;
        for by in bin(py.0, self.ty)..=bin(py.1 - 1, self.ty) {
            for bx in bin(px.0, self.tx)..=bin(px.1 - 1, self.tx) {
                for patch in &self.patches[(by * bins + bx) as usize] {
                    let meets =
                        patch.px.0 < px.1 && px.0 < patch.px.1 && patch.py.0 < py.1 && py.0 < patch.py.1;
                    if meets && patch.near > near {
                        found.push(patch.id);
                    }
                }
            }
        }
        found.sort_unstable();
        found.dedup();
    }
}
