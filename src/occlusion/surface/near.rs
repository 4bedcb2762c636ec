//! The edges of kept patches that come near a group of pixels.

use fearless_simd::prelude::*;

use crate::occlusion::surface::raster::{COLUMNS, EdgeVectors, Edges, LANES, Raster};
use crate::occlusion::surface::sides::Sides;
use crate::occlusion::tiles::TILE;

/// How many times finer.
pub(crate) const FINER: i64 = TILE;

/// Pixels along each side of a group. Larger groups need fewer drawings, and fill more pixels that
/// no target asks for.
pub(crate) const GROUP: i64 = 4;

/// Tiles of finer pixels in a group.
pub(crate) const GROUP_TILES: usize = (GROUP * GROUP) as usize;

/// Finer pixels along each side of a group.
pub(super) const GROUP_PIXELS: i32 = (GROUP * FINER) as i32;

const _: () = assert!(GROUP_PIXELS as i64 == COLUMNS, "a group is one column of blocks");

/// Those of eight sides that come near the group, and the seams among them, one bit each.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Choice {
    pub(super) near: u8,
    pub(super) seams: u8,
}

/// Draws the edges of a patch that were chosen.
#[inline(always)]
pub(super) fn draw_edges<S: Simd>(
    simd: S,
    raster: &mut Raster,
    groups: &[Sides],
    choices: &[Choice],
    turned: bool,
) {
    let (mut few, mut count) = (Edges::default(), 0);
    for (sides, choice) in groups.iter().zip(choices) {
        let mut lanes = choice.near;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            sides.put(lane, &mut few, count, choice.seams >> lane & 1 == 1);
            count += 1;
            if count == LANES {
                raster.edges(simd, &few.vectors(simd, FINER as f32), turned);
                (few, count) = (Edges::default(), 0);
            }
        }
    }
    if count > 0 {
        raster.edges(simd, &few.vectors(simd, FINER as f32), turned);
    }
}

/// The borders of a group, counted in pixels as edges are.
pub(super) struct GroupBorders {
    pub(super) left: f32,
    pub(super) right: f32,
    pub(super) low: f32,
    pub(super) high: f32,
}

impl GroupBorders {
    /// Those of some edges that come near the group, and those that pass it on the left, one bit
    /// each.
    ///
    /// An edge stays within its width of the rectangle around its ends; one that stays outside of
    /// the group's rows passes the middles of none of them.
    #[inline(always)]
    pub(super) fn near_and_left<S: Simd>(&self, e: &EdgeVectors<S>) -> (u8, u8) {
        let &EdgeVectors { x0, y0, x1, y1, wide, .. } = e;
        let beside = (y0.min(y1) - wide).simd_le(self.high)
            & (y0.max(y1) + wide).simd_ge(self.low)
            & (x0.min(x1) - wide).simd_le(self.right);
        let left = (x0.max(x1) + wide).simd_lt(self.left);
        let (beside, left) = (beside.to_bitmask() as u8 & e.plain, left.to_bitmask() as u8);
        (beside & !left, beside & left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::surface::PatchNumber;
    use crate::occlusion::surface::raster::{Area, Windings, rows_passed};
    use crate::random::Random;
    use crate::simd::vectorized;

    /// A path of edges with ends in a wide rectangle around a group, some of them flat, steep or
    /// short.
    fn random_sides(random: &mut Random, bounds: &GroupBorders) -> Sides {
        let mut byte = || (random.next() * 256.0) as u8;
        let plain = byte();
        let seams = plain & byte();
        let mut end = |i: usize, middle: f32| {
            let spread = [1.0, 6.0, 40.0][i % 3];
            middle + random.within(-spread, spread) as f32
        };
        let mut x = std::array::from_fn(|i| end(i, bounds.left + 2.0));
        let mut y = std::array::from_fn(|i| end(i, bounds.low + 2.0));
        (y[6], y[7], x[LANES]) = (y[5], y[5] + 1e-4, x[7]);
        let wide = std::array::from_fn(|i| if i % 2 == 0 { 2e-5 } else { random.within(0.01, 0.6) as f32 });
        let (unsure, twins) = ([1e-5; LANES], [PatchNumber::NONE; LANES]);
        Sides { x, y, wide, unsure, plain, seams, begins: 0xff, shared: 0, opposite: 0, twins }
    }

    #[test]
    fn chosen_edges_leave_the_marks_of_all() {
        let mut random = Random::new(17);
        let first = (40 * FINER, 12 * FINER);
        let bounds = GroupBorders { left: 40.0, low: 12.0, right: 44.0, high: 16.0 };
        let area = Area { x: first.0, y: first.1, nx: 1, ny: GROUP };
        let (mut raster, mut chosen_only) = (Raster::default(), Raster::default());
        let (mut covered, mut chosen, mut left_of_it) = (0, 0, 0);
        for round in 0..2000 {
            let turned = round % 2 == 0;
            let sides: Vec<Sides> = (0..3).map(|_| random_sides(&mut random, &bounds)).collect();
            raster.begin(area, (0, 0));
            chosen_only.begin(area, (0, 0));
            let (mut passed, mut choices) = (Windings::default(), Vec::new());
            for own in &sides {
                let (near, left, rows) = vectorized!(simd => {
                    let finer = own.edges(simd, FINER as f32);
                    raster.edges(simd, &finer, turned);
                    let (near, left) = bounds.near_and_left(&own.edges(simd, 1.0));
                    (near, left, rows_passed(&finer, left, (first.1 as i32, GROUP_PIXELS), turned))
                });
                chosen += near.count_ones();
                left_of_it += left.count_ones();
                passed.add(rows);
                choices.push(Choice { near, seams: own.seams });
            }
            vectorized!(simd => draw_edges(simd, &mut chosen_only, &sides, &choices, turned));
            chosen_only.pass_left(&passed);
            for block in 0..GROUP as usize {
                assert_eq!(chosen_only.whole(block), raster.whole(block), "{round}");
                covered += raster.whole(block).covered().iter().map(|row| row.count_ones()).sum::<u32>();
            }
        }
        assert!(covered > 100_000 && chosen > 10_000 && left_of_it > 1000, "{covered} {chosen} {left_of_it}");
    }
}
