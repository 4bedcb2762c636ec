//! I: the objects that touch each cell (thesis, section 3.3).

use casca_slots::Slot;
use glam::IVec2;
use smallvec::SmallVec;

use crate::bits::CrossBits;
use crate::geometry::Shape;
use crate::grid::Grid;
use crate::raster::touched;

/// Cells of a block along each axis.
const BLOCK: i32 = 8;

const CELLS: usize = (BLOCK * BLOCK) as usize;

/// A block without objects takes no memory but its number.
const NO_BLOCK: u32 = u32::MAX;

/// The slots of the objects in a cell.
type Cell = SmallVec<[Slot; 4]>;

/// Lists of objects by cell, in blocks of 8x8 cells that exist where there are objects.
#[derive(Debug, Clone)]
pub(crate) struct CellLists {
    /// Blocks of a row.
    stride: usize,
    /// By block of the grid: its number in `blocks`.
    numbers: Vec<u32>,
    blocks: Vec<[Cell; CELLS]>,
    /// The cells whose lists have entries.
    pub(crate) occupied: CrossBits,
}

impl CellLists {
    pub(crate) fn new(grid: &Grid) -> Self {
        let blocks = (grid.dims + BLOCK - 1) / BLOCK;
        let numbers = vec![NO_BLOCK; (blocks.x * blocks.y) as usize];
        let occupied = CrossBits::new(grid.dims.as_uvec2());
        Self { stride: blocks.x as usize, numbers, blocks: Vec::new(), occupied }
    }

    /// The number of the block of a cell of the grid, and the place of the cell in it.
    fn place(&self, cell: IVec2) -> (usize, usize) {
        let (block, inner) = (cell / BLOCK, cell % BLOCK);
        (block.y as usize * self.stride + block.x as usize, (inner.y * BLOCK + inner.x) as usize)
    }

    /// The objects that touch a cell of the grid.
    pub(crate) fn get(&self, cell: IVec2) -> &[Slot] {
        let (block, inner) = self.place(cell);
        match self.numbers[block] {
            NO_BLOCK => &[],
            number => &self.blocks[number as usize][inner],
        }
    }

    /// Adds an object to the lists of the cells that its shape touches.
    pub(crate) fn insert(&mut self, slot: Slot, shape: &Shape, grid: &Grid) {
        touched(shape, grid, &mut |y, xs| xs.for_each(|x| self.add(IVec2::new(x, y), slot)));
    }

    fn add(&mut self, cell: IVec2, slot: Slot) {
        let (block, inner) = self.place(cell);
        if self.numbers[block] == NO_BLOCK {
            self.numbers[block] = self.blocks.len() as u32;
            self.blocks.push(std::array::from_fn(|_| Cell::new()));
        }
        let number = self.numbers[block] as usize;
        let list = &mut self.blocks[number][inner];
        // Runs of the sides of one shape overlap; other objects come between them never.
        if list.last() != Some(&slot) {
            list.push(slot);
            self.occupied.set(cell.x as u32, cell.y as u32, true);
        }
    }

    /// Takes an object out of the lists of the cells that its shape touches.
    pub(crate) fn remove(&mut self, slot: Slot, shape: &Shape, grid: &Grid) {
        touched(shape, grid, &mut |y, xs| {
            for x in xs {
                let (block, inner) = self.place(IVec2::new(x, y));
                let number = self.numbers[block] as usize;
                let Some(list) = self.blocks.get_mut(number).map(|block| &mut block[inner]) else { continue };
                // From the end: what came last is often taken out first.
                if let Some(at) = list.iter().rposition(|&other| other == slot) {
                    list.swap_remove(at);
                    if list.is_empty() {
                        self.occupied.set(x as u32, y as u32, false);
                    }
                }
            }
        });
    }
}
