//! The options of a world.

use glam::{BVec3, UVec3};

use crate::error::Error;
use crate::grid::MAX_CELLS_PER_AXIS;
use crate::numeric::world::{LARGEST_CELL, SMALLEST_CELL};
use crate::world::page::PAGE_CELLS;

/// The most pages of a window along an axis: as many as a grid has cells for.
const MOST_PAGES: u32 = MAX_CELLS_PER_AXIS / PAGE_CELLS;

/// How a [`World`](crate::World) is divided, and how much of it a frame changes.
///
/// ```
/// use casca::{World, WorldOptions};
/// use glam::{BVec3, UVec3};
///
/// // A landscape: cells of one metre, a window of 16x2x16 pages that follows the eye along the ground.
/// let options = WorldOptions::new(1.0).window(UVec3::new(16, 2, 16)).still(BVec3::new(false, true, false));
/// assert_eq!(World::new(options).unwrap().page_size(), 512.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct WorldOptions {
    /// Edge length of a cell in world units, 2^-30 to 2^20. A page has 512 cells along each axis.
    /// Powers of two let shapes with few digits stay exact.
    pub cell: f32,
    /// Pages along each axis that the grid around the eye covers: 1 to 16. An empty one takes about
    /// 20 kB.
    pub window: UVec3,
    /// The axes along which the window stays where it is, around the corner of page 0: one of the
    /// height for a landscape.
    pub still: BVec3,
    /// What a frame may cost for pages, in bricks of 8x8x8 cells that it takes into the scene or
    /// out of it: an object counts as those on the surface of its box, and as one at least. As
    /// many more are taken over while the window moves. At least 1; a brick takes one to
    /// three microseconds. `usize::MAX` does everything at once.
    pub budget: usize,
}

impl WorldOptions {
    /// A window of 8x8x8 pages with cells of this edge length, in world units, that follows the eye
    /// along all axes, and a budget of 1,024 bricks.
    pub const fn new(cell: f32) -> Self {
        Self { cell, window: UVec3::splat(8), still: BVec3::FALSE, budget: 1024 }
    }

    /// Sets [`WorldOptions::window`], in pages.
    #[must_use]
    pub const fn window(mut self, pages: UVec3) -> Self {
        self.window = pages;
        self
    }

    /// Sets [`WorldOptions::still`].
    #[must_use]
    pub const fn still(mut self, axes: BVec3) -> Self {
        self.still = axes;
        self
    }

    /// Sets [`WorldOptions::budget`], in bricks.
    #[must_use]
    pub const fn budget(mut self, bricks: usize) -> Self {
        self.budget = bricks;
        self
    }

    /// Whether a world can be made with these.
    ///
    /// # Errors
    /// [`Error::CellSize`] and [`Error::Setting`] for what is out of its range.
    pub fn check(&self) -> Result<(), Error> {
        if !(SMALLEST_CELL..=LARGEST_CELL).contains(&self.cell) {
            return Err(Error::CellSize(self.cell));
        }
        let out_of_range = |what, value, min, max| Err(Error::Setting { what, value, min, max });
        for pages in self.window.to_array() {
            if !(1..=MOST_PAGES).contains(&pages) {
                let most = f64::from(MOST_PAGES);
                return out_of_range("the pages of a window along an axis", f64::from(pages), 1.0, most);
            }
        }
        if self.budget == 0 {
            return out_of_range("the budget", 0.0, 1.0, usize::MAX as f64);
        }
        Ok(())
    }

    /// The edge length of a page in world units, an exact number.
    pub(super) fn page_size(&self) -> f64 {
        f64::from(self.cell) * f64::from(PAGE_CELLS)
    }
}
