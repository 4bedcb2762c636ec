//! The walker, the guards, the doors, and the tiles that the walker has seen.

use std::collections::{HashMap, VecDeque};
use std::error::Error;

use casca_plane::maps::Drawing;
use casca_plane::{FieldOfView, Fog, FovOptions, OpaqueTiles, TilePoint};
use glam::Vec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A tile, column and row.
pub type Tile = (u32, u32);

/// The four steps to a neighbour.
pub const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];
/// Guards on maps that place none.
const GUARDS: usize = 12;
/// How far the walker sees, and how far guards do, in tiles.
const SIGHT: f32 = 24.0;
const GUARD_SIGHT: f32 = 9.0;
/// Half the angle that guards see, in radians.
const GUARD_ANGLE: f32 = 0.6;

/// What stands on a tile.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    Ground,
    Wall,
    Door { open: bool },
}

pub struct Guard {
    pub at: Tile,
    facing: (i32, i32),
    /// Whether the guard sees the walker.
    pub alert: bool,
}

pub struct Game {
    /// Walls and closed doors.
    opaque: OpaqueTiles,
    doors: Vec<Tile>,
    pub guards: Vec<Guard>,
    pub walker: Tile,
    pub fog: Fog,
    /// What each tile looked like when it was last seen, row by row.
    memory: Vec<Option<Kind>>,
    /// The tiles that some guard watches.
    pub watched: Fog,
    random: Pcg64Mcg,
    fov: FieldOfView,
}

impl Game {
    /// A map with all doors closed. Guards and walker stand on free tiles by chance if the map does
    /// not place them.
    pub fn new(map: Drawing, seed: u64) -> Result<Self, Box<dyn Error>> {
        let (width, height) = (map.walls.width(), map.walls.height());
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut free: Vec<Tile> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
        free.retain(|&(x, y)| !map.walls.get(x, y));
        if free.is_empty() {
            return Err("the map has no free tile".into());
        }
        let mut any = || free[random.random_range(0..free.len())];
        let walker = map.start.unwrap_or_else(&mut any);
        let mut places = map.guards;
        if places.is_empty() {
            places.extend((0..GUARDS).map(|_| any()));
        }
        let mut opaque = OpaqueTiles::new(map.walls);
        map.doors.iter().for_each(|&(x, y)| opaque.set(x, y, true));
        let guard = |at| Guard { at, facing: STEPS[random.random_range(0..4)], alert: false };
        let guards = places.into_iter().map(guard).collect();
        let mut game = Self {
            opaque,
            doors: map.doors,
            guards,
            walker,
            fog: Fog::new(width, height),
            memory: vec![None; (width * height) as usize],
            watched: Fog::new(width, height),
            random,
            fov: FieldOfView::new(),
        };
        game.look_around()?;
        Ok(game)
    }

    pub fn size(&self) -> (u32, u32) {
        (self.opaque.width(), self.opaque.height())
    }

    /// The tile beside another, if the map has it.
    pub fn beside(&self, (x, y): Tile, (right, down): (i32, i32)) -> Option<Tile> {
        let (x, y) = (x.checked_add_signed(right)?, y.checked_add_signed(down)?);
        (x < self.opaque.width() && y < self.opaque.height()).then_some((x, y))
    }

    fn kind(&self, (x, y): Tile) -> Kind {
        match (self.doors.contains(&(x, y)), self.opaque.get(x, y)) {
            (true, closed) => Kind::Door { open: !closed },
            (false, true) => Kind::Wall,
            (false, false) => Kind::Ground,
        }
    }

    /// What the walker knows of a tile.
    pub fn known(&self, (x, y): Tile) -> Option<Kind> {
        self.memory[(y * self.opaque.width() + x) as usize]
    }

    /// Lets the walker take a step, or open the door that is in the way.
    pub fn step(&mut self, step: (i32, i32)) {
        let Some(to) = self.beside(self.walker, step) else { return };
        match self.kind(to) {
            Kind::Wall => {}
            Kind::Door { open: false } => self.opaque.set(to.0, to.1, false),
            _ if self.guards.iter().any(|guard| guard.at == to) => {}
            _ => self.walker = to,
        }
    }

    /// Opens or closes the doors beside the walker.
    pub fn turn_doors(&mut self) {
        for to in STEPS.into_iter().filter_map(|step| self.beside(self.walker, step)).collect::<Vec<_>>() {
            if let Kind::Door { open } = self.kind(to)
                && self.guards.iter().all(|guard| guard.at != to)
            {
                self.opaque.set(to.0, to.1, open);
            }
        }
    }

    /// Ends a turn: guards walk, then all look around.
    pub fn end_turn(&mut self) -> Result<(), Box<dyn Error>> {
        for index in 0..self.guards.len() {
            self.walk(index);
        }
        self.look_around()
    }

    /// Lets a guard go on ahead, or turn where the way ends. Guards close the doors behind them.
    fn walk(&mut self, index: usize) {
        let Guard { at, facing, .. } = self.guards[index];
        let turns = self.random.random_bool(0.08);
        let free = |to: &Tile| {
            let taken = *to == self.walker || self.guards.iter().any(|guard| guard.at == *to);
            self.kind(*to) != Kind::Wall && !taken
        };
        match self.beside(at, facing).filter(free) {
            Some(to) if !turns => {
                if matches!(self.kind(at), Kind::Door { .. }) {
                    self.opaque.set(at.0, at.1, true);
                }
                self.opaque.set(to.0, to.1, false);
                self.guards[index].at = to;
            }
            _ => self.guards[index].facing = STEPS[self.random.random_range(0..4)],
        }
    }

    /// The first step on the way to unknown tiles, around guards; none if all that can be reached is
    /// known.
    pub fn next_step(&self) -> Option<(i32, i32)> {
        let guarded = |at: Tile| {
            let (x, y) = at;
            self.fog.seen().get(x, y) && self.guards.iter().any(|guard| guard.at == at)
        };
        let mut first_steps: HashMap<Tile, (i32, i32)> = HashMap::new();
        let mut open = VecDeque::from([self.walker]);
        while let Some(at) = open.pop_front() {
            let first = first_steps.get(&at).copied();
            for step in STEPS {
                let Some(to) = self.beside(at, step) else { continue };
                let first = first.unwrap_or(step);
                match self.known(to) {
                    None if at != self.walker => return Some(first),
                    // An unknown tile beside the walker lies behind a corner of walls.
                    None | Some(Kind::Wall) => {}
                    Some(_) if to == self.walker || guarded(to) || first_steps.contains_key(&to) => {}
                    Some(_) => {
                        first_steps.insert(to, first);
                        open.push_back(to);
                    }
                }
            }
        }
        None
    }

    /// Finds what the walker and the guards see.
    fn look_around(&mut self) -> Result<(), Box<dyn Error>> {
        let eye = |(x, y): Tile| TilePoint::center_of(x, y);
        self.fog.begin_frame();
        self.fov.run(&self.opaque, eye(self.walker), &FovOptions::default().in_circle(SIGHT)?);
        self.fog.add(&self.fov)?;
        for (x, y) in self.fog.seen().cells() {
            self.memory[(y * self.opaque.width() + x) as usize] = Some(self.kind((x, y)));
        }
        self.watched.begin_frame();
        for guard in &mut self.guards {
            let ahead = Vec2::new(guard.facing.0 as f32, guard.facing.1 as f32);
            let options = FovOptions::default().in_circle(GUARD_SIGHT)?.in_sector(ahead, GUARD_ANGLE)?;
            let seen = self.fov.run(&self.opaque, eye(guard.at), &options);
            guard.alert = seen.get(self.walker.0, self.walker.1);
            self.watched.add(&self.fov)?;
        }
        Ok(())
    }
}
