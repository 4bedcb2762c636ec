//! A tick: all clients are answered.

use std::collections::{BTreeMap, BTreeSet};

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::answer::Answer;
use crate::entity::Team;
use crate::error::{ServerError, time};
use crate::id::{ClientId, EntityId};
use crate::numeric::STEP;
use crate::plane::client::{PlaneClient, PlaneState};
use crate::plane::entity::{PlaneBody, PlaneEntity};
use crate::plane::ground::{Ground, Tile};
use crate::plane::options::PlaneOptions;
use crate::plane::server::PlaneServer;
use crate::plane::sights::{Key, Sights, Window};

/// An entity may be in so many tiles: one that may be in more is told to all.
const MOST_TAKEN: usize = 4096;

/// The tiles of each entity, in their order; none if it may be anywhere.
type Places = Vec<Option<Vec<Tile>>>;

/// What all clients share in a tick.
struct Moment<'a, H> {
    sights: &'a Sights,
    entities: &'a [(EntityId, &'a PlaneBody)],
    /// By the time ahead, in steps.
    places: &'a BTreeMap<u64, Places>,
    hook: &'a H,
}

impl PlaneServer {
    /// Answers all clients at the time `now`: the answers, in the order of clients.
    ///
    /// Costs each client the words of its view once for each tile that its eye may be in, and some
    /// nanoseconds for each tile of each entity; and some microseconds for each tile of an eye that
    /// was not looked from lately. With the feature `rayon`, clients are shared among the threads
    /// of rayon's current pool; answers do not depend on their number.
    ///
    /// # Errors
    /// Refuses a time that is not finite, or before that of the last tick. No answer changes then.
    pub fn tick(&mut self, now: f64) -> Result<Vec<&Answer>, ServerError> {
        self.tick_with(now, |_, _| false)
    }

    /// As [`PlaneServer::tick`], where a client is also told of the entities for which `hook` is
    /// true: of those that it hears, for example. It is asked by several threads.
    ///
    /// # Errors
    /// As [`PlaneServer::tick`].
    pub fn tick_with<H>(&mut self, now: f64, hook: H) -> Result<Vec<&Answer>, ServerError>
    where
        H: Fn((ClientId, &PlaneClient), (EntityId, &PlaneEntity)) -> bool + Sync,
    {
        time("the time of a tick", now, self.now)?;
        (self.now, self.ticks) = (now, self.ticks + 1);
        self.take_sides();
        let options = self.options;
        let ground = Ground { opaque: &self.map, walls_stop: options.walls_stop };
        let eyes: Vec<Option<Vec<Key>>> =
            self.clients.values().map(|state| eyes(ground, state, now, &options)).collect();
        let all: BTreeSet<Key> = eyes.iter().flatten().flatten().copied().collect();
        self.sights.find(&self.map, &all, self.ticks, options.memory)?;

        let entities: Vec<(EntityId, &PlaneBody)> =
            self.entities.iter().map(|(slot, entity)| (EntityId(self.entities.id(slot)), entity)).collect();
        let times = self.clients.values().map(|state| steps(state.time_ahead(now, &options).0));
        let times: BTreeSet<u64> = times.collect();
        let place = |steps: u64, body: &PlaneBody| {
            let reach = body.reach(now, steps as f64 * STEP);
            ground.taken(body.desc.place, body.desc.half, reach, MOST_TAKEN)
        };
        #[cfg(feature = "rayon")]
        let in_turn = entities.par_iter();
        #[cfg(not(feature = "rayon"))]
        let in_turn = entities.iter();
        let all_at = |steps: u64| in_turn.clone().map(|(_, body)| place(steps, body)).collect();
        let places = times.into_iter().map(|steps| (steps, all_at(steps))).collect();
        let moment = Moment { sights: &self.sights, entities: &entities, places: &places, hook: &hook };
        let mut states: Vec<(&mut PlaneState, Option<Vec<Key>>)> =
            self.clients.values_mut().zip(eyes).collect();
        let see = |(state, eyes): &mut (&mut PlaneState, Option<Vec<Key>>)| {
            let (seconds, is_stale) = state.time_ahead(now, &options);
            let told = told(state, eyes.as_deref(), steps(seconds), &moment);
            state.before = std::mem::replace(&mut state.answer.told, told);
            state.answer.reach = state.reach(now, &options);
            state.answer.is_stale = is_stale;
            state.answer.is_fresh = std::mem::take(&mut state.jumped);
        };
        #[cfg(feature = "rayon")]
        states.par_iter_mut().for_each(see);
        #[cfg(not(feature = "rayon"))]
        states.iter_mut().for_each(see);
        let mut states: Vec<&mut PlaneState> = states.into_iter().map(|(state, _)| state).collect();
        if options.teams_share {
            share(&mut states);
        }
        states.iter_mut().for_each(|state| state.answer.compare(&state.before));
        Ok(self.clients.values().map(|state| &state.answer).collect())
    }

    /// Finds the teams of entities that have that of their owners. Owners that left are forgotten.
    fn take_sides(&mut self) {
        let slots: Vec<_> = self.entities.iter().map(|(slot, _)| slot).collect();
        for slot in slots {
            let Some(entity) = self.entities.get_mut(slot) else { continue };
            let known =
                entity.desc.owner.and_then(|owner| Some((owner, self.clients.get(&owner)?.desc.team)));
            entity.desc.owner = known.map(|(owner, _)| owner);
            entity.side = entity.desc.team.or(known.and_then(|(_, team)| team));
        }
    }
}

/// The number of steps that a time is rounded up to.
fn steps(seconds: f64) -> u64 {
    (seconds / STEP).ceil() as u64
}

/// Where the eye of a client may be; `None` if in too many tiles.
fn eyes(ground: Ground, state: &PlaneState, now: f64, options: &PlaneOptions) -> Option<Vec<Key>> {
    let (tiles, _) = ground.reached(state.desc.eye, state.reach(now, options), options.most_tiles)?;
    Some(tiles.into_iter().map(|tile| (tile, state.desc.radius.to_bits())).collect())
}

/// All entities that a client is told of.
fn told<H>(state: &PlaneState, eyes: Option<&[Key]>, steps: u64, moment: &Moment<H>) -> Vec<EntityId>
where
    H: Fn((ClientId, &PlaneClient), (EntityId, &PlaneEntity)) -> bool,
{
    let (client, desc) = (state.answer.client, &state.desc);
    // Who may be in too many tiles sees all, and so does one whose view was not found.
    let windows: Option<Vec<&Window>> =
        eyes.and_then(|eyes| eyes.iter().map(|key| moment.sights.get(key)).collect());
    let seen = windows.map(|windows| Window::union(&windows));
    let places = moment.places.get(&steps).into_iter().flatten();
    let is_told = |(id, body): (EntityId, &PlaneBody), place: &Option<Vec<Tile>>| {
        let visible = match (&seen, place) {
            (Some(seen), Some(tiles)) => tiles.iter().any(|tile| seen.has(*tile)),
            _ => true,
        };
        let own = body.desc.owner == Some(client) || desc.team.is_some_and(|team| body.side == Some(team));
        visible || own || (moment.hook)((client, desc), (id, &body.desc))
    };
    let all = moment.entities.iter().zip(places).filter(|(entity, place)| is_told(**entity, place));
    all.map(|((id, _), _)| *id).collect()
}

/// Tells clients of a team what any of them is told of.
fn share(states: &mut [&mut PlaneState]) {
    let mut teams: BTreeMap<Team, BTreeSet<EntityId>> = BTreeMap::new();
    for state in states.iter() {
        if let Some(team) = state.desc.team {
            teams.entry(team).or_default().extend(&state.answer.told);
        }
    }
    for state in states {
        if let Some(told) = state.desc.team.and_then(|team| teams.get(&team)) {
            state.answer.told = told.iter().copied().collect();
        }
    }
}
