//! The light of lamps and suns: which still entities lie in it, kept until one of them changes.
//!
//! What moves and hides nothing changes nothing for others. So it counts as lit where it is in
//! reach, and a query is run anew only after another change there.

use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_math::{Affine3A, IVec2, Mat3A, Vec3A};
use bevy_platform::collections::HashMap;
use bevy_tasks::ComputeTaskPool;
use casca::{Method, PointOptions, Query, Scene, View};

/// A light whose query finds this many entities is asked once a frame at most, one with twice as many
/// in every second frame, and so on, up to a second.
const LIT_A_FRAME: usize = 256;
const LONGEST_PAUSE: usize = 64;

/// More changes than this in a frame count as changes everywhere.
const MOST_CHANGES: usize = 256;

/// Where something changed in a frame, but for what moves and hides nothing.
#[derive(Debug, Default)]
pub(crate) struct Changes {
    boxes: Vec<(Vec3A, Vec3A)>,
    pub(crate) everywhere: bool,
}

impl Changes {
    /// Notes a box, from corner to corner.
    pub(crate) fn note(&mut self, changed: (Vec3A, Vec3A)) {
        self.everywhere |= self.boxes.len() >= MOST_CHANGES;
        if !self.everywhere {
            self.boxes.push(changed);
        }
    }

    fn reach(&self, reach: &Reach) -> bool {
        self.everywhere || self.boxes.iter().any(|changed| reach.overlaps(changed))
    }
}

/// A box that a light shines into, along axes of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reach {
    pub(crate) to_axes: Mat3A,
    /// Along these axes.
    pub(crate) middle: Vec3A,
    pub(crate) half: Vec3A,
}

impl Reach {
    /// Whether a box along the world's axes may lie in it; in doubt, it does.
    fn overlaps(&self, &(min, max): &(Vec3A, Vec3A)) -> bool {
        let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let apart = (self.to_axes * middle - self.middle).abs();
        !apart.cmpgt(self.half + self.to_axes.abs() * half).any()
    }
}

/// A view of all that a light shines on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Aim {
    pub(crate) view: View,
    pub(crate) reach: Reach,
}

/// The result of a query.
#[derive(Debug)]
pub(crate) struct Beam {
    aim: Aim,
    /// The entities in the light that do not move.
    lit: Vec<Entity>,
    /// Whether that holds, and the last frame for which it did or was found not to.
    holds: bool,
    frame: u32,
    /// The frame in which the query ran.
    ran: u32,
}

impl Beam {
    /// Frames from one query to the next one: where much is lit, that takes long.
    fn pause(&self) -> u32 {
        (self.lit.len() / LIT_A_FRAME).min(LONGEST_PAUSE) as u32
    }
}

/// An entity that moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mover {
    /// The frame from which on it counts as still if it stays.
    pub(crate) rests: u32,
    /// The corners of a box around it.
    pub(crate) around: (Vec3A, Vec3A),
    /// Where it was last.
    pub(crate) at: Affine3A,
}

/// A light; for suns the camera for which it shines, and the tile of its light.
pub(crate) type Key = (Entity, Entity, IVec2);

/// The beams of some lights.
#[derive(Debug, Default)]
pub(crate) struct Beams {
    beams: HashMap<Key, Beam>,
    /// Memory of queries that ran.
    queries: Vec<Query>,
}

impl Beams {
    pub(crate) fn clear(&mut self) {
        self.beams.clear();
    }

    /// The frame in which a beam was asked, if it was.
    pub(crate) fn ran(&self, key: &Key) -> Option<u32> {
        self.beams.get(key).map(|beam| beam.ran)
    }

    /// Brings the beams up to date by no more than `most` queries, in the order in which they are wanted,
    /// and forgets others.
    pub(crate) fn shine(
        &mut self,
        (scene, changes, frame): (Option<&Scene>, &Changes, u32),
        options: PointOptions,
        wanted: Vec<(Key, Aim)>,
        most: usize,
        movers: &EntityHashMap<Mover>,
    ) {
        // Results that are kept should be as small as they get.
        let options = options.coherent(false);
        let mut old = std::mem::take(&mut self.beams);
        let Some(scene) = scene else { return };
        let mut jobs: Vec<(Key, Beam, Query)> = Vec::new();
        for (key, aim) in wanted {
            let old = old.remove(&key);
            let is_known = old.is_some();
            let none = || Beam { aim: aim.clone(), lit: Vec::new(), holds: false, frame, ran: frame };
            let beam = old.unwrap_or_else(none);
            let held = beam.holds && beam.frame.wrapping_add(1) == frame;
            let holds = held && beam.aim == aim && !changes.reach(&aim.reach);
            // While a level loads, no result would hold until the next frame; nor does one of a sun that turns.
            let turned = beam.aim.reach.to_axes != aim.reach.to_axes;
            let waits = is_known && frame.wrapping_sub(beam.ran) < beam.pause();
            if holds || changes.everywhere || turned || waits || jobs.len() >= most {
                self.beams.insert(key, Beam { aim, holds, frame, ..beam });
                continue;
            }
            let mut query = self.queries.pop().unwrap_or_default();
            if query.set_method(Method::Point(options)).is_ok() {
                jobs.push((key, Beam { aim, holds: true, frame, ran: frame, ..beam }, query));
            }
        }
        each(&mut jobs, &|(_, beam, query)| _ = query.run(scene, &beam.aim.view));
        for (key, mut beam, query) in jobs {
            let found = query.pvs().visible().iter();
            let found = found.filter_map(|&id| Entity::try_from_bits(scene.user_data(id).ok()?));
            beam.lit.clear();
            beam.lit.extend(found.filter(|entity| !movers.contains_key(entity)));
            self.beams.insert(key, beam);
            self.queries.push(query);
        }
    }

    /// The entities in the light of some beams that may cast shadows, with those in reach that move;
    /// `None` where that is not known.
    pub(crate) fn casters(
        &self,
        keys: &[Key],
        reach: &Reach,
        movers: &EntityHashMap<Mover>,
    ) -> Option<Vec<Entity>> {
        let mut out = Vec::new();
        for key in keys {
            out.extend(&self.beams.get(key).filter(|beam| beam.holds)?.lit);
        }
        // What lies in two tiles is in two lists.
        out.sort_unstable();
        out.dedup();
        let near = movers.iter().filter(|(_, mover)| reach.overlaps(&mover.around));
        out.extend(near.map(|(entity, _)| *entity));
        Some(out)
    }
}

/// Does something to each, by Bevy's compute tasks if there are several.
pub(crate) fn each<T: Send>(all: &mut [T], does: &(impl Fn(&mut T) + Sync)) {
    if all.len() < 2 {
        return all.iter_mut().for_each(does);
    }
    ComputeTaskPool::get_or_init(Default::default).scope(|scope| {
        all.iter_mut().for_each(|one| scope.spawn(async move { does(one) }));
    });
}
