//! Queries: the memory of one view, and the methods that find its PVS.

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
        for (slot, _) in scene.living() {
            pvs.push(scene.id(slot));
        }
        pvs
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }
}
