//! Fog of war: the tiles that a group of viewers has seen.

use glam::UVec2;

use crate::bits::BitGrid;
use crate::error::Error;
use crate::tiles::fov::{FieldOfView, Marks};

/// What a group of viewers knows of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TileState {
    /// No viewer has seen it yet.
    Unseen,
    /// It was seen before, but not in this frame.
    Remembered,
    /// A viewer sees it in this frame.
    Seen,
}

/// Which tiles a group of viewers sees in a frame, and which it has ever seen.
///
/// ```
/// use casca_plane::{FieldOfView, Fog, FovOptions, OpaqueTiles, BitGrid, TilePoint, TileState};
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let map = OpaqueTiles::new(BitGrid::new(30, 20));
/// let (mut fog, mut fov) = (Fog::new(30, 20), FieldOfView::new());
/// for step in 0..5 {
///     fog.begin_frame();
///     for y in [3, 15] {
///         fov.run(&map, TilePoint::center_of(2 + step, y), &FovOptions::default().in_circle(4.0)?);
///         fog.add(&fov)?;
///     }
/// }
/// assert_eq!(fog.state(1, 3), TileState::Remembered);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fog {
    seen: Marks,
    ever: BitGrid,
}

impl Fog {
    /// A map of which nothing was seen. Takes two bits a tile.
    pub fn new(width: u32, height: u32) -> Self {
        Self::with_memory(BitGrid::new(width, height))
    }

    /// A map of which some tiles were seen before, as from a saved game.
    pub fn with_memory(ever: BitGrid) -> Self {
        let mut seen = Marks::default();
        seen.clear(&ever);
        Self { seen, ever }
    }

    /// Ends the sight of the last frame: the tiles that were seen are remembered. Costs the tiles
    /// that were seen, by words.
    pub fn begin_frame(&mut self) {
        self.seen.clear(&self.ever);
    }

    /// Adds the tiles that the last run of a field of view found; call it once after each run.
    /// Costs its bounds, by words.
    ///
    /// # Errors
    /// A field of view on a map of other dimensions, or one that has not run yet.
    pub fn add(&mut self, fov: &FieldOfView) -> Result<(), Error> {
        let (tiles, (columns, rows)) = (fov.seen(), fov.bounds());
        let [found, map] = [tiles, &self.ever].map(|bits| UVec2::new(bits.width(), bits.height()));
        if found != map {
            return Err(Error::Dimensions { found, map });
        }
        let words = columns.start as usize / 64..(columns.end as usize).div_ceil(64);
        for y in rows.clone() {
            let added = &tiles.row(y)[words.clone()];
            let seen = &mut self.seen.bits.row_mut(y)[words.clone()];
            let ever = &mut self.ever.row_mut(y)[words.clone()];
            for ((added, seen), ever) in added.iter().zip(seen).zip(ever) {
                *seen |= added;
                *ever |= added;
            }
        }
        self.seen.widen(columns, rows);
        Ok(())
    }

    /// What is known of a tile. Tiles outside of the map are unseen.
    pub fn state(&self, x: u32, y: u32) -> TileState {
        match (self.seen.bits.get(x, y), self.ever.get(x, y)) {
            (true, _) => TileState::Seen,
            (false, true) => TileState::Remembered,
            (false, false) => TileState::Unseen,
        }
    }

    /// The tiles that are seen in this frame.
    pub fn seen(&self) -> &BitGrid {
        &self.seen.bits
    }

    /// The tiles that were ever seen, also in this frame: the memory to be saved.
    pub fn ever_seen(&self) -> &BitGrid {
        &self.ever
    }
}
