//! The light of lamps and suns: which still entities lie in it, kept until one of them changes.
//!
//! What moves and hides nothing changes nothing for others. So it counts as lit where it is in
//! reach, and a query is run anew only after another change there.

use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_math::{Affine3A, Mat3A, Vec3A};
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
    pub(crate) aim: Aim,
    query: Query,
    /// The entities in the light that do not move.
    lit: Vec<Entity>,
    /// Whether that holds, and the last frame for which it did or was found not to.
    holds: bool,
    frame: u32,
    /// The frame in which the query ran.
    ran: u32,
}

impl Beam {
    /// The entities that may cast shadows; `None` where that is not known.
    pub(crate) fn casters(&self, movers: &EntityHashMap<Mover>) -> Option<impl Iterator<Item = Entity>> {
        let near = movers.iter().filter(|(_, mover)| self.aim.reach.overlaps(&mover.around));
        let near = near.map(|(entity, _)| *entity);
        self.holds.then(|| self.lit.iter().copied().chain(near))
    }

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

/// A light, and for suns the camera for which it shines.
pub(crate) type Key = (Entity, Entity);

pub(crate) type Beams = HashMap<Key, Beam>;

/// Brings the beams of some lights up to date, and forgets others.
pub(crate) fn shine(
    beams: &mut Beams,
    (scene, changes, frame): (Option<&Scene>, &Changes, u32),
    options: PointOptions,
    aims: Vec<(Key, Aim)>,
    moves: impl Fn(Entity) -> bool,
) {
    let mut old = std::mem::take(beams);
    let Some(scene) = scene else { return };
    // Results that are kept should be as small as they get.
    let method = Method::Point(options.coherent(false));
    let mut jobs: Vec<(Key, Beam)> = Vec::new();
    for (key, aim) in aims {
        let (mut query, mut lit) = (Query::new(), Vec::new());
        if let Some(beam) = old.remove(&key) {
            let held = beam.holds && beam.frame.wrapping_add(1) == frame && beam.query.method() == method;
            let holds = held && beam.aim == aim && !changes.reach(&aim.reach);
            if holds || changes.everywhere || frame.wrapping_sub(beam.ran) < beam.pause() {
                beams.insert(key, Beam { aim, holds, frame, ..beam });
                continue;
            }
            (query, lit) = (beam.query, beam.lit);
        } else if changes.everywhere {
            // While a level loads, no result would hold until the next frame.
            continue;
        }
        if query.method() == method || query.set_method(method).is_ok() {
            lit.clear();
            jobs.push((key, Beam { aim, query, lit, holds: true, frame, ran: frame }));
        }
    }
    each(&mut jobs, &|(_, beam)| _ = beam.query.run(scene, &beam.aim.view));
    for (_, beam) in &mut jobs {
        let found = beam.query.pvs().visible().iter();
        let found = found.filter_map(|&id| Entity::try_from_bits(scene.user_data(id).ok()?));
        beam.lit.extend(found.filter(|&entity| !moves(entity)));
    }
    beams.extend(jobs);
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
