//! Windows of finer cells that move with the eye: a world larger than a grid has cells for.
//!
//! Nested grids around the viewer are those of clipmaps (Losasso and Hoppe 2004) and of cascaded
//! light (Kaplanyan and Dachsbacher 2010). Here all cells share one list of states and one tree of
//! triangles, so that rays cross the edges of windows without a seam: only where a hit is read
//! depends on the size of cells there.

use glam::{DVec3, Vec3};

use crate::cache::Cache;
use crate::error::{LightError, numbers};
use crate::lattice::{Lattice, Level};
use crate::moves::{Bounds, Change, Moved};
use crate::numeric::WINDOW_REST;
use crate::voxels::Voxels;

/// The parts of a box that are not in another one.
fn without((low, high): Bounds, (from, to): Bounds) -> Vec<Bounds> {
    let (mut low, mut high) = (low, high);
    let mut parts = Vec::new();
    for axis in 0..3 {
        let (mut below, mut above) = (high, low);
        below[axis] = high[axis].min(from[axis]);
        above[axis] = low[axis].max(to[axis]);
        parts.extend([(low, below), (above, high)].into_iter().filter(|(l, h)| l[axis] < h[axis]));
        (low[axis], high[axis]) = (low[axis].max(from[axis]), high[axis].min(to[axis]));
        if low[axis] >= high[axis] {
            break;
        }
    }
    parts
}

/// Whether a point is near the middle of a level.
fn is_resting(level: &Level, point: DVec3) -> bool {
    let (low, high) = level.bounds();
    (point - 0.5 * (low + high)).abs().cmple((high - low) * WINDOW_REST).all()
}

impl Cache {
    /// Lets the windows follow an eye, which may move every frame: they stay while it is within the
    /// middle quarter of each, and else move around it. No window leaves the grid, or the window
    /// that it is in.
    ///
    /// States, rays and light of cells that keep their size stay; rays that end where cells have
    /// another size now are sent again. Call [`Cache::gather`], [`Cache::direct`] and passes next.
    /// The states then have the same rays as those of a cache that is made anew. If windows move,
    /// it costs the cells of all triangles, a look at each stored ray, and the rays that are sent;
    /// [`Moved::kept`] is 0 if none did.
    ///
    /// # Errors
    /// If the eye is not finite, or the triangles touch too many cells; then nothing changes.
    pub fn move_windows(&mut self, eye: Vec3) -> Result<Moved, LightError> {
        numbers("the eye of windows", 0, eye, -f32::MAX..=f32::MAX)?;
        let old = self.voxels.lattice;
        let windows = old.levels().iter().skip(1);
        if windows.clone().all(|level| is_resting(level, old.cells(eye))) {
            return Ok(self.unmoved());
        }
        let mut settings = self.settings;
        settings.windows.iter_mut().flatten().for_each(|w| w.middle = eye);
        let lattice = Lattice::new(&settings.grid, &settings.windows);
        if lattice == old {
            return Ok(self.unmoved());
        }
        let surfaces = self.voxels.surfaces.clone();
        let voxels = Voxels::with(lattice, surfaces, self.voxels.tree.clone())?;
        self.settings = settings;
        // Where cells have another size than before.
        let pairs = old.levels().iter().zip(lattice.levels()).map(|(a, b)| (a.bounds(), b.bounds()));
        let resized = pairs.flat_map(|(a, b)| [without(a, b), without(b, a)].concat()).collect();
        Ok(self.replace(voxels, &Change::Windows(resized)))
    }

    fn unmoved(&self) -> Moved {
        Moved { waiting: self.waiting(), ..Moved::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{Grid, Window};
    use crate::lattice::Cell;
    use glam::IVec3;

    fn volume((low, high): &Bounds) -> f64 {
        (*high - *low).element_product()
    }

    #[test]
    fn parts_of_a_box_fill_what_another_leaves() {
        let whole = (DVec3::ZERO, DVec3::new(4.0, 3.0, 5.0));
        for (low, high, rest) in [
            (DVec3::splat(1.0), DVec3::splat(2.0), 59.0),
            (DVec3::splat(-1.0), DVec3::splat(9.0), 0.0),
            (DVec3::splat(6.0), DVec3::splat(9.0), 60.0),
            (DVec3::new(-1.0, 1.0, 2.0), DVec3::new(2.0, 9.0, 4.0), 60.0 - 8.0),
        ] {
            let parts = without(whole, (low, high));
            assert_eq!(parts.iter().map(volume).sum::<f64>(), rest, "{low} {high}");
            let middle = |(l, h): &Bounds| 0.5 * (*l + *h);
            let is_in = |p: DVec3| p.cmpgt(low).all() && p.cmplt(high).all();
            assert!(parts.iter().all(|p| !is_in(middle(p))));
        }
    }

    #[test]
    fn cells_have_one_number_each_and_keep_it_in_a_window_that_moves() {
        let grid = Grid { min: Vec3::ZERO, max: Vec3::new(16.0, 8.0, 8.0), cells: 16 };
        let at = |x: f32| {
            let window = Window { middle: Vec3::new(x, 4.0, 4.0), half: 2.0, finer: 4 };
            Lattice::new(&grid, &[Some(window), Some(Window { half: 0.6, finer: 2, ..window })])
        };
        let (before, now) = (at(5.0), at(6.1));
        for lattice in [&before, &now] {
            let count = lattice.levels().iter().map(|l| l.dims.element_product() as u32).sum();
            for number in 0..count {
                let cell = lattice.place(number);
                assert!(lattice.has(cell), "{cell:?}");
                assert_eq!(lattice.number(cell), number);
                assert_eq!(lattice.of_slot(lattice.slot(cell)), cell);
                let middle = (cell.at.as_dvec3() + 0.5) / lattice.fine(cell);
                assert_eq!(lattice.at(middle) != cell, lattice.is_finer(cell), "{cell:?}");
            }
        }
        let mut kept = 0;
        for level in 0..3 {
            for number in 0..before.levels()[level].dims.element_product() as u32 {
                let cell: Cell = before.place(before.levels()[level].first + number);
                if now.has(cell) {
                    assert_eq!(before.number(cell), now.number(cell));
                    kept += usize::from(level > 0);
                }
            }
        }
        // Windows of 16 x 16 x 16 cells, and of 16, have moved by a cell of the grid, or 4.
        assert!(kept > 12 * 16 * 16, "{kept}");
        assert_ne!(before.levels()[1].low, now.levels()[1].low);
    }

    #[test]
    fn windows_stay_inside() {
        let grid = Grid { min: Vec3::ZERO, max: Vec3::splat(8.0), cells: 8 };
        for middle in [Vec3::splat(-1e30), Vec3::splat(3e38), Vec3::new(0.1, 7.9, 4.0)] {
            let window = Window { middle, half: 1.0, finer: 2 };
            let lattice =
                Lattice::new(&grid, &[Some(window), Some(Window { half: 100.0, finer: 8, ..window })]);
            for (inner, outer) in [(1, 0), (2, 1)] {
                let (inner, outer) = (lattice.levels()[inner].bounds(), lattice.levels()[outer].bounds());
                assert!(inner.0.cmpge(outer.0).all() && inner.1.cmple(outer.1).all(), "{middle}");
            }
            assert_eq!(lattice.levels()[1].dims, IVec3::splat(4));
        }
    }
}
