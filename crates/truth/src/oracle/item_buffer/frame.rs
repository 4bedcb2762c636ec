//! What one frame draws, by tile.

use casca_scenes::world::Object;
use glam::DVec3;

use super::pixel_rays::PixelRays;

/// No object.
pub const NONE: u32 = u32::MAX;

/// Edge of a tile in pixels.
pub(super) const TILE: usize = 16;
/// Pixels of a tile.
pub(super) const AREA: usize = TILE * TILE;

/// Something to draw: a solid, or a triangle of a mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    /// At most its least depth behind the near plane.
    pub(super) near: f32,
    pub(super) object: u32,
    /// Triangle of the mesh.
    pub(super) triangle: u32,
    /// Which of the meshes in view.
    pub(super) slot: u32,
    /// Whether it hides what is behind it from the eye.
    pub(super) hides: bool,
    /// First and last pixel: x, y, x, y.
    pub(super) rect: [u16; 4],
}

/// Entries by tile.
#[derive(Debug, Default)]
pub(super) struct Bins {
    pub(super) starts: Vec<u32>,
    pub(super) entries: Vec<u32>,
}

impl Bins {
    pub(super) fn new(entries: &[Entry], columns: usize, rows: usize) -> Self {
        let mut starts = vec![0_u32; columns * rows + 1];
        let tiles = |entry: &Entry| {
            let [x0, y0, x1, y1] = entry.rect.map(|v| usize::from(v) / TILE);
            (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * columns + x))
        };
        for entry in entries {
            tiles(entry).for_each(|tile| starts[tile + 1] += 1);
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut list = vec![0_u32; starts[columns * rows] as usize];
        let mut next = starts.clone();
        for (i, entry) in entries.iter().enumerate() {
            tiles(entry).for_each(|tile| {
                list[next[tile] as usize] = i as u32;
                next[tile] += 1;
            });
        }
        Self { starts, entries: list }
    }

    pub(super) fn of(&self, tile: usize) -> &[u32] {
        &self.entries[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

/// Everything to draw in one frame.
pub(super) struct Frame<'a> {
    pub(super) objects: &'a [Object],
    pub(super) rays: PixelRays,
    /// Vertices relative to the eye, for each mesh in view.
    pub(super) meshes: Vec<Vec<DVec3>>,
    pub(super) eye: DVec3,
}
