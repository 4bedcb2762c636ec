//! Patches that are drawn together, and where faces see them.

use crate::geometry::Block;
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::drawable::Drawable;

/// A box as one face sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sighting {
    /// The place of the face among those that the view looks through.
    pub(crate) face: u32,
    /// For the box around a patch, its index in the batch.
    pub(crate) patch: u32,
    /// No point of it is nearer.
    pub(crate) near: f32,
    /// The pixels that it may touch.
    pub(crate) pixels: PixelRect,
}

/// Patches that are drawn together.
#[derive(Debug, Clone, Default)]
pub(crate) struct Batch<'a> {
    pub(crate) drawables: Vec<Drawable<'a>>,
    /// For each patch, the faces that see it.
    pub(crate) sights: Vec<Sighting>,
}

impl<'a> Batch<'a> {
    /// Its memory, for patches of another query.
    pub(crate) fn emptied<'b>(mut self) -> Batch<'b> {
        self.drawables.clear();
        self.sights.clear();
        // A list is turned in place into one of items of the same size.
        Batch { drawables: self.drawables.into_iter().map_while(|_| None).collect(), sights: self.sights }
    }

    /// Appends the faces that see the box around the next patch, relative to the origin. Returns
    /// whether any does. Without such a patch call [`Batch::drop_sights`].
    pub(crate) fn see(&mut self, buffers: &OcclusionBuffers, block: &Block) -> bool {
        let (patch, before) = (self.drawables.len() as u32, self.sights.len());
        let block = buffers.within_reach(block);
        for (buffer, face) in buffers.faces().zip(0..) {
            if let Some((near, pixels)) = buffer.sight(&block) {
                self.sights.push(Sighting { face, patch, near, pixels });
            }
        }
        self.sights.len() > before
    }

    /// Drops the faces that see a patch that is not drawn.
    pub(crate) fn drop_sights(&mut self) {
        let patch = self.drawables.len() as u32;
        while self.sights.pop_if(|sight| sight.patch == patch).is_some() {}
    }
}
