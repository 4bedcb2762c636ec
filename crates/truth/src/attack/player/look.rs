//! Looks: sets compared with the truth.

use casca::{Light, Method, View};
use glam::{DVec3, Vec3};

use super::super::dice::{Dice, turned};
use super::super::ops::{From, Look, Toward};
use super::super::truth::{Sighting, Thing, find_lost};
use super::super::views::{Limits, Roams, TrueView, look};
use super::{KEPT, Kept, Kind, Origin, Played, Player, refused};
use crate::places::coordinate;

/// A lamp stands this far from the origin, and shines this far.
const LAMP_AWAY: f32 = 8.0;
const LAMP_RANGE: f32 = 12.0;

impl Player {
    /// The eye; a camera where there is no such object or volume.
    pub(super) fn eye(&self, from: From) -> Vec3 {
        let world = &self.worlds[self.active];
        let camera = self.config.cameras[0];
        match from {
            From::Camera(i) => self.config.cameras[usize::from(i) % 3],
            From::At(p) => p,
            From::Inside(who, share) => self.who(who).map_or(camera, |i| {
                let thing = &world.things[i];
                self.config.snap(thing.bounds.center() + share * thing.body.radius as f32)
            }),
            From::Volume(who, share) => {
                let volume = self.who(who).and_then(|i| world.scene.tbv(world.things[i].id).ok().flatten());
                volume.map_or(camera, |(min, max)| (min + (max - min) * share.as_dvec3()).as_vec3())
            }
        }
    }

    pub(super) fn view(
        &self,
        eye: Vec3,
        toward: Toward,
        limits: &Limits,
    ) -> Result<Option<(View, TrueView)>, (Kind, String)> {
        let forward = match toward {
            Toward::Along(d) => d,
            Toward::Object(who) => {
                self.who(who).map_or(Vec3::X, |i| self.worlds[self.active].things[i].bounds.center() - eye)
            }
        };
        match look(eye, forward, limits) {
            Ok(views) => Ok(Some(views)),
            // Far away, a matrix in single precision is no camera's, or not that eye's.
            Err(_) if (eye.abs().max_element()) > 500.0 => Ok(None),
            Err(error) => {
                Err((Kind::Answer, format!("the view {eye} {forward} {limits:?} is refused: {error}")))
            }
        }
    }

    /// Whether what was found on the active scene by now tells it from the other.
    pub(super) fn origin(&self) -> Origin {
        let differ = self.worlds.len() == 2 && self.worlds.iter().any(|w| w.changed);
        let parting = if differ { self.parting } else { 0 };
        Origin { world: self.worlds[self.active].number, parting }
    }

    pub(super) fn look(&mut self, look: &Look) -> Played {
        let (limits, mask, seed) = (&look.limits, look.mask, look.seed);
        let (query, method) = (usize::from(look.query % 3), look.method);
        let eye = self.eye(look.from);
        let Some((view, mut truth)) = self.view(eye, look.toward, limits)? else { return Ok(()) };
        let roams = match (look.roams, limits) {
            (Roams::Ball { .. }, Limits::Around | Limits::Camera { .. }) => look.roams,
            (Roams::Box(_), Limits::Around) => look.roams,
            _ => Roams::Not,
        };
        let view = roams.open(view).map_err(refused("a view of several cameras"))?.with_layers(mask);
        truth.layers = mask;
        // Kept results are for ways: some cameras come from close by.
        let mut dice = Dice::new(u64::from(seed) ^ u64::from(u32::MAX));
        let step = Vec3::from_array([(); 3].map(|()| dice.between(-0.25, 0.25)));
        let before = self.view(eye - step, look.toward, limits)?.filter(|_| dice.once_in(2));
        let before = before.map(|(before, _)| before.with_layers(mask));
        let origin = self.origin();
        let world = &mut self.worlds[self.active];
        let (point, cell) = self.options[query];
        let (number, lasting) = (query, &mut self.lasting[query]);
        let (query, from) = &mut self.queries[query];
        let method = match method {
            Method::Point(_) => Method::Point(point),
            Method::Cell(_) => Method::Cell(cell),
            other => other,
        };
        query.set_method(method).map_err(refused("a method"))?;
        let pvs = query.run(&world.scene, &view);
        *from = Some(origin);
        world.looked = true;
        for thing in &mut world.things {
            thing.found |= pvs.contains(thing.id);
        }
        let shown = |t: &&Thing| pvs.contains(t.id) && t.layers & mask != 0;
        let known = world.things.iter().filter(shown).count();
        if known != pvs.len() {
            return Err((Kind::State, format!("a set of {} holds {known} that the view shows", pvs.len())));
        }
        // A set is that of all cameras that the view stands for, and one of `Cell` that of all eyes of
        // its cell that are in no occluder.
        let mut truths = vec![truth.clone()];
        match pvs.view_cell() {
            _ if roams != Roams::Not => truths.extend((0..3).map(|_| roams.camera(&truth, &mut dice))),
            Some(cell) => {
                let (min, max) = world.scene.grid().cell_bounds(cell);
                let mut share = || f64::from(coordinate(dice.real(), 0.0..1.0, 0.5));
                let eyes = (0..3).map(|_| min + (max - min) * DVec3::new(share(), share(), share()));
                let outside = |eye: &DVec3| world.things.iter().all(|t| t.is_outside(*eye, mask));
                truths.extend(eyes.filter(outside).map(|eye| truth.from(eye)));
            }
            None => {}
        }
        let lost = truths.iter().find_map(|truth| {
            find_lost(&world.things, truth, |t| pvs.contains(t.id), self.effort, &mut Dice::new(seed.into()))
        });
        self.checks += 1;
        // Half of the looks are answered by a kept query, too.
        let lost_later = (seed & 1 == 0 && matches!(method, Method::Point(_)))
            .then(|| {
                // Some answer from results that were made ready at an earlier look, for whatever
                // scene that was.
                if let Some((_, result)) = self.ready.take_if(|(of, _)| *of == number) {
                    let _ = lasting.install(result, &world.scene);
                }
                if seed & 6 == 0 {
                    self.ready = Some((number, lasting.prepare(&world.scene, &view).run()));
                }
                if let Some(before) = before {
                    lasting.run(&world.scene, &before);
                }
                lasting.run(&world.scene, &view)
            })
            .and_then(|pvs| {
                self.checks += 1;
                let mut dice = Dice::new(seed.into());
                find_lost(&world.things, &truth, |t| pvs.contains(t.id), self.effort, &mut dice)
            });
        let kept = look.keep.then(|| pvs.clone());
        let eye = truth.eye;
        self.note(|p| {
            let found = p.worlds[p.active].things.iter().filter(|t| t.found).map(|t| t.name);
            format!("eye {eye:?}, found in this frame: things {:?}", found.collect::<Vec<_>>())
        });
        if let Some(pvs) = kept {
            if self.kept.len() == KEPT {
                self.kept.remove(0);
            }
            self.kept.push(Kept { pvs, view, truth, limits: limits.clone(), origin });
        }
        if let Some(lost) = lost_later {
            return Err((Kind::Lost, self.tell_lost(&lost, "a kept query")));
        }
        lost.map_or(Ok(()), |s| Err((Kind::Lost, self.tell_lost(&s, &format!("{method:?}")))))
    }

    /// A lost object in words.
    pub(super) fn tell_lost(&self, lost: &Sighting, by: &str) -> String {
        let world = &self.worlds[self.active];
        let thing = &world.things[lost.thing];
        format!(
            "{by} lacks thing {} ({}), {:?} {:?}, which is {} from there (it may be {:.9} away) and seen from {} at {}; \
             its volume is {:?}, the time {}",
            thing.name,
            thing.id,
            thing.moves,
            thing.bounds,
            lost.drift,
            thing.way,
            lost.sight.from,
            lost.sight.to,
            world.scene.tbv(thing.id),
            world.now,
        )
    }

    pub(super) fn ask(&mut self, nudge: Vec3, toward: Toward, limits: &Limits, seed: u32) -> Played {
        for k in 0..self.kept.len() {
            self.ask_one(k, None, seed)?;
            let Some(eye) = self.kept[k].truth.eye else { continue };
            let layers = self.kept[k].truth.layers;
            // Its own camera, moved and turned.
            let mut dice = Dice::new(seed.into());
            let angle = dice.pick(&[0.0, 0.005, 0.1, 0.5]);
            let turn = turned(&mut dice, angle).as_quat();
            let (own, ahead) = (&self.kept[k].limits, turn * self.kept[k].truth.direction().as_vec3());
            if let Ok((view, mut truth)) = look(eye.as_vec3() + nudge, ahead, own) {
                truth.layers = layers;
                self.ask_one(k, Some((view.with_layers(layers), truth)), seed)?;
            }
            let Ok(Some((view, mut truth))) = self.view(eye.as_vec3() + nudge, toward, limits) else {
                continue;
            };
            truth.layers = layers;
            self.ask_one(k, Some((view.with_layers(layers), truth)), seed)?;
        }
        Ok(())
    }

    pub(super) fn ask_one(&mut self, k: usize, other: Option<(View, TrueView)>, seed: u32) -> Played {
        let (world, kept) = (&self.worlds[self.active], &self.kept[k]);
        let (view, truth) = other.as_ref().map_or((&kept.view, &kept.truth), |(v, t)| (v, t));
        if !kept.pvs.is_valid_for(&world.scene, view) {
            return Ok(());
        }
        let away = kept.origin.world != world.number;
        if away && kept.origin.parting == self.parting && self.worlds.len() == 2 {
            return Err((Kind::Passed, "a set of the other scene is said to hold".into()));
        }
        self.checks += 1;
        let held = |t: &Thing| kept.pvs.contains(t.id);
        let lost = find_lost(&world.things, truth, held, self.effort, &mut Dice::new(seed.into()));
        let by = format!(
            "a set of {:?}{} that is said to hold{}",
            kept.pvs.method(),
            if away { " of the other scene" } else { "" },
            if other.is_some() { " for another view" } else { "" }
        );
        lost.map_or(Ok(()), |s| Err((Kind::Held, self.tell_lost(&s, &by))))
    }

    pub(super) fn casters(&mut self, query: u8, receivers: u8, light: Vec3) -> Played {
        let (query, receivers) = (usize::from(query % 3), usize::from(receivers % 3));
        let origin = self.origin();
        let world = &self.worlds[self.active];
        if self.queries[receivers].1.is_none_or(|o| o.world != origin.world) {
            return Ok(());
        }
        let camera = self.queries[receivers].0.clone();
        let (query, from) = &mut self.queries[query];
        // The second light is the one whose set may end the frame.
        let lamp = Light::point(light * LAMP_AWAY, LAMP_RANGE);
        for light in [lamp, Light::directional(light)] {
            query
                .shadow_casters(&world.scene, &camera, &light, &mut Vec::new())
                .map_err(refused("casters"))?;
        }
        *from = Some(origin);
        world.scene.memory();
        Ok(())
    }
}
