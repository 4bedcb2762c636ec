//! Rays through the cells, exactly: Amanatides and Woo (1987), with empty bricks crossed in one
//! step, and the test of Möller and Trumbore (1997) for the triangles that each cell touches.
//!
//! A triangle is listed in all cells that it touches, grown by a margin. So a hit is the first one
//! as soon as the ray leaves a cell behind it, whichever cell lists it, and no ray passes between
//! two cells.

use glam::{DVec3, IVec3};

use crate::voxels::{NONE, Surface, Voxels};

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// The distance from the start, in cells.
    pub(crate) distance: f64,
    /// The triangle.
    pub(crate) surface: u32,
    /// A cell that lists it.
    pub(crate) cell: IVec3,
}

impl Surface {
    /// The distance along a unit direction at which a ray meets it, if it does ahead.
    fn meet(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let [a, b, c] = self.corners;
        let (first, second) = (b - a, c - a);
        let p = direction.cross(second);
        let determinant = first.dot(p);
        let way = from - a;
        let u = way.dot(p) / determinant;
        if u < -self.slack[1] {
            return None;
        }
        let q = way.cross(first);
        let v = direction.dot(q) / determinant;
        let distance = second.dot(q) / determinant;
        // Comparisons with NaN, of parallel rays, fail.
        let is_in = v >= -self.slack[2] && 1.0 - u - v >= -self.slack[0];
        (is_in && distance >= 0.0).then_some(distance)
    }
}

/// The part of a ray inside a box, as distances; the first one is not negative.
pub(crate) fn within(from: DVec3, direction: DVec3, low: DVec3, high: DVec3) -> Option<(f64, f64)> {
    let (mut start, mut end) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        if direction[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let a = (low[axis] - from[axis]) / direction[axis];
        let b = (high[axis] - from[axis]) / direction[axis];
        (start, end) = (start.max(a.min(b)), end.min(a.max(b)));
    }
    (start <= end).then_some((start, end))
}

impl Voxels {
    /// The first surface within a reach along a unit direction. Costs the cells on its way in
    /// bricks that are not empty, and one step for each other brick.
    pub(crate) fn first(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.walk(from, direction, reach, |cell, surface, end| {
            let limit = best.map_or(reach, |b| b.distance);
            if let Some(number) = surface {
                let met = self.surfaces[number as usize].meet(from, direction);
                if let Some(distance) = met.filter(|d| *d < limit || best.is_none() && *d <= limit) {
                    best = Some(Hit { distance, surface: number, cell });
                }
                return false;
            }
            limit <= end && best.is_some()
        });
        best
    }

    /// Whether the segment between two points meets no surface.
    pub(crate) fn free(&self, from: DVec3, to: DVec3) -> bool {
        let way = to - from;
        let Some(direction) = way.try_normalize() else { return true };
        let (reach, mut is_free) = (way.length(), true);
        self.walk(from, direction, reach, |_, surface, _| {
            let of = |number: u32| self.surfaces[number as usize].meet(from, direction);
            is_free &= surface.and_then(of).is_none_or(|d| d > reach);
            !is_free
        });
        is_free
    }

    /// Visits the triangles of each cell on the way, and then, with `None`, the end of the cell as
    /// a distance; ends where `visit` returns true.
    fn walk(
        &self,
        from: DVec3,
        direction: DVec3,
        reach: f64,
        mut visit: impl FnMut(IVec3, Option<u32>, f64) -> bool,
    ) {
        let dims = self.lattice.dims;
        let Some((mut t, end)) = within(from, direction, DVec3::ZERO, dims.as_dvec3()) else { return };
        let end = end.min(reach);
        let inverse = direction.recip();
        let mut cell = (from + direction * t).floor().as_ivec3().clamp(IVec3::ZERO, dims - 1);
        while t <= end {
            let mask = self.mask(cell);
            // The box to cross: a cell, or an empty brick.
            let (low, high) = match mask {
                0 => (cell & !3, cell | 3),
                _ => (cell, cell),
            };
            let next = |axis: usize| match direction[axis] {
                d if d > 0.0 => (f64::from(high[axis] + 1) - from[axis]) * inverse[axis],
                d if d < 0.0 => (f64::from(low[axis]) - from[axis]) * inverse[axis],
                _ => f64::INFINITY,
            };
            let ends = DVec3::new(next(0), next(1), next(2));
            let axis = ends.min_position();
            if mask != 0 {
                let references = self.references_of(cell);
                for r in references {
                    if visit(cell, Some(r.surface), ends[axis]) {
                        return;
                    }
                }
                if !references.is_empty() && visit(cell, None, ends[axis]) {
                    return;
                }
            }
            t = t.max(ends[axis]);
            if mask == 0 {
                // Walks never turn back, whatever is rounded.
                let at = (from + direction * t).floor().as_ivec3().clamp(low, high);
                cell = IVec3::from_array([0, 1, 2].map(|a| match direction[a] < 0.0 {
                    true => at[a].min(cell[a]),
                    false => at[a].max(cell[a]),
                }));
            }
            cell[axis] = if direction[axis] > 0.0 { high[axis] + 1 } else { low[axis] - 1 };
            if !self.lattice.has(cell) {
                return;
            }
        }
    }

    /// The entry of a triangle at a point on it: that of the point's cell, of the cell that lists
    /// it, or of a cell next to the point. Rounding may put a point into a cell in which hardly
    /// anything of the triangle is.
    pub(crate) fn entry_at(&self, surface: u32, point: DVec3, listed: IVec3) -> Option<u32> {
        let of = |c: IVec3| {
            let is_it = |r: &&crate::voxels::Reference| r.surface == surface && r.entry != NONE;
            let references = if self.lattice.has(c) { self.references_of(c) } else { &[] };
            references.iter().find(is_it).map(|r| r.entry)
        };
        let at = point.floor().as_ivec3();
        of(at).or_else(|| of(listed)).or_else(|| around(at).find_map(of))
    }
}

/// The 27 cells around one, itself among them.
pub(crate) fn around(c: IVec3) -> impl Iterator<Item = IVec3> {
    block(c, 1)
}

/// The cells that are at most so many cells from one along each axis.
pub(crate) fn block(c: IVec3, reach: i32) -> impl Iterator<Item = IVec3> {
    let n = 2 * reach + 1;
    (0..n * n * n).map(move |i| c + IVec3::new(i % n, i / n % n, i / n / n) - reach)
}
