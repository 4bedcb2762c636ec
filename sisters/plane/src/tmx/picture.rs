//! Where layers show the pictures of tiles.

use glam::{DAffine2, DMat2, DVec2};

use super::TmxError;
use super::space::Space;
use super::xml::{Element, Xml};

/// How a tileset shows its tiles on layers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Style {
    /// By how many pixels of the picture they are shifted.
    offset: DVec2,
    /// Whether pictures are made as large as the tiles of the map.
    to_grid: bool,
    /// Whether they keep their ratio of width to height then.
    keeps_ratio: bool,
    /// The size of the tile on which shapes are drawn in isometric coordinates, if they are.
    isometric: Option<[f64; 2]>,
}

impl Style {
    pub fn new(xml: &Xml<'_>, tileset: &Element<'_>) -> Result<Self, TmxError> {
        let is = |name, value| Ok(xml.attribute(tileset, name)?.is_some_and(|found| found == value));
        let (to_grid, keeps_ratio) = (is("tilerendersize", "grid")?, is("fillmode", "preserve-aspect-fit")?);
        Ok(Self { to_grid, keeps_ratio, ..Self::default() })
    }

    /// Takes over an element `tileoffset` or `grid`, at its start.
    pub fn add(&mut self, xml: &Xml<'_>, element: &Element<'_>) -> Result<(), TmxError> {
        if element.local_name().as_ref() == b"tileoffset" {
            self.offset = DVec2::new(xml.decimal(element, "x")?, xml.decimal(element, "y")?);
        } else {
            let size = [xml.decimal(element, "width")?, xml.decimal(element, "height")?];
            let isometric = xml.attribute(element, "orientation")?.is_some_and(|o| o == "isometric");
            self.isometric = (isometric && size.iter().all(|&length| length > 0.0)).then_some(size);
        }
        Ok(())
    }
}

/// The picture of a tile on layers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Picture {
    /// In pixels.
    pub size: [f64; 2],
    pub style: Style,
}

impl Picture {
    /// From coordinates of shapes on the picture to pixels of the picture.
    pub fn drawing(&self) -> DAffine2 {
        let Some(tile) = self.style.isometric else { return DAffine2::IDENTITY };
        // The diamond stands on the foot of the picture.
        let top = DVec2::new(tile[0] / 2.0, self.size[1] - tile[1]);
        DAffine2::from_mat2_translation(Space { isometric: true, tile }.screen(), top)
    }

    /// From pixels of the picture to the screen, with the upper bits of an id that turn the tile.
    /// The cell is the tile `(0, 0)` of the map.
    pub fn on_screen(&self, space: &Space, id: u32) -> DAffine2 {
        let (own, cell) = (DVec2::from(self.size), DVec2::from(space.tile));
        let Style { offset, to_grid, keeps_ratio, .. } = self.style;
        let shown = if to_grid { cell } else { own };
        // A picture of no size is shown nowhere; its shapes are as drawn.
        let ratio = |shown: f64, own: f64| if own > 0.0 { shown / own } else { 1.0 };
        let scale = DVec2::new(ratio(shown.x, own.x), ratio(shown.y, own.y));
        let scale = if keeps_ratio { DVec2::splat(scale.min_element()) } else { scale };
        let [sideways, upside_down, swapped] =
            [0x8000_0000, 0x4000_0000, 0x2000_0000].map(|bit| id & bit != 0);
        let mut turn = DMat2::from_diagonal(scale);
        if swapped {
            turn = DMat2::from_cols(DVec2::new(0.0, scale.x), DVec2::new(scale.y, 0.0));
        }
        let sign = DVec2::new(if sideways { -1.0 } else { 1.0 }, if upside_down { -1.0 } else { 1.0 });
        // Pictures stand on the lower left corner of the box around the cell, turned ones, too.
        let foot = DVec2::new(if space.isometric { -cell.x / 2.0 } else { 0.0 }, cell.y);
        let room = if swapped { DVec2::new(shown.y, shown.x) } else { shown };
        let middle = foot + DVec2::new(room.x, -room.y) / 2.0 + offset * scale;
        let turn = DMat2::from_diagonal(sign) * turn;
        DAffine2::from_mat2_translation(turn, middle - turn * (own / 2.0))
    }
}
