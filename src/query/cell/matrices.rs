//! What a walk looks for in the cells of the grid.

use glam::IVec3;
use smallvec::SmallVec;

use crate::grid::bricks::Pages;
use crate::matrix::bits::BitMatrix;
use crate::matrix::tbv::TbvMatrix;
use crate::query::cell::lists::CellLists;
use crate::scene::Scene;
use crate::view::View;

/// What a walk looks for: objects, surfaces of volumes, and opaque cells.
pub(super) struct CellMatrices<'a> {
    /// The objects by cell.
    pub(super) lists: &'a CellLists,
    pub(super) volumes: &'a TbvMatrix,
    /// The cells that count as opaque.
    pub(super) opaque: SmallVec<[&'a BitMatrix; 4]>,
}

impl<'a> CellMatrices<'a> {
    pub(super) fn new(scene: &'a Scene, view: &View, lists: &'a CellLists) -> Self {
        let layers = scene.opacity(view.layers());
        let opaque = layers.flat_map(|part| std::iter::once(part.fixed()).chain(part.known_moving()));
        Self { lists, volumes: scene.tbv_matrix(), opaque: opaque.collect() }
    }

    /// Whether some pages contain nothing, by a question that is put to the pages of each matrix.
    #[inline(always)]
    pub(super) fn none_in(&self, empty: impl Fn(&dyn Pages) -> bool) -> bool {
        self.lists.none_in(&empty)
            && empty(self.volumes.pages())
            && self.opaque.iter().all(|opaque| empty(opaque.pages()))
    }

    /// Whether the pages between two columns of a row of bricks contain nothing.
    pub(super) fn pages_are_empty(&self, axis: usize, brick: IVec3, cols: (i32, i32)) -> bool {
        (cols.0 >> 6..=cols.1 >> 6).all(|col| {
            let mut page = brick >> 3i32;
            page[axis] = col;
            self.none_in(|pages| pages.page_is_empty(page))
        })
    }
}
