//! One temporal bounding volume: a disc of cells that holds a hidden object for a while.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DVec2, IVec2};

use crate::geometry::Shape;
use crate::grid::Grid;
use crate::numeric::VOLUME;
use crate::volume::circle::circle;

/// Circles are larger by at most this many cells than the object needs: the cost of drawing one and
/// the chance that it is seen grow with it.
const MOST_CELLS: f64 = 16.0;

/// A circle is no larger than a rectangle whose sides are those of the grid, divided by this
/// (thesis, section 3.4.1).
const GRID_PARTS: f64 = 5.0;

/// A volume: the cells of a [circle](super::circle) and those inside of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tbv {
    /// The cell in the middle.
    center: IVec2,
    /// In cells.
    radius: i32,
}

/// The circle around a shape.
#[derive(Debug, Clone, Copy)]
struct Around {
    center: DVec2,
    radius: f64,
}

impl Around {
    fn of(shape: &Shape) -> Self {
        if let Shape::Disc(disc) = shape {
            return Self { center: disc.center.as_dvec2(), radius: f64::from(disc.radius) };
        }
        let block = shape.block();
        Self { center: (block.min + block.max) * 0.5, radius: (block.max - block.min).length() * 0.5 }
    }
}

impl Tbv {
    pub(super) fn new(center: IVec2, radius: i32) -> Self {
        Self { center, radius }
    }

    /// A volume around a shape that may move by up to `distance` world units. It holds no cell of a
    /// viewer, and no object that `confined` says must stay in the grid while it is inside. None if
    /// the shape is too large or too close to a viewer or a border.
    ///
    /// Its radius is at most that of the thesis, sqrt((w/5)² + (h/5)²), and a few cells more than
    /// the shape needs.
    pub(crate) fn around(
        grid: &Grid,
        shape: &Shape,
        distance: f64,
        viewers: &[IVec2],
        confined: bool,
    ) -> Option<Self> {
        let around = Around::of(shape);
        let center = grid.cell_of(around.center);
        if !grid.contains(center) {
            return None;
        }
        let per_cell = 1.0 / grid.cell_size();
        let needed = Self::needed(grid, center, &around);
        let fifth = grid.dims().as_dvec2() / GRID_PARTS;
        let mut most = fifth.length().min(needed + MOST_CELLS);
        for &viewer in viewers {
            // No cell of the disc is farther than radius + 1/2 from the middle.
            most = most.min((viewer - center).as_dvec2().length() - 0.5 - VOLUME);
        }
        if confined {
            let room = (around.center - grid.min()).min(grid.max() - around.center).min_element();
            most = most.min(needed + (room - around.radius) * per_cell);
        }
        let radius = (needed + distance.max(0.0) * per_cell).ceil().min(most.floor());
        // Also false where something is not a number.
        (radius >= needed).then(|| Self::new(center, radius as i32))
    }

    /// The least radius, in cells, whose disc around a cell holds all cells that a circle touches:
    /// the centres of those are within half a diagonal of it.
    fn needed(grid: &Grid, cell: IVec2, around: &Around) -> f64 {
        let (lo, hi) = grid.cell_bounds(cell);
        let off = around.center.distance((lo + hi) * 0.5);
        (off + around.radius) / grid.cell_size() + FRAC_1_SQRT_2 + VOLUME
    }

    /// How far a shape can move, in world units, and stay inside; negative if it may not be inside.
    pub(crate) fn room(&self, grid: &Grid, shape: &Shape) -> f64 {
        let needed = Self::needed(grid, self.center, &Around::of(shape));
        (f64::from(self.radius) - needed) * grid.cell_size()
    }

    /// The cells of its outline, also those beyond the grid.
    pub(crate) fn outline(&self) -> impl Iterator<Item = IVec2> + use<> {
        let center = self.center;
        circle(self.radius).map(move |cell| center + cell)
    }

    /// Whether a cell may be on its outline or inside.
    pub(crate) fn may_contain(&self, cell: IVec2) -> bool {
        let (off, reach) = ((cell - self.center).as_i64vec2(), 2 * i64::from(self.radius) + 1);
        4 * off.length_squared() <= reach * reach
    }

    /// The cell in the middle, and the number of cells along an axis.
    pub(super) fn place(&self) -> (IVec2, u32) {
        (self.center, 2 * self.radius.unsigned_abs() + 1)
    }

    /// A circle around all of its cells: its centre and its radius in world units.
    pub(crate) fn disc(&self, grid: &Grid) -> (DVec2, f64) {
        let (lo, hi) = grid.cell_bounds(self.center);
        ((lo + hi) * 0.5, (f64::from(self.radius) + 0.5 + FRAC_1_SQRT_2 + VOLUME) * grid.cell_size())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use glam::{UVec2, Vec2};

    use super::*;
    use crate::geometry::{Disc, Rect};
    use crate::grid::GridSpec;
    use crate::raster::touched;

    fn grid() -> Grid {
        Grid::new(&GridSpec { min: Vec2::ZERO, cell: 0.5, dims: UVec2::new(100, 60) }).unwrap()
    }

    #[test]
    fn a_volume_holds_every_place_within_its_room_and_no_viewer() {
        let g = grid();
        for i in 0..400 {
            let share = |by: i32| (i * by % 409) as f32 / 409.0;
            let place = Vec2::new(10.0 + 20.0 * share(7), 8.0 + 14.0 * share(11));
            let size = 0.1 + 1.5 * share(5);
            let shape: Shape = if i % 2 == 0 {
                Disc::new(place, size).into()
            } else {
                Rect::new(place, place + Vec2::new(size, 0.3)).into()
            };
            let viewer = g.cell_of(place.as_dvec2()) + IVec2::new(12, 5);
            let Some(tbv) = Tbv::around(&g, &shape, f64::from(3.0 * share(3)), &[viewer], true) else {
                panic!("{shape:?}");
            };
            assert!(!tbv.may_contain(viewer));
            let outline: HashSet<IVec2> = tbv.outline().collect();
            assert!(outline.iter().all(|&cell| tbv.may_contain(cell)));
            let room = tbv.room(&g, &shape);
            assert!(room >= 0.0);
            let moved = |step: Vec2| -> Shape {
                match &shape {
                    Shape::Disc(d) => Disc::new(d.center + step, d.radius).into(),
                    Shape::Rect(r) => Rect::new(r.min + step, r.max + step).into(),
                    _ => unreachable!(),
                }
            };
            for turn in 0..16 {
                let step = Vec2::from_angle(turn as f32 * 0.4) * room as f32 * 0.9999;
                touched(&moved(step), &g, &mut |y, xs| {
                    // From the cell to the middle, the way does not leave the disc: some outline
                    // cell is as far out.
                    for x in xs {
                        let off = IVec2::new(x, y) - tbv.center;
                        let inside = off.length_squared() <= tbv.radius * tbv.radius;
                        assert!(inside || outline.contains(&IVec2::new(x, y)), "{shape:?} {x} {y}");
                    }
                });
            }
        }
    }

    #[test]
    fn volumes_that_cannot_be() {
        let g = grid();
        let ball = |x: f32, y: f32, radius: f32| Shape::from(Disc::new(Vec2::new(x, y), radius));
        let none = |shape: Shape, viewers: &[IVec2]| Tbv::around(&g, &shape, 1.0, viewers, false).is_none();
        assert!(
            none(ball(9.0, 9.0, 0.3), &[IVec2::new(18, 18)])
                && none(ball(9.0, 9.0, 0.3), &[IVec2::new(19, 18)])
        );
        assert!(none(ball(-1.0, 9.0, 0.3), &[]) && none(ball(9.0, 9.0, 20.0), &[]));
        assert!(none(ball(3e38, 9.0, 3e38), &[]));
        assert!(Tbv::around(&g, &ball(1.0, 9.0, 2.0), 1.0, &[], true).is_none(), "it leaves the grid");
        let tbv = Tbv::around(&g, &ball(9.0, 9.0, 0.3), 1e300, &[], false).unwrap();
        assert_eq!(tbv.radius, 18);
        let cramped = Tbv::around(&g, &ball(1.5, 9.0, 0.3), 9.0, &[], true).unwrap();
        assert!(cramped.room(&g, &ball(1.5, 9.0, 0.3)) <= 1.2);
    }
}
