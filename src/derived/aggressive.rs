//! Aggressive opacity: cells that are mostly solid pass for opaque. **Not conservative.**
//!
//! After the thesis' "approximate PVS by an opacity threshold" (section 3): for
//! [`crate::Method::Cell`] only cells wholly inside solids hide, so that most of the solids hide
//! nothing. If cells that are filled to a share count too, the PVS is smaller, but lacks objects
//! that show through the unfilled part.

use glam::{DVec3, IVec3};

use crate::error::Error;
use crate::method::Method;
use crate::pvs::Pvs;
use crate::query::{AggressiveCells, Extras, Query};
use crate::scene::Scene;
use crate::shape::Shape;
use crate::view::View;

/// Points along each edge of a cell at which its filling is sampled.
const SAMPLES: i32 = 4;

/// Cells that static solids fill to at least a share of their volume, for
/// [`Query::run_aggressive`]. **Results lose visible objects.**
///
/// ```
/// use casca::{Aabb, AggressiveOpacity, GridSpec, Method, ObjectDesc, Query, Scene, Sphere, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(16) })?;
/// // A wall that fills three quarters of each cell hides nothing by whole cells.
/// let wall = Aabb::new(Vec3::new(0.0, 0.0, 8.0), Vec3::new(16.0, 16.0, 8.75));
/// scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let ball = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(8.0, 8.0, 14.0), 0.5)))?;
/// let mut query = Query::with_method(Method::cell())?;
/// let view = View::omnidirectional(Vec3::new(8.5, 8.5, 4.5))?;
/// assert!(query.run(&scene, &view).contains(ball));
/// let opacity = AggressiveOpacity::new(&scene, 0.7)?;
/// assert!(!query.run_aggressive(&scene, &view, &opacity)?.contains(ball));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct AggressiveOpacity {
    cells: AggressiveCells,
    share: f32,
    scene: u32,
}

impl AggressiveOpacity {
    /// The cells of `scene` that its static solids fill to a `share` (above 0, up to 1) or more: at
    /// least that share of 64 points in the cell lies in solids. Open meshes and instances fill
    /// nothing.
    ///
    /// Later changes of the scene do not count: make it anew when static objects change. Costs 64
    /// tests of points for each cell that static solids touch; one in a closed mesh goes through
    /// its triangles.
    ///
    /// # Errors
    /// Refuses a share out of its range.
    pub fn new(scene: &Scene, share: f32) -> Result<Self, Error> {
        let mut made = Self::for_shares(scene, &[share])?;
        Ok(made.swap_remove(0))
    }

    /// As [`AggressiveOpacity::new`] for several shares, in their order, at the cost of one.
    ///
    /// # Errors
    /// As [`AggressiveOpacity::new`].
    pub fn for_shares(scene: &Scene, shares: &[f32]) -> Result<Vec<Self>, Error> {
        if let Some(share) = shares.iter().find(|&&s| !(s > 0.0 && s <= 1.0)) {
            let what = "the share of aggressive opacity";
            return Err(Error::Setting { what, value: f64::from(*share), min: 0.0, max: 1.0 });
        }
        let grid = scene.grid();
        let empty = |&share: &f32| Self { cells: AggressiveCells::default(), share, scene: scene.tag() };
        let mut made: Vec<Self> = shares.iter().map(empty).collect();
        let points = SAMPLES.pow(3);
        let mut asked = AggressiveCells::default();
        let mut solids = Vec::new();
        scene.static_solid_cells(&mut |part, cell| {
            let layers = scene.opacity_part(part).layers();
            if !asked.set(layers, grid.dims(), cell) {
                return;
            }
            solids.clear();
            solids.extend(scene.static_solids(cell, part).filter(|s| s.is_solid()));
            let (min, max) = grid.cell_bounds(cell);
            let filled = (0..points).filter(|i| {
                let at = IVec3::new(i % SAMPLES, i / SAMPLES % SAMPLES, i / (SAMPLES * SAMPLES)).as_dvec3();
                let point = min + (max - min) * ((at + DVec3::splat(0.5)) / f64::from(SAMPLES));
                solids.iter().any(|s| s.contains_point(point))
            });
            let filled = filled.count() as f64 / f64::from(points);
            for opacity in made.iter_mut().filter(|o| filled >= f64::from(o.share)) {
                opacity.cells.set(layers, grid.dims(), cell);
            }
        });
        Ok(made)
    }

    /// The share asked for.
    pub fn share(&self) -> f32 {
        self.share
    }

    /// The cells that pass for opaque and are not. One that solids on different layers fill comes
    /// more than once.
    pub fn cells(&self) -> impl Iterator<Item = IVec3> {
        self.cells.parts.iter().flat_map(|(_, cells)| cells.iter())
    }
}

impl Query {
    /// As [`Query::run`] with [`crate::Method::Cell`], but mostly solid cells pass for opaque:
    /// **visible objects may be missing**, which [`Pvs::is_aggressive`] then says. For uses where a
    /// smaller set is worth holes in the picture, such as the order in which to load objects. Costs
    /// as [`Query::run`].
    ///
    /// # Errors
    /// Refuses an opacity of another scene, and other methods.
    pub fn run_aggressive(
        &mut self,
        scene: &Scene,
        view: &View,
        opacity: &AggressiveOpacity,
    ) -> Result<&Pvs, Error> {
        if opacity.scene != scene.tag() {
            return Err(Error::ForeignOpacity);
        }
        if !matches!(self.method(), Method::Cell(_)) {
            return Err(Error::AggressiveMethod);
        }
        Ok(self.run_with(scene, view, Extras { more: Some(&opacity.cells), ..Extras::default() }))
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::geometry::{Aabb, Sphere};
    use crate::grid::GridSpec;
    use crate::object::ObjectDesc;

    fn scene() -> Scene {
        Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(16) }).unwrap()
    }

    #[test]
    fn cells_count_from_the_share_that_solids_fill_together() {
        let mut scene = scene();
        // Two boxes fill the lower and the upper quarter of cell (5, 5, 5); one fills a half of (9,
        // 9, 9).
        for (min, max) in [([5.0, 5.0, 5.0], [6.0, 5.25, 6.0]), ([5.0, 5.75, 5.0], [6.0, 6.0, 6.0])] {
            let b = Aabb::new(min.into(), max.into());
            scene.insert(ObjectDesc::fixed(b).occluder(b)).unwrap();
        }
        let half = Aabb::new(Vec3::splat(9.0), Vec3::new(9.5, 10.0, 10.0));
        scene.insert(ObjectDesc::fixed(half).occluder(half)).unwrap();
        let cells = |share| {
            let opacity = AggressiveOpacity::new(&scene, share).unwrap();
            let mut cells: Vec<IVec3> = opacity.cells().collect();
            cells.sort_by_key(|c| c.to_array());
            cells
        };
        assert_eq!(cells(0.5), [IVec3::splat(5), IVec3::splat(9)]);
        assert_eq!(cells(0.51), []);
    }

    #[test]
    fn shares_methods_and_scenes_that_do_not_fit_are_refused() {
        let (mut one, other) = (scene(), scene());
        for share in [0.0, -1.0, 1.5, f32::NAN] {
            assert!(AggressiveOpacity::new(&one, share).is_err());
        }
        let opacity = AggressiveOpacity::new(&one, 1.0).unwrap();
        let view = View::omnidirectional(Vec3::splat(8.5)).unwrap();
        let mut query = Query::new();
        assert_eq!(query.run_aggressive(&one, &view, &opacity).unwrap_err(), Error::AggressiveMethod);
        query.set_method(Method::cell()).unwrap();
        assert_eq!(query.run_aggressive(&other, &view, &opacity).unwrap_err(), Error::ForeignOpacity);
        let ball = one.insert(ObjectDesc::fixed(Sphere::new(Vec3::splat(3.0), 0.5))).unwrap();
        assert!(query.run_aggressive(&one, &view, &opacity).unwrap().is_aggressive());
        assert!(query.pvs().contains(ball));
        assert!(!query.run(&one, &view).is_aggressive());
        assert!(query.pvs().is_valid_for(&one, &view));
        query.run_aggressive(&one, &view, &opacity).unwrap();
        assert!(!query.pvs().is_valid_for(&one, &view), "an aggressive result stands for no other");
    }
}
