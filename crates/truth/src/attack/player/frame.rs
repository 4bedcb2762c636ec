//! Frames: their begin and end, reports, and scenes that part.

use casca::{DrawOptions, Pvs};
use glam::{DVec3, Vec3};

use super::super::dice::{Dice, direction};
use super::super::ops::Due;
use super::{KEPT, Kind, Origin, Played, Player, World, refused};
use crate::numeric::attack::OUT_OF_VOLUME;

impl Player {
    /// The direction to the wall of its volume that the middle of a hidden object is nearest to,
    /// and how far that is.
    pub(super) fn wall(&self, i: usize) -> Option<(DVec3, f64)> {
        let world = &self.worlds[self.active];
        let (min, max) = world.scene.tbv(world.things[i].id).ok()??;
        let p = world.things[i].body.middle;
        let (low, high) = (p - min, max - p);
        let axis = low.min(high).min_position();
        let way = if low[axis] < high[axis] { -DVec3::AXES[axis] } else { DVec3::AXES[axis] };
        Some((way, low.min(high)[axis]))
    }

    /// Reports a hidden object nearer to one of the six walls of its volume.
    pub(super) fn nearer(&mut self, i: usize, side: u8, share: f32) -> Played {
        let world = &self.worlds[self.active];
        let thing = &world.things[i];
        let Ok(Some((min, max))) = world.scene.tbv(thing.id) else { return Ok(()) };
        let (axis, up) = (usize::from(side) / 2 % 3, side % 2 == 1);
        let p = thing.body.middle;
        let way = if up { (max - p)[axis] - thing.body.radius } else { (min - p)[axis] + thing.body.radius };
        let by = self.config.snap((DVec3::AXES[axis] * way * f64::from(share)).as_vec3());
        self.shift(i, by)
    }

    /// Moves an unreported object through the wall of its volume that it is nearest to, as far as
    /// it can.
    pub(super) fn leave(&mut self, i: usize) {
        if let Some((way, _)) = self.wall(i) {
            let thing = &mut self.world().things[i];
            thing.drift_to(way * thing.way);
        }
    }

    pub(super) fn begin(&mut self, dt: f64, due: Due, seed: u32) -> Played {
        let world = self.world();
        // Late, a clock has no short steps.
        let dt = world.now + dt - world.now;
        world.now += dt;
        let ids = world.scene.begin_frame(world.now).map_err(refused("a frame"))?;
        for thing in &mut world.things {
            thing.wait(dt);
            // Without results the last set is that of the queries, or an older one.
            if !world.ended && world.looked {
                thing.held = thing.found;
            }
            thing.found = false;
        }
        (world.ended, world.looked) = (false, false);
        for id in &ids {
            let thing = world.things.iter_mut().find(|t| t.id == *id && t.on_expiry());
            let Some(thing) = thing else {
                return Err((Kind::State, format!("{id} is due, and goes not unreported")));
            };
            thing.owed = true;
        }
        self.note(|p| format!("time {}, due {ids:?}", p.worlds[p.active].now));
        for i in 0..self.world().things.len() {
            let thing = &self.world().things[i];
            let mut dice = Dice::new(u64::from(seed) << 32 | u64::from(thing.name));
            let wanted = match due {
                Due::All => true,
                Due::Some => dice.once_in(2),
                Due::None => false,
            };
            if thing.on_expiry() && if thing.owed { wanted } else { thing.held } {
                self.report(i, &mut dice)?;
            }
        }
        self.check_volumes()
    }

    /// Whether volumes hold unreported objects wherever they may be by now.
    pub(super) fn check_volumes(&self) -> Played {
        let world = &self.worlds[self.active];
        for thing in world.things.iter().filter(|t| t.on_expiry() && !t.owed) {
            let Ok(Some((min, max))) = world.scene.tbv(thing.id) else { continue };
            let (low, high) = thing.body.extent;
            let out = (min - (low - thing.way)).max(high + thing.way - max).max_element();
            if out > OUT_OF_VOLUME * (1.0 + thing.body.middle.abs().max_element()) {
                let (name, bounds, way) = (thing.name, &thing.bounds, thing.way);
                let text = format!(
                    "thing {name} ({}), {bounds:?}, may have gone {way:.9}, {out:.9} out of its volume from {min} to {max}, and is not due",
                    thing.id
                );
                return Err((Kind::Volume, text));
            }
        }
        Ok(())
    }

    /// Reports an object: where it is, close by, or far away.
    pub(super) fn report(&mut self, i: usize, dice: &mut Dice) -> Played {
        let thing = &self.worlds[self.active].things[i];
        let step = match dice.below(8) {
            0..=3 => Vec3::ZERO,
            4..=6 => direction(dice) * thing.way as f32 * dice.unit(),
            _ => direction(dice) * self.config.cell * 3.0,
        };
        let by = self.config.snap(thing.drift.as_vec3() + step);
        self.shift(i, by)
    }

    pub(super) fn end(&mut self, queries: u8, kept: u8) -> Played {
        let world = &mut self.worlds[self.active];
        let number = world.number;
        let mut sets: Vec<(bool, &Pvs)> = Vec::new();
        for (i, (query, origin)) in self.queries.iter().enumerate() {
            if queries >> i & 1 != 0 && origin.is_none_or(|o| o.world == number) {
                sets.push((origin.is_some(), query.pvs()));
            }
        }
        for (i, kept) in self.kept.iter().enumerate().filter(|(i, _)| kept >> i & 1 != 0) {
            debug_assert!(i < KEPT);
            if kept.origin.world == number {
                sets.push((true, &kept.pvs));
            }
        }
        world.scene.end_frame(sets.iter().map(|(_, set)| *set)).map_err(refused("the end of a frame"))?;
        if sets.iter().any(|(ran, _)| *ran) {
            world.ended = true;
            for thing in &mut world.things {
                thing.held = sets.iter().any(|(_, set)| set.contains(thing.id));
            }
        }
        Ok(())
    }

    pub(super) fn part(&mut self, go_on_with_it: bool) -> Played {
        if self.worlds.len() == 2 {
            return Ok(());
        }
        self.parting += 1;
        let old = &mut self.worlds[0];
        old.changed = false;
        old.things.iter_mut().for_each(|t| t.own = false);
        let scene = old.scene.clone();
        let mut things = old.things.clone();
        for thing in &mut things {
            let id = scene.ids().find(|id| id.index() == thing.id.index());
            thing.id = id.ok_or((Kind::State, format!("a clone lacks {}", thing.id)))?;
        }
        let number = self.parting + 1;
        let (now, ended, looked) = (old.now, old.ended, old.looked);
        let gone = Vec::new();
        self.worlds.push(World { number, scene, things, gone, now, ended, looked, changed: false });
        self.active = usize::from(go_on_with_it);
        Ok(())
    }

    /// Sets and ids of a scene must not pass for those of its clone once the two differ.
    pub(super) fn cross(&mut self) -> Played {
        if self.worlds.len() < 2 {
            return Ok(());
        }
        let other = self.worlds[1 - self.active].number;
        let foreign = |o: &Origin| o.world == other && o.parting == self.parting;
        let sets = self.queries.iter().filter(|q| q.1.as_ref().is_some_and(foreign)).map(|q| q.0.pvs());
        let sets: Vec<&Pvs> =
            sets.chain(self.kept.iter().filter(|k| foreign(&k.origin)).map(|k| &k.pvs)).collect();
        let passed = |what: &str| Err((Kind::Passed, what.to_owned()));
        let (low, high) = self.worlds.split_at_mut(1);
        let (here, there) = if self.active == 0 { (&mut low[0], &high[0]) } else { (&mut high[0], &low[0]) };
        for set in sets {
            if set.draw_list(&here.scene, &DrawOptions::default(), &mut Vec::new()).is_ok() {
                return passed("a set of the other scene is listed");
            }
            if here.scene.end_frame([set]).is_ok() {
                return passed("a frame ends with a set of the other scene");
            }
        }
        for thing in there.things.iter().filter(|t| t.own) {
            if here.scene.bounds(thing.id).is_ok() {
                return Err((Kind::Passed, format!("{} of the other scene is known", thing.id)));
            }
        }
        Ok(())
    }
}
