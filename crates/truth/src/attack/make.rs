//! Makes operations: frames as an application runs them, with most of what can go wrong in between.

mod shapes;

use casca::Method;
use glam::Vec3;

use super::dice::{Dice, direction};
use super::ops::{Config, Due, From, Look, Op, Toward};
use super::views::{Depth, Limits, Roams};

/// Things in a scene, at most.
const MOST_THINGS: usize = 40;

/// Makes the operations of one play.
pub struct Maker<'a> {
    dice: Dice<'a>,
    /// The scene.
    pub config: Config,
    /// Boxes that hide.
    walls: Vec<(Vec3, Vec3)>,
    ops: Vec<Op>,
    /// Numbers of objects that are there, and how many there were.
    living: Vec<u16>,
    names: u16,
}

impl<'a> Maker<'a> {
    /// Chooses the scene.
    pub fn new(mut dice: Dice<'a>) -> Self {
        let config = Config::new(&mut dice);
        Self { dice, config, walls: Vec::new(), ops: Vec::new(), living: Vec::new(), names: 0 }
    }

    /// Makes about as many operations as asked for, fewer where bytes are used up.
    pub fn ops(mut self, count: usize) -> (Config, Vec<Op>) {
        for _ in 0..1 + self.dice.below(3) {
            let op = self.wall();
            self.ops.push(op);
        }
        for _ in 0..4 + self.dice.below(20) {
            let op = self.insert();
            self.ops.push(op);
        }
        while self.ops.len() < count && !self.dice.is_over() {
            self.frame();
        }
        (self.config, self.ops)
    }

    fn frame(&mut self) {
        let mut ran = 0u8;
        if !self.dice.once_in(12) {
            let dt = match self.dice.below(16) {
                0 => 0.0,
                1 => 1e-6,
                2 | 3 => f64::from(self.dice.between(0.5, 10.0)),
                4 if self.dice.once_in(3) => -f64::from(self.dice.between(0.0, 3.0)),
                5 if self.dice.once_in(8) => self.dice.pick(&[1e6, 1e12, 1e30]),
                5..=9 => f64::from(self.dice.between(0.05, 0.5)),
                _ => 1.0 / 60.0,
            };
            let due = self.dice.pick(&[Due::All, Due::All, Due::Some, Due::None]);
            let seed = self.dice.seed();
            self.ops.push(Op::Begin { dt, due, seed });
        }
        for _ in 0..self.dice.below(6) {
            self.change();
        }
        for _ in 0..1 + self.dice.below(3) / 2 {
            self.look(&mut ran);
        }
        if self.dice.once_in(3) {
            self.change();
            self.ask();
        }
        if self.dice.once_in(4) {
            self.change();
            self.look(&mut ran);
        }
        if self.dice.once_in(4) {
            self.ask();
        }
        if self.dice.once_in(4) {
            self.stalk(&mut ran);
        }
        let end = match self.dice.below(10) {
            0 => None,
            1 => Some((0, 0)),
            2 => Some((self.dice.below(8) as u8, 0)),
            3 => Some((ran, self.dice.below(16) as u8)),
            _ => Some((ran, 0)),
        };
        if let Some((queries, kept)) = end {
            self.ops.push(Op::End { queries, kept });
            if self.dice.once_in(12) {
                self.change();
            }
        }
        if end.is_some_and(|end| end != (0, 0)) && self.dice.once_in(3) {
            self.run_out();
        }
        if self.dice.once_in(5) {
            self.rarely();
        }
    }

    fn nearer(&mut self, who: u16) -> Op {
        Op::Nearer { who, side: self.dice.below(6) as u8, share: self.dice.pick(&[0.5, 0.9, 0.99]) }
    }

    /// One eye looks for some frames, while hidden objects are reported nearer to the walls of
    /// their volumes.
    fn run_out(&mut self) {
        let from = From::Camera(self.dice.pick(&[0, 0, 0, 1, 2]));
        let method = self.dice.pick(&[Method::point(), Method::point(), Method::cell()]);
        for frame in 0..4 {
            let due = if frame < 2 { Due::All } else { Due::None };
            let dt = f64::from(self.dice.between(0.02, 0.3));
            self.ops.push(Op::Begin { dt, due, seed: self.dice.seed() });
            for _ in 0..if frame == 2 { 6 } else { 0 } {
                let who = self.who();
                let op = self.nearer(who);
                self.ops.push(op);
            }
            let (toward, limits, seed) = (Toward::Along(Vec3::X), Limits::Around, self.dice.seed());
            let (mask, roams) = (u64::MAX, Roams::Not);
            let look = Look { query: 0, method, from, toward, limits, roams, keep: false, mask, seed };
            self.ops.push(Op::Look(look));
            self.ops.push(Op::End { queries: 1, kept: 0 });
        }
    }

    /// An object that is there.
    fn who(&mut self) -> u16 {
        match self.living.len() as u32 {
            0 => 0,
            n => self.living[self.dice.below(n) as usize],
        }
    }

    fn name(&mut self) -> u16 {
        self.names += 1;
        self.living.push(self.names);
        self.names
    }

    fn change(&mut self) {
        let who = self.who();
        let op = match self.dice.below(24) {
            0..=8 => {
                let step = self.config.cell * self.dice.pick(&[0.05, 0.3, 1.0, 3.0]);
                let by = self.config.snap(direction(&mut self.dice) * step);
                Op::Move { who, by }
            }
            9..=11 => Op::Jump { who, to: self.place() },
            12 => {
                let form = self.form();
                Op::Reshape { who, form, hides: self.hides() }
            }
            13 if self.dice.once_in(3) => Op::Uncover { who },
            14 => Op::Same { who },
            15 => {
                let by = direction(&mut self.dice) * self.config.cell * self.dice.unit();
                Op::Translate { who, by: self.config.snap(by) }
            }
            16 | 17 if self.dice.once_in(2) || self.living.len() >= MOST_THINGS => {
                self.living.retain(|&name| name != who);
                Op::Remove { who }
            }
            16 | 17 => self.insert(),
            18 | 19 => Op::Leave { who },
            20 => self.nearer(who),
            21 if self.dice.once_in(2) => {
                let mask = self.dice.pick(&[u64::MAX, u64::MAX, u64::MAX, 1, 2, 3, 0]);
                Op::Layers { who, mask }
            }
            _ => {
                let share = self.dice.pick(&[1.0, 1.0, 0.5]);
                Op::Drift { who, along: direction(&mut self.dice), share }
            }
        };
        self.ops.push(op);
    }

    fn from(&mut self) -> From {
        match self.dice.below(24) {
            0..=11 => From::Camera(0),
            12..=15 => From::Camera(self.dice.below(3) as u8),
            16 => From::Inside(self.who(), direction(&mut self.dice) * self.dice.pick(&[0.0, 0.3, 1.0])),
            17 => {
                let share = Vec3::new(self.dice.unit(), self.dice.unit(), self.dice.unit());
                From::Volume(self.who(), self.dice.settled(share, 1.0))
            }
            18 => From::At(self.config.min + direction(&mut self.dice) * self.config.size() * 3.0),
            19 if self.dice.once_in(4) => From::At(self.config.min + direction(&mut self.dice) * 1e5),
            20 if self.dice.once_in(2) => From::At(self.beyond()),
            _ => From::At(self.place()),
        }
    }

    fn toward(&mut self) -> Toward {
        if self.dice.once_in(3) {
            Toward::Along(direction(&mut self.dice))
        } else {
            Toward::Object(self.who())
        }
    }

    fn limits(&mut self) -> Limits {
        let depth =
            self.dice.pick(&[Depth::Usual, Depth::Usual, Depth::Reversed, Depth::Infinite, Depth::Gl]);
        let aspect = self.dice.between(0.5, 2.0);
        let mirrored = self.dice.once_in(4);
        let far = self.config.size().length() * self.dice.pick(&[1.5, 1.5, 0.4]);
        match self.dice.below(12) {
            0..=5 => Limits::Around,
            6 | 7 => {
                let back = self.config.cell * self.dice.pick(&[0.0, 0.0, 1.0, -1.5]);
                let planes = (0..1 + self.dice.below(4)).map(|_| (direction(&mut self.dice), back)).collect();
                Limits::Planes(planes)
            }
            8..=10 => Limits::Camera {
                fov: self.dice.pick(&[1.0, 1.5, 0.3, 2.6]),
                aspect,
                near: self.config.cell * self.dice.pick(&[0.01, 0.1, 0.1, 2.0]),
                far,
                mirrored,
                depth,
                exact: !self.dice.once_in(3),
            },
            _ => Limits::Parallel {
                half: self.config.cell * self.dice.between(2.0, 20.0),
                aspect,
                near: self.config.cell * self.dice.pick(&[-60.0, 0.0, 1.0]),
                far,
                mirrored,
                depth,
                told: !self.dice.once_in(4),
            },
        }
    }

    fn roams(&mut self) -> Roams {
        let cell = self.config.cell;
        match self.dice.below(8) {
            0 | 1 => {
                let reach = cell * self.dice.pick(&[0.0, 0.02, 0.3, 0.3, 2.0]);
                Roams::Ball { reach, turn: self.dice.pick(&[0.0, 0.01, 0.2, 1.0]) }
            }
            // Some are flat.
            2 => Roams::Box(direction(&mut self.dice).abs() * cell * self.dice.pick(&[0.1, 0.5, 2.0])),
            _ => Roams::Not,
        }
    }

    fn look(&mut self, ran: &mut u8) {
        let query = self.dice.below(3) as u8;
        let method = match self.dice.below(8) {
            0 => Method::Frustum,
            1..=3 => Method::cell(),
            _ => Method::point(),
        };
        let (from, keep) = (self.from(), self.dice.once_in(3));
        self.look_from(ran, query, method, from, keep);
    }

    fn look_from(&mut self, ran: &mut u8, query: u8, method: Method, from: From, keep: bool) {
        *ran |= 1 << query;
        let (toward, limits, roams) = (self.toward(), self.limits(), self.roams());
        let (mask, seed) = (self.mask(), self.dice.seed());
        self.ops.push(Op::Look(Look { query, method, from, toward, limits, roams, keep, mask, seed }));
    }

    /// The layers of a view: mostly all.
    fn mask(&mut self) -> u64 {
        if self.dice.once_in(4) { self.dice.pick(&[1, 2, 3, 4, u64::MAX - 1, 0]) } else { u64::MAX }
    }

    /// Keeps a set, moves an object step by step, and asks for the set each time.
    fn stalk(&mut self, ran: &mut u8) {
        let method = self.dice.pick(&[Method::point(), Method::cell(), Method::cell(), Method::Frustum]);
        self.look_from(ran, 0, method, From::Camera(0), true);
        let (who, along) = (self.who(), direction(&mut self.dice));
        for _ in 0..1 + self.dice.below(3) {
            let by = self.config.snap(along * self.config.cell * self.dice.pick(&[0.4, 1.0]));
            self.ops.push(Op::Move { who, by });
            self.ask();
        }
    }

    fn ask(&mut self) {
        let nudge = direction(&mut self.dice) * self.config.cell * self.dice.pick(&[0.0, 0.1, 0.4]);
        let (toward, limits) = (self.toward(), self.limits());
        self.ops.push(Op::Ask { nudge, toward, limits, seed: self.dice.seed() });
    }

    fn rarely(&mut self) {
        let op = match self.dice.below(10) {
            0 => Op::Clone { go_on_with_it: self.dice.once_in(2) },
            1 | 2 => Op::Switch,
            3 => Op::Forget,
            4 | 5 => Op::Cross,
            6 | 7 => Op::Casters {
                query: self.dice.below(3) as u8,
                receivers: self.dice.below(3) as u8,
                light: direction(&mut self.dice),
            },
            _ => Op::List { query: self.dice.below(3) as u8, least: self.dice.pick(&[0.0, 0.1, 10.0]) },
        };
        self.ops.push(op);
    }
}
