//! The data structures inside a scene and a query, for pictures, tests and experiments.
//!
//! Only with the feature `internals`. Applications do not need it, and its names may change in any
//! release.
//!
//! Methods of [`Scene`] and [`Query`] that show internals are in two traits, to be imported by
//! name:
//!
//! ```
//! use casca::internals::{QueryInternals, SceneInternals};
//! use casca::{Aabb, Method, ObjectDesc, Query, Scene, View};
//! use glam::{IVec3, UVec3, Vec3};
//!
//! # fn main() -> Result<(), casca::Error> {
//! let mut scene = Scene::new(1.0)?;
//! let wall = Aabb::new(Vec3::new(8.0, 0.0, 0.0), Vec3::new(10.0, 32.0, 32.0));
//! scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
//! assert_eq!(scene.static_opacity().count(), 2 * 32 * 32);
//!
//! let mut query = Query::with_method(Method::cell())?;
//! query.record_cells(true);
//! query.run(&scene, &View::omnidirectional(Vec3::new(2.5, 16.5, 16.5))?);
//! assert!(query.hidden_cells().is_some_and(|cells| cells.get(IVec3::new(12, 16, 16))));
//! # Ok(())
//! # }
//! ```

use std::borrow::Cow;

use glam::IVec3;

use crate::object::{Bounds, Occluder};
use crate::query::Query;
use crate::scene::{LayerOpacity, Scene};
use crate::shape::pieces::touched;

pub use crate::grid::run::CellRun;
pub use crate::matrix::bits::{BitMatrix, OcclusionMatrix, OpacityMatrix};
pub use crate::matrix::ids::IdMatrix;
pub use crate::matrix::tbv::TbvMatrix;
pub use crate::reference::occlusion_by_lattice;
pub use crate::shape::{Shape, Which};

/// The matrices of a scene.
pub trait SceneInternals {
    /// Whether a cell is opaque (O) by occluders on the same layers, whichever these are. Costs two
    /// look-ups for each mask of layers.
    fn is_opaque(&self, cell: IVec3) -> bool;

    /// The cells that listed objects touch. Costs the cells of all objects.
    fn occupied(&self) -> BitMatrix;

    /// Os: the opaque cells of static objects, on all layers. A copy if occluders are on different
    /// layers.
    fn static_opacity(&self) -> Cow<'_, OpacityMatrix>;

    /// The opaque cells of visible dynamic objects, on all layers; with Os they make O, except
    /// while an occluder that is [reported on expiry](crate::Reports::OnExpiry) is due for a
    /// report: then O is Os.
    fn dynamic_opacity(&self) -> Cow<'_, OpacityMatrix>;

    /// I: the objects that touch each brick.
    fn id_matrix(&self) -> &IdMatrix;

    /// Txy, Txz, Tyz: the temporal bounding volumes.
    fn tbv_matrix(&self) -> &TbvMatrix;
}

/// The opaque cells of all masks of layers.
fn of_all_layers(scene: &Scene, cells: impl Fn(&LayerOpacity) -> &OpacityMatrix) -> Cow<'_, OpacityMatrix> {
    let mut parts = scene.opacity(u64::MAX).map(cells);
    let mut all = parts.next().map_or_else(|| Cow::Owned(OpacityMatrix::default()), Cow::Borrowed);
    for part in parts {
        part.iter().for_each(|cell| all.to_mut().set(cell));
    }
    all
}

impl SceneInternals for Scene {
    fn is_opaque(&self, cell: IVec3) -> bool {
        self.is_opaque(cell, u64::MAX)
    }

    fn occupied(&self) -> BitMatrix {
        let mut cells = BitMatrix::default();
        for (_, object) in self.living().filter(|(_, object)| object.in_cells()) {
            touched(object.bounds().kind(), self.grid(), &mut |piece| {
                piece.bricks(|brick, mask| cells.set_mask(brick, mask));
            });
        }
        cells
    }

    fn static_opacity(&self) -> Cow<'_, OpacityMatrix> {
        of_all_layers(self, LayerOpacity::fixed)
    }

    fn dynamic_opacity(&self) -> Cow<'_, OpacityMatrix> {
        of_all_layers(self, LayerOpacity::moving)
    }

    fn id_matrix(&self) -> &IdMatrix {
        self.id_matrix()
    }

    fn tbv_matrix(&self) -> &TbvMatrix {
        self.tbv_matrix()
    }
}

/// The shapes behind bounds and occluders.
pub trait ShapeInternals {
    /// The shape, to ask for its cells and its inside.
    fn shape(&self) -> &dyn Shape;
}

impl ShapeInternals for Bounds {
    fn shape(&self) -> &dyn Shape {
        self.kind()
    }
}

impl ShapeInternals for Occluder {
    fn shape(&self) -> &dyn Shape {
        self.kind()
    }
}

/// The cells that a query visited, and the buffers that it drew.
pub trait QueryInternals {
    /// Says whether runs of [`crate::Method::Cell`] keep which cells they visited and which they
    /// found hidden. A new query does not. Costs two bits for each cell of the bricks that a run
    /// visits.
    fn record_cells(&mut self, record: bool);

    /// The cells that the last run of [`crate::Method::Cell`] found hidden (H), if
    /// [`QueryInternals::record_cells`] was set.
    ///
    /// Cells behind the last shell of the walk are hidden too, and not in it.
    fn hidden_cells(&self) -> Option<&OcclusionMatrix>;

    /// The cells inside the frustum that the last run of [`crate::Method::Cell`] visited, if
    /// [`QueryInternals::record_cells`] was set.
    fn visited_cells(&self) -> Option<&BitMatrix>;
}

impl QueryInternals for Query {
    fn record_cells(&mut self, record: bool) {
        self.record_cells(record);
    }

    fn hidden_cells(&self) -> Option<&OcclusionMatrix> {
        self.recorded().1
    }

    fn visited_cells(&self) -> Option<&BitMatrix> {
        self.recorded().0
    }
}
