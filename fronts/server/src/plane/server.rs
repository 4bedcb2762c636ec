//! The server of a map: clients and entities, from tick to tick.

use std::collections::{BTreeMap, BTreeSet};

use casca::glam::Vec2;
use casca_plane::OpaqueTiles;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::answer::Answer;
use crate::error::{ServerError, time, within};
use crate::id::{ClientId, EntityId};
use crate::numeric::STEP;
use crate::plane::client::{PlaneClient, PlaneState};
use crate::plane::entity::{PlaneBody, PlaneEntity};
use crate::plane::ground::{Ground, Tile};
use crate::plane::options::{PlaneOptions, WIDEST};
use crate::plane::sights::{Key, Sights, Window};
use crate::roster::{Roster, steps};

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
    map: OpaqueTiles,
    options: PlaneOptions,
    roster: Roster<PlaneClient, (), PlaneEntity, ()>,
    sights: Sights,
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
        Ok(Self { map, options, roster: Roster::new(), sights: Sights::default() })
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
            return Err(casca_plane::Error::Outside { x, y, width, height }.into());
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
        self.roster.add_client(desc, (), now, self.options.most_clients)
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
    pub fn client(&self, id: ClientId) -> Result<&PlaneClient, ServerError> {
        Ok(&self.roster.client(id)?.desc)
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
        let client = self.roster.client_mut(id)?;
        let step = f64::from(eye.x - client.desc.eye.x).hypot((eye.y - client.desc.eye.y).into());
        client.report(step, now, self.options.tick)?;
        client.desc.eye = eye;
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
        self.roster.add_entity(desc, (), now, self.options.most_entities)
    }

    /// Moves an entity: at the time `now` it is at a place.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server, a place off the map or not finite, and a
    /// time before that of the last move.
    pub fn move_entity(&mut self, id: EntityId, place: Vec2, now: f64) -> Result<(), ServerError> {
        self.entity(id)?;
        self.on_map("the place of an entity", place)?;
        let entity = self.roster.entity_mut(id)?;
        time("the time of a move", now, entity.time)?;
        (entity.desc.place, entity.time) = (place, now);
        Ok(())
    }

    /// Removes an entity: clients that were told of it must forget it in the next tick.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server.
    pub fn remove_entity(&mut self, id: EntityId) -> Result<(), ServerError> {
        self.roster.remove_entity(id)
    }

    /// What is known of an entity.
    ///
    /// # Errors
    /// Refuses an id that names no entity of this server.
    pub fn entity(&self, id: EntityId) -> Result<&PlaneEntity, ServerError> {
        Ok(&self.roster.entity(id)?.desc)
    }

    /// The last answer to a client; it is told of nothing before the first tick.
    ///
    /// # Errors
    /// Refuses an id that names no client of this server.
    pub fn answer(&self, id: ClientId) -> Result<&Answer, ServerError> {
        Ok(&self.roster.client(id)?.answer)
    }

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
        time("the time of a tick", now, self.roster.now)?;
        self.roster.begin(now);
        let options = self.options;
        let ground = Ground { opaque: &self.map, walls_stop: options.walls_stop };
        let Roster { clients, entities, ticks, .. } = &mut self.roster;
        let eyes: Vec<Option<Vec<Key>>> =
            clients.values().map(|state| eyes(ground, state, now, &options)).collect();
        let all: BTreeSet<Key> = eyes.iter().flatten().flatten().copied().collect();
        self.sights.find(&self.map, &all, *ticks, options.memory)?;

        let entities: Vec<(EntityId, &PlaneBody)> =
            entities.iter().map(|(slot, entity)| (EntityId(entities.id(slot)), entity)).collect();
        let ahead = |state: &PlaneState| state.time_ahead(now, options.tick, options.most_age);
        let times: BTreeSet<u64> = clients.values().map(|state| steps(ahead(state).0)).collect();
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
        let all: Vec<(&mut PlaneState, Option<Vec<Key>>)> = clients.values_mut().zip(eyes).collect();
        let see = |(state, eyes): (&mut PlaneState, Option<Vec<Key>>)| {
            let (seconds, is_stale) = ahead(state);
            let told = told(state, eyes.as_deref(), steps(seconds), &moment);
            state.tell(told, state.reach(now, &options), is_stale);
        };
        #[cfg(feature = "rayon")]
        all.into_par_iter().for_each(see);
        #[cfg(not(feature = "rayon"))]
        all.into_iter().for_each(see);
        Ok(self.roster.end(options.teams_share))
    }
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
