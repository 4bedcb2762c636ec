//! What a walk looks for in the cells of the grid.

use glam::IVec3;
use smallvec::SmallVec;

use crate::grid::bricks::Pages;
use crate::grid::cell_box::{CellBox, volume};
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
    pages: Occupied,
}

/// The pages of a block of cells that contain anything.
struct Occupied {
    block: CellBox,
    pages: Vec<bool>,
    /// Whether a plane across an axis has any.
    planes: [Vec<bool>; 3],
    /// Whether a row along x or along y has any, by its other two coordinates.
    rows: [Vec<bool>; 2],
}

impl Occupied {
    fn new(extent: CellBox) -> Self {
        let block = CellBox { lo: extent.lo >> 6i32, hi: extent.hi >> 6i32 };
        let none = |n: i32| vec![false; n as usize];
        let IVec3 { x, y, z } = block.hi - block.lo + 1;
        let pages = vec![false; volume(block.lo, block.hi) as usize];
        Self { block, pages, planes: [none(x), none(y), none(z)], rows: [none(y * z), none(x * z)] }
    }

    /// The index of a page, and that of its row along x or y; none outside of the block.
    #[inline]
    fn places(&self, page: IVec3) -> Option<(usize, [usize; 2])> {
        let IVec3 { x, y, z } = page - self.block.lo;
        let per = self.block.hi - self.block.lo + 1;
        let rows = || [(z * per.y + y) as usize, (z * per.x + x) as usize];
        self.block.contains(page).then(|| (((z * per.y + y) * per.x + x) as usize, rows()))
    }

    fn add(&mut self, pages: &Pages) {
        for page in pages.iter() {
            let Some((at, rows)) = self.places(page) else { continue };
            self.pages[at] = true;
            let planes = self.planes.iter_mut().zip((page - self.block.lo).to_array());
            planes.for_each(|(plane, at)| plane[at as usize] = true);
            self.rows.iter_mut().zip(rows).for_each(|(row, at)| row[at] = true);
        }
    }
}

impl<'a> CellMatrices<'a> {
    /// What there is in a block of cells.
    pub(super) fn new(scene: &'a Scene, view: &View, lists: &'a CellLists, extent: CellBox) -> Self {
        let layers = scene.opacity(view.layers());
        let opaque = layers.flat_map(|part| std::iter::once(part.fixed()).chain(part.known_moving()));
        let opaque: SmallVec<[&BitMatrix; 4]> = opaque.collect();
        let mut pages = Occupied::new(extent);
        lists.pages().into_iter().for_each(|own| pages.add(own));
        pages.add(scene.tbv_matrix().pages());
        opaque.iter().for_each(|opaque| pages.add(opaque.pages()));
        Self { lists, volumes: scene.tbv_matrix(), opaque, pages }
    }

    /// Whether a page contains nothing.
    #[inline]
    pub(super) fn page_is_empty(&self, page: IVec3) -> bool {
        self.pages.places(page).is_none_or(|(at, _)| !self.pages.pages[at])
    }

    /// Whether no page with the same coordinate along an axis contains anything.
    #[inline]
    pub(super) fn plane_is_empty(&self, axis: usize, page: IVec3) -> bool {
        let at = page[axis] - self.pages.block.lo[axis];
        !self.pages.planes[axis].get(at as usize).is_some_and(|&any| any)
    }

    /// Whether no page in the row along x (axis 0) or y (axis 1) through a page contains anything.
    #[inline]
    pub(super) fn row_is_empty(&self, along: usize, page: IVec3) -> bool {
        self.pages.places(page).is_none_or(|(_, rows)| !self.pages.rows[along][rows[along]])
    }

    /// Whether the pages between two columns of a row of bricks contain nothing.
    pub(super) fn pages_are_empty(&self, axis: usize, brick: IVec3, cols: (i32, i32)) -> bool {
        (cols.0 >> 6..=cols.1 >> 6).all(|col| {
            let mut page = brick >> 3i32;
            page[axis] = col;
            self.page_is_empty(page)
        })
    }
}
