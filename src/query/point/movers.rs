//! Small moving objects, of which there may be very many in sight.
//!
//! They hide nothing, so that nothing is gained by testing them before all occluders are drawn.
//! Their zones are tested then: most are out of sight, hidden, or in the open, with all that is in
//! them. In the others, most objects are found visible by one pixel: that of the middle of their
//! box, which lies in them. None of that looks at the object itself, only at its box in the scene's
//! array ([`crate::scene::Scene::boxes`]).

use casca_slots::Slot;

use crate::geometry::Block;
use crate::id::ObjectId;
use crate::query::point::decide::Candidate;
use crate::query::point::planes::{BoxSide, Planes};
use crate::query::point::{PointWalk, WalkScratch};
use crate::scene::Zone;

/// A zone with fewer objects is not tested itself.
const WORTH_TESTING: usize = 3;

/// What a query may say of all objects of a zone at once.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outlook {
    /// None of them is in sight.
    Hidden,
    /// All of them are, if views show them.
    Open,
    /// Each is tested by its box. `BoxSide::Inside` if all are inside the frustum.
    Mixed(BoxSide),
    /// The eye is among them: each is tested as other objects are.
    Close,
}

impl PointWalk<'_> {
    /// Finds the small moving objects that are in sight of all that was drawn. Those that need no
    /// further test are listed apart.
    pub(super) fn find_movers(&mut self) {
        let scene = self.run.scene;
        if self.run.fixed_only || self.run.view.layers() == 0 || scene.movers().zones().is_empty() {
            return;
        }
        self.drawing.buffers_mut().read_clear();
        let planes = Planes::new(self.run.view, scene.grid());
        let mut order = std::mem::take(&mut self.scratch.zones);
        order.clear();
        for (index, zone) in scene.movers().zones().iter().enumerate() {
            if zone.plain().len() + zone.others().len() > 0 && self.run.view.may_see_volume(zone.room()) {
                order.push((self.distance(zone.room()), index as u32));
            }
        }
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(_, index) in &order {
            self.zone(&scene.movers().zones()[index as usize], &planes);
        }
        self.scratch.zones = order;
        self.settle();
    }

    /// Finds the objects of a zone in the frustum.
    fn zone(&mut self, zone: &Zone, planes: &Planes) {
        let outlook = self.outlook(zone, planes);
        if outlook == Outlook::Hidden {
            return;
        }
        // Layers, forms with holes in their middles.
        zone.others().iter().for_each(|&slot| self.find(slot));
        match outlook {
            Outlook::Open => {
                self.drawing.stats.objects_tested += zone.plain().len() as u32;
                let ids = zone.plain().iter().map(|&id| ObjectId(id));
                if self.run.scene.any_overdue() {
                    self.scratch.movers.extend(ids.filter(|id| !self.marks.is_decided(id.slot())));
                } else {
                    self.scratch.movers.extend(ids);
                }
            }
            Outlook::Mixed(side) => self.test_boxes(zone, side, planes),
            Outlook::Hidden | Outlook::Close => zone.plain().iter().for_each(|id| self.find(id.slot())),
        }
    }

    /// What may be said of all objects of a zone in the frustum.
    fn outlook(&self, zone: &Zone, planes: &Planes) -> Outlook {
        let room = zone.room();
        let reach = self.run.view.eye_box();
        let around = Block { min: room.min - reach, max: room.max + reach };
        // A coherent run asks more of its objects.
        let close = self.run.coherent || self.run.view.eye().is_some_and(|eye| around.contains_point(eye));
        let worth = zone.plain().len() + zone.others().len() >= WORTH_TESTING;
        if worth && self.drawing.hides(room) {
            return Outlook::Hidden;
        }
        let side = planes.side_of(room);
        if close {
            Outlook::Close
        } else if worth && side == BoxSide::Inside && self.drawing.buffers().is_clear_block(room) {
            Outlook::Open
        } else {
            Outlook::Mixed(side)
        }
    }

    /// Tests the boxes of objects. Those before all occluders are found visible, those that may lie
    /// behind one are tested with the others.
    fn test_boxes(&mut self, zone: &Zone, zone_side: BoxSide, planes: &Planes) {
        let scene = self.run.scene;
        let WalkScratch { movers, candidates, .. } = &mut *self.scratch;
        let (buffers, mut tested) = (self.drawing.buffers(), 0);
        let origin = buffers.origin().as_vec3a();
        // Those that are overdue were found as such.
        let any_overdue = scene.any_overdue();
        for &id in zone.plain() {
            if any_overdue && self.marks.is_decided(id.slot()) {
                continue;
            }
            let own = scene.boxes().of(id.slot());
            let (min, max) = own.corners();
            let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5);
            let side = if zone_side == BoxSide::Inside { zone_side } else { planes.side(middle, half) };
            let sees = |slot: Slot| self.run.view.may_see(scene.object(slot).bounds());
            if side == BoxSide::Outside || side == BoxSide::Crosses && !sees(id.slot()) {
                continue;
            }
            tested += 1;
            if buffers.is_clear(middle - origin) {
                movers.push(ObjectId(id));
            } else {
                let block = Some(own.block());
                candidates.push(Candidate { slot: id.slot(), block, is_centered: true, occludes: false });
            }
        }
        self.drawing.stats.objects_tested += tested;
    }
}
