//! What servers in space and on maps of tiles have in common: clients and entities, their reports,
//! and what clients are told.

use std::collections::BTreeMap;

use casca::Aabb;
use casca_slots::Slots;
use casca_walls::Walls;

use crate::answer::Answer;
use crate::entity::{EntityDesc, Team, grown, span_of};
use crate::error::{ServerError, time};
use crate::id::{ClientId, EntityId};
use crate::numeric::STEP;

/// The parts of a client's description that all servers need.
pub(crate) trait Party {
    fn speed(&self) -> f32;
    fn latency(&self) -> f32;
    fn team(&self) -> Option<Team>;
}

/// The parts of an entity's description that all servers need.
pub(crate) trait Thing {
    fn owner(&mut self) -> &mut Option<ClientId>;
    fn team(&self) -> Option<Team>;
}

/// A client, and what a server keeps about it from tick to tick.
#[derive(Debug, Clone)]
pub(crate) struct Client<C, S> {
    pub(crate) desc: C,
    /// When its last report came.
    pub(crate) time: f64,
    /// Whether the eye jumped since the last tick.
    jumped: bool,
    /// What it was told of in the tick before.
    before: Vec<EntityId>,
    pub(crate) answer: Answer,
    /// In space: what it saw last, and from where.
    pub(crate) own: S,
}

impl<C: Party, S> Client<C, S> {
    /// For how long the eye and all entities may move until the next answer counts, in seconds; and
    /// whether the last report is too old. `tick` and `most_age` are those of the options.
    pub(crate) fn time_ahead(&self, now: f64, tick: f32, most_age: f32) -> (f64, bool) {
        let (age, most) = ((now - self.time).max(0.0), f64::from(most_age));
        (f64::from(self.desc.latency()) + f64::from(tick) + age.min(most), age > most)
    }

    /// Takes a report that the eye is so far from where it was.
    pub(crate) fn report(&mut self, step: f64, now: f64, tick: f32) -> Result<(), ServerError> {
        time("the time of a report", now, self.time)?;
        // Reports come unevenly: one may be early by the latency, and one late.
        let seconds = now - self.time + f64::from(self.desc.latency()) + f64::from(tick);
        self.jumped |= step > f64::from(self.desc.speed()) * seconds;
        self.time = now;
        Ok(())
    }

    /// Takes all that it is told of in a tick, ascending.
    pub(crate) fn tell(&mut self, told: Vec<EntityId>, reach: f64, is_stale: bool) {
        self.before = std::mem::replace(&mut self.answer.told, told);
        (self.answer.reach, self.answer.is_stale) = (reach, is_stale);
        self.answer.is_fresh = std::mem::take(&mut self.jumped);
    }
}

/// An entity, with its last report.
#[derive(Debug, Clone)]
pub struct Entity<E = EntityDesc, O = Option<casca::ObjectId>> {
    pub(crate) desc: E,
    /// When it was where it is.
    pub(crate) time: f64,
    /// Its team or that of its owner.
    pub(crate) side: Option<Team>,
    /// In space: the object of the level that hides in its place.
    pub(crate) own: O,
}

impl<E, O> Entity<E, O> {
    /// Where it is, with its speed, owner and team.
    pub fn desc(&self) -> &E {
        &self.desc
    }

    /// When it was last reported, in seconds.
    pub fn time(&self) -> f64 {
        self.time
    }
}

impl Thing for EntityDesc {
    fn owner(&mut self) -> &mut Option<ClientId> {
        &mut self.owner
    }

    fn team(&self) -> Option<Team> {
        self.team
    }
}

impl Entity {
    /// A box around all places where it may be within `seconds` of the time `now`.
    pub(crate) fn grown(&self, now: f64, seconds: f64) -> Aabb {
        let time = seconds + (now - self.time).clamp(0.0, f64::MAX);
        grown(&self.desc.bounds, f64::from(self.desc.speed) * time)
    }

    /// The part of a box around it that it can get to.
    pub(crate) fn reached(&self, walls: &Walls, grown: &Aabb) -> Aabb {
        let reached = walls.reached(&span_of(&self.desc.bounds), span_of(grown));
        // All of these are single numbers: ends of boxes, and places of walls.
        Aabb::new(reached.min.as_vec3(), reached.max.as_vec3())
    }
}

/// All clients and entities of a server.
#[derive(Debug)]
pub(crate) struct Roster<C, S, E, O> {
    ids: Slots<()>,
    pub(crate) clients: BTreeMap<ClientId, Client<C, S>>,
    pub(crate) entities: Slots<Entity<E, O>>,
    /// The time of the last tick.
    pub(crate) now: f64,
    /// How many ticks there were.
    pub(crate) ticks: u64,
}

impl<C: Party, S, E: Thing, O> Roster<C, S, E, O> {
    pub(crate) fn new() -> Self {
        let (ids, clients, entities) = (Slots::new(), BTreeMap::new(), Slots::new());
        Self { ids, clients, entities, now: f64::MIN, ticks: 0 }
    }

    /// Adds a client; there may be `most`.
    pub(crate) fn add_client(
        &mut self,
        desc: C,
        own: S,
        now: f64,
        most: usize,
    ) -> Result<ClientId, ServerError> {
        time("the time of a new client", now, f64::MIN)?;
        let full = ServerError::Full { what: "clients", most };
        if self.clients.len() >= most {
            return Err(full);
        }
        let slot = self.ids.insert(()).ok_or(full)?;
        let id = ClientId(self.ids.id(slot));
        let (before, answer) = (Vec::new(), Answer::new(id));
        self.clients.insert(id, Client { desc, time: now, jumped: true, before, answer, own });
        Ok(id)
    }

    pub(crate) fn remove_client(&mut self, id: ClientId) -> Result<(), ServerError> {
        self.clients.remove(&id).ok_or(ServerError::UnknownClient(id))?;
        self.ids.remove(id.slot());
        Ok(())
    }

    pub(crate) fn client(&self, id: ClientId) -> Result<&Client<C, S>, ServerError> {
        self.clients.get(&id).ok_or(ServerError::UnknownClient(id))
    }

    pub(crate) fn client_mut(&mut self, id: ClientId) -> Result<&mut Client<C, S>, ServerError> {
        self.clients.get_mut(&id).ok_or(ServerError::UnknownClient(id))
    }

    /// Adds an entity; there may be `most`.
    pub(crate) fn add_entity(
        &mut self,
        mut desc: E,
        own: O,
        now: f64,
        most: usize,
    ) -> Result<EntityId, ServerError> {
        time("the time of a new entity", now, f64::MIN)?;
        desc.owner().map_or(Ok(()), |owner| self.client(owner).map(|_| ()))?;
        let full = ServerError::Full { what: "entities", most };
        if self.entities.len() >= most {
            return Err(full);
        }
        let slot = self.entities.insert(Entity { desc, time: now, side: None, own }).ok_or(full)?;
        Ok(EntityId(self.entities.id(slot)))
    }

    pub(crate) fn remove_entity(&mut self, id: EntityId) -> Result<O, ServerError> {
        self.entity(id)?;
        let removed = self.entities.remove(id.slot()).ok_or(ServerError::UnknownEntity(id))?;
        Ok(removed.own)
    }

    pub(crate) fn entity(&self, id: EntityId) -> Result<&Entity<E, O>, ServerError> {
        self.entities.find(id.0).ok_or(ServerError::UnknownEntity(id))
    }

    pub(crate) fn entity_mut(&mut self, id: EntityId) -> Result<&mut Entity<E, O>, ServerError> {
        self.entity(id)?;
        self.entities.get_mut(id.slot()).ok_or(ServerError::UnknownEntity(id))
    }

    /// All entities with their ids, in the order of slots.
    pub(crate) fn all_entities(&self) -> impl Iterator<Item = (EntityId, &Entity<E, O>)> {
        self.entities.iter().map(|(slot, entity)| (EntityId(self.entities.id(slot)), entity))
    }

    /// Begins a tick: finds the teams of entities that have that of their owners. Owners that left
    /// are forgotten.
    pub(crate) fn begin(&mut self, now: f64) {
        (self.now, self.ticks) = (now, self.ticks + 1);
        let slots: Vec<_> = self.entities.iter().map(|(slot, _)| slot).collect();
        for slot in slots {
            let Some(entity) = self.entities.get_mut(slot) else { continue };
            let owner = entity.desc.owner();
            let known = owner.and_then(|owner| Some((owner, self.clients.get(&owner)?.desc.team())));
            *owner = known.map(|(owner, _)| owner);
            entity.side = entity.desc.team().or(known.and_then(|(_, team)| team));
        }
    }

    /// Ends a tick: if teams share, tells clients of a team what any of them is told of; finds what
    /// changed since the tick before. The answers, in the order of clients.
    pub(crate) fn end(&mut self, teams_share: bool) -> Vec<&Answer> {
        let mut teams: BTreeMap<Team, Vec<EntityId>> = BTreeMap::new();
        for client in self.clients.values().filter(|_| teams_share) {
            if let Some(team) = client.desc.team() {
                teams.entry(team).or_default().extend(&client.answer.told);
            }
        }
        for told in teams.values_mut() {
            told.sort_unstable();
            told.dedup();
        }
        for client in self.clients.values_mut() {
            if let Some(told) = client.desc.team().and_then(|team| teams.get(&team)) {
                client.answer.told.clone_from(told);
            }
            client.answer.compare(&client.before);
        }
        self.clients.values().map(|client| &client.answer).collect()
    }
}

/// The number of steps that a time is rounded up to.
pub(crate) fn steps(seconds: f64) -> u64 {
    (seconds / STEP).ceil() as u64
}
