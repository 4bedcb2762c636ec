//! A bot: how it moves.

use casca::glam::Vec3;
use casca_scenes::random::{Generator, generator, spread};
use rand::RngExt;

/// How far bots step aside from their path, in metres.
const ASIDE: f32 = 0.2;

/// Steps of a path count as this long at least, in metres: one of no length would take no time.
const SHORTEST: f32 = 1e-4;

/// The greatest speed of players, in metres a second.
pub const SPEED: f32 = 5.0;

/// How often a second a bot turns back, as one who peeks around a corner, stops for a while, begins to
/// strafe from side to side, and jumps to another place.
const TURNS: f64 = 0.8;
const STOPS: f64 = 0.1;
const STRAFES: f64 = 0.3;
const JUMPS: f64 = 0.05;

/// A bot that runs along a path.
#[derive(Debug, Clone)]
pub struct Bot {
    random: Generator,
    /// How far along the path it is, in places of it.
    along: f32,
    way: f32,
    rest: f64,
    strafe: f64,
    /// Where its eye is.
    pub eye: Vec3,
    /// Whether it jumped in the last step.
    pub jumped: bool,
}

impl Bot {
    /// A bot somewhere on a path, by its number.
    pub fn new(path: &[Vec3], seed: u64, number: u64) -> Self {
        let mut random = generator(seed ^ spread(number + 1), 0xb07);
        let along = random.random_range(0.0..1.0) * (path.len() - 1) as f32;
        let way = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        let mut bot = Self { random, along, way, rest: 0.0, strafe: 0.0, eye: Vec3::ZERO, jumped: true };
        bot.eye = bot.target(path);
        bot
    }

    /// Where it wants to be.
    fn target(&self, path: &[Vec3]) -> Vec3 {
        let last = path.len() - 1;
        let i = (self.along as usize).min(last.saturating_sub(1));
        let (a, b) = (path[i], path[(i + 1).min(last)]);
        let ahead = (b - a).normalize_or_zero();
        let aside = Vec3::new(-ahead.z, 0.0, ahead.x) * (ASIDE * (self.strafe * 9.0).sin() as f32);
        a.lerp(b, (self.along - i as f32).clamp(0.0, 1.0)) + aside
    }

    /// Moves for some seconds.
    pub fn step(&mut self, path: &[Vec3], seconds: f64) {
        let happens =
            |random: &mut Generator, rate: f64| random.random_bool((rate * seconds).clamp(0.0, 1.0));
        self.jumped = happens(&mut self.random, JUMPS);
        if self.jumped {
            self.along = self.random.random_range(0.0..1.0) * (path.len() - 1) as f32;
            (self.strafe, self.rest) = (0.0, 0.0);
            self.eye = self.target(path);
            return;
        }
        if happens(&mut self.random, TURNS) {
            self.way = -self.way;
        }
        if happens(&mut self.random, STOPS) {
            self.rest = self.random.random_range(0.2..2.0);
        }
        if happens(&mut self.random, STRAFES) {
            self.strafe = self.random.random_range(0.5..2.0);
        }
        self.rest -= seconds;
        self.strafe = (self.strafe - seconds).max(0.0);
        let step = SPEED * seconds as f32 * 0.999;
        if self.rest <= 0.0 {
            self.advance(path, step);
        }
        self.eye += (self.target(path) - self.eye).clamp_length_max(step);
    }

    /// Goes on along the path, and turns around at its ends.
    fn advance(&mut self, path: &[Vec3], step: f32) {
        let last = (path.len() - 1) as f32;
        // It never runs far ahead of its eye, which would cut corners.
        let mut left = if self.target(path).distance(self.eye) < step { step } else { 0.0 };
        while left > 0.0 {
            let i = (self.along as usize).min(path.len() - 2);
            let long = path[i].distance(path[i + 1]).max(SHORTEST);
            let by = (left / long).min(0.5);
            self.along += self.way * by;
            left -= by * long;
            if self.along <= 0.0 || self.along >= last {
                self.along = self.along.clamp(0.0, last);
                self.way = -self.way;
                break;
            }
        }
    }
}
