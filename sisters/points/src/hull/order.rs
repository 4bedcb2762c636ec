//! Points in an order in which neighbours in space are neighbours in memory.
//!
//! The growing hull looks at the points above a face, which lie near each other. In the order of a
//! scan, or in none, each of them is a line of the cache of its own.

use crate::morton::morton;
use bitvec::vec::BitVec;
use glam::DVec3;

/// Cells along each axis: codes of three coordinates have 30 bits, which leave 32 for an index.
const CELLS: f64 = (1 << 10) as f64;

/// The indices of points along a curve through cells (Morton 1966), for points within ±2 when
/// multiplied by `scale`. Points of a cell keep their order.
pub(super) fn by_place(points: &[DVec3], scale: f64) -> Vec<u32> {
    let code = |p: DVec3| {
        let cell = (p * scale + 2.0) * (CELLS / 4.0);
        morton(cell.to_array().map(|x| x as u32))
    };
    let mut codes: Vec<u64> = points.iter().zip(0_u64..).map(|(&p, i)| code(p) << 32 | i).collect();
    codes.sort_unstable();
    codes.into_iter().map(|code| code as u32).collect()
}

/// The bits of points in their own order.
pub(super) fn undone(bits: &BitVec, order: &[u32]) -> BitVec {
    let mut own = BitVec::repeat(false, bits.len());
    for at in bits.iter_ones() {
        own.set(order[at] as usize, true);
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::extreme_points;
    use crate::hull::tests::circle;

    /// The corners of a cube of 16 x 16 x 16 cells, in an order that jumps.
    fn scattered() -> Vec<DVec3> {
        let cube = |i: u64| DVec3::new((i % 16) as f64, (i / 16 % 16) as f64, (i / 256) as f64) / 8.0 - 1.0;
        // 1021 and 4096 have no common divisor, so that each number comes once.
        (0..4096).map(|i| cube(i * 1021 % 4096)).collect()
    }

    #[test]
    fn points_next_to_each_other_lie_near_each_other() {
        let points = scattered();
        let way = |order: &mut dyn Iterator<Item = DVec3>| {
            let order: Vec<DVec3> = order.collect();
            order.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>() / 4095.0
        };
        let sorted = way(&mut by_place(&points, 1.0).into_iter().map(|i| points[i as usize]));
        // A curve that leaves no step out would have steps of 1/8.
        assert!(sorted < 0.3 && way(&mut points.iter().copied()) > 0.7, "{sorted}");
        // The scale belongs to the points.
        let large: Vec<DVec3> = points.iter().map(|p| p * 1024.0).collect();
        assert_eq!(by_place(&large, 1.0 / 1024.0), by_place(&points, 1.0));
    }

    #[test]
    fn each_point_keeps_its_bit() {
        let ring = circle().into_iter().map(|[x, y]| DVec3::new(x as f64, y as f64, 0.0));
        let tips = [DVec3::Z * 1e5, DVec3::Z * -1e5];
        let on: Vec<DVec3> = ring.chain(tips).collect();
        let within: Vec<DVec3> = on.iter().map(|p| p * 0.5).collect();
        let mixed: Vec<DVec3> = on.iter().zip(&within).flat_map(|(&p, &q)| [q, p]).collect();
        let bits = extreme_points(&mixed).unwrap();
        assert!(bits.iter().enumerate().all(|(i, bit)| *bit == (i % 2 == 1)));
    }
}
