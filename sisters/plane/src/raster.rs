//! The cells that a shape touches, row by row: rounded outwards (thesis, section 3.3.1).

use std::ops::RangeInclusive;

use glam::DVec2;

use crate::geometry::polygon::ring;
use crate::geometry::{Block, Shape};
use crate::grid::Grid;
use crate::numeric::TOUCH;

/// Calls `run` with rows of cells and runs of columns that contain all cells of the grid that a
/// shape touches, also those that it touches from outside. Cells of one row may come several times.
/// The shape must lie inside the grid.
pub(crate) fn touched(shape: &Shape, grid: &Grid, run: &mut impl FnMut(i32, RangeInclusive<i32>)) {
    let block = shape.block();
    match shape {
        Shape::Rect(_) => {
            rows(grid, &block).for_each(|row| run(row, columns(grid, block.min.x, block.max.x)));
        }
        Shape::Disc(disc) => {
            let (center, radius) = (disc.center.as_dvec2(), f64::from(disc.radius));
            for row in rows(grid, &block) {
                let (low, high) = strip(grid, row);
                let off = (low - center.y).max(center.y - high).max(0.0);
                let half = (radius * radius - off * off).max(0.0).sqrt();
                run(row, columns(grid, center.x - half, center.x + half));
            }
        }
        Shape::Polygon(polygon) => {
            let all = rows(grid, &block);
            let mut spans = vec![EMPTY; all.clone().count()];
            for side in ring(polygon.corners()) {
                for row in rows(grid, &Block::EMPTY.with(side.0).with(side.1)) {
                    let (from, to) = span(side, strip(grid, row)).unwrap_or(EMPTY);
                    let all = &mut spans[(row - all.start()) as usize];
                    *all = (all.0.min(from), all.1.max(to));
                }
            }
            all.zip(spans).for_each(|(row, (from, to))| run(row, columns(grid, from, to)));
        }
        Shape::Segment(s) => segment((s.a.as_dvec2(), s.b.as_dvec2()), grid, run),
        Shape::Polyline(line) => {
            line.segments().for_each(|s| segment((s.a.as_dvec2(), s.b.as_dvec2()), grid, run));
        }
    }
}

fn segment(ends: (DVec2, DVec2), grid: &Grid, run: &mut impl FnMut(i32, RangeInclusive<i32>)) {
    let block = Block::EMPTY.with(ends.0).with(ends.1);
    for row in rows(grid, &block) {
        if let Some((from, to)) = span(ends, strip(grid, row)) {
            run(row, columns(grid, from, to));
        }
    }
}

const EMPTY: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// The lower and the upper line of a row of cells, with the margin of touching.
fn strip(grid: &Grid, row: i32) -> (f64, f64) {
    let margin = TOUCH * grid.cell;
    (grid.line(1, row) - margin, grid.line(1, row + 1) + margin)
}

fn rows(grid: &Grid, block: &Block) -> RangeInclusive<i32> {
    cells_along(grid, 1, block.min.y, block.max.y)
}

fn columns(grid: &Grid, from: f64, to: f64) -> RangeInclusive<i32> {
    cells_along(grid, 0, from, to)
}

/// The cells of the grid that an interval along an axis touches; none if it is empty.
fn cells_along(grid: &Grid, axis: usize, from: f64, to: f64) -> RangeInclusive<i32> {
    let margin = TOUCH * grid.cell;
    if from > to {
        return RangeInclusive::new(1, 0);
    }
    let (first, last) = (grid.cell_along(axis, from - margin), grid.cell_along(axis, to + margin));
    first.max(0)..=last.min(grid.dims[axis] - 1)
}

/// The interval of x that a segment covers between two values of y.
fn span((a, b): (DVec2, DVec2), (low, high): (f64, f64)) -> Option<(f64, f64)> {
    let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
    if b.y < low || a.y > high {
        return None;
    }
    let height = b.y - a.y;
    let at =
        |y: f64| if height > 0.0 { a.x + (b.x - a.x) * ((y - a.y) / height).clamp(0.0, 1.0) } else { a.x };
    let (from, to) = if height > 0.0 { (at(low), at(high)) } else { (a.x, b.x) };
    Some((from.min(to), from.max(to)))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::{IVec2, UVec2, Vec2};

    use super::*;
    use crate::geometry::{ConvexPolygon, Disc, Polyline, Rect, Segment};
    use crate::grid::GridSpec;

    fn cells(shape: impl Into<Shape>) -> BTreeSet<(i32, i32)> {
        let spec = GridSpec { min: Vec2::splat(-1.0), cell: 1.0, dims: UVec2::splat(12) };
        let mut cells = BTreeSet::new();
        touched(&shape.into(), &Grid::new(&spec).unwrap(), &mut |y, xs| {
            cells.extend(xs.map(|x| (x - 1, y - 1)))
        });
        cells
    }

    fn at(x: f32, y: f32) -> Vec2 {
        Vec2::new(x, y)
    }

    #[test]
    fn shapes_touch_the_cells_that_they_should() {
        let block = |x: [i32; 2], y: [i32; 2]| -> BTreeSet<(i32, i32)> {
            (x[0]..=x[1]).flat_map(|x| (y[0]..=y[1]).map(move |y| (x, y))).collect()
        };
        assert_eq!(cells(Rect::new(at(1.5, 2.0), at(3.5, 2.5))), block([1, 3], [1, 2]));
        assert_eq!(cells(Segment::new(at(2.5, 0.5), at(2.5, 3.5))), block([2, 2], [0, 3]));
        assert_eq!(cells(Segment::new(at(0.5, 3.5), at(4.5, 3.5))), block([0, 4], [3, 3]));
        assert_eq!(cells(Segment::new(at(3.0, 3.0), at(3.0, 3.0))), block([2, 3], [2, 3]));
        assert_eq!(cells(Disc::new(at(3.5, 3.5), 0.25)), block([3, 3], [3, 3]));
        let diagonal: BTreeSet<_> = [(0, 0), (1, 0), (1, 1), (2, 1), (2, 2)].into();
        assert_eq!(cells(Segment::new(at(0.5, 0.25), at(2.75, 2.5))), diagonal);
        let bend = Polyline::new(&[at(0.5, 0.5), at(2.5, 0.5), at(2.5, 2.5)]).unwrap();
        assert_eq!(cells(bend), &block([0, 2], [0, 0]) | &block([2, 2], [0, 2]));
    }

    #[test]
    fn round_shapes_touch_the_cells_of_their_points() {
        let disc = Disc::new(at(4.2, 5.1), 2.9);
        let hull = ConvexPolygon::new(&disc.polygon()).unwrap();
        let (of_disc, of_hull) = (cells(disc), cells(hull));
        assert!(of_hull.is_subset(&of_disc) && of_disc.len() < 49);
        for i in 0..1000 {
            let (sin, cos) = (i as f32 * 0.37).sin_cos();
            let p = disc.center + Vec2::new(cos, sin) * 2.89 * (i as f32 / 1000.0).sqrt();
            let cell = p.floor().as_ivec2();
            assert!(of_disc.contains(&(cell.x, cell.y)), "{cell}");
        }
        // A corner cell of its rectangle lies beyond the disc.
        assert!(!of_disc.contains(&IVec2::new(1, 2).into()));
    }
}
