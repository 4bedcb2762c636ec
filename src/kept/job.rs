//! Results that are made ready on another thread while frames go on.

use std::sync::Arc;

use crate::kept::still::{Stamp, Still};
use crate::query::Query;
use crate::scene::Scene;
use crate::view::View;

/// How many copies of a scene are kept: one that a job reads, and one that can be brought up to
/// date meanwhile.
const COPIES: usize = 2;

/// A copy of a scene, and the static objects that it was made with.
#[derive(Debug, Clone)]
struct Snapshot {
    scene: Arc<Scene>,
    stamp: Stamp,
}

impl Snapshot {
    fn of(scene: &Scene) -> Self {
        Self { scene: Arc::new(scene.clone()), stamp: Stamp::of(scene) }
    }

    /// Takes over the static objects of a scene that changed since; false, without a change, if
    /// they are too many or a job reads the copy.
    fn follow(&mut self, scene: &Scene) -> bool {
        let Some(copy) = Arc::get_mut(&mut self.scene) else { return false };
        let Some(slots) = self.stamp.changed_slots(scene) else { return false };
        copy.follow_static(scene, &slots);
        self.stamp = Stamp::of(scene);
        true
    }
}

/// The copies of a scene that jobs read.
#[derive(Debug, Clone, Default)]
pub(super) struct Snapshots(Vec<Snapshot>);

impl Snapshots {
    /// A copy with the static objects that a scene has now. Takes over what changed, or copies the
    /// scene.
    fn take(&mut self, scene: &Scene) -> Snapshot {
        let stamp = Stamp::of(scene);
        let ready = self.0.iter().position(|copy| copy.stamp == stamp);
        let at = ready.or_else(|| self.0.iter_mut().position(|copy| copy.follow(scene)));
        let at = at.unwrap_or_else(|| {
            // The oldest makes room.
            self.0.drain(..(self.0.len() + 1).saturating_sub(COPIES));
            self.0.push(Snapshot::of(scene));
            self.0.len() - 1
        });
        self.0[at].clone()
    }

    /// A job for a view of a scene.
    pub(super) fn job(&mut self, scene: &Scene, view: View, query: Box<Query>) -> KeptJob {
        KeptJob { snapshot: self.take(scene), view, query }
    }
}

/// A result of a [`KeptQuery`](crate::KeptQuery) that is to be found, on any thread: see
/// [`KeptQuery::prepare`](crate::KeptQuery::prepare).
#[derive(Debug)]
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
    /// Finds the result. Costs a query of the widened view.
    pub fn run(self) -> KeptResult {
        let Snapshot { scene, stamp } = self.snapshot;
        KeptResult(Box::new(Still::find(self.query, &scene, self.view, stamp)))
    }
}
