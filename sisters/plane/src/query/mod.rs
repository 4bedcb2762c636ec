//! Queries: the memory of one view, and the methods that find its PVS.

mod region;
mod valid;

use glam::Vec2;

use crate::bits::BitGrid;
use crate::cell::{self, CellOptions, CellScratch};
use crate::error::Error;
use crate::geometry::Shape;
use crate::method::Method;
use crate::point::Sight;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::view::View;

pub use region::visible_region;

/// Finds the objects that a view can see.
///
/// A query keeps its memory and its last result: use one for each view and run it again every
/// frame. Any number of queries can run on one scene at the same time, each in its own thread.
#[derive(Debug, Clone, Default)]
pub struct Query {
    method: Method,
    pvs: Pvs,
    cell_options: CellOptions,
    cell: CellScratch,
    sight: Sight,
}

impl Query {
    /// A query by the default method, [`Method::Point`].
    pub fn new() -> Self {
        Self::default()
    }

    /// A query by the method given.
    ///
    /// # Errors
    /// [`Error::Setting`] if one of its options is out of its range.
    pub fn with_method(method: Method) -> Result<Self, Error> {
        Ok(Self { method, ..Self::default() })
    }

    /// The method.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Finds the objects that a view can see. The result stays in the query ([`Query::pvs`]).
    pub fn run(&mut self, scene: &Scene, view: &View) -> &Pvs {
        let pvs = &mut self.pvs;
        pvs.reset(scene.slot_count());
        (pvs.scene, pvs.revision) = (scene.tag(), scene.revision());
        (pvs.method, pvs.view) = (self.method, Some(*view));
        match self.method {
            Method::Cell => {
                self.sight.open(scene, view);
                cell::run(scene, view, &self.cell_options, &self.sight, &mut self.cell, pvs);
            }
            Method::Sector => self.sight.run_without_occluders(scene, view, pvs),
            Method::Point => self.sight.run(scene, view, pvs),
        }
        pvs
    }

    /// The options of [`Method::Cell`].
    pub fn cell_options(&self) -> CellOptions {
        self.cell_options
    }

    /// Changes the options of [`Method::Cell`] from the next run on.
    ///
    /// # Errors
    /// [`Error::Setting`] if one of them is out of its range. The query then keeps the old ones.
    pub fn set_cell_options(&mut self, options: CellOptions) -> Result<(), Error> {
        options.check()?;
        self.cell_options = options;
        Ok(())
    }

    /// The cells of the grid that the last run of [`Method::Cell`] found in sight: each cell of
    /// which a point of the eye's cell sees a point inside the view, and a few more; with a
    /// [reach](View::with_reach), of any cell that the eye may be in. `None` if the last run was by
    /// another method, or on another scene. Costs all cells of the grid, for each cell of the eye.
    pub fn seen_cells(&self, scene: &Scene) -> Option<BitGrid> {
        let ran = self.pvs.method == Method::Cell && self.pvs.scene == scene.tag();
        ran.then(|| self.cell.seen_cells(scene))
    }

    /// Whether a point can be seen by the view of the last run: whether it belongs to the visible
    /// region, as [`Method::Point`] defines it. After a run of another method that is the whole
    /// view. Exact, but for the end of a range. `false` before the first run, and for points that
    /// are not finite. Costs the logarithm of the number of sides in sight.
    pub fn sees_point(&self, point: Vec2) -> bool {
        self.sight.sees_point(point.as_dvec2())
    }

    /// Whether any point of a shape can be seen by the view of the last run, as
    /// [`Query::sees_point`] says. Exact, but for discs and for the end of a range: these are
    /// larger by their rounding. `false` before the first run. Costs the sides in sight in the
    /// directions of the shape.
    ///
    /// # Errors
    /// Refuses shapes that are not finite or inverted, or have a negative radius.
    pub fn sees(&self, shape: impl Into<Shape>) -> Result<bool, Error> {
        let shape = shape.into();
        shape.check("the shape")?;
        Ok(self.sight.sees(&shape))
    }

    /// The visible region of the last run as a polygon: its corners, counterclockwise, rounded to
    /// single precision. Empty if nothing is seen. Costs the sides in sight.
    ///
    /// The polygon is star-shaped around the eye. The eye is a corner of it unless one sees in all
    /// directions. Where nothing stops the eye, the polygon ends at the range of the view: at
    /// chords around the circle, which leave it by 0.13% of the range at most. Without a range it
    /// ends a cell beyond the rectangle around the grid, all objects and the eye.
    ///
    /// ```
    /// use casca_plane::{GridSpec, ObjectDesc, Query, Scene, Segment, View};
    /// use glam::{UVec2, Vec2};
    ///
    /// # fn main() -> Result<(), casca_plane::Error> {
    /// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(8) })?;
    /// let wall = Segment::new(Vec2::new(2.0, 4.0), Vec2::new(6.0, 4.0));
    /// scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
    /// let mut query = Query::new();
    /// query.run(&scene, &View::sector(Vec2::new(4.0, 2.0), Vec2::Y, 0.5)?);
    /// assert!(query.sees_point(Vec2::new(4.0, 4.0)) && !query.sees_point(Vec2::new(4.0, 4.1)));
    /// // The eye and two points of the wall.
    /// assert_eq!(query.polygon().len(), 3);
    /// # Ok(())
    /// # }
    /// ```
    pub fn polygon(&self) -> Vec<Vec2> {
        self.sight.polygon()
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }
}
