//! Opening pixels again that were covered by occluders which are gone.

use smallvec::SmallVec;

use crate::geometry::Block;
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::tiles::TILE;

/// Tiles of a face that were opened.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hole {
    /// The number of the face among the active ones.
    face: usize,
    /// The pixels of those tiles.
    area: PixelRect,
}

impl Hole {
    /// How many pixels it has.
    pub(crate) fn pixels(&self) -> u64 {
        ((self.area.x.1 - self.area.x.0) * (self.area.y.1 - self.area.y.0)) as u64
    }
}

impl OcclusionBuffers {
    /// Opens the tiles in which rays from an eye within reach may end after they pass some boxes,
    /// given in world units.
    pub(crate) fn reopen(&mut self, gone: &[Block]) -> Vec<Hole> {
        let mut holes = Vec::new();
        let gone: SmallVec<[(Block, bool); 4]> = gone
            .iter()
            .map(|block| self.within_reach(&self.relative(block)))
            .map(|b| (b, self.is_close(&b)))
            .collect();
        let (faces, _) = self.surfaces_mut();
        for (face, buffer) in faces.enumerate() {
            let before = holes.len();
            for (block, close) in &gone {
                let all = || Some(*buffer.window().pixels());
                let area = if *close { all() } else { touched(buffer, block) };
                holes.extend(area.map(|area| Hole { face, area: open(buffer, &area) }));
            }
            if holes.len() > before {
                buffer.cover_outside();
            }
        }
        holes
    }

    /// Whether an occluder inside of a box in world units may cover pixels that were opened.
    pub(crate) fn reaches_into(&self, block: &Block, holes: &[Hole]) -> bool {
        let relative = self.relative(block);
        let close = self.is_close(&relative);
        self.faces().enumerate().any(|(face, buffer)| {
            let mut of_face = holes.iter().filter(|hole| hole.face == face).peekable();
            of_face.peek().is_some()
                && (close
                    || touched(buffer, &relative)
                        .is_some_and(|area| of_face.any(|hole| hole.area.overlaps(&area))))
        })
    }
}

/// The pixels that a box may touch, if the face sees any of it.
fn touched(buffer: &FaceBuffer, block: &Block) -> Option<PixelRect> {
    let (rect, _) = buffer.face().block(block)?;
    let pixels = buffer.window().touched_by(&rect.grown());
    (!pixels.is_empty()).then_some(pixels)
}

/// Opens the tiles of some pixels of the window, also outside of the view. Returns the pixels of
/// those tiles.
fn open(buffer: &mut FaceBuffer, pixels: &PixelRect) -> PixelRect {
    let ((tx0, tx1), (ty0, ty1)) = (pixels.tiles_x(), pixels.tiles_y());
    for ty in ty0..=ty1 {
        let row = buffer.window().tile_index(tx0, ty);
        (row..=row + (tx1 - tx0) as usize).for_each(|tile| buffer.coverage_mut().open(tile));
    }
    PixelRect { x: (tx0 * TILE, (tx1 + 1) * TILE), y: (ty0 * TILE, (ty1 + 1) * TILE) }
}
