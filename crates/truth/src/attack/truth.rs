//! The truth: where everything is, what was told about it, and what can be seen.

use casca::ObjectId;
use glam::DVec3;

use super::dice::Dice;
use super::forms::Form;
use super::ops::Moves;
use super::solid::Solid;
use super::views::{Sight, TrueView};
use crate::numeric::attack::KEPT_SPEED;

#[derive(Debug, Clone)]
pub struct Thing {
    /// A number for messages, the same in clones.
    pub name: u16,
    pub id: ObjectId,
    /// What was told last.
    pub bounds: Form,
    /// What was told last.
    pub occluder: Option<Form>,
    pub layers: u64,
    pub moves: Moves,
    /// Its points, where it was told to be.
    pub body: Solid,
    /// What it hides others with, where it was told to be.
    pub cover: Option<Solid>,
    /// How far it may be from there by now.
    pub way: f64,
    /// How far it is from there.
    pub drift: DVec3,
    /// Whether the last set holds it, so that it is reported in the next frame.
    pub held: bool,
    /// Whether a query of this frame found it.
    pub found: bool,
    /// Whether it was due and not reported since: then every set must hold it, wherever it is.
    pub owed: bool,
    /// Whether it was inserted after the scene and its clone parted.
    pub own: bool,
}

#[derive(Debug, Clone)]
pub struct Sighting {
    pub thing: usize,
    pub sight: Sight,
    /// How far the object is from where it was told to be.
    pub drift: DVec3,
}

/// Effort of a look for lost objects.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    pub points: u32,
    /// Places of each object that is not reported.
    pub places: u32,
}

impl Thing {
    /// Whether its motion goes unreported while it is hidden.
    pub fn on_expiry(&self) -> bool {
        matches!(self.moves, Moves::OnExpiry(_))
    }

    /// Whether an eye is surely outside of its occluder, or views of these layers do not show it.
    pub fn is_outside(&self, eye: DVec3, layers: u64) -> bool {
        self.layers & layers == 0 || self.cover.as_ref().is_none_or(|c| !c.may_hold(eye - self.drift))
    }

    /// Takes up what was told just now.
    pub fn told(&mut self, bounds: Form, occluder: Option<Form>) {
        self.body = Solid::new(&bounds);
        self.cover = occluder.as_ref().map(Solid::new);
        (self.bounds, self.occluder) = (bounds, occluder);
        (self.way, self.drift, self.owed) = (0.0, DVec3::ZERO, false);
    }

    pub fn wait(&mut self, dt: f64) {
        if let Moves::OnExpiry(speed) = self.moves {
            self.way += f64::from(speed) * dt.max(0.0) * KEPT_SPEED;
        }
    }

    /// Moves it, unreported, within its promise.
    pub fn drift_to(&mut self, drift: DVec3) {
        self.drift = drift.clamp_length_max(self.way);
    }
}

/// Whether another thing on some layers hides the end of a sight; tries the one that did last
/// first.
fn hidden(things: &[Thing], target: usize, layers: u64, sight: &Sight, last: &mut usize) -> bool {
    let hides = |i: usize| {
        // A solid that hides points of itself is met at a point of itself before.
        i != target
            && things[i].layers & layers != 0
            && things[i]
                .cover
                .as_ref()
                .is_some_and(|c| c.hides(sight.from - things[i].drift, sight.to - things[i].drift))
    };
    if *last < things.len() && hides(*last) {
        return true;
    }
    for i in 0..things.len() {
        if hides(i) {
            *last = i;
            return true;
        }
    }
    false
}

/// A place that an unreported object may have reached.
fn place(thing: &Thing, view: &TrueView, attempt: u32, dice: &mut Dice) -> DVec3 {
    let (towards, _) = view.towards(thing.body.middle);
    let way = thing.way;
    match attempt {
        0 => thing.drift,
        1 => towards * way,
        _ if dice.once_in(2) => {
            let (a, b) = towards.any_orthonormal_pair();
            let angle = f64::from(dice.unit()) * std::f64::consts::TAU;
            (a * angle.cos() + b * angle.sin()) * way * f64::from((dice.unit() * 2.0).min(1.0))
        }
        _ => DVec3::AXES[dice.below(3) as usize] * way * dice.pick(&[1.0, -1.0]),
    }
}

/// Looks for an object that is seen and not among those held.
pub fn find_lost(
    things: &[Thing],
    view: &TrueView,
    held: impl Fn(&Thing) -> bool,
    effort: Effort,
    dice: &mut Dice,
) -> Option<Sighting> {
    let mut last = usize::MAX;
    let seed = u64::from(dice.seed()) << 32;
    for (i, thing) in things.iter().enumerate() {
        if held(thing) || thing.layers & view.layers == 0 {
            continue;
        }
        // Each thing has dice of its own, so that a play without some others finds the same.
        let mut dice = Dice::new(seed | u64::from(thing.name));
        let places = if thing.way > 0.0 { effort.places } else { 1 };
        for attempt in 0..places {
            let drift = place(thing, view, attempt, &mut dice);
            let (towards, distance) = view.towards(thing.body.middle + drift);
            for _ in 0..effort.points {
                let p = thing.body.point(towards, distance, &mut dice) + drift;
                let Some(sight) = view.sight(p) else { continue };
                if !hidden(things, i, view.layers, &sight, &mut last) {
                    return Some(Sighting { thing: i, sight, drift });
                }
            }
        }
    }
    None
}
