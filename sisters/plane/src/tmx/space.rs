//! Where pixels lie among tiles.

use glam::{DMat2, DVec2};

/// How a map shows its tiles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Space {
    pub isometric: bool,
    /// The width and the height of a tile in pixels.
    pub tile: [f64; 2],
}

impl Space {
    /// A place on the screen in pixels as one in tiles, column and row.
    pub fn tiles(&self, shift: [f64; 2]) -> [f64; 2] {
        let [x, y] = [shift[0] / self.tile[0], shift[1] / self.tile[1]];
        // Rows of isometric maps go down to the left, columns down to the right.
        if self.isometric { [y + x, y - x] } else { [x, y] }
    }

    /// From coordinates of objects to the screen. Those of isometric maps count along columns and
    /// rows, with the height of a tile for each.
    pub fn screen(&self) -> DMat2 {
        let [width, height] = self.tile;
        if self.isometric {
            let right = width / height / 2.0;
            DMat2::from_cols(DVec2::new(right, 0.5), DVec2::new(-right, 0.5))
        } else {
            DMat2::IDENTITY
        }
    }
}
