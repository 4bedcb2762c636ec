//! Which cells a triangle touches, and which part of it lies in each: by halving boxes of cells.

use glam::{DVec3, IVec3};
use smallvec::SmallVec;

use crate::spread::in_triangle;

/// A convex polygon in cells. A triangle that six planes cut has nine corners at most.
pub(crate) type Polygon = SmallVec<[DVec3; 10]>;

/// The part of a polygon on one side of a plane across an axis.
fn half(polygon: &Polygon, axis: usize, at: f64, above: bool) -> Polygon {
    let height = |p: DVec3| if above { p[axis] - at } else { at - p[axis] };
    let mut part = Polygon::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (hp, hq) = (height(p), height(q));
        if hp >= 0.0 {
            part.push(p);
        }
        if (hp > 0.0 && hq < 0.0) || (hp < 0.0 && hq > 0.0) {
            let mut cut = p + (q - p) * (hp / (hp - hq));
            cut[axis] = at;
            part.push(cut);
        }
    }
    part
}

/// The least and the greatest coordinate along an axis.
pub(crate) fn range(polygon: &Polygon, axis: usize) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    polygon.iter().fold(start, |(low, high), p| (low.min(p[axis]), high.max(p[axis])))
}

/// The part of a polygon in the box of cells from `low` up to `high`, grown by a margin on all
/// sides; empty if there is none.
pub(crate) fn inside(polygon: &Polygon, low: IVec3, high: IVec3, margin: f64) -> Polygon {
    let mut part = polygon.clone();
    for axis in 0..3 {
        let ends = (f64::from(low[axis]) - margin, f64::from(high[axis]) + margin);
        let (least, greatest) = range(&part, axis);
        if least < ends.0 {
            part = half(&part, axis, ends.0, true);
        }
        if greatest > ends.1 {
            part = half(&part, axis, ends.1, false);
        }
    }
    part
}

/// The part of a polygon that belongs to one cell. A part in the upper face of a cell belongs to
/// the next one, so that each part has one cell.
pub(crate) fn part_of(polygon: &Polygon, cell: IVec3) -> Polygon {
    let part = inside(polygon, cell, cell + 1, 0.0);
    let is_next = (0..3).any(|axis| range(&part, axis).0 >= f64::from(cell[axis] + 1));
    if is_next { Polygon::new() } else { part }
}

/// Twice the area times the normal of a polygon.
pub(crate) fn cross(polygon: &Polygon) -> DVec3 {
    let fan = (1..polygon.len().saturating_sub(1))
        .map(|i| (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]));
    fan.sum()
}

/// The point of a polygon before which such an area lies, and so far across.
pub(crate) fn point_of(polygon: &Polygon, area: f64, across: f64) -> DVec3 {
    let mut rest = area;
    let mut last = polygon[0];
    for pair in polygon[1..].windows(2) {
        let of_fan = 0.5 * (pair[0] - polygon[0]).cross(pair[1] - polygon[0]).length();
        if of_fan > 0.0 {
            let share = (rest / of_fan).clamp(0.0, 1.0);
            let [a, b, c] = in_triangle(share, across);
            last = polygon[0] * a + pair[0] * b + pair[1] * c;
            if rest < of_fan {
                return last;
            }
        }
        rest -= of_fan;
    }
    last
}

/// Calls `visit` with each cell from `low` up to `high` that is nearer to the polygon than a
/// margin, until it returns false; returns whether it never did.
///
/// Costs the touched cells times the logarithm of the box.
pub(crate) fn touched(
    polygon: &Polygon,
    low: IVec3,
    high: IVec3,
    margin: f64,
    visit: &mut impl FnMut(IVec3) -> bool,
) -> bool {
    if polygon.is_empty() || (high - low).min_element() <= 0 {
        return true;
    }
    let size = high - low;
    if size == IVec3::ONE {
        return visit(low);
    }
    let axis = (0..3).max_by_key(|&axis| size[axis]).unwrap_or(0);
    let middle = low[axis] + size[axis] / 2;
    let plane = f64::from(middle);
    let (least, greatest) = range(polygon, axis);
    let side = |end: f64, above: bool| match above {
        true if least < end => half(polygon, axis, end, true),
        false if greatest > end => half(polygon, axis, end, false),
        _ => polygon.clone(),
    };
    let (mut below, mut above) = (high, low);
    (below[axis], above[axis]) = (middle, middle);
    (least > plane + margin || touched(&side(plane + margin, false), low, below, margin, visit))
        && (greatest < plane - margin || touched(&side(plane - margin, true), above, high, margin, visit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::GROW;

    fn triangle(corners: [[f64; 3]; 3]) -> Polygon {
        corners.map(DVec3::from_array).into_iter().collect()
    }

    #[test]
    fn parts_have_the_area_of_the_whole() {
        let high = IVec3::splat(16);
        for t in [
            triangle([[0.5, 0.5, 0.5], [14.0, 3.0, 9.0], [2.0, 15.5, 11.0]]),
            // In faces of cells.
            triangle([[1.0, 4.0, 1.0], [9.0, 4.0, 1.0], [1.0, 4.0, 7.0]]),
            triangle([[8.0, 8.0, 8.0], [12.0, 12.0, 8.0], [8.0, 12.0, 12.0]]),
            triangle([[3.0, 0.0, 0.0], [3.0, 16.0, 0.0], [3.0, 0.0, 16.0]]),
        ] {
            let mut area = 0.0;
            touched(&t, IVec3::ZERO, high, GROW, &mut |cell| {
                area += cross(&part_of(&t, cell)).length();
                true
            });
            let whole = cross(&t).length();
            assert!((area / whole - 1.0).abs() < 1e-12, "{area} of {whole}");
        }
    }

    #[test]
    fn a_wall_in_a_face_is_listed_on_both_sides() {
        let t = triangle([[1.5, 4.0, 1.5], [1.75, 4.0, 1.5], [1.5, 4.0, 1.75]]);
        let mut cells = Vec::new();
        touched(&t, IVec3::ZERO, IVec3::splat(16), GROW, &mut |cell| {
            cells.push(cell.to_array());
            true
        });
        assert_eq!(cells, [[1, 3, 1], [1, 4, 1]]);
        assert!(part_of(&t, IVec3::new(1, 3, 1)).is_empty());
        assert_eq!(part_of(&t, IVec3::new(1, 4, 1)).len(), 3);
    }
}
