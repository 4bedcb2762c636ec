//! The thread that plays the game, tick by tick.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use casca::glam::Vec3;
use tokio::sync::{mpsc, oneshot, watch};

use crate::bots::{Bot, Level, SPEED, Track};
use crate::describe::{ClientDesc, EntityDesc};
use crate::error::ServerError;
use crate::id::{ClientId, EntityId};
use crate::net::map::Map;
use crate::net::metrics::Metrics;
use crate::net::options::FrontOptions;
use crate::server::VisibilityServer;
use crate::wire::{AnswerFrame, ToClient};

/// The latency of bots, in seconds.
const BOT_LATENCY: f32 = 0.1;

/// The seed of bots and of places to begin at.
const SEED: u64 = 1;

/// Ticks of the program are not more often than that, in seconds.
const SHORTEST_TICK: f32 = 1e-3;

/// The server expects ticks to be so many times as far apart as they are meant to be: answers hold
/// also if a tick begins a little late.
const TICK_ROOM: f32 = 1.25;

/// The map gets a new moment every so many seconds.
const MAP: f64 = 0.1;

/// What a connection and the game share.
#[derive(Debug)]
pub(crate) struct Link {
    /// The last place that the eye was reported at.
    pub(crate) eye: Mutex<Option<Vec3>>,
    pub(crate) answers: mpsc::Sender<Vec<u8>>,
}

/// What a connection asks of the game.
#[derive(Debug)]
pub(crate) enum Command {
    Join { latency: f32, link: Arc<Link>, reply: oneshot::Sender<Option<(ClientId, Vec<u8>)>> },
    Leave(ClientId),
}

/// A client with its entity.
struct Player {
    client: ClientId,
    entity: EntityId,
    /// None of a bot.
    link: Option<Arc<Link>>,
    bot: Option<Bot>,
    /// When its eye was last believed, in seconds.
    time: f64,
    latency: f64,
}

pub(crate) struct Game {
    track: Track,
    period: f32,
    server: VisibilityServer,
    players: BTreeMap<ClientId, Player>,
    metrics: Arc<Metrics>,
    map: Arc<Map>,
    joined: u64,
    tick: u64,
    drawn: f64,
}

impl Game {
    pub(crate) fn new(
        level: Level,
        options: &FrontOptions,
        metrics: Arc<Metrics>,
        map: Arc<Map>,
    ) -> Result<Self, ServerError> {
        let expected = options.server.tick(options.server.tick * TICK_ROOM);
        let mut server = VisibilityServer::new(level.scene, expected)?;
        level.baked.map_or(Ok(()), |file| server.set_baked(file))?;
        let mut game = Self {
            track: level.track,
            period: options.server.tick,
            server,
            players: BTreeMap::new(),
            metrics,
            map,
            joined: 0,
            tick: 0,
            drawn: -MAP,
        };
        for number in 0..options.bots as u64 {
            let bot = Bot::new(&game.track.path, SEED, number);
            game.add(bot.eye, BOT_LATENCY, None, Some(bot), 0.0)?;
        }
        // The first tick finds the walls, so that no report is believed without them.
        game.server.tick(0.0)?;
        Ok(game)
    }

    fn add(
        &mut self,
        eye: Vec3,
        latency: f32,
        link: Option<Arc<Link>>,
        bot: Option<Bot>,
        now: f64,
    ) -> Result<ClientId, ServerError> {
        let client = self.server.add_client(ClientDesc::new(eye, SPEED, latency), now)?;
        let desc = EntityDesc::new(self.track.body(eye), SPEED).owner(client);
        let entity = self.server.add_entity(desc, now).inspect_err(|_| {
            let _ = self.server.remove_client(client);
        })?;
        let player = Player { client, entity, link, bot, time: now, latency: latency.into() };
        self.players.insert(client, player);
        Ok(client)
    }

    fn remove(&mut self, client: ClientId) {
        if let Some(player) = self.players.remove(&client) {
            let _ = self.server.remove_entity(player.entity);
            let _ = self.server.remove_client(client);
        }
    }

    /// Plays until the server stops.
    pub(crate) fn play(mut self, mut commands: mpsc::Receiver<Command>, stopped: &watch::Receiver<bool>) {
        let begin = Instant::now();
        let period = Duration::from_secs_f32(self.period.max(SHORTEST_TICK));
        let room = period.mul_f32(TICK_ROOM - 1.0);
        let mut due = begin + period;
        while !*stopped.borrow() {
            let now = Instant::now();
            if now < due {
                std::thread::sleep(due - now);
            } else if now > due + room {
                self.metrics.late_ticks.inc();
                due = now;
            }
            due += period;
            let seconds = begin.elapsed().as_secs_f64();
            while let Ok(command) = commands.try_recv() {
                self.obey(command, seconds);
            }
            // All that is given is checked: an error would be one of this program.
            if let Err(error) = self.step(seconds) {
                tracing::error!(%error, "a tick failed");
            }
        }
        // Dropped links end their connections.
        self.players.clear();
    }

    fn obey(&mut self, command: Command, now: f64) {
        match command {
            Command::Join { latency, link, reply } => {
                let joined = self.join(latency, link, now);
                if let Err(Some((client, _))) = reply.send(joined) {
                    self.remove(client);
                }
            }
            Command::Leave(client) => self.remove(client),
        }
    }

    fn join(&mut self, latency: f32, link: Arc<Link>, now: f64) -> Option<(ClientId, Vec<u8>)> {
        // Anyone begins at another place.
        self.joined += 1;
        let number = self.joined + (1 << 32);
        let eye = Bot::new(&self.track.path, SEED, number).eye;
        let client = self.add(eye, latency, Some(link), None, now).ok()?;
        let entity = self.players.get(&client)?.entity;
        let welcome = ToClient::Welcome {
            client: client.key(),
            entity: entity.key(),
            tick: (self.period * 1e6) as u32,
            speed: SPEED,
            eye,
        };
        Some((client, welcome.encode()))
    }

    /// Moves all, and answers all clients.
    fn step(&mut self, now: f64) -> Result<(), ServerError> {
        self.tick += 1;
        self.move_all(now)?;
        let begin = Instant::now();
        let answers = self.server.tick(now)?;
        self.metrics.tick_seconds.observe(begin.elapsed().as_secs_f64());
        self.metrics.ticks.inc();
        self.metrics.told.set(answers.iter().map(|answer| answer.told.len() as i64).sum());
        self.metrics.clients.set(answers.len() as i64);
        self.metrics.entities.set(self.players.len() as i64);
        self.send()?;
        if now - self.drawn >= MAP {
            self.drawn = now;
            self.map.update(&self.server, self.tick);
        }
        Ok(())
    }

    fn move_all(&mut self, now: f64) -> Result<(), ServerError> {
        let tick = f64::from(self.period);
        for player in self.players.values_mut() {
            let eye = if let Some(bot) = &mut player.bot {
                bot.step(&self.track.path, tick);
                Some(bot.eye)
            } else if let Some(link) = &player.link {
                let eye = link.eye.lock().unwrap_or_else(PoisonError::into_inner).take();
                let from = self.server.client(player.client)?.eye;
                let most = f64::from(SPEED) * (now - player.time + player.latency + tick);
                let goes = |to: &Vec3| {
                    let far = (to.as_dvec3() - from.as_dvec3()).length() > most;
                    // A body in a wall would be seen on its other side before it is told.
                    let ways = std::iter::once([from, *to]).chain(self.track.across(*to));
                    let walled = |[from, to]: [Vec3; 2]| self.server.has_wall_between(from, to);
                    let stands = !far && !ways.into_iter().any(walled);
                    self.metrics.refused_moves.inc_by(u64::from(!stands));
                    stands
                };
                eye.filter(goes)
            } else {
                None
            };
            if let Some(eye) = eye {
                player.time = now;
                self.server.move_eye(player.client, eye, now)?;
                self.server.move_entity(player.entity, self.track.body(eye), now)?;
            }
        }
        Ok(())
    }

    /// Sends answers, and drops clients that do not read theirs.
    fn send(&mut self) -> Result<(), ServerError> {
        let mut slow = Vec::new();
        for player in self.players.values() {
            let Some(link) = &player.link else { continue };
            let answer = self.server.answer(player.client)?;
            let frame = ToClient::Answer(AnswerFrame::of(&self.server, answer, self.tick)).encode();
            self.metrics.bytes.inc_by(frame.len() as u64);
            // The queue is full, or the connection ended.
            if link.answers.try_send(frame).is_err() {
                slow.push(player.client);
            }
        }
        slow.into_iter().for_each(|client| self.remove(client));
        Ok(())
    }
}
