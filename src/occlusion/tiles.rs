//! Tiles: coverage bits of 8x8 pixels with far depths.
//!
//! After Greene 1996 (hierarchical coverage masks) and Hasselgren, Andersson & Akenine-Möller 2016
//! (masked occlusion culling), with four layers instead of two: layer i of a tile says that all its
//! pixels in `mask[i]` are hidden for targets not nearer than `near[i]`. Masks grow from layer to
//! layer as nearness falls; a fifth layer merges two.

/// Pixels along each side of a tile.
pub(crate) const TILE: i64 = 8;

const LAYERS: usize = 4;

/// The first column of a tile.
const COLUMN: u64 = 0x0101_0101_0101_0101;

/// No layer.
const NONE: f32 = f32::NEG_INFINITY;

/// Coverage of 8x8 pixels; bit `8 * row + column`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile {
    near: [f32; LAYERS],
    mask: [u64; LAYERS],
}

impl Tile {
    pub(crate) const EMPTY: Self = Self { near: [NONE; LAYERS], mask: [0; LAYERS] };

    /// Whether nothing was drawn in it: what lies outside of the frustum is covered as by something
    /// at the eye.
    pub(crate) fn is_untouched(&self) -> bool {
        self.near.iter().all(|&near| near == NONE || near == f32::INFINITY)
    }

    /// The pixels in which a target that is nowhere nearer than `near` is hidden.
    #[inline]
    pub(crate) fn hidden(&self, near: f32) -> u64 {
        let layers = self.near.iter().map(|&n| usize::from(n >= near)).sum::<usize>();
        if layers == 0 { 0 } else { self.mask[layers - 1] }
    }

    /// Nearness down to which all pixels are hidden.
    #[inline]
    pub(crate) fn closed(&self) -> f32 {
        // Nothing follows a layer that covers all.
        let full = self.mask.iter().zip(&self.near).find(|&(&m, &n)| m == u64::MAX && n > NONE);
        full.map_or(NONE, |(_, &n)| n)
    }

    /// Nearness down to which a pixel is hidden; negative infinity if it is open.
    pub(crate) fn nearness(&self, bit: u32) -> f32 {
        let layer = self.mask.iter().zip(&self.near).find(|&(m, &n)| n > NONE && m >> bit & 1 == 1);
        layer.map_or(NONE, |(_, &n)| n)
    }

    /// Hides pixels for targets not nearer than `near`. Returns whether that hides more than
    /// before.
    #[inline]
    pub(crate) fn cover(&mut self, mask: u64, near: f32) -> bool {
        if near.is_nan() {
            return false;
        }
        if self.near[0] == NONE && near > NONE && mask != 0 {
            (self.near[0], self.mask[0]) = (near, mask);
            return true;
        }
        let at = self.near.iter().map(|&n| usize::from(n >= near)).sum::<usize>();
        let before = if at == 0 { 0 } else { self.mask[at - 1] };
        let mask = before | mask;
        if mask == before {
            return false;
        }
        if mask == u64::MAX && at < LAYERS {
            // Nothing follows a layer that covers all.
            let at = if at > 0 && self.near[at - 1] == near { at - 1 } else { at };
            (self.near[at], self.mask[at]) = (near, mask);
            self.near[at + 1..].fill(NONE);
            self.mask[at + 1..].fill(0);
            return true;
        }
        // The layers behind gain the new pixels. Layers without pixels of their own are dropped.
        let mut layers = [(NONE, 0u64); LAYERS + 1];
        let mut count = 0;
        for i in 0..at {
            layers[count] = (self.near[i], self.mask[i]);
            count += 1;
        }
        if count > 0 && layers[count - 1].0 == near {
            count -= 1;
        }
        layers[count] = (near, mask);
        count += 1;
        for i in at..LAYERS {
            let wider = self.mask[i] | mask;
            if self.near[i] > NONE && wider != layers[count - 1].1 {
                layers[count] = (self.near[i], wider);
                count += 1;
            }
        }
        if count > LAYERS {
            // Drop the layer whose pixels lose least depth; the last one stays.
            let loss = |i: usize| {
                let own = layers[i].1 & !(if i == 0 { 0 } else { layers[i - 1].1 });
                own.count_ones() as f32 * (layers[i].0 - layers[i + 1].0).min(f32::MAX)
            };
            let dropped = (0..LAYERS).min_by(|&a, &b| loss(a).total_cmp(&loss(b))).unwrap_or(0);
            layers.copy_within(dropped + 1.., dropped);
            count -= 1;
        }
        layers[count..].fill((NONE, 0));
        for ((near, own), layer) in self.near.iter_mut().zip(&mut self.mask).zip(layers) {
            (*near, *own) = layer;
        }
        true
    }
}

/// The pixels of a tile's rows from `lo` up to before `hi`, counted from the tile's left.
#[inline]
pub(crate) fn span(lo: i64, hi: i64) -> u64 {
    let (lo, hi) = (lo.clamp(0, TILE), hi.clamp(0, TILE));
    if lo >= hi { 0 } else { ((1u64 << hi) - 1) & !((1u64 << lo) - 1) }
}

/// The pixels of a rectangle, counted from the tile's corner, upper ends excluded.
#[inline]
pub(crate) fn block(x0: i64, x1: i64, y0: i64, y1: i64) -> u64 {
    let (y0, y1) = (y0.clamp(0, TILE), y1.clamp(0, TILE));
    if y0 >= y1 {
        return 0;
    }
    let rows = (u64::MAX >> (64 - 8 * (y1 - y0))) << (8 * y0);
    span(x0, x1).wrapping_mul(COLUMN) & rows
}

/// The pixels from column `x` of a window on, in the tile that contains it.
#[inline]
pub(crate) fn columns_from(x: i64) -> u64 {
    (0xff << (x & 7) & 0xff) * COLUMN
}

/// The pixels up to before column `x` of a window, in the tile that contains the column before it.
#[inline]
pub(crate) fn columns_up_to(x: i64) -> u64 {
    (0xff >> (7 - ((x - 1) & 7))) * COLUMN
}

/// The pixels from row `y` of a window on, in the tile that contains it.
#[inline]
pub(crate) fn rows_from(y: i64) -> u64 {
    u64::MAX << (8 * (y & 7))
}

/// The pixels up to before row `y` of a window, in the tile that contains the row before it.
#[inline]
pub(crate) fn rows_up_to(y: i64) -> u64 {
    u64::MAX >> (8 * (7 - ((y - 1) & 7)))
}

/// The set bits of a word.
#[inline]
pub(crate) fn bits(mut word: u64) -> impl Iterator<Item = i64> {
    std::iter::from_fn(move || {
        let bit = i64::from(word.trailing_zeros());
        (word != 0).then(|| {
            word &= word - 1;
            bit
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn layers_never_say_more_than_was_drawn() {
        let mut random = Random::new(7);
        let mut next = || random.bits();
        for round in 0..300 {
            let mut tile = Tile::EMPTY;
            let mut pixels = [f32::NEG_INFINITY; 64];
            for _ in 0..40 {
                let mask = next() & next() & (next() | next()) | (1 << (next() % 64));
                let near = (next() % 100) as f32 / 10.0;
                let before = tile.hidden(f32::MIN);
                let changed = tile.cover(mask, near);
                for (i, p) in pixels.iter_mut().enumerate() {
                    if mask >> i & 1 == 1 {
                        *p = p.max(near);
                    }
                }
                let covered = tile.hidden(f32::MIN);
                assert!(changed || covered == before);
                let all = pixels.iter().enumerate().filter(|(_, p)| **p > f32::NEG_INFINITY);
                assert_eq!(covered, all.map(|(i, _)| 1 << i).sum::<u64>(), "{round}");
                for step in 0..110 {
                    let near = step as f32 / 10.0;
                    let hidden = tile.hidden(near);
                    for (i, p) in pixels.iter().enumerate() {
                        assert!(hidden >> i & 1 == 0 || *p >= near, "{round}: {tile:?} {i} {near}");
                    }
                }
                if covered == u64::MAX {
                    assert!((0..64).all(|bit| tile.nearness(bit) >= tile.closed()));
                    assert_eq!(tile.hidden(tile.closed()), u64::MAX);
                    assert!(tile.hidden(tile.closed() + 0.05) != u64::MAX);
                } else {
                    assert_eq!(tile.closed(), f32::NEG_INFINITY);
                }
            }
        }
    }

    #[test]
    fn blocks_of_pixels() {
        assert_eq!(block(-5, 20, -1, 9), u64::MAX);
        assert_eq!(block(3, 3, 0, 8), 0);
        assert_eq!(block(0, 8, 8, 9), 0);
        let mut expected = 0;
        for y in 2..5 {
            for x in 1..7 {
                expected |= 1u64 << (8 * y + x);
            }
        }
        assert_eq!(block(1, 7, 2, 5), expected);
        for at in 0..8 {
            assert_eq!(columns_from(16 + at), block(at, 8, 0, 8));
            assert_eq!(columns_up_to(17 + at), block(0, at + 1, 0, 8));
            assert_eq!(rows_from(16 + at), block(0, 8, at, 8));
            assert_eq!(rows_up_to(17 + at), block(0, 8, 0, at + 1));
        }
    }
}
