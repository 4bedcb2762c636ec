//! Results that are made ready on another thread while frames go on.

use std::sync::Arc;

use crate::kept::still::{Stamp, Still};
use crate::query::Query;
use crate::scene::Scene;
use crate::view::View;

/// A copy of a scene, and the static objects that it was made with.
#[derive(Clone)]
pub(super) struct Snapshot {
    scene: Arc<Scene>,
    stamp: Stamp,
}

impl Snapshot {
    pub(super) fn of(scene: &Scene) -> Self {
        Self { scene: Arc::new(scene.clone()), stamp: Stamp::of(scene) }
    }

    /// Whether the static objects of a scene are still those of the copy.
    pub(super) fn is_of(&self, scene: &Scene) -> bool {
        self.stamp == Stamp::of(scene)
    }
}

/// A result of a [`KeptQuery`](crate::KeptQuery) that is to be found, on any thread: see
/// [`KeptQuery::prepare`](crate::KeptQuery::prepare).
#[must_use = "a job that is not run finds nothing"]
pub struct KeptJob {
    snapshot: Snapshot,
    view: View,
    query: Box<Query>,
}

/// A result that a [`KeptJob`] found, for [`KeptQuery::install`](crate::KeptQuery::install).
#[derive(Debug)]
#[must_use = "a result that is not installed serves no frame"]
pub struct KeptResult(pub(super) Box<Still>);

impl KeptJob {
    pub(super) fn new(snapshot: Snapshot, view: View, query: Box<Query>) -> Self {
        Self { snapshot, view, query }
    }

    /// Finds the result. Costs a query of the widened view.
    pub fn run(self) -> KeptResult {
        let Snapshot { scene, stamp } = self.snapshot;
        KeptResult(Box::new(Still::find(self.query, &scene, self.view, stamp)))
    }
}
