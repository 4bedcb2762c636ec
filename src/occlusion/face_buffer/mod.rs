//! The buffer of one face: covered pixels, and lists of the occluders that cover them.

mod draw;
mod frustum;
mod receivers;
pub(crate) mod search;

use casca_slots::Slot;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::numeric::occlusion::above;
use crate::occlusion::bins::{Bins, WideBins};
use crate::occlusion::coverage::Coverage;
use crate::occlusion::face::{Face, Linear, Rect};
use crate::occlusion::front::Front;
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::rows::ShapeRows;
use crate::occlusion::silhouette::Silhouette;

/// A convex occluder as drawn on one face.
#[derive(Debug, Clone)]
pub(crate) struct DrawnSolid {
    pub(crate) silhouette: Silhouette,
    pub(crate) front: Front,
    /// The object that it was drawn for.
    pub(crate) owner: Slot,
}

/// A convex occluder in the list of a bin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Listed {
    /// Index into the drawn occluders of the face.
    pub(crate) drawn: u32,
    /// No point of it is nearer.
    pub(crate) near: f32,
    /// Around its silhouette. Most occluders of a bin are beside a target, which this tells without
    /// a look at them.
    pub(crate) rect: Rect,
}

/// A patch of triangles in the list of a bin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ListedPatch {
    /// Its number in the order of drawing.
    pub(crate) id: u32,
    /// No point of it is nearer.
    pub(crate) near: f32,
    /// The pixels that it may touch.
    pub(crate) pixels: PixelRect,
}

/// The receivers in a tile.
#[derive(Debug, Clone, Copy)]
struct Received {
    /// The pixels that they may touch.
    mask: u64,
    /// None of them is less near.
    near: f32,
}

/// One face, as far as the view looks through it.
#[derive(Debug, Clone)]
pub(crate) struct FaceBuffer {
    face: Face,
    /// Whether any part of the face is inside the frustum.
    active: bool,
    window: Window,
    /// Directions inside the frustum.
    halves: SmallVec<[Linear; 8]>,
    coverage: Coverage,
    occluders: Bins<Listed>,
    patches: WideBins<ListedPatch>,
    /// Those of this query come first; the others keep their memory.
    drawn: Vec<DrawnSolid>,
    drawn_count: usize,
    /// Memory for the rows of one shape.
    rows: ShapeRows,
    received: Vec<Received>,
    /// For each tile, whether nothing was drawn into it when that was last noted.
    untouched: Vec<bool>,
}

impl FaceBuffer {
    pub(crate) fn new(face: Face) -> Self {
        Self {
            face,
            active: false,
            window: Window::empty(1),
            halves: SmallVec::new(),
            coverage: Coverage::default(),
            occluders: Bins::new(),
            patches: WideBins::new(),
            drawn: Vec::new(),
            drawn_count: 0,
            rows: ShapeRows::default(),
            received: Vec::new(),
            untouched: Vec::new(),
        }
    }

    /// Puts the buffer on another face. Call [`FaceBuffer::clear`] next.
    pub(crate) fn set_face(&mut self, face: Face) {
        self.face = face;
    }

    /// Clears the buffer, for the part of the face inside a rectangle and inside the half-planes of
    /// the frustum; `None` if there is none. The whole face has `pixels` along each side.
    pub(crate) fn clear(&mut self, bounds: Option<Rect>, pixels: i64) {
        self.drawn_count = 0;
        self.active = bounds.is_some();
        let Some(bounds) = bounds else {
            self.window = Window::empty(pixels);
            return;
        };
        self.window = Window::around(&bounds, pixels);
        let (nx, ny) = self.window.tile_count();
        self.coverage.clear((nx * ny) as usize);
        self.occluders.clear(&self.window);
        self.patches.clear(&self.window);
        self.cover_outside();
    }

    /// Takes over the covered pixels of another buffer, but not the lists of its occluders: those
    /// serve refinement only.
    pub(crate) fn copy_coverage(&mut self, from: &Self) {
        self.face = from.face;
        self.drawn_count = 0;
        self.active = from.active;
        self.window = from.window;
        self.halves.clone_from(&from.halves);
        if self.active {
            self.coverage.copy(&from.coverage);
            self.occluders.clear(&self.window);
            self.patches.clear(&self.window);
        }
    }

    pub(crate) fn face(&self) -> &Face {
        &self.face
    }

    /// Whether any part of the face is inside the frustum.
    pub(crate) fn is_active(&self) -> bool {
        self.active
    }

    pub(crate) fn window(&self) -> &Window {
        &self.window
    }

    /// Half-planes around the directions inside the frustum.
    pub(crate) fn halves(&self) -> &[Linear] {
        &self.halves
    }

    pub(crate) fn coverage_mut(&mut self) -> &mut Coverage {
        &mut self.coverage
    }

    /// The convex occluders drawn, by place.
    pub(crate) fn occluders(&self) -> &Bins<Listed> {
        &self.occluders
    }

    /// The patches drawn, by place.
    pub(crate) fn patches(&self) -> &WideBins<ListedPatch> {
        &self.patches
    }

    pub(crate) fn patches_mut(&mut self) -> &mut WideBins<ListedPatch> {
        &mut self.patches
    }

    /// The convex occluder that a list names by this number.
    #[inline]
    pub(crate) fn drawn(&self, number: u32) -> &DrawnSolid {
        debug_assert!((number as usize) < self.drawn_count, "a solid of an earlier query");
        &self.drawn[number as usize]
    }

    /// Whether all pixels are covered nearer than a distance along the axis of the face.
    pub(crate) fn is_closed(&self, distance: f64) -> bool {
        self.coverage.is_closed(above(self.face.nearness_of(distance)))
    }

    /// Whether every pixel of the rectangle around a box is covered nearer than it.
    #[inline]
    pub(crate) fn hides_block(&self, block: &Block) -> bool {
        let Some((rect, (depth, _))) = self.face.block(block) else { return true };
        self.hides(&rect.grown(), above(self.face.nearness_of(depth)))
    }

    /// Whether few pixels of the rectangle around a box are open: see [`Coverage::few_open`].
    pub(crate) fn few_open(&self, block: &Block, most: u64) -> bool {
        let Some((rect, (depth, _))) = self.face.block(block) else { return true };
        let near = above(self.face.nearness_of(depth));
        self.coverage.few_open(&self.window, &self.window.touched_by(&rect), near, most)
    }

    /// The nearness of the nearest point of a box, and the pixels of the rectangle around it;
    /// `None` if the face does not see it, or hides it.
    #[inline]
    pub(crate) fn sight(&self, block: &Block) -> Option<(f32, PixelRect)> {
        let (rect, (depth, _)) = self.face.block(block)?;
        let pixels = self.window.touched_by(&rect);
        if pixels.is_empty() {
            return None;
        }
        let near = above(self.face.nearness_of(depth));
        (!self.hides_pixels(&pixels, near)).then_some((near, pixels))
    }

    /// Whether every pixel of a rectangle is covered for targets nowhere nearer than `near`.
    #[inline]
    pub(crate) fn hides(&self, rect: &Rect, near: f32) -> bool {
        self.hides_pixels(&self.window.touched_by(rect), near)
    }

    /// Whether every pixel of a rectangle of them is covered for targets nowhere nearer than
    /// `near`.
    #[inline]
    pub(crate) fn hides_pixels(&self, pixels: &PixelRect, near: f32) -> bool {
        self.coverage.hides(&self.window, pixels, near)
    }

    /// The nearness down to which a pixel of the window is hidden; negative infinity if it is open.
    pub(crate) fn nearness(&self, x: i64, y: i64) -> f32 {
        self.coverage.nearness(&self.window, x, y)
    }

    /// Number of pixels of the window.
    pub(crate) fn pixel_count(&self) -> u64 {
        self.window.pixels().count()
    }
}
