//! The server of a map: clients and entities, from tick to tick.

use std::collections::BTreeMap;

use casca::glam::Vec2;
use casca_plane::OpaqueTiles;
use casca_slots::Slots;

use crate::answer::Answer;
use crate::error::{ServerError, time, within};
use crate::id::{ClientId, EntityId};
use crate::plane::client::{PlaneClient, PlaneState};
use crate::plane::entity::{PlaneBody, PlaneEntity};
use crate::plane::numeric::WIDEST;
use crate::plane::options::PlaneOptions;
use crate::plane::sights::Sights;

/// Finds, tick by tick, which entities each client may be told of on a map of tiles.
///
/// See the [module](crate::plane) for what it promises. Times are seconds of one clock of the
/// caller's, which must not run backwards. Places are on the map, its border included.
///
/// ```
/// use casca_plane::{BitGrid, OpaqueTiles};
/// use casca_server::casca::glam::Vec2;
/// use casca_server::plane::{PlaneClient, PlaneEntity, PlaneOptions, PlaneServer};
///
/// # fn main() -> Result<(), casca_server::ServerError> {
/// // A wall across the map, with a gap at its end.
/// let mut walls = BitGrid::new(32, 16);
/// walls.fill(8, 0..31);
/// let mut server = PlaneServer::new(OpaqueTiles::new(walls), PlaneOptions::new())?;
/// // An eye that walks 4 tiles a second, of a client with 100 ms latency.
/// let client = server.add_client(PlaneClient::new(Vec2::new(3.5, 4.5), 4.0, 0.1), 0.0)?;
/// let friend = server.add_entity(PlaneEntity::new(Vec2::new(9.5, 2.5), 4.0), 0.0)?;
/// let enemy = server.add_entity(PlaneEntity::new(Vec2::new(3.5, 12.5), 4.0), 0.0)?;
///
/// server.tick(0.0)?;
/// assert_eq!(server.answer(client)?.told, [friend], "the enemy is behind the wall");
/// server.move_entity(enemy, Vec2::new(31.5, 8.5), 0.03)?;
/// server.tick(0.033)?;
/// assert_eq!(server.answer(client)?.new, [enemy]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct PlaneServer {
    pub(super) map: OpaqueTiles,
    pub(super) options: PlaneOptions,
    pub(super) ids: Slots<()>,
    pub(super) clients: BTreeMap<ClientId, PlaneState>,
    pub(super) entities: Slots<PlaneBody>,
    pub(super) sights: Sights,
    /// The time of the last tick.
    pub(super) now: f64,
    /// How many ticks there were.
    pub(super) ticks: u64,
}

impl PlaneServer {
    /// A server for a map.
    ///
    /// # Errors
    /// Refuses options that are out of their ranges, and maps without a tile or with more than
    /// 2^20 columns or rows.
    pub fn new(map: OpaqueTiles, options: PlaneOptions) -> Result<Self, ServerError> {
        options.check()?;
        for (what, size) in [("the width of a map", map.width()), ("the height of a map", map.height())] {
            within(what, size as f32, 1.0, WIDEST as f32)?;
        }
        let (clients, sights) = (BTreeMap::new(), Sights::default());
        let (ids, entities) = (Slots::new(), Slots::new());
        Ok(Self { map, options, ids, clients, entities, sights, now: f64::MIN, ticks: 0 })
    }

    /// The map.
    pub fn map(&self) -> &OpaqueTiles {
        &self.map
    }

    /// The options.
    pub fn options(&self) -> &PlaneOptions {
        &self.options
    }

    /// Bytes that are taken by what eyes see, kept by tile: see [`PlaneOptions::memory`].
    pub fn kept_bytes(&self) -> usize {
        self.sights.bytes()
    }

    /// Lets a tile block sight, or not, from the next tick on: a door, a tree that falls. All that
    /// was found is forgotten if it changed, which costs the next tick some microseconds for each
    /// tile that an eye may be in.
    ///
    /// # Errors
    /// Refuses tiles that are not on the map.
    pub fn set_opaque(&mut self, x: u32, y: u32, opaque: bool) -> Result<(), ServerError> {
        let (width, height) = (self.map.width(), self.map.height());
        if x >= width || y >= height {
            return Err(casca_plane::TileError::Outside { x, y, width, height }.into());
        }
        if self.map.get(x, y) != opaque {
            self.map.set(x, y, opaque);
            self.sights.clear();
        }
        Ok(())
    }

    /// Refuses places that are not on the map, or not finite.
    fn on_map(&self, what: &'static str, place: Vec2) -> Result<(), ServerError> {
        let (width, height) = (self.map.width(), self.map.height());
        let is_on = |at: f32, size: u32| (0.0..=size as f32).contains(&at);
        if is_on(place.x, width) && is_on(place.y, height) {
            return Ok(());
        }
        Err(ServerError::OffMap { what, x: place.x, y: place.y, width, height })
    }

    /// Adds a client, whose eye is at its place at the time `now`.
    ///
    /// # Errors
    /// Refuses numbers that are out of their ranges or not finite, a place off the map, and more
    /// clients than [`PlaneOptions::most_clients`].
    pub fn add_client(&mut self, desc: PlaneClient, now: f64) -> Result<ClientId, ServerError> {
        desc.check()?;
        self.on_map("the eye of a client", desc.eye)?;
        time("the time of a new client", now, f64::MIN)?;
        let full = ServerError::Full { what: "clients", most: self.options.most_clients };
        if self.clients.len() >= self.options.most_clients {
            return Err(full);
        }
        let slot = self.ids.insert(()).ok_or(full)?;
        let id = ClientId(self.ids.id(slot));
        self.clients.insert(id, PlaneState::new(id, desc, now));
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

    /// What is known of a client.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn client(&self, id: ClientId) -> Result<&PlaneClient, ServerError> {
        self.clients.get(&id).map(|state| &state.desc).ok_or(ServerError::UnknownClient(id))
    }

    /// Takes a client's report that its eye is at a place; the report came at the time `now`. An
    /// eye that is farther off than its speed explains has jumped: the next answer is fresh.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server, a place off the map or not finite, and a
    /// time before that of the last report.
    pub fn move_eye(&mut self, id: ClientId, eye: Vec2, now: f64) -> Result<(), ServerError> {
        self.client(id)?;
        self.on_map("the eye of a client", eye)?;
        let tick = f64::from(self.options.tick);
        let state = self.clients.get_mut(&id).ok_or(ServerError::UnknownClient(id))?;
        time("the time of a report", now, state.time)?;
        let step = f64::from(eye.x - state.desc.eye.x).hypot((eye.y - state.desc.eye.y).into());
        // Reports come unevenly: one may be early by the latency, and one late.
        let seconds = now - state.time + f64::from(state.desc.latency) + tick;
        state.jumped |= step > f64::from(state.desc.speed) * seconds;
        (state.desc.eye, state.time) = (eye, now);
        Ok(())
    }

    /// Adds an entity, which is at its place at the time `now`.
    ///
    /// # Errors
    /// Refuses numbers that are out of their ranges or not finite, a place off the map, an owner
    /// that is no client of this server, and more entities than [`PlaneOptions::most_entities`].
    pub fn add_entity(&mut self, desc: PlaneEntity, now: f64) -> Result<EntityId, ServerError> {
        desc.check()?;
        self.on_map("the place of an entity", desc.place)?;
        time("the time of a new entity", now, f64::MIN)?;
        desc.owner.map_or(Ok(()), |owner| self.client(owner).map(|_| ()))?;
        let full = ServerError::Full { what: "entities", most: self.options.most_entities };
        if self.entities.len() >= self.options.most_entities {
            return Err(full);
        }
        let slot = self.entities.insert(PlaneBody { desc, time: now, side: None }).ok_or(full)?;
        Ok(EntityId(self.entities.id(slot)))
    }

    /// Moves an entity: at the time `now` it is at a place.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, a place off the map or not finite, and a
    /// time before that of the last move.
    pub fn move_entity(&mut self, id: EntityId, place: Vec2, now: f64) -> Result<(), ServerError> {
        self.entity(id)?;
        self.on_map("the place of an entity", place)?;
        let entity = self.entities.get_mut(id.slot()).ok_or(ServerError::UnknownEntity(id))?;
        time("the time of a move", now, entity.time)?;
        (entity.desc.place, entity.time) = (place, now);
        Ok(())
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
    pub fn entity(&self, id: EntityId) -> Result<&PlaneEntity, ServerError> {
        self.entities.find(id.0).map(|entity| &entity.desc).ok_or(ServerError::UnknownEntity(id))
    }

    /// The last answer to a client; it is told of nothing before the first tick.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn answer(&self, id: ClientId) -> Result<&Answer, ServerError> {
        self.clients.get(&id).map(|state| &state.answer).ok_or(ServerError::UnknownClient(id))
    }
}
