//! One result that is kept: the static objects that a widened view may see, with the buffers of the
//! static occluders.
//!
//! Let the view of a frame be one of those that the widened view stands for. Static objects that
//! came, went or changed since are *followed* first, by [`Query::follow`]: then the
//! set and the buffers are as if all static objects were as they are now.
//!
//! - *Static objects*: one that the view sees is in the set of the widened view.
//! - *Dynamic objects outside of volumes*: whatever moves, the buffers hide for every eye within
//!   reach the space behind static occluders. These objects are tested where they are now.
//! - *Dynamic occluders* of objects in sight are drawn over a copy of the buffers, as the query
//!   draws its own. All objects in sight are tested again against that.
//! - *Volumes*: if an object in one is seen, so is the surface of the volume, or the eye is inside.
//!   The volumes that the widened view may see are watched: each frame tests them against its own
//!   frustum. All others stay hidden as long as they stay as they are. New ones are in the scene's
//!   journal, and are tested once ([`crate::kept::watch`]).

use casca_slots::Slot;

use crate::geometry::Block;
use crate::id::ObjectId;
use crate::kept::watch::{Drawn, Watch};
use crate::pvs::{Pvs, Stats};
use crate::query::point::StaticChanges;
use crate::query::point::drawing::{DrawingScratch, Offered};
use crate::query::{Extras, Query};
use crate::scene::{Object, Scene, StaticChange};
use crate::view::View;

/// A static object in sight of the widened view.
#[derive(Debug, Clone, Copy)]
struct InSight {
    id: ObjectId,
    block: Block,
}

/// A dynamic object whose box is in sight before static occluders.
#[derive(Debug, Clone, Copy)]
struct SeenMover {
    slot: Slot,
    /// Whether its place is known.
    located: bool,
}

/// A result is not followed any more once pixels were opened again this often on average: where
/// they were, seams stay open and nothing is refined.
const MOST_OPENED: f64 = 1.0;

/// Tells which static objects of a scene changed since.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    scene: u32,
    /// The number of all changes ever made.
    changes: u64,
}

impl Stamp {
    pub(super) fn of(scene: &Scene) -> Self {
        Self { scene: scene.tag(), changes: scene.static_changes().end() }
    }

    /// The changes of static objects of a scene since; `None` if they are too many, or if it is
    /// another scene.
    pub(super) fn changes<'a>(
        &self,
        scene: &'a Scene,
    ) -> Option<impl Iterator<Item = StaticChange> + use<'a>> {
        let own = scene.tag() == self.scene;
        own.then(|| scene.static_changes().since(self.changes)).flatten()
    }

    /// The slots of the static objects that changed since, in order; `None` as for
    /// [`Stamp::changes`].
    pub(super) fn changed_slots(&self, scene: &Scene) -> Option<Vec<Slot>> {
        let mut slots: Vec<Slot> = self.changes(scene)?.map(|change| change.slot()).collect();
        slots.sort_unstable();
        slots.dedup();
        Some(slots)
    }
}

/// A result that is kept.
#[derive(Debug, Clone)]
pub(super) struct Still {
    /// The query of the widened view.
    query: Box<Query>,
    view: View,
    stamp: Stamp,
    objects: Vec<InSight>,
    /// The objects on whose occluders the buffers may rest.
    offered: Offered,
    /// How often pixels were opened again, on average.
    opened: f64,
    watch: Watch,
    /// The buffers with the dynamic occluders of a frame.
    overlay: DrawingScratch,
    /// Memory used again: the dynamic objects whose boxes a frame may see.
    movers: Vec<SeenMover>,
}

/// Whether a result of a widened view holds for a view.
pub(super) fn serves(widened: &View, scene: &Scene, view: &View) -> bool {
    if widened.layers() != view.layers() {
        return false;
    }
    if view.eye().is_none() {
        return widened == view;
    }
    let (min, max) = scene.extent();
    widened.reaches(view) && widened.covers_starts(view) && widened.contains(view, min, max)
}

impl Still {
    /// Runs a query of a widened view on the static objects of a scene. `stamp` is that of the
    /// scene, or of the one that it is a copy of.
    pub(super) fn find(mut query: Box<Query>, scene: &Scene, view: View, stamp: Stamp) -> Self {
        query.run_with(scene, &view, Extras { fixed_only: true, ..Extras::default() });
        let in_sight = |id: ObjectId| InSight { id, block: scene.object(id.slot()).bounds().block() };
        let objects = query.pvs().iter().map(in_sight).collect();
        let (watch, overlay, movers) = (Watch::default(), DrawingScratch::default(), Vec::new());
        let mut offered = Offered::default();
        offered.append(&query.drawn().offered);
        Self { query, view, stamp, objects, offered, opened: 0.0, watch, overlay, movers }
    }

    /// The query, to be run again.
    pub(super) fn into_query(self) -> Box<Query> {
        self.query
    }

    /// The work of the query of the widened view.
    pub(super) fn stats(&self) -> &Stats {
        self.query.pvs().stats()
    }

    /// The buffers of the static occluders.
    pub(super) fn drawn(&self) -> &DrawingScratch {
        self.query.drawn()
    }

    /// Whether the static objects of a scene are as they were.
    pub(super) fn is_of(&self, scene: &Scene) -> bool {
        self.stamp == Stamp::of(scene)
    }

    /// Whether the result can be brought up to date with a scene at less cost than that of a new
    /// one.
    pub(super) fn can_follow(&self, scene: &Scene) -> bool {
        self.is_of(scene) || self.opened <= MOST_OPENED && self.stamp.changes(scene).is_some()
    }

    /// Whether the result, brought up to date, holds for a view of a scene as it is now.
    pub(super) fn holds(&self, scene: &Scene, view: &View) -> bool {
        self.can_follow(scene) && serves(&self.view, scene, view)
    }

    /// Brings the result up to date with a scene that it can follow.
    pub(super) fn follow(&mut self, scene: &Scene) {
        if self.is_of(scene) {
            return;
        }
        let Some(slots) = self.stamp.changed_slots(scene) else { return };
        let changed = |slot: Slot| slots.binary_search(&slot).is_ok();
        let mut changes = StaticChanges::default();
        let gone = self.stamp.changes(scene).into_iter().flatten();
        let gone = gone.filter(|change| self.offered.has(change.slot()));
        changes.gone.extend(gone.filter_map(|change| change.occluder()));
        self.offered.forget(&slots);
        self.objects.retain(|object| !changed(object.id.slot()));
        let is_there = |slot: &Slot| scene.living_at(*slot).is_some_and(Object::is_static);
        changes.fresh.extend(slots.iter().copied().filter(is_there));
        self.stamp = Stamp::of(scene);
        if changes.fresh.is_empty() && changes.gone.is_empty() {
            return;
        }
        changes.known.extend(self.objects.iter().map(|object| object.id.slot()));
        self.opened += self.query.follow(scene, &self.view, &changes, &self.offered);
        let in_sight = |id: ObjectId| InSight { id, block: scene.object(id.slot()).bounds().block() };
        self.objects.extend(self.query.pvs().iter().map(in_sight));
        self.offered.append(&self.query.drawn().offered);
        let hides = |&slot: &Slot| scene.object(slot).occluder().is_some();
        if changes.fresh.iter().any(hides) {
            let drawn = self.query.drawn();
            self.objects.retain(|object| !drawn.hides(&object.block));
        }
        if !changes.gone.is_empty() {
            self.watch = Watch::default();
        }
    }

    /// Fills a set with the objects that a view may see for which the result holds. Static ones
    /// come first.
    pub(super) fn answer(&mut self, scene: &Scene, view: &View, pvs: &mut Pvs) {
        self.watch.update(&Drawn { scene, view: &self.view, query: &self.query });
        let mut movers = std::mem::take(&mut self.movers);
        movers.clear();
        self.find_movers(scene, view, pvs, &mut movers);
        let hides = |mover: &&SeenMover| mover.located && scene.object(mover.slot).occluder().is_some();
        let slots = movers.iter().filter(hides).map(|mover| mover.slot);
        let occluders = self.overlay.draw_over(self.query.drawn(), scene, &self.view, slots);
        let (overlay, drawn, covered) = (&self.overlay, self.query.drawn(), occluders > 0);
        let hidden = |slot: Slot| covered && overlay.hides_bounds(scene.object(slot).bounds());
        let hidden_mover = |slot: Slot| {
            if covered { hidden(slot) } else { drawn.hides_bounds(scene.object(slot).bounds()) }
        };
        pvs.stats.occluders_drawn += occluders;
        pvs.stats.objects_tested += self.objects.len() as u32;
        for InSight { id, block } in &self.objects {
            if view.may_see_volume(block) && !hidden(id.slot()) {
                pvs.push(*id);
            }
        }
        for &SeenMover { slot, located } in &movers {
            if !(located && hidden_mover(slot)) {
                pvs.push(scene.id(slot));
            }
        }
        self.movers = movers;
    }

    /// Lists the dynamic objects whose boxes a view may see before static occluders, and reveals
    /// volumes in its sight.
    fn find_movers(&self, scene: &Scene, view: &View, pvs: &mut Pvs, movers: &mut Vec<SeenMover>) {
        for (slot, _) in scene.movers_outside_volumes().filter(|(_, object)| object.is_shown(view)) {
            movers.extend(self.find_mover(scene, view, slot, &mut pvs.stats));
        }
        for &slot in self.watch.slots().iter().filter(|&&slot| scene.is_hidden(slot)) {
            // Parallel rays stay as they are: their volumes are in sight.
            if view.eye().is_none() || view.may_see_volume(&scene.volume_block(slot)) {
                pvs.stats.tbvs_revealed += 1;
                pvs.revealed.push(scene.id(slot));
                movers.extend(self.find_mover(scene, view, slot, &mut pvs.stats));
            }
        }
    }

    /// A dynamic object, if a view may see its box before static occluders where it is now.
    fn find_mover(&self, scene: &Scene, view: &View, slot: Slot, stats: &mut Stats) -> Option<SeenMover> {
        let object = scene.object(slot);
        if scene.is_unlocated(slot) || object.is_hidden_unreported() {
            return Some(SeenMover { slot, located: false });
        }
        stats.objects_tested += 1;
        if !view.may_see(object.bounds()) {
            return None;
        }
        stats.occlusion_tests += 1;
        (!self.query.drawn().hides(&object.bounds().block())).then_some(SeenMover { slot, located: true })
    }
}
