//! The server: a level, clients and entities, from tick to tick.

use casca::glam::Vec3;
use casca::{Aabb, ObjectDesc, Scene};
use casca_slots::{Id, Slot, Slots};
use casca_walls::Walls;

use crate::baked::BakedFile;
use crate::client::ClientDesc;
use crate::entity::{Entity, EntityDesc, check_box};
use crate::error::{ServerError, place, time, within};
use crate::field::FieldOfView;
use crate::gaze::Gaze;
use crate::id::{ClientId, EntityId};
use crate::options::ServerOptions;
use crate::state::ClientState;

/// Finds, tick by tick, which entities each client may be told of.
///
/// See the [crate] for what it promises. Times are seconds of one clock of the caller's, which must
/// not run backwards.
#[derive(Debug)]
pub struct VisibilityServer {
    pub(crate) level: Scene,
    pub(crate) options: ServerOptions,
    pub(crate) entities: Slots<Entity>,
    ids: Slots<()>,
    /// By the slots of their ids.
    pub(crate) clients: Vec<Option<Box<ClientState>>>,
    /// The time of the last tick.
    pub(crate) now: f64,
    /// How many ticks there were.
    pub(crate) ticks: u64,
    /// The walls of the level; `None` if it changed since.
    pub(crate) walls: Option<Walls>,
    /// What was found of the level ahead of time.
    pub(crate) baked: Option<BakedFile>,
}

impl VisibilityServer {
    /// A server for a level: a scene whose static objects hide entities. Dynamic objects hide
    /// nothing. The objects of the level are not told of, but count for shadows.
    ///
    /// # Errors
    /// Refuses options that are out of their ranges.
    pub fn new(level: Scene, options: ServerOptions) -> Result<Self, ServerError> {
        options.check()?;
        // Refuses options of queries before a client needs them.
        Gaze::new(options.point)?;
        let (entities, ids, clients) = (Slots::new(), Slots::new(), Vec::new());
        Ok(Self { level, options, entities, ids, clients, now: f64::MIN, ticks: 0, walls: None, baked: None })
    }

    /// The level, with the occluders of entities.
    pub fn level(&self) -> &Scene {
        &self.level
    }

    /// The level, to be changed: what comes, goes or moves counts from the next tick on, which
    /// costs a pass over all of it, and baked sets are given up. Leave objects alone that you did
    /// not insert. Entities with occluders cost less.
    pub fn level_mut(&mut self) -> &mut Scene {
        self.walls = None;
        self.forget_baked();
        &mut self.level
    }

    /// Takes a file of sets from cell to cell, by `casca-bake --cell-to-cell` or the library
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
        self.baked = Some(file);
        Ok(())
    }

    /// Whether there are baked sets, and they count.
    pub fn has_baked(&self) -> bool {
        self.baked.is_some() && self.options.walls
    }

    fn forget_baked(&mut self) {
        self.baked = None;
        self.clients.iter_mut().flatten().for_each(|client| client.seen_cells.forget());
    }

    /// How many walls the level has, since the last tick: see [`ServerOptions::walls`].
    pub fn wall_count(&self) -> usize {
        self.walls.as_ref().map_or(0, Walls::len)
    }

    /// Whether a wall stands between two places, as far as known since the last tick: to refuse
    /// reports of eyes that went through one. Who is in the plane of a wall only touches it; from
    /// one face of a wall to the other is through it.
    pub fn has_wall_between(&self, from: Vec3, to: Vec3) -> bool {
        self.walls.as_ref().is_some_and(|walls| walls.part(from.as_dvec3(), to.as_dvec3()))
    }

    /// The options.
    pub fn options(&self) -> &ServerOptions {
        &self.options
    }

    /// Adds a client, whose eye is at its place at the time `now`.
    ///
    /// # Errors
    /// Refuses numbers that are out of their ranges or not finite, and more clients than
    /// [`ServerOptions::most_clients`].
    pub fn add_client(&mut self, desc: ClientDesc, now: f64) -> Result<ClientId, ServerError> {
        desc.check()?;
        time("the time of a new client", now, f64::MIN)?;
        let full = ServerError::Full { what: "clients", most: self.options.most_clients };
        if self.ids.len() >= self.options.most_clients {
            return Err(full);
        }
        let gaze = Gaze::new(self.options.point)?;
        let slot = self.ids.insert(()).ok_or(full)?;
        let id = ClientId(self.ids.id(slot));
        let state = ClientState::new(id, desc, now, gaze, self.options.sun.is_some());
        if self.clients.len() <= slot.index() {
            self.clients.resize_with(slot.index() + 1, || None);
        }
        self.clients[slot.index()] = Some(Box::new(state));
        Ok(id)
    }

    /// Removes a client. Its entities stay, without an owner.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn remove_client(&mut self, id: ClientId) -> Result<(), ServerError> {
        self.client(id)?;
        self.ids.remove(id.slot());
        self.clients[id.slot().index()] = None;
        Ok(())
    }

    /// What is known of a client.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn client(&self, id: ClientId) -> Result<&ClientDesc, ServerError> {
        let known = self.ids.find(id.0).and_then(|()| self.clients.get(id.slot().index())?.as_ref());
        known.map(|state| &state.desc).ok_or(ServerError::UnknownClient(id))
    }

    fn client_mut(&mut self, id: ClientId) -> Result<&mut ClientState, ServerError> {
        self.client(id)?;
        let state = self.clients.get_mut(id.slot().index()).and_then(Option::as_mut);
        state.map(AsMut::as_mut).ok_or(ServerError::UnknownClient(id))
    }

    /// Takes a client's report that its eye is at a place; the report came at the time `now`. An
    /// eye that is farther off than its speed explains has jumped: the next answer is fresh.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, a place that is too far or not finite,
    /// and a time before that of the last report.
    pub fn move_eye(&mut self, id: ClientId, eye: Vec3, now: f64) -> Result<(), ServerError> {
        place("the eye of a client", eye)?;
        let tick = f64::from(self.options.tick);
        let state = self.client_mut(id)?;
        time("the time of a report", now, state.time)?;
        let step = eye.as_dvec3() - state.desc.eye.as_dvec3();
        // Reports come unevenly: one may be early by the latency, and one late.
        let seconds = now - state.time + f64::from(state.desc.latency) + tick;
        state.jumped |= step.length() > f64::from(state.desc.speed) * seconds;
        (state.desc.eye, state.time, state.step) = (eye, now, step);
        Ok(())
    }

    /// Changes the speed and the latency of a client, in metres a second and seconds.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, and numbers that are out of their ranges.
    pub fn set_motion(&mut self, id: ClientId, speed: f32, latency: f32) -> Result<(), ServerError> {
        let state = self.client_mut(id)?;
        let desc = ClientDesc { speed, latency, ..state.desc };
        desc.check()?;
        state.desc = desc;
        Ok(())
    }

    /// Changes the field of view of a client.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, and a field that makes no sense.
    pub fn set_field(&mut self, id: ClientId, field: Option<FieldOfView>) -> Result<(), ServerError> {
        let state = self.client_mut(id)?;
        field.map_or(Ok(()), |field| field.check())?;
        state.desc.field = field;
        Ok(())
    }

    /// Adds an entity, which is at its place at the time `now`.
    ///
    /// # Errors
    /// Refuses numbers that are out of their ranges or not finite, an inverted box, an owner that
    /// is no client of this server, an occluder of an entity with a speed, occluders that casca
    /// refuses, and more entities than [`ServerOptions::most_entities`].
    pub fn add_entity(&mut self, desc: EntityDesc, now: f64) -> Result<EntityId, ServerError> {
        desc.check()?;
        time("the time of a new entity", now, f64::MIN)?;
        desc.owner.map_or(Ok(()), |owner| self.client(owner).map(|_| ()))?;
        let full = ServerError::Full { what: "entities", most: self.options.most_entities };
        if self.entities.len() >= self.options.most_entities {
            return Err(full);
        }
        let object = match &desc.occluder {
            Some(occluder) => {
                Some(self.level.insert(ObjectDesc::fixed(desc.bounds).occluder(occluder.clone()))?)
            }
            None => None,
        };
        let entity = Entity { desc, time: now, object, caster: None, side: None };
        let Some(slot) = self.entities.insert(entity) else {
            object.map_or(Ok(()), |object| self.level.remove(object))?;
            return Err(full);
        };
        Ok(EntityId(self.entities.id(slot)))
    }

    /// Moves an entity that hides nothing: at the time `now` it is in `bounds`.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, a box that is inverted, too far or not
    /// finite, a time before that of the last move, and an entity with an occluder: that takes
    /// [`VisibilityServer::move_occluder`].
    pub fn move_entity(&mut self, id: EntityId, bounds: Aabb, now: f64) -> Result<(), ServerError> {
        check_box(&bounds)?;
        let entity = self.entity_mut(id)?;
        time("the time of a move", now, entity.time)?;
        if entity.object.is_some() {
            return Err(ServerError::MovingOccluder(entity.desc.speed));
        }
        (entity.desc.bounds, entity.time) = (bounds, now);
        Ok(())
    }

    /// Moves an entity that hides others, such as a door, from one tick to the next at once.
    ///
    /// # Errors
    /// As [`VisibilityServer::move_entity`]; also refuses an occluder that casca refuses, and an
    /// entity that has none.
    pub fn move_occluder(
        &mut self,
        id: EntityId,
        bounds: Aabb,
        occluder: impl Into<casca::Occluder>,
        now: f64,
    ) -> Result<(), ServerError> {
        check_box(&bounds)?;
        let (last, object) = (self.entity(id)?.time, self.entity(id)?.object);
        time("the time of a move", now, last)?;
        let (object, occluder) = (object.ok_or(ServerError::UnknownEntity(id))?, occluder.into());
        self.level.update(object, bounds, Some(occluder.clone()))?;
        let entity = self.entity_mut(id)?;
        (entity.desc.bounds, entity.desc.occluder, entity.time) = (bounds, Some(occluder), now);
        Ok(())
    }

    /// Changes the greatest speed of an entity, in metres a second.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, a speed out of its range, and one of an
    /// entity with an occluder.
    pub fn set_speed(&mut self, id: EntityId, speed: f32) -> Result<(), ServerError> {
        within("the speed of an entity, in m/s,", speed, 0.0, crate::numeric::FASTEST)?;
        let entity = self.entity_mut(id)?;
        if entity.object.is_some() && speed > 0.0 {
            return Err(ServerError::MovingOccluder(speed));
        }
        entity.desc.speed = speed;
        Ok(())
    }

    /// Removes an entity: clients that were told of it must forget it in the next tick.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server.
    pub fn remove_entity(&mut self, id: EntityId) -> Result<(), ServerError> {
        let Entity { object, caster, .. } = *self.entity(id)?;
        self.entities.remove(id.slot());
        for object in object.into_iter().chain(caster) {
            // Whoever has the level may have taken it out.
            let _ = self.level.remove(object);
        }
        Ok(())
    }

    /// What is known of an entity.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server.
    pub fn entity(&self, id: EntityId) -> Result<&Entity, ServerError> {
        self.entities.find(id.0).ok_or(ServerError::UnknownEntity(id))
    }

    fn entity_mut(&mut self, id: EntityId) -> Result<&mut Entity, ServerError> {
        self.entity(id)?;
        self.entities.get_mut(id.slot()).ok_or(ServerError::UnknownEntity(id))
    }

    /// All clients, in the order of their ids.
    pub fn clients(&self) -> impl Iterator<Item = (ClientId, &ClientDesc)> {
        self.clients.iter().flatten().map(|state| (state.id, &state.desc))
    }

    /// All entities, in the order of their slots.
    pub fn entities(&self) -> impl Iterator<Item = (EntityId, &Entity)> {
        let id = |slot: Slot| -> Id { self.entities.id(slot) };
        self.entities.iter().map(move |(slot, entity)| (EntityId(id(slot)), entity))
    }
}
