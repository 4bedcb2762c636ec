//! A match: bots that are clients and entities of a server, with latency in both directions.

use std::collections::VecDeque;

use casca::Aabb;
use casca::glam::Vec3;
use casca_scenes::random::{Generator, generator};
use rand::RngExt;

use super::bot::{Bot, SPEED};
use super::level::Level;
use crate::describe::{ClientDesc, EntityDesc};
use crate::error::ServerError;
use crate::id::{ClientId, EntityId};
use crate::options::ServerOptions;
use crate::server::{Answer, VisibilityServer};

/// The server has the default options.
const SERVER: ServerOptions = ServerOptions::new();

/// Ticks that a report takes to the server.
const UP: usize = 2;

/// Ticks that an answer takes to the client.
pub const DOWN: usize = 1;

/// The share of reports that are lost.
const LOSS: f64 = 0.05;

/// What is true at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// The eyes of all bots.
    pub eyes: Vec<Vec3>,
    /// Their bodies.
    pub bodies: Vec<Aabb>,
    /// Whether a bot jumped since the moment before.
    pub jumped: Vec<bool>,
}

impl Moment {
    /// What is true a share of the way from here to a later moment.
    #[must_use]
    pub fn toward(&self, later: &Self, share: f32) -> Self {
        let mut moment = self.clone();
        for i in 0..self.eyes.len() {
            if !later.jumped[i] {
                moment.eyes[i] = self.eyes[i].lerp(later.eyes[i], share);
                let offset = moment.eyes[i] - self.eyes[i];
                moment.bodies[i] = Aabb::new(self.bodies[i].min + offset, self.bodies[i].max + offset);
            }
        }
        moment
    }
}

/// For how many ticks a client that lags sends nothing.
const LAG: u32 = 10;

/// How often a client begins to lag, in a tick.
const LAGS: f64 = 0.002;

/// Bots, their server, and the messages that are on their way.
///
/// Jumps are ordered by the server: it knows of one as many ticks before as its answer takes, and
/// the client jumps when the answer arrives.
#[derive(Debug)]
pub struct Match<'a> {
    level: &'a Level,
    /// The server.
    pub server: VisibilityServer,
    bots: Vec<Bot>,
    clients: Vec<ClientId>,
    entities: Vec<EntityId>,
    /// What is true now, and in the ticks to come.
    moments: VecDeque<Moment>,
    /// Reports by the tick that they were sent in, the oldest first; `None` if lost.
    reports: VecDeque<Vec<Option<Vec3>>>,
    /// The answers that count now, and those on their way: by client and bot.
    told: VecDeque<Vec<Vec<bool>>>,
    /// For how many ticks reports of a bot are ignored, since they are from before it jumped.
    ignored: Vec<usize>,
    lags: Vec<u32>,
    random: Generator,
    tick: u64,
}

impl<'a> Match<'a> {
    /// A match in a level. The server is told these shares of the speed and the latency of bots: less than
    /// 1 is a lie, to see that it is found out.
    ///
    /// # Errors
    /// As [`VisibilityServer::new`].
    pub fn new(level: &'a Level, bots: usize, seed: u64, told: [f32; 2]) -> Result<Self, ServerError> {
        let [speed, late] = told;
        let mut server = VisibilityServer::new(level.scene.clone(), SERVER)?;
        level.baked.clone().map_or(Ok(()), |file| server.set_baked(file))?;
        let bots: Vec<Bot> = (0..bots as u64).map(|i| Bot::new(&level.track.path, seed, i)).collect();
        let seconds = (UP + DOWN) as f32 * SERVER.tick;
        let (mut clients, mut entities) = (Vec::new(), Vec::new());
        for bot in &bots {
            let desc = ClientDesc::new(bot.eye, SPEED * speed, seconds * late);
            clients.push(server.add_client(desc, 0.0)?);
            let desc = EntityDesc::new(level.track.body(bot.eye), SPEED * speed);
            entities.push(server.add_entity(desc, 0.0)?);
        }
        let count = bots.len();
        let mut game = Self {
            level,
            server,
            bots,
            clients,
            entities,
            moments: VecDeque::new(),
            reports: VecDeque::new(),
            told: VecDeque::new(),
            ignored: vec![0; count],
            lags: vec![0; count],
            random: generator(seed, 0x105e),
            tick: 0,
        };
        let first = game.moment(false);
        game.moments.push_back(first);
        game.look_ahead();
        Ok(game)
    }

    fn moment(&self, moved: bool) -> Moment {
        let eyes: Vec<Vec3> = self.bots.iter().map(|bot| bot.eye).collect();
        let bodies = eyes.iter().map(|&eye| self.level.track.body(eye)).collect();
        Moment { eyes, bodies, jumped: self.bots.iter().map(|bot| moved && bot.jumped).collect() }
    }

    /// Lets bots run as far ahead as answers take.
    fn look_ahead(&mut self) {
        while self.moments.len() < DOWN + 1 {
            let seconds = f64::from(SERVER.tick);
            self.bots.iter_mut().for_each(|bot| bot.step(&self.level.track.path, seconds));
            let next = self.moment(true);
            self.moments.push_back(next);
        }
    }

    /// What is true when a tick begins, and when the next one does.
    pub fn now(&self) -> [&Moment; 2] {
        [&self.moments[0], &self.moments[1]]
    }

    /// Which bots each client was told of by the answer that counts from this tick to the next;
    /// empty as long as none arrived.
    pub fn told(&self) -> &[Vec<bool>] {
        match self.told.front() {
            Some(told) if self.told.len() > DOWN => told,
            _ => &[],
        }
    }

    /// What bots report and where they are, as the server knows it at this tick.
    fn report(&mut self) -> Result<(), ServerError> {
        let now = self.now_seconds();
        let sent: Vec<Option<Vec3>> = (0..self.bots.len())
            .map(|i| {
                let lost = self.random.random_bool(LOSS);
                self.lags[i] =
                    if self.random.random_bool(LAGS) { LAG } else { self.lags[i].saturating_sub(1) };
                (!lost && self.lags[i] == 0).then_some(self.moments[0].eyes[i])
            })
            .collect();
        self.reports.push_back(sent);
        let arrived = if self.reports.len() > UP { self.reports.pop_front() } else { None };
        for i in 0..self.bots.len() {
            // The jump that the answer of this tick orders.
            let jump = self.moments.get(DOWN).filter(|moment| moment.jumped[i] && self.tick > 0);
            let known = (1..=DOWN).rev().find(|&ahead| self.moments[ahead].jumped[i]).unwrap_or(0);
            self.server.move_entity(self.entities[i], self.moments[known].bodies[i], now)?;
            if let Some(moment) = jump {
                self.ignored[i] = UP + DOWN;
                self.server.move_eye(self.clients[i], moment.eyes[i], now)?;
            } else if self.ignored[i] > 0 {
                self.ignored[i] -= 1;
            } else if let Some(eye) = arrived.as_ref().and_then(|sent| sent[i]) {
                self.server.move_eye(self.clients[i], eye, now)?;
            }
        }
        Ok(())
    }

    /// The time of this tick, in seconds.
    pub fn now_seconds(&self) -> f64 {
        self.tick as f64 * f64::from(SERVER.tick)
    }

    /// Goes on to the next tick.
    pub fn advance(&mut self) {
        self.tick += 1;
        self.moments.pop_front();
        self.look_ahead();
    }

    /// Takes the reports of a tick and answers them. Returns how long the server took for that, by
    /// the clock that `clock` is, in its units.
    ///
    /// # Errors
    /// As [`VisibilityServer::tick`].
    pub fn answer<T>(
        &mut self,
        clock: impl FnOnce(&mut VisibilityServer, f64) -> T,
    ) -> Result<T, ServerError> {
        self.report()?;
        let now = self.now_seconds();
        let taken = clock(&mut self.server, now);
        let flags = |answer: &Answer| {
            self.entities.iter().map(|entity| answer.told.binary_search(entity).is_ok()).collect()
        };
        let told = self.clients.iter().map(|&client| self.server.answer(client).map(flags));
        let told = told.collect::<Result<_, _>>()?;
        self.told.push_back(told);
        if self.told.len() > DOWN + 1 {
            self.told.pop_front();
        }
        Ok(taken)
    }
}
