//! The server: a level, clients and entities, from tick to tick.

use std::collections::BTreeSet;

use casca::glam::Vec3;
use casca::{Aabb, ObjectDesc, ObjectId, Scene};
use casca_walls::Walls;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::answer::Answer;
use crate::baked::{BakedFile, cells_of};
use crate::client::ClientDesc;
use crate::entity::{EntityDesc, check_box, span_of};
use crate::error::{ServerError, place, time, within};
use crate::gaze::Gaze;
use crate::hook::Hook;
use crate::id::{ClientId, EntityId};
use crate::numeric::{LEAST_WALL, STEP};
use crate::options::ServerOptions;
use crate::roster::{Entity, Roster, steps};
use crate::state::{ClientState, Eye, Moment, Place};

/// Finds, tick by tick, which entities each client may be told of.
///
/// See the [crate] for what it promises. Times are seconds of one clock of the caller's, which must
/// not run backwards.
#[derive(Debug)]
pub struct VisibilityServer {
    level: Scene,
    options: ServerOptions,
    roster: Roster<ClientDesc, Eye, EntityDesc, Option<ObjectId>>,
    /// The walls of the level; `None` if it changed since.
    walls: Option<Walls>,
    /// What was found of the level ahead of time.
    baked: Option<BakedFile>,
}

impl VisibilityServer {
    /// A server for a level: a scene whose static objects hide entities. Dynamic objects hide
    /// nothing. The objects of the level are not told of.
    ///
    /// # Errors
    /// Refuses options that are out of their ranges.
    pub fn new(level: Scene, options: ServerOptions) -> Result<Self, ServerError> {
        options.check()?;
        // Refuses options of queries before a client needs them.
        Gaze::new(options.point)?;
        Ok(Self { level, options, roster: Roster::new(), walls: None, baked: None })
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
        self.roster.clients.values_mut().for_each(|client| client.own.seen_cells.forget());
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
        let eye = Eye::new(Gaze::new(self.options.point)?);
        self.roster.add_client(desc, eye, now, self.options.most_clients)
    }

    /// Removes a client. Its entities stay, without an owner.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn remove_client(&mut self, id: ClientId) -> Result<(), ServerError> {
        self.roster.remove_client(id)
    }

    /// What is known of a client.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn client(&self, id: ClientId) -> Result<&ClientDesc, ServerError> {
        Ok(&self.roster.client(id)?.desc)
    }

    /// Takes a client's report that its eye is at a place; the report came at the time `now`. An
    /// eye that is farther off than its speed explains has jumped: the next answer is fresh.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, a place that is too far or not finite,
    /// and a time before that of the last report.
    pub fn move_eye(&mut self, id: ClientId, eye: Vec3, now: f64) -> Result<(), ServerError> {
        place("the eye of a client", eye)?;
        let client = self.roster.client_mut(id)?;
        let step = eye.as_dvec3() - client.desc.eye.as_dvec3();
        client.report(step.length(), now, self.options.tick)?;
        (client.desc.eye, client.own.step) = (eye, step);
        Ok(())
    }

    /// Changes the speed and the latency of a client, in metres a second and seconds.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, and numbers that are out of their ranges.
    pub fn set_motion(&mut self, id: ClientId, speed: f32, latency: f32) -> Result<(), ServerError> {
        let client = self.roster.client_mut(id)?;
        let desc = ClientDesc { speed, latency, ..client.desc };
        desc.check()?;
        client.desc = desc;
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
        let object = desc.occluder.clone().map(|occluder| ObjectDesc::fixed(desc.bounds).occluder(occluder));
        let id = self.roster.add_entity(desc, None, now, self.options.most_entities)?;
        if let Some(object) = object {
            match self.level.insert(object) {
                Ok(object) => self.roster.entity_mut(id)?.own = Some(object),
                Err(why) => {
                    self.roster.remove_entity(id)?;
                    return Err(why.into());
                }
            }
        }
        Ok(id)
    }

    /// Moves an entity that hides nothing: at the time `now` it is in `bounds`.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, a box that is inverted, too far or not
    /// finite, a time before that of the last move, and an entity with an occluder: that takes
    /// [`VisibilityServer::move_occluder`].
    pub fn move_entity(&mut self, id: EntityId, bounds: Aabb, now: f64) -> Result<(), ServerError> {
        check_box(&bounds)?;
        let entity = self.roster.entity_mut(id)?;
        time("the time of a move", now, entity.time)?;
        if entity.own.is_some() {
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
        let (entity, occluder) = (self.roster.entity_mut(id)?, occluder.into());
        time("the time of a move", now, entity.time)?;
        let object = entity.own.ok_or(ServerError::UnknownEntity(id))?;
        self.level.update(object, bounds, Some(occluder.clone()))?;
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
        let entity = self.roster.entity_mut(id)?;
        if entity.own.is_some() && speed > 0.0 {
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
        if let Some(object) = self.roster.remove_entity(id)? {
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
        self.roster.entity(id)
    }

    /// All clients, in the order of their ids.
    pub fn clients(&self) -> impl Iterator<Item = (ClientId, &ClientDesc)> {
        self.roster.clients.iter().map(|(id, client)| (*id, &client.desc))
    }

    /// All entities, in the order of their slots.
    pub fn entities(&self) -> impl Iterator<Item = (EntityId, &Entity)> {
        self.roster.all_entities()
    }

    /// The last answer to a client; it is told of nothing before the first tick.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn answer(&self, id: ClientId) -> Result<&Answer, ServerError> {
        Ok(&self.roster.client(id)?.answer)
    }

    /// Answers all clients for the time `now`, in the order of their ids. `hook` adds entities that
    /// a client cannot see; give `&()` to add none.
    ///
    /// Costs a test of some hundred nanoseconds for each pair of a client and an entity, and a
    /// query of the level for each client whose eye used up its room. With the feature `rayon`
    /// clients are shared among the threads of rayon's current pool; answers do not depend on their
    /// number.
    ///
    /// # Errors
    /// Refuses a time that is not finite, or before that of the last tick. No answer changes then.
    pub fn tick<H: Hook + ?Sized>(&mut self, now: f64, hook: &H) -> Result<Vec<&Answer>, ServerError> {
        time("the time of a tick", now, self.roster.now)?;
        self.level.begin_frame(now)?;
        self.roster.begin(now);
        let walls = match self.walls.take() {
            Some(walls) => walls,
            None if !self.options.walls => Walls::default(),
            None => {
                let own: BTreeSet<_> =
                    self.roster.entities.iter().filter_map(|(_, entity)| entity.own).collect();
                Walls::of(&self.level, LEAST_WALL, |id| own.contains(&id))
            }
        };
        let result = self.see_all(&walls, hook);
        self.walls = Some(walls);
        result?;
        Ok(self.roster.end(self.options.teams_share))
    }

    /// Whether it is a client's turn to look at the level, by the order of clients: those that
    /// waited longest.
    fn turns(&self) -> Vec<bool> {
        let clients = self.roster.clients.values().enumerate();
        let mut waiting: Vec<(u64, usize)> = clients
            .filter(|(_, client)| client.waits(self.roster.now, &self.options))
            .map(|(number, client)| (client.own.looked, number))
            .collect();
        waiting.sort_unstable();
        let mut turns = vec![false; self.roster.clients.len()];
        waiting.iter().take(self.options.most_queries).for_each(|&(_, number)| turns[number] = true);
        turns
    }

    fn see_all<H: Hook + ?Sized>(&mut self, walls: &Walls, hook: &H) -> Result<(), ServerError> {
        let (turns, options) = (self.turns(), &self.options);
        let Roster { clients, entities, now, ticks, .. } = &mut self.roster;
        let (now, ticks) = (*now, *ticks);
        let entities: Vec<(EntityId, &Entity)> =
            entities.iter().map(|(slot, entity)| (EntityId(entities.id(slot)), entity)).collect();
        let times = clients.values().map(|client| {
            let (seconds, _) = client.time_ahead(now, options.tick, options.most_age);
            steps(seconds)
        });
        let times: BTreeSet<u64> = times.collect();
        let baked = self.baked.as_ref().filter(|_| options.walls).and_then(BakedFile::sets);
        let place = |entity: &Entity, steps: u64| {
            let grown = entity.grown(now, steps as f64 * STEP);
            let bounds = entity.reached(walls, &grown);
            Place { bounds, cells: baked.as_ref().and_then(|sets| cells_of(sets, &span_of(&bounds))) }
        };
        #[cfg(feature = "rayon")]
        let in_turn = entities.par_iter();
        #[cfg(not(feature = "rayon"))]
        let in_turn = entities.iter();
        let places = |steps: u64| in_turn.clone().map(|(_, entity)| place(entity, steps)).collect();
        let moment = Moment {
            now,
            level: &self.level,
            walls,
            options,
            entities: &entities,
            places: &times.into_iter().map(|steps| (steps, places(steps))).collect(),
            baked,
            hook,
        };
        let see = |(client, turn): (&mut ClientState, bool)| {
            client.own.looked = if turn { ticks } else { client.own.looked };
            client.see(&moment, turn)
        };
        let all: Vec<(&mut ClientState, bool)> = clients.values_mut().zip(turns).collect();
        #[cfg(feature = "rayon")]
        return all.into_par_iter().try_for_each(see);
        #[cfg(not(feature = "rayon"))]
        all.into_iter().try_for_each(see)
    }
}
