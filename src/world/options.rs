//! The options of a world.

use crate::error::Error;
use crate::numeric::world::{LARGEST_CELL, SMALLEST_CELL};
use crate::world::page::{PAGE_CELLS, PageId};

/// The eye goes no more pages than this from the origin.
const MOST_PAGES: u32 = 16;

/// How a [`World`](crate::World) is divided, and how much of it a frame changes.
///
/// ```
/// use casca::{World, WorldOptions};
///
/// // Cells of one metre. The origin follows an eye that is more than 2 km away from it.
/// let options = WorldOptions::new(1.0).reach(4);
/// assert_eq!(World::new(options).unwrap().page_size(), 512.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct WorldOptions {
    /// Edge length of a cell in world units, 2^-30 to 2^20. A page has 512 cells along each axis.
    /// Powers of two let shapes with few digits stay exact.
    pub cell: f32,
    /// How many pages the eye goes from the origin of coordinates, along any axis, before that
    /// follows it: 1 to 16. The farther, the coarser are coordinates in single precision: 8192
    /// cells away they are multiples of a 2048th of a cell.
    pub reach: u32,
    /// What a frame may cost for pages, in bricks of 8x8x8 cells that it takes into the scene or
    /// out of it: an object counts as those on the surface of its box, and as one at least. As
    /// many more are taken over while the origin moves. At least 1; a brick takes one to
    /// three microseconds. `usize::MAX` does everything at once.
    pub budget: usize,
}

impl WorldOptions {
    /// Cells of this edge length, in world units, an origin that follows the eye after 8 pages, and
    /// a budget of 1,024 bricks.
    pub const fn new(cell: f32) -> Self {
        Self { cell, reach: 8, budget: 1024 }
    }

    /// Sets [`WorldOptions::reach`], in pages.
    #[must_use]
    pub const fn reach(mut self, pages: u32) -> Self {
        self.reach = pages;
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
        if !(1..=MOST_PAGES).contains(&self.reach) {
            let most = f64::from(MOST_PAGES);
            return out_of_range("the pages from the origin to the eye", f64::from(self.reach), 1.0, most);
        }
        if self.budget == 0 {
            return out_of_range("the budget", 0.0, 1.0, usize::MAX as f64);
        }
        Ok(())
    }

    /// The page whose corner is the next origin, if the eye's is too far from that of this one.
    pub(super) fn next_origin(&self, origin: PageId, eye: PageId) -> Option<PageId> {
        let pages = origin.to_array().into_iter().zip(eye.to_array());
        pages.into_iter().any(|(own, eye)| own.abs_diff(eye) > self.reach).then_some(eye)
    }

    /// The edge length of a page in world units, an exact number.
    pub(super) fn page_size(&self) -> f64 {
        f64::from(self.cell) * f64::from(PAGE_CELLS)
    }
}
