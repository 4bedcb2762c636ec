//! A tick: all clients are answered.

use std::collections::{BTreeMap, BTreeSet};

use casca::{Light, ObjectDesc};
use casca_walls::Walls;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::answer::Answer;
use crate::baked::{BakedFile, cells_of};
use crate::entity::{Entity, span_of};
use crate::error::{ServerError, time};
use crate::hook::Hook;
use crate::id::{ClientId, EntityId};
use crate::numeric::{LEAST_WALL, STEP};
use crate::server::VisibilityServer;
use crate::state::{ClientState, Moment, Place, steps};

impl VisibilityServer {
    /// Answers all clients for the time `now`, in the order of their slots. `hook` adds entities
    /// that a client cannot see; give `&()` to add none.
    ///
    /// Costs a test of some hundred nanoseconds for each pair of a client and an entity, and a
    /// query of the level for each client whose eye used up its room. With the feature `rayon`
    /// clients are shared among the threads of rayon's current pool; answers do not depend on their
    /// number.
    ///
    /// # Errors
    /// Refuses a time that is not finite, or before that of the last tick. No answer changes then.
    pub fn tick<H: Hook + ?Sized>(&mut self, now: f64, hook: &H) -> Result<Vec<&Answer>, ServerError> {
        time("the time of a tick", now, self.now)?;
        self.level.begin_frame(now)?;
        self.now = now;
        self.ticks += 1;
        self.take_sides();
        self.place_casters()?;
        self.find_walls();
        let walls = self.walls.take().unwrap_or_default();
        let result = self.see_all(&walls, hook);
        self.walls = Some(walls);
        result?;
        if self.options.teams_share {
            share(&mut self.clients);
        }
        self.clients.iter_mut().flatten().for_each(|client| client.compare());
        Ok(self.clients.iter().flatten().map(|client| &client.answer).collect())
    }

    /// The last answer to a client; it is told of nothing before the first tick.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn answer(&self, id: ClientId) -> Result<&Answer, ServerError> {
        self.client(id)?;
        let state = self.clients.get(id.0.slot().index()).and_then(Option::as_ref);
        state.map(|state| &state.answer).ok_or(ServerError::UnknownClient(id))
    }

    /// Finds the walls of the level, if it changed.
    fn find_walls(&mut self) {
        if self.walls.is_some() {
            return;
        }
        let own: BTreeSet<_> = self.entities.iter().filter_map(|(_, entity)| entity.object).collect();
        let walls = self.options.walls.then(|| Walls::of(&self.level, LEAST_WALL, |id| own.contains(&id)));
        self.walls = Some(walls.unwrap_or_default());
    }

    /// The slots of the clients whose turn it is to look at the level: those that waited longest.
    fn turns(&self) -> Vec<bool> {
        let clients = self.clients.iter().enumerate();
        let mut waiting: Vec<(u64, usize)> = clients
            .filter_map(|(slot, client)| Some((slot, client.as_ref()?)))
            .filter(|(_, client)| client.waits(self.now, &self.options))
            .map(|(slot, client)| (client.looked, slot))
            .collect();
        waiting.sort_unstable();
        let mut turns = vec![false; self.clients.len()];
        waiting.iter().take(self.options.most_queries).for_each(|&(_, slot)| turns[slot] = true);
        turns
    }

    fn see_all<H: Hook + ?Sized>(&mut self, walls: &Walls, hook: &H) -> Result<(), ServerError> {
        let turns = self.turns();
        let ids = |slot| EntityId(self.entities.id(slot));
        let entities: Vec<(EntityId, &Entity)> =
            self.entities.iter().map(|(slot, entity)| (ids(slot), entity)).collect();
        let all = self.clients.iter().flatten();
        let times: BTreeSet<u64> =
            all.map(|client| steps(client.time_ahead(self.now, &self.options).0)).collect();
        let baked = self.baked.as_ref().filter(|_| self.options.walls).and_then(BakedFile::sets);
        let place = |entity: &Entity, steps: u64| {
            let grown = entity.grown(self.now, steps as f64 * STEP);
            let bounds = entity.reached(walls, &grown);
            Place { bounds, cells: baked.as_ref().and_then(|sets| cells_of(sets, &span_of(&bounds))) }
        };
        #[cfg(feature = "rayon")]
        let entities_in_turn = entities.par_iter();
        #[cfg(not(feature = "rayon"))]
        let entities_in_turn = entities.iter();
        let places = |steps: u64| entities_in_turn.clone().map(|(_, entity)| place(entity, steps)).collect();
        let moment = Moment {
            now: self.now,
            level: &self.level,
            walls,
            options: &self.options,
            entities: &entities,
            places: &times.into_iter().map(|steps| (steps, places(steps))).collect(),
            baked,
            light: self.options.sun.map(Light::directional),
            hook,
        };
        let see = |(client, turn): (&mut Option<Box<ClientState>>, bool)| match client {
            Some(client) => {
                client.looked = if turn { self.ticks } else { client.looked };
                client.see(&moment, turn)
            }
            None => Ok(()),
        };
        #[cfg(feature = "rayon")]
        return self.clients.par_iter_mut().zip(turns).try_for_each(see);
        #[cfg(not(feature = "rayon"))]
        self.clients.iter_mut().zip(turns).try_for_each(see)
    }

    /// Finds the teams of entities that have that of their owners. Owners that left are forgotten.
    fn take_sides(&mut self) {
        let slots: Vec<_> = self.entities.iter().map(|(slot, _)| slot).collect();
        for slot in slots {
            let owner = self.entities.get(slot).and_then(|entity| entity.desc.owner);
            let known = owner.and_then(|owner| self.client(owner).ok().map(|desc| (owner, desc.team)));
            if let Some(entity) = self.entities.get_mut(slot) {
                entity.desc.owner = known.map(|(owner, _)| owner);
                entity.side = entity.desc.team.or(known.and_then(|(_, team)| team));
            }
        }
    }

    /// Puts entities into the scene as far as any client must expect them, if there is a sun.
    fn place_casters(&mut self) -> Result<(), ServerError> {
        if self.options.sun.is_none() {
            return Ok(());
        }
        let clients = self.clients.iter().flatten();
        let times = clients.map(|client| client.time_ahead(self.now, &self.options).0);
        let most = times.fold(0.0, f64::max);
        let slots: Vec<_> = self.entities.iter().map(|(slot, _)| slot).collect();
        for slot in slots {
            let Some(entity) = self.entities.get_mut(slot) else { continue };
            // What hides is in the scene already, and has no speed.
            if entity.object.is_some() {
                continue;
            }
            let bounds = entity.grown(self.now, most);
            // Whoever has the level may have taken it out.
            let is_there =
                entity.caster.is_some_and(|caster| self.level.update(caster, bounds, None).is_ok());
            if !is_there {
                entity.caster = Some(self.level.insert(ObjectDesc::dynamic(bounds))?);
            }
        }
        Ok(())
    }
}

/// Tells clients of a team what any of them is told of.
fn share(clients: &mut [Option<Box<ClientState>>]) {
    let mut teams: BTreeMap<u32, Vec<EntityId>> = BTreeMap::new();
    for client in clients.iter().flatten() {
        if let Some(team) = client.desc.team {
            teams.entry(team).or_default().extend(&client.answer.told);
        }
    }
    for told in teams.values_mut() {
        told.sort_unstable();
        told.dedup();
    }
    for client in clients.iter_mut().flatten() {
        if let Some(told) = client.desc.team.and_then(|team| teams.get(&team)) {
            client.answer.told.clone_from(told);
        }
    }
}
