//! A layer of tiles, placed in a scene.

use glam::{DVec2, Vec2};

use crate::bits::BitGrid;
use crate::error::{Error, LEAST, finite2, within};
use crate::geometry::Rect;
use crate::tiles::opaque::OpaqueTiles;

/// Square tiles in a scene, some of which block sight.
///
/// Tile `(x, y)` covers the square from `origin + (x, y) * tile_size` to `origin + (x + 1, y + 1) *
/// tile_size`.
#[derive(Debug, Clone, PartialEq)]
pub struct TileLayer {
    origin: Vec2,
    tile_size: f32,
    opaque: OpaqueTiles,
}

impl TileLayer {
    /// A layer whose tile `(0, 0)` has its least corner at `origin`.
    ///
    /// # Errors
    /// An origin or a size that is not finite, a size that is not greater than zero, a layer that
    /// reaches beyond the numbers of single precision.
    pub fn new(origin: Vec2, tile_size: f32, opaque: BitGrid) -> Result<Self, Error> {
        finite2("the origin of a tile layer", origin)?;
        let most = f64::from(f32::MAX);
        within("the size of a tile", tile_size.into(), [LEAST, most])?;
        let layer = Self { origin, tile_size, opaque: OpaqueTiles::new(opaque) };
        for part in layer.corner(layer.opaque.width(), layer.opaque.height()).to_array() {
            within("the far corner of a tile layer", part, [-most, most])?;
        }
        Ok(layer)
    }

    /// The side of a tile.
    pub fn tile_size(&self) -> f32 {
        self.tile_size
    }

    /// The tiles that block sight.
    pub fn opaque(&self) -> &OpaqueTiles {
        &self.opaque
    }

    /// The least corner of a tile, in the scene.
    pub(crate) fn corner(&self, x: u32, y: u32) -> DVec2 {
        self.origin.as_dvec2() + DVec2::new(x.into(), y.into()) * f64::from(self.tile_size)
    }

    /// The rectangle of all tiles, in the scene, rounded to single precision: for
    /// [`GridSpec::covering`](crate::GridSpec::covering), for example.
    pub fn bounds(&self) -> Rect {
        let max = self.corner(self.opaque.width(), self.opaque.height());
        Rect::new(self.origin, max.as_vec2())
    }
}
