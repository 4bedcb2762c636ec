//! Blocks around many pieces of the visible region, so that a target behind all of them is found
//! hidden in one comparison.

use crate::geometry::{Block, orient};
use crate::point::envelope::{BLOCKED, OPEN, Piece};
use crate::point::wall::{Around, Wall};

/// A block of the next level for so many of one level.
const FAN: usize = 8;

/// Blocks around 8, 64, 512 ... pieces that follow each other. Those with an open piece are not
/// finite.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bounds {
    levels: Vec<Vec<Block>>,
}

impl Bounds {
    /// Forgets all blocks: then nothing is skipped.
    pub(crate) fn clear(&mut self) {
        self.levels.clear();
    }

    /// Finds the blocks of some pieces.
    pub(crate) fn build(&mut self, around: &Around, pieces: impl Iterator<Item = Piece>) {
        self.levels.clear();
        let mut level: Vec<Block> = pieces.map(|piece| around_piece(around, &piece)).collect();
        while level.len() >= FAN {
            let join = |blocks: &[Block]| {
                blocks.iter().fold(Block::EMPTY, |all, block| all.with(block.min).with(block.max))
            };
            level = level.chunks(FAN).map(join).collect();
            self.levels.push(level.clone());
        }
    }

    /// The number of a piece from `i` on such that a target meets none of the pieces between.
    pub(crate) fn skip(&self, target: &Wall, mut i: usize) -> usize {
        let (mut level, mut size) = (0, FAN);
        while let Some(block) = self.levels.get(level).and_then(|blocks| blocks.get(i / size)) {
            if i.is_multiple_of(size) && hides(block, target) {
                i += size;
                // Upwards as long as blocks are passed as a whole.
                if i.is_multiple_of(size * FAN) && level + 1 < self.levels.len() {
                    (level, size) = (level + 1, size * FAN);
                }
            } else if level > 0 {
                (level, size) = (level - 1, size / FAN);
            } else {
                break;
            }
        }
        i
    }
}

/// A block around the part of a wall in a piece: nothing if the piece is blocked, and all of the
/// plane if it is open.
fn around_piece(around: &Around, piece: &Piece) -> Block {
    match piece.wall {
        BLOCKED => Block::EMPTY,
        OPEN => Block { min: Block::EMPTY.max, max: Block::EMPTY.min },
        wall => {
            let wall = around.wall(wall);
            let hits = [&piece.from, &piece.to].map(|along| around.hit(wall, along));
            hits.iter().fold(Block::EMPTY, |block, &(p, doubt)| block.with(p - doubt).with(p + doubt))
        }
    }
}

/// Whether all of a block lies on the eye's side of the line through a target.
fn hides(block: &Block, target: &Wall) -> bool {
    let (a, b) = (target.a, target.b);
    let mut farthest = block.max;
    if b.x > a.x {
        farthest.y = block.min.y;
    }
    if b.y < a.y {
        farthest.x = block.min.x;
    }
    farthest.is_finite() && orient(a, b, farthest) > 0.0
}
