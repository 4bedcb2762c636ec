//! The cells that a view may see, asked for one row of a shell's side at a time (thesis, section
//! 3.3.3).

use glam::DVec2;
use smallvec::SmallVec;

use crate::numeric::{REGION, REGION_SLOPE};

/// A half-plane in cells, relative to the centre of the viewer's cell: `normal . p + offset >= 0`.
#[derive(Debug, Clone, Copy)]
struct CellPlane {
    normal: DVec2,
    offset: f64,
}

/// A convex region around the viewer's cell V that holds all of a view, in cells relative to the
/// centre of V.
///
/// It holds V itself, so it holds the way from any point of V to any point in it, and no way to a
/// cell in it passes through a cell outside of it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Region {
    planes: SmallVec<[CellPlane; 2]>,
    /// Cells whose centre is farther from the centre of V are outside.
    radius: Option<f64>,
}

impl Region {
    /// The region of the directions between two half-planes through an eye in V, of which it takes
    /// the normals of length 1; all directions without them. The eye is relative to the centre of
    /// V.
    ///
    /// With a reach, eyes in other cells have the same region relative to the centres of these.
    pub(crate) fn new(eye: DVec2, normals: &[DVec2], reach: f64, range: Option<f64>) -> Self {
        // Moved out by half of this, a half-plane through the eye holds V; the other half is for
        // cells that reach into it.
        let offset = |normal: DVec2| normal.abs().element_sum() + REGION;
        let plane = |&normal: &DVec2| CellPlane { normal, offset: offset(normal) };
        let half_diagonal = std::f64::consts::FRAC_1_SQRT_2;
        // How far an eye is from the centre of its cell: nearer than from the centre of V.
        let away = (eye.length() + reach).min(half_diagonal);
        let radius = |range: f64| (range + away).max(half_diagonal) + half_diagonal + REGION;
        Self { planes: normals.iter().map(plane).collect(), radius: range.map(radius) }
    }

    /// The lattice lines from `lo` to `hi` of a side whose cells may reach into the region. The
    /// side is at `depth` along an axis (0 for x), its lines are places along the other one.
    pub(crate) fn row(&self, axis: usize, depth: i32, (lo, hi): (i32, i32)) -> Option<(i32, i32)> {
        let (mut a, mut b) = (f64::from(lo), f64::from(hi));
        for plane in &self.planes {
            let rest = plane.offset + plane.normal[axis] * f64::from(depth);
            let slope = plane.normal[1 - axis];
            if slope > REGION_SLOPE {
                a = a.max(-rest / slope);
            } else if slope < -REGION_SLOPE {
                b = b.min(-rest / slope);
            } else if rest + (slope * a).max(slope * b) < 0.0 {
                return None;
            }
        }
        if let Some(radius) = self.radius {
            let square = radius * radius - f64::from(depth) * f64::from(depth);
            if square < 0.0 {
                return None;
            }
            let reach = square.sqrt() + REGION;
            (a, b) = (a.max(-reach), b.min(reach));
        }
        let (a, b) = (a.ceil() as i32, b.floor() as i32);
        (a <= b).then_some((a, b))
    }

    /// Whether a cell, relative to V, may reach into the region.
    #[cfg(test)]
    pub(crate) fn meets(&self, cell: glam::IVec2) -> bool {
        self.row(0, cell.x, (cell.y, cell.y)).is_some()
    }
}

#[cfg(test)]
mod tests {
    use glam::IVec2;

    use super::*;

    /// Points of a cell, its corners included.
    fn points(cell: IVec2) -> impl Iterator<Item = DVec2> {
        (0..25).map(move |i| cell.as_dvec2() + DVec2::new(f64::from(i % 5), f64::from(i / 5)) / 4.0 - 0.5)
    }

    #[test]
    fn rows_hold_the_cells_of_the_view_and_few_others() {
        let eye = DVec2::new(0.2, -0.4);
        let (mut inside, mut outside) = (0, 0);
        for turn in 0..24 {
            let middle = f64::from(turn) * 0.27;
            let normals = [0.4 - 0.5 * std::f64::consts::PI, 0.5 * std::f64::consts::PI - 0.4]
                .map(|by| DVec2::from_angle(middle + by));
            let region = Region::new(eye, &normals, 0.0, Some(9.0));
            for (axis, depth) in (0..2).flat_map(|axis| (-14..=14).map(move |depth| (axis, depth))) {
                let row = region.row(axis, depth, (-14, 14));
                for lateral in -14..=14 {
                    let mut cell = IVec2::splat(lateral);
                    cell[axis] = depth;
                    let sees = points(cell)
                        .any(|p| p.distance(eye) <= 9.0 && normals.iter().all(|n| n.dot(p - eye) >= 0.0));
                    let listed = row.is_some_and(|(a, b)| a <= lateral && lateral <= b);
                    assert!(listed || !(sees || cell == IVec2::ZERO), "{turn} {cell}");
                    assert_eq!(listed, region.meets(cell));
                    inside += i32::from(sees);
                    outside += i32::from(listed && !sees);
                }
            }
        }
        assert!(inside > 2000 && outside < inside, "{inside} {outside}");
    }

    #[test]
    fn a_reach_adds_what_other_eyes_of_the_cell_see() {
        for (eye, reach) in [(DVec2::ZERO, 0.3), (DVec2::new(0.3, -0.1), 0.1), (DVec2::new(-0.4, 0.4), 7.0)] {
            let region = Region::new(eye, &[], reach, Some(5.0));
            let places = (0..100).map(|i| DVec2::new(f64::from(i % 10), f64::from(i / 10)) / 9.0 - 0.5);
            let eyes: Vec<_> = places.filter(|at| at.distance(eye) <= reach).collect();
            for cell in (0..29 * 29).map(|i| IVec2::new(i % 29 - 14, i / 29 - 14)) {
                let sees = points(cell).any(|p| eyes.iter().any(|eye| p.distance(*eye) <= 5.0));
                assert!(region.meets(cell) || !sees, "{eye} {reach} {cell}");
                assert!(!region.meets(cell) || cell.as_dvec2().length() <= 5.0 + 2f64.sqrt() + 1e-5);
            }
        }
    }

    #[test]
    fn absurd_half_planes_overflow_nothing() {
        for value in [0.0, -0.0, 1e-300, 1e300, f64::NAN, f64::INFINITY] {
            let normals = [DVec2::new(value, 1e-8), DVec2::new(1.0, value)];
            let region = Region::new(DVec2::splat(value), &normals, value, Some(value));
            for depth in [-1 << 20, -1, 0, 7, 1 << 20] {
                let row = region.row(0, depth, (-9, 9));
                assert!(row.is_none_or(|(a, b)| -9 <= a && a <= b && b <= 9));
            }
        }
    }
}
