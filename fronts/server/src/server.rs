//! The server: clients and entities, their reports, and what clients are told, from tick to tick.

use std::collections::{BTreeMap, BTreeSet};

use casca::glam::Vec3;
use casca::{Aabb, Scene};
use casca_slots::Slots;
use casca_walls::Span;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::baked::BakedFile;
use crate::describe::{ClientDesc, EntityDesc, Team};
use crate::error::{ServerError, time, within};
use crate::id::{ClientId, EntityId};
use crate::numeric::{FASTEST, ROUNDING, STEP, at_least, at_most};
use crate::options::ServerOptions;
use crate::space::{Kept, Reached, Space, check_bounds, check_place, reached};

/// Finds, tick by tick, which entities each client may be told of.
///
/// See the [crate] for what it promises. Times are seconds of one clock of the caller's, which must
/// not run backwards. Lengths are metres.
#[derive(Debug)]
pub struct VisibilityServer {
    space: Space,
    options: ServerOptions,
    ids: Slots<()>,
    clients: BTreeMap<ClientId, Client>,
    entities: Slots<Entity>,
    /// The time of the last tick.
    now: f64,
}

/// What one client is told in a tick. Lists are in the order of ids.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Answer {
    /// The client.
    pub client: ClientId,
    /// All entities that it is told of.
    pub told: Vec<EntityId>,
    /// Those that it was not told of in the tick before.
    pub new: Vec<EntityId>,
    /// Those that it was told of in the tick before, and must forget: also those that were removed.
    pub forgotten: Vec<EntityId>,
    /// How far its eye may be from where it was reported, in metres.
    pub reach: f64,
    /// Whether it is the first answer, or the eye jumped farther than its speed allows: whatever it
    /// knew may be wrong, so tell it all of [`Answer::told`].
    pub is_fresh: bool,
    /// Whether its last report is older than [`ServerOptions::most_age`], so that entities may be
    /// told late: drop the client, or stop its eye.
    pub is_stale: bool,
}

impl Answer {
    fn new(client: ClientId) -> Self {
        let (told, new, forgotten) = (Vec::new(), Vec::new(), Vec::new());
        Self { client, told, new, forgotten, reach: 0.0, is_fresh: true, is_stale: false }
    }

    /// Takes over a new list, and finds what changed.
    fn compare(&mut self, told: Vec<EntityId>) {
        let before = std::mem::replace(&mut self.told, told);
        let lacks = |list: &[EntityId], id: &EntityId| list.binary_search(id).is_err();
        self.new.clear();
        self.new.extend(self.told.iter().filter(|id| lacks(&before, id)));
        self.forgotten.clear();
        self.forgotten.extend(before.iter().filter(|id| lacks(&self.told, id)));
    }
}

/// A client, with all that the server keeps about it from tick to tick.
#[derive(Debug)]
struct Client {
    desc: ClientDesc,
    /// When its last report came.
    time: f64,
    /// Whether the eye jumped since the last tick.
    jumped: bool,
    answer: Answer,
    kept: Kept,
}

/// An entity, with its last report.
#[derive(Debug)]
struct Entity {
    desc: EntityDesc,
    /// When it was where it is.
    time: f64,
    /// Where it may have been when walls came, and when that was; at first as it is.
    since: (Aabb, f64),
    /// Its team or that of its owner.
    side: Option<Team>,
}

impl Client {
    /// For how long the eye and all entities may move until the next answer counts, in seconds; and
    /// whether the last report is too old.
    fn time_ahead(&self, now: f64, options: &ServerOptions) -> (f64, bool) {
        let (age, most) = ((now - self.time).max(0.0), f64::from(options.most_age));
        (f64::from(self.desc.latency) + f64::from(options.tick) + age.min(most), age > most)
    }
}

/// The number of steps that a time is rounded up to.
fn steps(seconds: f64) -> u64 {
    (seconds / STEP).ceil() as u64
}

impl VisibilityServer {
    /// A server for a level: a scene whose static objects hide entities. Dynamic objects hide
    /// nothing. The objects of the level are not told of.
    ///
    /// # Errors
    /// Refuses options that are out of their ranges.
    pub fn new(level: Scene, options: ServerOptions) -> Result<Self, ServerError> {
        options.check()?;
        let (ids, clients, entities) = (Slots::new(), BTreeMap::new(), Slots::new());
        let space = Space::new(level, options.walls);
        Ok(Self { space, options, ids, clients, entities, now: f64::MIN })
    }

    /// The level.
    pub fn level(&self) -> &Scene {
        &self.space.level
    }

    /// The level, to be changed: what comes, goes or moves counts from the next tick on, which
    /// costs a pass over all of it, and baked sets are given up. A door that closes is an object
    /// with an occluder that comes. Who was reported before that tick may have passed it.
    pub fn level_mut(&mut self) -> &mut Scene {
        self.space.change();
        self.forget_baked();
        &mut self.space.level
    }

    /// Takes a file of sets from cell to cell, by `casca bake --cell-to-cell` or the library
    /// casca-bake, as a first filter: a pair of a client and an entity of which it tells that the
    /// cells of the one see none of those of the other is withheld without another test. All the
    /// file's occluders must be static objects of the level. It counts only with
    /// [`ServerOptions::walls`]: its eyes keep out of solid objects. Costs a check of all of it.
    ///
    /// # Errors
    /// Refuses bytes that are no such file; the server keeps the file that it had.
    pub fn set_baked(&mut self, file: Vec<u8>) -> Result<(), ServerError> {
        let file = BakedFile::read(file)?;
        self.forget_baked();
        self.space.baked = Some(file);
        Ok(())
    }

    /// Whether there are baked sets, and they count.
    pub fn has_baked(&self) -> bool {
        self.space.baked.is_some() && self.space.uses_walls
    }

    fn forget_baked(&mut self) {
        self.space.baked = None;
        self.clients.values_mut().for_each(|client| client.kept.seen_cells.forget());
    }

    /// How many walls the level has, since the last tick: see [`ServerOptions::walls`].
    pub fn wall_count(&self) -> usize {
        self.space.walls.len()
    }

    /// Whether a wall stands between two places, as far as known since the last tick: to refuse
    /// reports of eyes that went through one. Who is in the plane of a wall only touches it; from
    /// one face of a wall to the other is through it.
    pub fn has_wall_between(&self, from: Vec3, to: Vec3) -> bool {
        self.space.walls.part(from.as_dvec3(), to.as_dvec3())
    }

    /// Adds a client, whose eye is at its place at the time `now`.
    ///
    /// # Errors
    /// Refuses numbers that are out of their ranges or not finite, and more clients than
    /// [`ServerOptions::most_clients`].
    pub fn add_client(&mut self, desc: ClientDesc, now: f64) -> Result<ClientId, ServerError> {
        desc.check()?;
        check_place(EYE, desc.eye)?;
        time("the time of a new client", now, f64::MIN)?;
        let full = ServerError::Full { what: "clients", most: self.options.most_clients };
        if self.clients.len() >= self.options.most_clients {
            return Err(full);
        }
        let slot = self.ids.insert(()).ok_or(full)?;
        let id = ClientId(self.ids.id(slot));
        let (answer, kept) = (Answer::new(id), Kept::default());
        self.clients.insert(id, Client { desc, time: now, jumped: true, answer, kept });
        Ok(id)
    }

    /// Removes a client. Its entities stay, without an owner.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn remove_client(&mut self, id: ClientId) -> Result<(), ServerError> {
        self.clients.remove(&id).ok_or(ServerError::UnknownClient(id))?;
        self.ids.remove(id.slot());
        Ok(())
    }

    fn find(&self, id: ClientId) -> Result<&Client, ServerError> {
        self.clients.get(&id).ok_or(ServerError::UnknownClient(id))
    }

    /// What is known of a client.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn client(&self, id: ClientId) -> Result<&ClientDesc, ServerError> {
        Ok(&self.find(id)?.desc)
    }

    /// Takes a client's report that its eye is at a place; the report came at the time `now`. An
    /// eye that is farther off than its speed explains has jumped: the next answer is fresh.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, a place that is too far or not finite, and
    /// a time before that of the last report.
    pub fn move_eye(&mut self, id: ClientId, eye: Vec3, now: f64) -> Result<(), ServerError> {
        check_place(EYE, eye)?;
        let client = self.clients.get_mut(&id).ok_or(ServerError::UnknownClient(id))?;
        time("the time of a report", now, client.time)?;
        let ClientDesc { speed, latency, .. } = client.desc;
        // Reports come unevenly: one may be early by the latency, and one late.
        let seconds = now - client.time + f64::from(latency) + f64::from(self.options.tick);
        let way = (eye.as_dvec3() - client.desc.eye.as_dvec3()).length();
        client.jumped |= way > f64::from(speed) * seconds;
        (client.desc.eye, client.time) = (eye, now);
        Ok(())
    }

    /// Changes the speed of a client's eye, a second, and its latency, in seconds: as if since its last report.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, and numbers that are out of their ranges.
    pub fn set_motion(&mut self, id: ClientId, speed: f32, latency: f32) -> Result<(), ServerError> {
        let client = self.clients.get_mut(&id).ok_or(ServerError::UnknownClient(id))?;
        let desc = ClientDesc { speed, latency, ..client.desc };
        desc.check()?;
        client.desc = desc;
        Ok(())
    }

    /// Adds an entity, which is at its place at the time `now`.
    ///
    /// # Errors
    /// Refuses numbers that are out of their ranges or not finite, inverted boxes, an owner
    /// that is no client of this server, and more entities than [`ServerOptions::most_entities`].
    pub fn add_entity(&mut self, desc: EntityDesc, now: f64) -> Result<EntityId, ServerError> {
        check_speed(desc.speed)?;
        check_bounds(&desc.bounds)?;
        time("the time of a new entity", now, f64::MIN)?;
        desc.owner.map_or(Ok(()), |owner| self.find(owner).map(|_| ()))?;
        let full = ServerError::Full { what: "entities", most: self.options.most_entities };
        if self.entities.len() >= self.options.most_entities {
            return Err(full);
        }
        let slot = self
            .entities
            .insert(Entity { desc, time: now, since: (desc.bounds, now), side: None })
            .ok_or(full)?;
        Ok(EntityId(self.entities.id(slot)))
    }

    /// Moves an entity: at the time `now` it is in `bounds`.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, bounds as [`VisibilityServer::add_entity`] does,
    /// and a time before that of the last move.
    pub fn move_entity(&mut self, id: EntityId, bounds: Aabb, now: f64) -> Result<(), ServerError> {
        check_bounds(&bounds)?;
        let entity = self.entity_mut(id)?;
        time("the time of a move", now, entity.time)?;
        (entity.desc.bounds, entity.time, entity.since) = (bounds, now, (bounds, now));
        Ok(())
    }

    /// Changes the greatest speed of an entity, a second: as if since its last move.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, and a speed out of its range.
    pub fn set_speed(&mut self, id: EntityId, speed: f32) -> Result<(), ServerError> {
        check_speed(speed)?;
        self.entity_mut(id)?.desc.speed = speed;
        Ok(())
    }

    fn entity_mut(&mut self, id: EntityId) -> Result<&mut Entity, ServerError> {
        self.entity(id)?;
        self.entities.get_mut(id.slot()).ok_or(ServerError::UnknownEntity(id))
    }

    /// Removes an entity: clients that were told of it must forget it in the next tick.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server.
    pub fn remove_entity(&mut self, id: EntityId) -> Result<(), ServerError> {
        self.entity(id)?;
        self.entities.remove(id.slot());
        Ok(())
    }

    /// What is known of an entity.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server.
    pub fn entity(&self, id: EntityId) -> Result<&EntityDesc, ServerError> {
        self.entities.find(id.0).map(|entity| &entity.desc).ok_or(ServerError::UnknownEntity(id))
    }

    /// All clients, in the order of their ids.
    pub fn clients(&self) -> impl Iterator<Item = (ClientId, &ClientDesc)> {
        self.clients.iter().map(|(id, client)| (*id, &client.desc))
    }

    /// All entities, in the order of their slots.
    pub fn entities(&self) -> impl Iterator<Item = (EntityId, &EntityDesc)> {
        self.entities.iter().map(|(slot, entity)| (EntityId(self.entities.id(slot)), &entity.desc))
    }

    /// The last answer to a client; it is told of nothing before the first tick.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn answer(&self, id: ClientId) -> Result<&Answer, ServerError> {
        Ok(&self.find(id)?.answer)
    }

    /// Answers all clients for the time `now`, in the order of their ids.
    ///
    /// Costs a test of some hundred nanoseconds for each pair of a client and an entity. With the
    /// feature `rayon`, clients are shared among the threads of rayon's current pool; answers do not
    /// depend on their number.
    ///
    /// # Errors
    /// Refuses a time that is not finite, or before that of the last tick. No answer changes then.
    pub fn tick(&mut self, now: f64) -> Result<Vec<&Answer>, ServerError> {
        self.tick_with(now, |_, _| false)
    }

    /// As [`VisibilityServer::tick`], where a client is also told of the entities for which `hook` is true:
    /// of those that it hears, for example. It is asked by several threads, in any order.
    ///
    /// # Errors
    /// As [`VisibilityServer::tick`].
    pub fn tick_with<H>(&mut self, now: f64, hook: H) -> Result<Vec<&Answer>, ServerError>
    where
        H: Fn((ClientId, &ClientDesc), (EntityId, &EntityDesc)) -> bool + Sync,
    {
        time("the time of a tick", now, self.now)?;
        self.now = now;
        let Self { space, options, clients, entities, .. } = self;
        let old = space.find_walls(now);
        // Owners that left are forgotten; entities without a team have that of their owners.
        for slot in entities.iter().map(|(slot, _)| slot).collect::<Vec<_>>() {
            let Some(entity) = entities.get_mut(slot) else { continue };
            if let Some(old) = &old {
                let (bounds, time) = entity.since;
                let way = f64::from(entity.desc.speed) * (now - time).clamp(0.0, f64::MAX);
                let Span { min, max } = reached(old, &bounds, way);
                let [min, max] = [min.to_array().map(at_most), max.to_array().map(at_least)];
                entity.since = (Aabb::new(min.into(), max.into()), time.max(now));
            }
            let owner = entity.desc.owner.and_then(|owner| clients.get(&owner));
            entity.desc.owner = owner.map(|owner| owner.answer.client);
            entity.side = entity.desc.team.or(owner.and_then(|owner| owner.desc.team));
        }

        // Where entities may be, by the time that they may move for, which clients share.
        let space = &*space;
        let entities: Vec<(EntityId, &Entity)> =
            entities.iter().map(|(slot, entity)| (EntityId(entities.id(slot)), entity)).collect();
        let place = |entity: &Entity, steps: u64| {
            let (bounds, time) = &entity.since;
            let seconds = steps as f64 * STEP + (now - time).clamp(0.0, f64::MAX);
            space.place(bounds, f64::from(entity.desc.speed) * seconds)
        };
        let times: BTreeSet<u64> =
            clients.values().map(|client| steps(client.time_ahead(now, options).0)).collect();
        #[cfg(feature = "rayon")]
        let in_turn = entities.par_iter();
        #[cfg(not(feature = "rayon"))]
        let in_turn = entities.iter();
        let places = |steps: u64| in_turn.clone().map(|(_, entity)| place(entity, steps)).collect();
        let places: BTreeMap<u64, Vec<Reached>> =
            times.into_iter().map(|steps| (steps, places(steps))).collect();

        let see = |client: &mut Client| {
            let (seconds, is_stale) = client.time_ahead(now, options);
            let Client { desc, time, kept, answer, .. } = client;
            let reach = f64::from(desc.speed) * seconds * (1.0 + ROUNDING);
            // The report may be older by the latency.
            let sent = *time - f64::from(desc.latency);
            let (id, mut may_see) = (answer.client, space.look(desc.eye, (reach, sent), kept));
            let all = entities.iter().zip(places.get(&steps(seconds)).into_iter().flatten());
            let told = all.filter(|((entity, about), place)| {
                about.desc.owner == Some(id)
                    || desc.team.is_some() && desc.team == about.side
                    || may_see(entity.slot().index(), place)
                    || hook((id, desc), (*entity, &about.desc))
            });
            let told = told.map(|((entity, _), _)| *entity).collect();
            client.answer.compare(told);
            (client.answer.reach, client.answer.is_stale) = (reach, is_stale);
            client.answer.is_fresh = std::mem::take(&mut client.jumped);
        };
        #[cfg(feature = "rayon")]
        clients.par_iter_mut().for_each(|(_, client)| see(client));
        #[cfg(not(feature = "rayon"))]
        clients.values_mut().for_each(see);

        Ok(clients.values().map(|client| &client.answer).collect())
    }
}

/// What errors call the place of an eye.
const EYE: &str = "the eye of a client";

fn check_speed(speed: f32) -> Result<(), ServerError> {
    within("the speed of an entity, a second,", speed, 0.0, FASTEST)
}
