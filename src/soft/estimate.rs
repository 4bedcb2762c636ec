//! Estimates from many rays or several cones: how much of a shape an eye sees, and how open the sky
//! is above a surface.

use glam::{DVec3, Vec3};

use crate::derived::DrawItem;
use crate::error::{Error, finite3};
use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::numeric::soft::OFF_SURFACE;
use crate::object::Bounds;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::soft::cone::{CellCone, March, between};
use crate::soft::grid::SoftGrid;
use crate::soft::rays::{above_surface, check_rays, on_box, on_sphere, six_cones};
use crate::soft::walk::Segment;

/// The share of a shape that an eye sees, 0 to 1, between two bounds.
///
/// They are far from each other where cells are large beside the things that hide: a sheet, or a
/// wall thinner than a cell, fills none. Finer cells bring them together. Mean errors for balls of
/// which something is seen, with 64 rays in a cube of 128 cells (the example `soft_fractions`):
///
/// | scene, radius of the ball in cells | seen on the mean | `least` | middle | `most` |
/// |---|---|---|---|---|
/// | houses, 4 | 0.86 | 0.008 | 0.006 | 0.006 |
/// | boxes of 2 to 16 cells, 4 | 0.87 | 0.048 | 0.026 | 0.046 |
/// | trunks of 0.8 to 2.4 cells, 4 | 0.34 | 0.18 | 0.14 | 0.36 |
/// | the same, 0.6 | 0.72 | 0.38 | 0.22 | 0.26 |
/// | rooms with walls of 0.4 cells, 4 | 0.43 | 0.18 | 0.22 | 0.57 |
/// | the same, 0.6 | 0.82 | 0.35 | 0.19 | 0.18 |
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleFraction {
    /// The share that is seen past all cells that shapes touch. It is 0 for a small thing behind
    /// the edge of another, though all of it may be seen.
    pub least: f32,
    /// The share that is seen past all cells that lie wholly in a solid or a closed mesh.
    pub most: f32,
}

impl VisibleFraction {
    /// All is seen.
    const ALL: Self = Self { least: 1.0, most: 1.0 };

    /// The mean of both bounds: it errs by half of their distance at most.
    pub fn middle(self) -> f32 {
        (self.least + self.most) * 0.5
    }
}

impl SoftGrid {
    /// The share of a shape that an eye sees, by solid angle, between two bounds: from about as
    /// many exact walks as `rays` says (1 to 4096), to a sphere itself and to the faces of the box
    /// around any other shape. 1 for an eye in the shape or in one of its cells.
    ///
    /// The share of the rays that reach the shape lies between both, but for two kinds of things
    /// that [`VisibleFraction::least`] does not see: cells inside the shape's bounding box never
    /// occlude it, since it may be in the grid itself; nor does the cell of the eye. Few rays are
    /// **an estimate** of the solid angle: 64 err by some percent. Shapes outside of the grid are
    /// hidden by the cells on the way.
    ///
    /// Costs a [`SoftGrid::first_hit`] for each ray, and a second one for each that meets a cell.
    ///
    /// # Errors
    /// Refuses an eye that is not finite, shapes that a scene would refuse, and numbers of rays out
    /// of range.
    pub fn visible_fraction(
        &self,
        eye: Vec3,
        shape: impl Into<Bounds>,
        rays: u32,
    ) -> Result<VisibleFraction, Error> {
        finite3("the eye", eye)?;
        check_rays(rays)?;
        let shape = shape.into();
        shape.check()?;
        Ok(self.fraction(eye.as_dvec3(), &shape, rays))
    }

    /// [`SoftGrid::visible_fraction`] for arguments that were checked.
    fn fraction(&self, eye: DVec3, shape: &Bounds, rays: u32) -> VisibleFraction {
        let block = shape.block();
        let own = self.cover(&block);
        if own.contains(self.grid().cell_of(eye)) {
            return VisibleFraction::ALL;
        }
        let mut points = match shape {
            Bounds::Sphere(ball) => match on_sphere(eye, ball, rays) {
                Some(points) => points,
                None => return VisibleFraction::ALL,
            },
            _ => on_box(eye, &block, rays),
        };
        let mut all: f64 = points.iter().map(|p| p.1).sum();
        if all.is_nan() || all <= 0.0 {
            // Nothing of a flat shape is seen edge-on: its middle stands for it.
            points = vec![((block.min + block.max) * 0.5, 1.0)];
            all = 1.0;
        }
        let (mut least, mut most) = (0.0, 0.0);
        for (to, weight) in points {
            let segment = Segment { from: eye, to, skips_first: true, until: Some(own) };
            if self.walk(&segment).is_none() {
                least += weight;
                most += weight;
            } else if self.walk_among(self.filled(), &segment).is_none() {
                most += weight;
            }
        }
        VisibleFraction { least: (least / all) as f32, most: (most / all) as f32 }
    }

    /// The cells around a box, which may lie outside of the grid.
    fn cover(&self, block: &Block) -> CellBox {
        let (lo, hi) = self.grid().cover(block.min, block.max);
        CellBox { lo, hi }
    }

    /// The share of the sky above a surface that is hidden, 0 to 1, weighted by the cosine of the
    /// angle with the normal: **an estimate**. Shapes farther away from the point than `reach`, in
    /// world units, hide nothing; it may be infinite. With [`March::Rays`], by so many rays; else
    /// by six cones of 60 degrees.
    ///
    /// All start 1.7 cells above the point along the normal: there no cell belongs to the surface
    /// itself, if that is flat. Nearer shapes are not seen.
    ///
    /// # Errors
    /// Refuses a point and a normal that are not finite, a normal of length 0, a negative reach,
    /// and settings of the march out of range.
    pub fn ambient_occlusion(
        &self,
        point: Vec3,
        normal: Vec3,
        reach: f32,
        march: &March,
    ) -> Result<f32, Error> {
        finite3("the point", point)?;
        finite3("the normal", normal)?;
        between("the reach", reach, 0.0, f32::INFINITY)?;
        march.check()?;
        let what = "the normal";
        let normal = normal.as_dvec3().try_normalize().ok_or(Error::NoDirection { what })?;
        let apex = self.to_cells(point.as_dvec3()) + normal * OFF_SURFACE;
        // Every direction ends on the sphere of that radius around the point.
        let reach = |direction: DVec3| {
            let (reach, along) = (f64::from(reach) / self.grid().cell_size(), normal.dot(direction));
            let aside = OFF_SURFACE * OFF_SURFACE * (1.0 - along * along);
            ((reach * reach - aside).max(0.0).sqrt() - OFF_SURFACE * along).max(0.0)
        };
        let cone = |direction, tan| CellCone { apex, direction, tan, reach: reach(direction) };
        // Half the angle of a cone of 60 degrees.
        let tan = (1.0f64 / 3.0).sqrt();
        let open: f64 = match *march {
            March::Rays(rays) => {
                let ray = |direction| self.march(&cone(direction, 0.0), &March::Rays(1)).0;
                above_surface(normal, rays).map(ray).sum::<f64>() / f64::from(rays)
            }
            _ => six_cones(normal)
                .map(|(direction, weight)| weight * self.march(&cone(direction, tan), march).0)
                .sum(),
        };
        // The weights of the cones sum to 1 but for rounding.
        Ok((1.0 - open).clamp(0.0, 1.0) as f32)
    }

    /// Sets [`DrawItem::fraction`] of objects in a draw list to the middle of
    /// [`SoftGrid::visible_fraction`] of their bounds from the eye of the view that the set was
    /// found for, by so many rays each. No object leaves the list.
    ///
    /// Objects that are gone, or go unreported while hidden, keep their fraction; so do all in
    /// views of parallel rays.
    ///
    /// ```
    /// use casca::soft::{Layer, SoftGrid};
    /// use casca::{DrawOptions, GridSpec, ObjectDesc, Query, Scene, Sphere, View};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let spec = GridSpec { min: Vec3::ZERO, cell: 0.5, dims: UVec3::splat(64) };
    /// let (mut scene, mut soft) = (Scene::new(&spec)?, SoftGrid::new(&spec)?);
    /// let ball = |x, z, r| Sphere::new(Vec3::new(x, 16.0, z), r);
    /// let near = scene.insert(ObjectDesc::dynamic(ball(16.0, 10.0, 2.0)).occluder(ball(16.0, 10.0, 2.0)))?;
    /// let behind = scene.insert(ObjectDesc::fixed(ball(20.0, 20.0, 2.0)))?;
    /// soft.follow(&scene)?;
    /// let mut query = Query::new();
    /// let pvs = query.run(&scene, &View::omnidirectional(Vec3::new(16.0, 16.0, 2.0))?);
    /// let mut items = Vec::new();
    /// pvs.draw_list(&scene, &DrawOptions::default(), &mut items)?;
    /// soft.estimate(pvs, &scene, 64, &mut items)?;
    /// assert_eq!((items[0].id, items[0].fraction), (near, 1.0));
    /// assert!(items[1].id == behind && items[1].fraction < 0.5 && items[1].seen_size() < items[1].size);
    /// // What shows most first, for streaming.
    /// items.sort_by(|a, b| b.seen_size().total_cmp(&a.seen_size()));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses a scene other than the one that was queried, and numbers of rays out of range.
    pub fn estimate(&self, pvs: &Pvs, scene: &Scene, rays: u32, items: &mut [DrawItem]) -> Result<(), Error> {
        check_rays(rays)?;
        if pvs.scene != scene.tag() {
            return Err(Error::ForeignPvs);
        }
        let Some(eye) = pvs.view.as_ref().and_then(|view| view.eye()) else { return Ok(()) };
        for item in items {
            let Ok(object) = scene.find(item.id) else { continue };
            if !scene.is_unlocated(item.id.slot()) && object.unreported_volume().is_none() {
                item.fraction = self.fraction(eye, object.bounds(), rays).middle();
            }
        }
        Ok(())
    }
}
