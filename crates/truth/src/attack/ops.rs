//! The operations of an attack, and the settings of the scene that they are played in.

use casca::Method;
use glam::{Affine3A, DVec3, UVec3, Vec3};

use super::dice::{Dice, direction, turn};
use super::forms::{CLOSED_BASES, Form, skew};
use super::views::{Limits, Roams};

/// Steps of coordinates that are exact in single precision, also far from the origin.
const STEPS: f32 = 64.0;

/// Cells between two planes of the lattice that half of all coordinates lie on.
const LATTICE: f32 = 2.0;

#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    pub min: Vec3,
    pub cell: f32,
    pub dims: UVec3,
    /// Whether coordinates are multiples of a 64th.
    pub exact: bool,
    /// Whether queries have the default settings instead of coarse, fast ones.
    pub fine: bool,
    /// Eyes that look again and again.
    pub cameras: [Vec3; 3],
}

impl Config {
    /// A scene by chance, also far from the origin.
    pub fn new(dice: &mut Dice) -> Self {
        let cell = dice.pick(&[1.0, 0.5, 2.0, 1.0]);
        let mut side = || dice.pick(&[16, 20, 24, 16, 18, 24, 32, 40]);
        let dims = UVec3::new(side(), side(), side());
        let away = dice.pick(&[0.0, 0.0, 0.0, 0.0, 1e3, 1e5]);
        let mut corner = || away * dice.pick(&[1.0, -1.0, 0.0]);
        let min = Vec3::new(corner(), corner(), corner());
        let exact = min != Vec3::ZERO || dice.once_in(3);
        let mut config = Self { min, cell, dims, exact, fine: dice.once_in(12), cameras: [Vec3::ZERO; 3] };
        config.cameras = [(); 3].map(|()| config.inside(dice));
        config
    }

    /// A coordinate that this scene uses.
    pub fn snap(&self, p: Vec3) -> Vec3 {
        if self.exact { (p * STEPS).round() / STEPS } else { p }
    }

    pub fn size(&self) -> Vec3 {
        self.dims.as_vec3() * self.cell
    }

    pub fn inside(&self, dice: &mut Dice) -> Vec3 {
        let share = Vec3::new(dice.unit(), dice.unit(), dice.unit());
        self.settled(dice, self.min + self.size() * share)
    }

    /// A place nearby, with half of its coordinates on planes between cells, a few of them.
    pub fn settled(&self, dice: &mut Dice, p: Vec3) -> Vec3 {
        self.snap(self.min + dice.settled(p - self.min, LATTICE * self.cell))
    }
}

/// What an object hides others with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hides {
    Nothing,
    /// All of its bounds.
    Itself,
    /// A solid inside its bounds: of this kind, and by this seed.
    Inner(u8, u32),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Moves {
    Fixed,
    Free,
    Within(f32),
    /// With a greatest speed, reported on expiry.
    OnExpiry(f32),
    /// It is fixed, but a greatest speed is given.
    FixedWithin(f32),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum From {
    Camera(u8),
    At(Vec3),
    /// At the middle of an object, moved by a share of its size.
    Inside(u16, Vec3),
    /// In the volume of a hidden object, at a share of its edges.
    Volume(u16, Vec3),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Toward {
    Object(u16),
    Along(Vec3),
}

/// Which of the objects due are reported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Due {
    All,
    Some,
    None,
}

/// A query; `mask` are the layers that its view shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    pub query: u8,
    pub method: Method,
    pub from: From,
    pub toward: Toward,
    pub limits: Limits,
    pub roams: Roams,
    pub keep: bool,
    pub mask: u64,
    pub seed: u32,
}

/// A call on a scene. Each object has a number for a name; calls on objects that do not exist are
/// passed over.
///
/// - `Reshape` changes bounds and occluder, `Uncover` updates without an occluder, `Same` with the
///   bounds that the scene has already.
/// - `Drift` moves an unreported object by a share of the way that its promise allows, `Leave` out
///   of its volume, or as far as it promised. `Nearer` reports a hidden object nearer to a wall of
///   its volume, by a share of the room that it has.
/// - `Ask` asks kept sets whether they hold: for their own views, for their cameras moved and turned,
///   and for others from close by.
/// - `End` ends the frame with the results of some queries (by bits) and some kept sets.
/// - `Forget` forgets the other scene, `Cross` uses sets and ids of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Op {
    Insert { name: u16, form: Form, hides: Hides, moves: Moves },
    Move { who: u16, by: Vec3 },
    Jump { who: u16, to: Vec3 },
    Reshape { who: u16, form: Form, hides: Hides },
    Uncover { who: u16 },
    Same { who: u16 },
    Translate { who: u16, by: Vec3 },
    Remove { who: u16 },
    Layers { who: u16, mask: u64 },
    Drift { who: u16, along: Vec3, share: f32 },
    Nearer { who: u16, side: u8, share: f32 },
    Leave { who: u16 },
    Begin { dt: f64, due: Due, seed: u32 },
    Look(Look),
    Ask { nudge: Vec3, toward: Toward, limits: Limits, seed: u32 },
    End { queries: u8, kept: u8 },
    Clone { go_on_with_it: bool },
    Switch,
    Forget,
    Cross,
    Casters { query: u8, receivers: u8, light: Vec3 },
    List { query: u8, least: f32 },
}

impl Hides {
    /// The occluder of an object with these bounds.
    pub fn form(self, bounds: &Form, config: &Config) -> Option<Form> {
        let (kind, seed) = match self {
            Self::Nothing => return None,
            Self::Itself => return Some(bounds.clone()),
            Self::Inner(kind, seed) => (kind, seed),
        };
        let Some((center, half)) = bounds.room() else { return Some(bounds.clone()) };
        // Inwards, where coordinates are rounded.
        let half = if config.exact { (half * STEPS).floor() / STEPS } else { half };
        if half.min_element() <= 0.0 {
            return Some(bounds.clone());
        }
        let mut dice = Dice::new(u64::from(seed));
        let least = half.min_element();
        // A turned box inside the ball of this radius.
        let corner = Vec3::splat(least * 0.55);
        Some(match kind % 6 {
            0 => Form::Ball { center, radius: least },
            1 => Form::Block { min: center - half, max: center + half },
            2 => Form::Turned { center, half: corner, turn: turn(&mut dice) },
            3 => {
                let cuts = (0..1 + dice.below(4))
                    .map(|_| (direction(&mut dice), dice.between(0.1, 0.9) * least))
                    .collect();
                Form::Cut { min: center - half, max: center + half, cuts, by: DVec3::ZERO }
            }
            4 => {
                let points = (0..4 + dice.below(5)).map(|_| {
                    let share = Vec3::new(dice.unit(), dice.unit(), dice.unit()) * 2.0 - 1.0;
                    let share = dice.settled(share, 0.5);
                    config.snap(center + share * half).clamp(center - half, center + half)
                });
                Form::Hull { points: points.collect(), by: DVec3::ZERO }
            }
            _ => {
                let base = dice.below(u32::from(CLOSED_BASES)) as u8;
                let matrix = skew(turn(&mut dice), corner * dice.pick(&[1.0, -1.0]), 0.0);
                Form::Placed { base, transform: Affine3A::from_mat3_translation(matrix, center) }
            }
        })
    }
}
