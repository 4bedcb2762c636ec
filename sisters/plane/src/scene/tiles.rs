//! Layers of tiles in a scene.

use crate::bits::BitGrid;
use crate::error::Error;
use crate::geometry::Rect;
use crate::id::ObjectId;
use crate::scene::{ObjectDesc, Scene};
use crate::tiles::TileLayer;

/// Tiles from `x` to before `end`, in rows from `y` to before `top`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Block {
    x: u32,
    end: u32,
    y: u32,
    top: u32,
}

impl Scene {
    /// Adds the tiles of a layer that block sight, as fixed objects with occluders: one for each
    /// rectangle of such tiles. Gives their ids. Corners of tiles are rounded to single precision,
    /// all tiles at a corner alike, so that no gaps open.
    ///
    /// Tiles that open and close are left free in the layer, and added as objects of their own,
    /// which get and lose their occluder ([`Scene::set_occluder`]). Costs the cells that the tiles
    /// touch.
    ///
    /// # Errors
    /// As [`Scene::insert`]; then none is added.
    pub fn insert_tiles(&mut self, layer: &TileLayer) -> Result<Vec<ObjectId>, Error> {
        let corner = |x: u32, y: u32| layer.corner(x, y).as_vec2();
        let blocks = blocks(layer.opaque().bits());
        let rects =
            blocks.iter().map(|block| Rect::new(corner(block.x, block.y), corner(block.end, block.top)));
        let mut ids = Vec::with_capacity(blocks.len());
        for rect in rects {
            match self.insert(ObjectDesc::new(rect).occluder(rect)) {
                Ok(id) => ids.push(id),
                Err(error) => {
                    ids.into_iter().try_for_each(|id| self.remove(id))?;
                    return Err(error);
                }
            }
        }
        Ok(ids)
    }
}

/// Rectangles that contain the set bits, each once: runs of a row, with those of the next rows that
/// begin and end alike.
fn blocks(bits: &BitGrid) -> Vec<Block> {
    let (mut done, mut open): (Vec<Block>, Vec<Block>) = (Vec::new(), Vec::new());
    if bits.width() == 0 {
        // There may be 2^32 rows of no tiles.
        return done;
    }
    for y in 0..bits.height() {
        let (mut x, mut last) = (0, std::mem::take(&mut open).into_iter().peekable());
        while x < bits.width() {
            let first = bits.next_set(x, y);
            x = bits.next_clear(first, y);
            if first >= x {
                break;
            }
            while let Some(block) = last.next_if(|block| block.x < first) {
                done.push(block);
            }
            let above = last.next_if(|block| block.x == first && block.end == x);
            open.push(Block { x: first, end: x, y: above.map_or(y, |block| block.y), top: y + 1 });
        }
        done.extend(last);
    }
    done.extend(open);
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(rows: &[&str]) -> BitGrid {
        let mut bits = BitGrid::new(rows[0].len() as u32, rows.len() as u32);
        for (y, row) in (0..).zip(rows) {
            (0..).zip(row.bytes()).for_each(|(x, tile)| bits.set(x, y, tile == b'#'));
        }
        bits
    }

    #[test]
    fn blocks_hold_each_tile_once() {
        for rows in [
            &["##.##", "##.##", ".####", "....."][..],
            &["#####", "#...#", "#.#.#", "#####"],
            &[".....", ".....", ".....", "....."],
            &["#.#.#", ".#.#.", "#.#.#", ".###."],
        ] {
            let (bits, mut seen) = (bits(rows), BitGrid::new(5, 4));
            for block in blocks(&bits) {
                for (x, y) in (block.x..block.end).flat_map(|x| (block.y..block.top).map(move |y| (x, y))) {
                    assert!(!seen.get(x, y));
                    seen.set(x, y, true);
                }
            }
            assert_eq!(seen, bits);
        }
        assert_eq!(blocks(&bits(&["##", "##", "##"])), [Block { x: 0, end: 2, y: 0, top: 3 }]);
        for empty in [BitGrid::default(), BitGrid::new(0, u32::MAX), BitGrid::new(u32::MAX, 0)] {
            assert!(blocks(&empty).is_empty());
        }
    }
}
