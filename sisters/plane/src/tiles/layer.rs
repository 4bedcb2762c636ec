//! A layer of tiles, placed in a scene.

use glam::{DVec2, Vec2};

use crate::bits::BitGrid;
use crate::geometry::Rect;
use crate::error::{Error, LEAST, finite2, within};
use crate::tiles::opaque::OpaqueTiles;
use crate::tiles::point::TilePoint;

/// Square tiles in a scene, some of which block sight.
///
/// Tile `(x, y)` covers the square from `origin + (x, y) * tile_size` to `origin + (x + 1, y + 1) *
/// tile_size`.
///
/// ```
/// use casca_plane::{BitGrid, TileLayer};
/// use glam::Vec2;
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let mut layer = TileLayer::new(Vec2::new(-8.0, -8.0), 0.5, BitGrid::new(32, 32))?;
/// layer.set_tile(16, 17, true)?;
/// assert_eq!(layer.point(Vec2::new(0.25, 0.25))?.tile(), (16, 16));
/// # Ok(())
/// # }
/// ```
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

    /// The least corner of tile `(0, 0)`.
    pub fn origin(&self) -> Vec2 {
        self.origin
    }

    /// The side of a tile.
    pub fn tile_size(&self) -> f32 {
        self.tile_size
    }

    /// The tiles that block sight.
    pub fn opaque(&self) -> &OpaqueTiles {
        &self.opaque
    }

    /// Lets a tile block sight, or not: a door that closes or opens.
    ///
    /// # Errors
    /// A tile that the layer does not have.
    pub fn set_tile(&mut self, x: u32, y: u32, opaque: bool) -> Result<(), Error> {
        let (width, height) = (self.opaque.width(), self.opaque.height());
        if x >= width || y >= height {
            return Err(Error::Outside { x, y, width, height });
        }
        self.opaque.set(x, y, opaque);
        Ok(())
    }

    /// A position of the scene, in tiles of the layer.
    ///
    /// Exact up to 2^-28 of a tile where origin and position have few digits and the size is a
    /// power of two; else rounded to about the 16th digit.
    ///
    /// # Errors
    /// A position that is not finite, or farther than 2^32 tiles away.
    pub fn point(&self, position: Vec2) -> Result<TilePoint, Error> {
        let tiles = (position.as_dvec2() - self.origin.as_dvec2()) / f64::from(self.tile_size);
        TilePoint::new(tiles.x, tiles.y)
    }

    /// The least corner of a tile, in the scene.
    pub fn corner(&self, x: u32, y: u32) -> DVec2 {
        self.origin.as_dvec2() + DVec2::new(x.into(), y.into()) * f64::from(self.tile_size)
    }

    /// The rectangle of all tiles, in the scene, rounded to single precision: for
    /// [`GridSpec::covering`](crate::GridSpec::covering), for example.
    pub fn bounds(&self) -> Rect {
        let max = self.corner(self.opaque.width(), self.opaque.height());
        Rect::new(self.origin, max.as_vec2())
    }
}
