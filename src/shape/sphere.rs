//! Spheres, row by row.
//!
//! The radius is widened or narrowed by [`DISTANCE`] of the coordinates.

use glam::{DVec3, IVec3, Vec3};

use crate::error::Error;
use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::geometry::{Block, Sphere};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::numeric::shape::{DISTANCE, REGION, SPHERE_BOX};
use crate::shape::Shape;
use crate::shape::kind::Kind;

impl Sphere {
    fn parts(&self) -> (DVec3, f64, f64) {
        let (c, r) = (self.center.as_dvec3(), f64::from(self.radius));
        (c, r, DISTANCE * (c.abs().max_element() + r))
    }
}

/// Nearest and farthest distance from `c` to the interval from `lo` to `hi`.
fn distances(c: f64, lo: f64, hi: f64) -> (f64, f64) {
    ((lo - c).max(c - hi).max(0.0), (c - lo).abs().max((hi - c).abs()))
}

impl Shape for Sphere {
    fn bounds(&self) -> (DVec3, DVec3) {
        let (c, r, margin) = self.parts();
        (c - (r + margin), c + (r + margin))
    }

    fn contains_box(&self, min: DVec3, max: DVec3) -> bool {
        let (c, r, margin) = self.parts();
        let farthest = (c - min).abs().max((max - c).abs());
        // A little less than the rows of `opaque` contain, so that every cell found here is one of
        // theirs.
        let r = r - SPHERE_BOX * margin;
        r > 0.0 && farthest.length_squared() <= r * r
    }

    fn contains_point(&self, point: DVec3) -> bool {
        let (c, r, margin) = self.parts();
        point.distance_squared(c) <= (r + margin) * (r + margin)
    }

    fn touched_rows(&self, grid: &Grid, from: IVec3, to: IVec3, out: &mut dyn FnMut(CellRun)) {
        let (c, r, margin) = self.parts();
        let r = r + margin;
        let (lo, hi) = grid.cover(c - r, c + r);
        let (lo, hi) = (lo.max(from), hi.min(to));
        for z in lo.z..=hi.z {
            let (dz, _) = distances(c.z, grid.plane(2, z), grid.plane(2, z + 1));
            for y in lo.y..=hi.y {
                let (dy, _) = distances(c.y, grid.plane(1, y), grid.plane(1, y + 1));
                let rest = r * r - dz * dz - dy * dy;
                if rest < 0.0 {
                    continue;
                }
                let dx = rest.sqrt() + margin;
                let (a, b) = grid.cover_along(0, c.x - dx, c.x + dx);
                let (x0, x1) = (a.max(lo.x), b.min(hi.x));
                if x0 <= x1 {
                    out(CellRun { x0, x1, y, z });
                }
            }
        }
    }

    fn opaque_rows(&self, grid: &Grid, from: IVec3, to: IVec3, out: &mut dyn FnMut(CellRun)) {
        let (c, r, margin) = self.parts();
        let r = r - margin;
        if r <= 0.0 {
            return;
        }
        let Some((lo, hi)) = grid.inside(c - r, c + r) else { return };
        let (lo, hi) = (lo.max(from), hi.min(to));
        for z in lo.z..=hi.z {
            let (_, dz) = distances(c.z, grid.plane(2, z), grid.plane(2, z + 1));
            for y in lo.y..=hi.y {
                let (_, dy) = distances(c.y, grid.plane(1, y), grid.plane(1, y + 1));
                let rest = r * r - dz * dz - dy * dy;
                if rest <= 0.0 {
                    continue;
                }
                let dx = rest.sqrt() - margin;
                let (a, b) = grid.inside_along(0, c.x - dx, c.x + dx);
                let (x0, x1) = (a.max(lo.x), b.min(hi.x));
                if x0 <= x1 {
                    out(CellRun { x0, x1, y, z });
                }
            }
        }
    }

    fn misses(&self, min: DVec3, max: DVec3) -> bool {
        let (c, r, margin) = self.parts();
        // A little more than the rows of `touched` contain.
        let r = r + SPHERE_BOX * margin;
        c.clamp(min, max).distance_squared(c) > r * r
    }
}

impl Kind for Sphere {
    fn is_centered(&self) -> bool {
        true
    }

    fn check(&self, what: &'static str) -> Result<(), Error> {
        Sphere::check(self, what)
    }

    fn same(&self, other: &Self) -> bool {
        self == other
    }

    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error> {
        Ok(Some(Sphere::new(self.center + offset, self.radius)))
    }

    fn may_reach(&self, planes: &[HalfSpace]) -> bool {
        let (c, r) = (self.center.as_dvec3(), f64::from(self.radius));
        let largest = c.abs().max_element() + r;
        planes.iter().all(|p| p.distance(c) >= -(r + p.margin(largest)))
    }

    fn may_meet(&self, planes: &[HalfSpace], around: &Block) -> bool {
        let (c, r) = (self.center.as_dvec3(), f64::from(self.radius));
        let away = (around.min - c).max(c - around.max).max(DVec3::ZERO);
        // Not written the other way round, so that NaN is doubt.
        let apart = away.length() > r + REGION * (r + c.abs().max_element());
        !apart && self.may_reach(planes)
    }

    fn distance_from(&self, eye: DVec3) -> f64 {
        (self.center.as_dvec3() - eye).length() - f64::from(self.radius)
    }

    fn distance_along(&self, direction: DVec3) -> f64 {
        self.center.as_dvec3().dot(direction) - f64::from(self.radius)
    }

    fn ball(&self) -> (DVec3, f64) {
        (self.center.as_dvec3(), f64::from(self.radius))
    }

    fn outer(&self, origin: DVec3, grow: f64) -> Body<'_> {
        Body::Sphere { center: self.center.as_dvec3() - origin, radius: f64::from(self.radius) + grow }
    }

    fn inner(&self, origin: DVec3, shrink: f64) -> Option<Body<'_>> {
        Some(Body::Sphere {
            center: self.center.as_dvec3() - origin,
            radius: f64::from(self.radius) - shrink,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::shape::Which;

    #[test]
    fn rows_agree_with_cell_by_cell_tests() {
        let grid = Grid::new(0.5).unwrap();
        let spheres = [
            Sphere::new(Vec3::splat(5.0), 3.3),
            Sphere::new(Vec3::new(0.1, 9.9, 4.2), 2.0),
            Sphere::new(Vec3::splat(5.1), 0.01),
            Sphere::new(Vec3::splat(5.25), 12.0),
            Sphere::new(Vec3::splat(50.0), 1.0),
        ];
        for s in spheres {
            let (mut touched, mut opaque) = (BTreeSet::new(), BTreeSet::new());
            s.rows(&grid, Which::Touched, &mut |run| {
                run.cells().for_each(|c| assert!(touched.insert(c.to_array())))
            });
            s.rows(&grid, Which::Opaque, &mut |run| {
                run.cells().for_each(|c| assert!(opaque.insert(c.to_array())))
            });
            let (c, r) = (s.center.as_dvec3(), f64::from(s.radius));
            for i in 0..8000 {
                let cell = IVec3::new(i % 20, i / 20 % 20, i / 400);
                let (min, max) = grid.cell_bounds(cell);
                let near = (c.clamp(min, max) - c).length();
                let far = (c - min).abs().max((max - c).abs()).length();
                assert_eq!(near < r, touched.contains(&cell.to_array()), "{s:?} {cell}");
                assert_eq!(far < r, opaque.contains(&cell.to_array()), "{s:?} {cell}");
                assert_eq!(far < r, s.contains_box(min, max));
            }
        }
    }

    #[test]
    fn a_cell_that_a_sphere_contains_is_in_its_rows() {
        // Corners of cells lie on these spheres, so that rounding decides.
        let grid = Grid::new(1.0).unwrap();
        let (mut inside, mut barely) = (0, 0);
        for i in 0..400 {
            let center = Vec3::new((i % 7) as f32 + 8.0, (i % 5) as f32 + 9.0, (i % 3) as f32 * 0.5 + 10.0);
            let corner = Vec3::new((i % 11) as f32, (i % 13) as f32, (i % 4) as f32 + 3.0);
            let s = Sphere::new(center, center.distance(corner));
            let mut rows = BTreeSet::new();
            s.rows(&grid, Which::Opaque, &mut |run| rows.extend(run.cells().map(|c| c.to_array())));
            for j in 0..24 * 24 * 24 {
                let cell = IVec3::new(j % 24, j / 24 % 24, j / 576);
                let (min, max) = grid.cell_bounds(cell);
                if s.contains_box(min, max) {
                    inside += 1;
                    assert!(rows.contains(&cell.to_array()), "{s:?} {cell}");
                } else {
                    barely += i32::from(rows.contains(&cell.to_array()));
                }
            }
        }
        assert!(inside > 1000 && barely < inside / 100, "{inside} {barely}");
    }
}
