//! The server: clients and entities, their reports, and what clients are told, from tick to tick.

use std::collections::{BTreeMap, BTreeSet};

use casca_slots::Slots;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::answer::Answer;
use crate::describe::{ClientDesc, EntityDesc, Team};
use crate::error::{ServerError, time, within};
use crate::id::{ClientId, EntityId};
use crate::numeric::{FASTEST, ROUNDING, STEP};
use crate::options::ServerOptions;
use crate::world::World;

/// Finds, tick by tick, which entities each client may be told of.
///
/// See the [crate] for what it promises. Times are seconds of one clock of the caller's, which must
/// not run backwards. Lengths are metres in space, and tiles on a map of tiles, on which all places
/// must be, its border included.
#[derive(Debug)]
pub struct Server<W: World> {
    pub(crate) world: W,
    options: ServerOptions,
    ids: Slots<()>,
    pub(crate) clients: BTreeMap<ClientId, Client<W>>,
    entities: Slots<Entity<W>>,
    /// The time of the last tick.
    now: f64,
    /// How many ticks there were.
    ticks: u64,
}

/// A client, with all that the server keeps about it from tick to tick.
#[derive(Debug)]
pub(crate) struct Client<W: World> {
    desc: ClientDesc<W::Eye>,
    /// When its last report came.
    time: f64,
    /// Whether the eye jumped since the last tick.
    jumped: bool,
    /// What it was told of in the tick before.
    before: Vec<EntityId>,
    answer: Answer,
    pub(crate) kept: W::Kept,
}

/// An entity, with its last report.
#[derive(Debug)]
struct Entity<W: World> {
    desc: EntityDesc<W::Bounds>,
    /// When it was where it is.
    time: f64,
    /// Its team or that of its owner.
    side: Option<Team>,
}

impl<W: World> Client<W> {
    /// For how long the eye and all entities may move until the next answer counts, in seconds; and
    /// whether the last report is too old.
    fn time_ahead(&self, now: f64, options: &ServerOptions) -> (f64, bool) {
        let (age, most) = ((now - self.time).max(0.0), f64::from(options.most_age));
        (f64::from(self.desc.latency) + f64::from(options.tick) + age.min(most), age > most)
    }

    /// How far the eye may be from where it was reported.
    fn reach(&self, now: f64, options: &ServerOptions) -> f64 {
        f64::from(self.desc.speed) * self.time_ahead(now, options).0 * (1.0 + ROUNDING)
    }
}

/// The number of steps that a time is rounded up to.
fn steps(seconds: f64) -> u64 {
    (seconds / STEP).ceil() as u64
}

impl<W: World> Server<W> {
    pub(crate) fn of(world: W, options: ServerOptions) -> Result<Self, ServerError> {
        options.check()?;
        let (ids, clients, entities) = (Slots::new(), BTreeMap::new(), Slots::new());
        Ok(Self { world, options, ids, clients, entities, now: f64::MIN, ticks: 0 })
    }

    /// The options.
    pub fn options(&self) -> &ServerOptions {
        &self.options
    }

    /// Adds a client, whose eye is at its place at the time `now`.
    ///
    /// # Errors
    /// Refuses numbers that are out of their ranges or not finite, places off the map, and more
    /// clients than [`ServerOptions::most_clients`].
    pub fn add_client(&mut self, desc: ClientDesc<W::Eye>, now: f64) -> Result<ClientId, ServerError> {
        desc.check()?;
        self.world.check_eye(&desc.eye)?;
        time("the time of a new client", now, f64::MIN)?;
        let full = ServerError::Full { what: "clients", most: self.options.most_clients };
        if self.clients.len() >= self.options.most_clients {
            return Err(full);
        }
        let slot = self.ids.insert(()).ok_or(full)?;
        let id = ClientId(self.ids.id(slot));
        let (before, answer, kept) = (Vec::new(), Answer::new(id), W::Kept::default());
        self.clients.insert(id, Client { desc, time: now, jumped: true, before, answer, kept });
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

    fn find(&self, id: ClientId) -> Result<&Client<W>, ServerError> {
        self.clients.get(&id).ok_or(ServerError::UnknownClient(id))
    }

    /// What is known of a client.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn client(&self, id: ClientId) -> Result<&ClientDesc<W::Eye>, ServerError> {
        Ok(&self.find(id)?.desc)
    }

    /// Takes a client's report that its eye is at a place; the report came at the time `now`. An
    /// eye that is farther off than its speed explains has jumped: the next answer is fresh.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, a place that is too far, off the map or
    /// not finite, and a time before that of the last report.
    pub fn move_eye(&mut self, id: ClientId, eye: W::Eye, now: f64) -> Result<(), ServerError> {
        self.world.check_eye(&eye)?;
        let client = self.clients.get_mut(&id).ok_or(ServerError::UnknownClient(id))?;
        time("the time of a report", now, client.time)?;
        let ClientDesc { speed, latency, .. } = client.desc;
        // Reports come unevenly: one may be early by the latency, and one late.
        let seconds = now - client.time + f64::from(latency) + f64::from(self.options.tick);
        client.jumped |= W::apart(&client.desc.eye, &eye) > f64::from(speed) * seconds;
        (client.desc.eye, client.time) = (eye, now);
        Ok(())
    }

    /// Changes the speed of a client's eye, a second, and its latency, in seconds.
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
    /// Refuses numbers that are out of their ranges or not finite, inverted boxes, places off the
    /// map, an owner that is no client of this server, and more entities than
    /// [`ServerOptions::most_entities`].
    pub fn add_entity(&mut self, desc: EntityDesc<W::Bounds>, now: f64) -> Result<EntityId, ServerError> {
        check_speed(desc.speed)?;
        self.world.check_bounds(&desc.bounds)?;
        time("the time of a new entity", now, f64::MIN)?;
        desc.owner.map_or(Ok(()), |owner| self.find(owner).map(|_| ()))?;
        let full = ServerError::Full { what: "entities", most: self.options.most_entities };
        if self.entities.len() >= self.options.most_entities {
            return Err(full);
        }
        let slot = self.entities.insert(Entity { desc, time: now, side: None }).ok_or(full)?;
        Ok(EntityId(self.entities.id(slot)))
    }

    /// Moves an entity: at the time `now` it is in `bounds`.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, bounds as [`Server::add_entity`] does,
    /// and a time before that of the last move.
    pub fn move_entity(&mut self, id: EntityId, bounds: W::Bounds, now: f64) -> Result<(), ServerError> {
        self.world.check_bounds(&bounds)?;
        let entity = self.entity_mut(id)?;
        time("the time of a move", now, entity.time)?;
        (entity.desc.bounds, entity.time) = (bounds, now);
        Ok(())
    }

    /// Changes the greatest speed of an entity, a second.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, and a speed out of its range.
    pub fn set_speed(&mut self, id: EntityId, speed: f32) -> Result<(), ServerError> {
        check_speed(speed)?;
        self.entity_mut(id)?.desc.speed = speed;
        Ok(())
    }

    fn entity_mut(&mut self, id: EntityId) -> Result<&mut Entity<W>, ServerError> {
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
    pub fn entity(&self, id: EntityId) -> Result<&EntityDesc<W::Bounds>, ServerError> {
        self.entities.find(id.0).map(|entity| &entity.desc).ok_or(ServerError::UnknownEntity(id))
    }

    /// All clients, in the order of their ids.
    pub fn clients(&self) -> impl Iterator<Item = (ClientId, &ClientDesc<W::Eye>)> {
        self.clients.iter().map(|(id, client)| (*id, &client.desc))
    }

    /// All entities, in the order of their slots.
    pub fn entities(&self) -> impl Iterator<Item = (EntityId, &EntityDesc<W::Bounds>)> {
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
    /// In space, costs a test of some hundred nanoseconds for each pair of a client and an entity.
    /// On a map, costs each client the words of its view once for each tile that its eye may be in,
    /// some nanoseconds for each tile of each entity, and some microseconds for each tile of an eye
    /// that was not looked from lately. With the feature `rayon`, clients are shared among the
    /// threads of rayon's current pool; answers do not depend on their number.
    ///
    /// # Errors
    /// Refuses a time that is not finite, or before that of the last tick. No answer changes then.
    pub fn tick(&mut self, now: f64) -> Result<Vec<&Answer>, ServerError> {
        self.tick_with(now, |_, _| false)
    }

    /// As [`Server::tick`], where a client is also told of the entities for which `hook` is true:
    /// of those that it hears, for example. It is asked by several threads, in any order.
    ///
    /// # Errors
    /// As [`Server::tick`].
    pub fn tick_with<H>(&mut self, now: f64, hook: H) -> Result<Vec<&Answer>, ServerError>
    where
        H: Fn((ClientId, &ClientDesc<W::Eye>), (EntityId, &EntityDesc<W::Bounds>)) -> bool + Sync,
    {
        time("the time of a tick", now, self.now)?;
        (self.now, self.ticks) = (now, self.ticks + 1);
        let Self { world, options, clients, entities, ticks, .. } = self;
        let with_reach = clients.values_mut().map(|client| {
            let reach = client.reach(now, options);
            (&client.desc, reach, &mut client.kept)
        });
        world.begin(with_reach, *ticks, options)?;
        // Owners that left are forgotten; entities without a team have that of their owners.
        for slot in entities.iter().map(|(slot, _)| slot).collect::<Vec<_>>() {
            let Some(entity) = entities.get_mut(slot) else { continue };
            let owner = entity.desc.owner.and_then(|owner| clients.get(&owner));
            entity.desc.owner = owner.map(|owner| owner.answer.client);
            entity.side = entity.desc.team.or(owner.and_then(|owner| owner.desc.team));
        }

        // Where entities may be, by the time that they may move for, which clients share.
        let world = &*world;
        let entities: Vec<(EntityId, &Entity<W>)> =
            entities.iter().map(|(slot, entity)| (EntityId(entities.id(slot)), entity)).collect();
        let place = |entity: &Entity<W>, steps: u64| {
            let seconds = steps as f64 * STEP + (now - entity.time).clamp(0.0, f64::MAX);
            world.place(&entity.desc.bounds, f64::from(entity.desc.speed) * seconds)
        };
        let times: BTreeSet<u64> =
            clients.values().map(|client| steps(client.time_ahead(now, options).0)).collect();
        #[cfg(feature = "rayon")]
        let in_turn = entities.par_iter();
        #[cfg(not(feature = "rayon"))]
        let in_turn = entities.iter();
        let places = |steps: u64| in_turn.clone().map(|(_, entity)| place(entity, steps)).collect();
        let places: BTreeMap<u64, Vec<W::Reached>> =
            times.into_iter().map(|steps| (steps, places(steps))).collect();

        let see = |client: &mut Client<W>| {
            let ((seconds, is_stale), reach) = (client.time_ahead(now, options), client.reach(now, options));
            let Client { desc, kept, answer, .. } = client;
            let (id, mut look) = (answer.client, world.look(&desc.eye, reach, kept));
            let all = entities.iter().zip(places.get(&steps(seconds)).into_iter().flatten());
            let told = all.filter(|((entity, about), place)| {
                about.desc.owner == Some(id)
                    || desc.team.is_some() && desc.team == about.side
                    || W::may_see(&mut look, entity.slot().index(), place)
                    || hook((id, desc), (*entity, &about.desc))
            });
            let told = told.map(|((entity, _), _)| *entity).collect();
            client.before = std::mem::replace(&mut client.answer.told, told);
            (client.answer.reach, client.answer.is_stale) = (reach, is_stale);
            client.answer.is_fresh = std::mem::take(&mut client.jumped);
        };
        #[cfg(feature = "rayon")]
        clients.par_iter_mut().for_each(|(_, client)| see(client));
        #[cfg(not(feature = "rayon"))]
        clients.values_mut().for_each(see);

        // If teams share, all clients of one are told what any of them is told of.
        let mut teams: BTreeMap<Team, BTreeSet<EntityId>> = BTreeMap::new();
        for client in clients.values().filter(|_| options.teams_share) {
            if let Some(team) = client.desc.team {
                teams.entry(team).or_default().extend(&client.answer.told);
            }
        }
        for client in clients.values_mut() {
            if let Some(told) = client.desc.team.and_then(|team| teams.get(&team)) {
                client.answer.told = told.iter().copied().collect();
            }
            client.answer.compare(&client.before);
        }
        Ok(clients.values().map(|client| &client.answer).collect())
    }
}

fn check_speed(speed: f32) -> Result<(), ServerError> {
    within("the speed of an entity, a second,", speed, 0.0, FASTEST)
}
