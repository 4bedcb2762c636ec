//! The pages around the eye that the grid covers.

use glam::DVec3;

use crate::grid::GridSpec;
use crate::numeric::world::FARTHEST_PAGE;
use crate::world::options::WorldOptions;
use crate::world::page::{PAGE_CELLS, PageId};

/// Except during a shift, the eye is at least this share of the window from its border. It can then
/// go half of the rest before the next shift, and there is room for what is loaded around the eye
/// until a shift is done.
const BORDER: (i32, i32) = (5, 16);

/// Where the grid lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct GridWindow {
    /// The page whose least corner is the origin of the scene. Half of the window's pages, rounded
    /// down, lie below it along each axis.
    page: PageId,
}

impl GridWindow {
    /// The window with a page in its middle; around page 0 along axes on which it stays.
    pub(super) fn around(options: &WorldOptions, page: PageId) -> Self {
        let still = <[bool; 3]>::from(options.still);
        let page = page.to_array().map(|p| p.clamp(-FARTHEST_PAGE, FARTHEST_PAGE));
        let along = |axis: usize| if still[axis] { 0 } else { page[axis] };
        Self { page: PageId::from_array([0, 1, 2].map(along)) }
    }

    /// The origin of the scene.
    pub(super) fn corner(self, options: &WorldOptions) -> DVec3 {
        self.page.corner(options.page_size())
    }

    /// The grid in the scene's coordinates.
    pub(super) fn spec(self, options: &WorldOptions) -> GridSpec {
        let below = (options.window / 2 * PAGE_CELLS).as_vec3();
        GridSpec { min: -below * options.cell, cell: options.cell, dims: options.window * PAGE_CELLS }
    }

    /// The window that the eye in some page needs, if it comes too near to the border of this one:
    /// to five sixteenths of the pages along an axis, rounded down.
    pub(super) fn moved(self, options: &WorldOptions, eye: PageId) -> Option<Self> {
        let (page, eye_page) = (self.page.to_array(), eye.to_array());
        let (pages, still) = (options.window.to_array(), <[bool; 3]>::from(options.still));
        let leaves = |axis: usize| {
            let pages = pages[axis] as i32;
            // The number of the eye's page in the window.
            let own = eye_page[axis] - page[axis] + pages / 2;
            let border = pages * BORDER.0 / BORDER.1;
            !still[axis] && !(border..pages - border).contains(&own)
        };
        let next = Self::around(options, eye);
        ((0..3).any(leaves) && next != self).then_some(next)
    }
}

#[cfg(test)]
mod tests {
    use glam::{BVec3, UVec3};

    use super::*;

    #[test]
    fn the_eye_stays_away_from_the_border_of_the_window() {
        for pages in 1..=16 {
            let options =
                WorldOptions::new(1.0).window(UVec3::splat(pages)).still(BVec3::new(false, true, false));
            let mut window = GridWindow::around(&options, PageId::default());
            let (mut eye, mut moves) = (0, 0);
            for _ in 0..100 {
                eye += 1;
                if let Some(next) = window.moved(&options, PageId::new(eye, eye, 0)) {
                    (window, moves) = (next, moves + 1);
                }
                let own = eye - window.page.x + pages as i32 / 2;
                let (border, pages) = (pages as i32 * 5 / 16, pages as i32);
                assert!((border..pages - border).contains(&own), "{pages}: {own}");
                assert_eq!((window.page.y, window.page.z), (0, 0));
            }
            let spec = window.spec(&options);
            assert_eq!(f64::from(spec.min.x), -f64::from(pages / 2) * options.page_size());
            assert!(moves <= 100 / (pages / 6).max(1), "{pages} pages: {moves} moves");
        }
    }
}
