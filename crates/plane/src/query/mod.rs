//! Queries: the memory of one view, and the methods that find its PVS.

use crate::bits::BitGrid;
use crate::cell::{self, CellOptions, CellScratch};
use crate::error::Error;
use crate::method::Method;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::view::View;

/// Finds the objects that a view can see.
///
/// A query keeps its memory and its last result: use one for each view and run it again every frame. Any number of queries can run on
/// one scene at the same time, each in its own thread.
#[derive(Debug, Clone, Default)]
pub struct Query {
    method: Method,
    pvs: Pvs,
    cell_options: CellOptions,
    cell: CellScratch,
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
            Method::Cell => cell::run(scene, view, &self.cell_options, &mut self.cell, pvs),
            _ => scene.living().for_each(|(slot, _)| pvs.push(scene.id(slot))),
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

    /// The cells of the grid that the last run of [`Method::Cell`] found in sight: each cell that some point of the eye's cell sees a point of, inside the
    /// view, and a few more. `None` after a run of another method, or on another scene. Costs all cells of the grid.
    pub fn seen_cells(&self, scene: &Scene) -> Option<BitGrid> {
        let ran = self.pvs.method == Method::Cell && self.pvs.scene == scene.tag();
        ran.then(|| self.cell.seen_cells(scene))
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }
}
