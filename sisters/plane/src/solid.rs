//! The cells that lie wholly inside a solid shape, row by row: rounded inwards (thesis, section
//! 3.3.1).

use std::ops::RangeInclusive;

use glam::DVec2;

use crate::geometry::Shape;
use crate::geometry::block::Block;
use crate::geometry::polygon::ring;
use crate::grid::Grid;
use crate::numeric::{CHORD, TOUCH};

/// Calls `run` with rows of cells and runs of columns that lie wholly inside a shape, in the grid.
/// A wall without thickness contains no cell.
pub(crate) fn filled(shape: &Shape, grid: &Grid, run: &mut impl FnMut(i32, RangeInclusive<i32>)) {
    match shape {
        // Grid lines and sides of rectangles are exact numbers.
        Shape::Rect(rect) => {
            let block = rect.block();
            let columns = between(grid, 0, block.min.x, block.max.x);
            if !columns.is_empty() {
                between(grid, 1, block.min.y, block.max.y).for_each(|row| run(row, columns.clone()));
            }
        }
        Shape::Disc(disc) => {
            let (center, radius) = (disc.center.as_dvec2(), f64::from(disc.radius));
            convex(grid, &disc.block(), run, |y| {
                let off = y - center.y;
                let half = (radius * radius - off * off).sqrt();
                // Not a number, and so no chord, beyond the disc.
                (center.x - half, center.x + half)
            });
        }
        Shape::Polygon(polygon) => {
            convex(grid, &polygon.block(), run, |y| chord(ring(polygon.corners()), y));
        }
        Shape::Segment(_) | Shape::Polyline(_) => {}
    }
}

/// The cells inside a convex shape: a row lies inside as far as the chords on its lower and on its
/// upper line do.
fn convex(
    grid: &Grid,
    block: &Block,
    run: &mut impl FnMut(i32, RangeInclusive<i32>),
    chord: impl Fn(f64) -> (f64, f64),
) {
    // Coordinates inside a grid err by less than the first part, those of corners and centres by
    // less than the second.
    let farthest = block.min.abs().max(block.max.abs()).max_element();
    let margin = TOUCH * grid.cell_size() + CHORD * farthest;
    for row in between(grid, 1, block.min.y + margin, block.max.y - margin) {
        let (below, above) = (chord(grid.line(1, row) - margin), chord(grid.line(1, row + 1) + margin));
        let from = f64::max(below.0 + margin, above.0 + margin);
        let to = f64::min(below.1 - margin, above.1 - margin);
        let sure = [below.0, above.0, below.1, above.1].iter().all(|end| end.is_finite());
        let columns = between(grid, 0, from, to);
        if sure && !columns.is_empty() {
            run(row, columns);
        }
    }
}

/// The interval of x in which a convex ring of sides contains points at a y; empty if it has none
/// there.
fn chord(sides: impl Iterator<Item = (DVec2, DVec2)>, y: f64) -> (f64, f64) {
    let ends = sides.filter(|(a, b)| (a.y <= y) != (b.y <= y));
    ends.map(|(a, b)| a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)).clamp(0.0, 1.0))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), x| (from.min(x), to.max(x)))
}

/// The cells of the grid that lie wholly between two coordinates of an axis.
fn between(grid: &Grid, axis: usize, from: f64, to: f64) -> RangeInclusive<i32> {
    let at_or_after = |p: f64| {
        let cell = grid.cell_along(axis, p);
        if grid.line(axis, cell) < p { cell.saturating_add(1) } else { cell }
    };
    if from.is_nan() || to.is_nan() || from > to {
        return RangeInclusive::new(1, 0);
    }
    // The line at or below `to` ends the last cell.
    at_or_after(from).max(0)..=(grid.cell_along(axis, to) - 1).min(grid.dims()[axis] - 1)
}

#[cfg(test)]
mod tests {
    use glam::{IVec2, UVec2, Vec2};

    use super::*;
    use crate::geometry::{ConvexPolygon, Disc, Rect, Segment};
    use crate::grid::GridSpec;

    fn grid() -> Grid {
        Grid::new(&GridSpec { min: Vec2::splat(-1.0), cell: 0.5, dims: UVec2::splat(40) }).unwrap()
    }

    fn cells(shape: &Shape) -> Vec<IVec2> {
        let mut cells = Vec::new();
        filled(shape, &grid(), &mut |y, xs| cells.extend(xs.map(|x| IVec2::new(x, y))));
        cells
    }

    #[test]
    fn filled_cells_lie_inside_and_are_nearly_all() {
        let at = |x: f32, y: f32| Vec2::new(x, y);
        let triangle = ConvexPolygon::new(&[at(0.3, 0.2), at(17.9, 3.3), at(4.0, 15.1)]).unwrap();
        let shapes: [Shape; 4] = [
            Disc::new(at(5.2, 6.1), 4.3).into(),
            Disc::new(at(-1.0, 3.0), 3.0).into(),
            triangle.into(),
            Rect::new(at(1.0, 2.0), at(6.3, 4.5)).into(),
        ];
        for shape in shapes {
            let found = cells(&shape);
            for cell in (0..1600).map(|i| IVec2::new(i % 40, i / 40)) {
                let (lo, hi) = grid().cell_bounds(cell);
                let inside = |grow: f64| {
                    let corners = [
                        lo - grow,
                        hi + grow,
                        DVec2::new(lo.x - grow, hi.y + grow),
                        DVec2::new(hi.x + grow, lo.y - grow),
                    ];
                    corners.iter().all(|&corner| shape.contains(corner))
                };
                assert!(!found.contains(&cell) || inside(0.0), "{shape:?} {cell}");
                assert!(found.contains(&cell) || !inside(1e-5), "{shape:?} {cell}");
            }
            assert!(found.len() > 20);
        }
    }

    #[test]
    fn rectangles_fill_the_cells_on_whose_lines_they_end() {
        let found = cells(&Rect::new(Vec2::new(0.0, 0.5), Vec2::new(1.0, 1.0)).into());
        assert_eq!(found, [IVec2::new(2, 3), IVec2::new(3, 3)]);
    }

    #[test]
    fn walls_and_shapes_elsewhere_fill_nothing() {
        let big = 3e38;
        assert!(cells(&Segment::new(Vec2::ZERO, Vec2::splat(9.0)).into()).is_empty());
        assert!(cells(&Disc::new(Vec2::splat(500.0), 100.0).into()).is_empty());
        assert!(cells(&Rect::new(Vec2::splat(-big), Vec2::splat(-1.0)).into()).is_empty());
        assert_eq!(cells(&Rect::new(Vec2::splat(-big), Vec2::splat(big)).into()).len(), 1600);
        // Coordinates so large are not exact enough.
        assert!(cells(&Disc::new(Vec2::splat(big), big).into()).is_empty());
    }
}
