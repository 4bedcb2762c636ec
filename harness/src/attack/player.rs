//! Plays operations on the library and on the truth, and compares the two.

use casca::{DrawOptions, Error, GridSpec, Method, ObjectDesc, Pvs, Query, Scene, Settings, View};
use glam::{DVec3, Vec3};

use super::api;
use super::dice::Dice;
use super::forms::{Form, Shelf};
use super::ops::{Config, Due, From, Hides, Moves, Op, Toward, direction};
use super::rays::Body;
use super::truth::{Effort, Sighting, Thing, find_lost};
use super::views::{Limits, TrueView, look};

/// Objects may be this share of their coordinates out of their volumes: a rounding.
const ROUNDING: f64 = 1e-9;
/// Sets that are kept.
const KEPT: usize = 4;
/// Ids of removed objects that are tried again.
const MOST_GONE: usize = 8;

/// In which way a play failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A set lacks what is seen.
    Lost,
    /// A kept set is said to hold, and lacks what is seen.
    Held,
    /// A volume does not hold its object for sure.
    Volume,
    /// A set or an id passes for another scene's.
    Passed,
    /// A call is refused that should not be, or taken that should not be.
    Answer,
    /// Something is left behind in the matrices, or an answer contradicts itself.
    State,
    /// The library panicked.
    Panic,
}

/// How a play failed.
#[derive(Debug, Clone)]
pub struct Failure {
    /// In which way.
    pub kind: Kind,
    /// Index of the operation.
    pub at: usize,
    /// What happened, in words.
    pub text: String,
}

type Played = Result<(), (Kind, String)>;

/// A scene, and the truth about it.
struct World {
    number: u32,
    scene: Scene,
    things: Vec<Thing>,
    gone: Vec<casca::ObjectId>,
    now: f64,
    /// Whether the frame ended with results, and whether a query ran in it.
    ended: bool,
    looked: bool,
    /// Whether it changed since it was parted from the other.
    changed: bool,
}

/// Where a set comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Origin {
    world: u32,
    /// The parting after which it was found on a scene that differed from the other; 0 if none.
    parting: u32,
}

struct Kept {
    pvs: Pvs,
    view: View,
    truth: TrueView,
    origin: Origin,
}

/// Plays operations.
pub struct Player {
    config: Config,
    shelf: Shelf,
    worlds: Vec<World>,
    active: usize,
    queries: [(Query, Option<Origin>); 3],
    kept: Vec<Kept>,
    effort: Effort,
    parting: u32,
    /// Notes on what was played, if they are wanted.
    pub notes: Option<Vec<String>>,
    /// Rounds of the check that looked for lost objects.
    pub checks: u64,
}

fn refused(what: &str) -> impl Fn(Error) -> (Kind, String) + use<'_> {
    move |error| (Kind::Answer, format!("{what} is refused: {error}"))
}

impl Player {
    /// An empty scene. A thorough player looks at more points.
    ///
    /// # Errors
    /// As the library's constructors.
    pub fn new(config: &Config, thorough: bool) -> Result<Self, Error> {
        let scene = Scene::new(&GridSpec { min: config.min, cell: config.cell, dims: config.dims })?;
        let mut settings = [Settings::default(); 3];
        for (settings, (degrees, mask)) in settings.iter_mut().zip([(1.0, 64), (8.0, 64), (3.0, 128)]) {
            if !config.fine {
                settings.pixel_degrees = degrees;
                settings.mask_resolution = mask;
                settings.min_pixels = 16;
                settings.refine_squares = 64;
                settings.refine_patches = 100;
            }
        }
        let query = |settings| Query::with_settings(settings).map(|q| (q, None));
        let world = World {
            number: 1,
            scene,
            things: Vec::new(),
            gone: Vec::new(),
            now: 0.0,
            ended: false,
            looked: false,
            changed: false,
        };
        Ok(Self {
            config: config.clone(),
            shelf: Shelf::new()?,
            worlds: vec![world],
            active: 0,
            queries: [query(settings[0])?, query(settings[1])?, query(settings[2])?],
            kept: Vec::new(),
            effort: if thorough { Effort { points: 24, places: 8 } } else { Effort { points: 5, places: 6 } },
            parting: 0,
            notes: None,
            checks: 0,
        })
    }

    fn world(&mut self) -> &mut World {
        &mut self.worlds[self.active]
    }

    fn note(&mut self, text: impl FnOnce(&Self) -> String) {
        if self.notes.is_some() {
            let text = text(self);
            self.notes.iter_mut().for_each(|notes| notes.push(text.clone()));
        }
    }

    /// The index of a thing.
    fn who(&self, who: u16) -> Option<usize> {
        self.worlds[self.active].things.iter().position(|thing| thing.name == who)
    }

    /// Plays one operation.
    ///
    /// # Errors
    /// Says how library and truth disagree.
    pub fn play(&mut self, op: &Op) -> Played {
        match op {
            Op::Insert { name, form, hides, moves } => self.insert(*name, form, *hides, *moves),
            Op::Move { who, by } => self.shift(*who, |_| *by),
            Op::Jump { who, to } => self.shift(*who, |thing| *to - thing.bounds.center()),
            Op::Reshape { who, form, hides } => {
                let Some(i) = self.who(*who) else { return Ok(()) };
                self.tell(i, form.clone(), hides.form(form, &self.config))
            }
            Op::Uncover { who } => {
                let Some(i) = self.who(*who) else { return Ok(()) };
                let bounds = self.world().things[i].bounds.clone();
                self.tell(i, bounds, None)
            }
            Op::Same { who } => {
                let Some(i) = self.who(*who) else { return Ok(()) };
                let thing = &self.world().things[i];
                let (bounds, occluder) = (thing.bounds.clone(), thing.occluder.clone());
                self.tell(i, bounds, occluder)
            }
            Op::Translate { who, by } => self.translate(*who, *by),
            Op::Remove { who } => self.remove(*who),
            Op::Drift { who, along, share } => {
                let Some(i) = self.who(*who) else { return Ok(()) };
                let thing = &mut self.world().things[i];
                thing.drift_to(along.as_dvec3() * thing.way * f64::from(*share));
                Ok(())
            }
            Op::Nearer { who, side, share } => {
                self.who(*who).map_or(Ok(()), |i| self.nearer(i, *side, *share))
            }
            Op::Leave { who } => {
                let Some(i) = self.who(*who) else { return Ok(()) };
                self.leave(i);
                Ok(())
            }
            Op::Begin { dt, due, seed } => self.begin(*dt, *due, *seed),
            Op::Look { query, method, from, toward, limits, keep, seed } => {
                let eye = self.eye(*from);
                let Some((view, truth)) = self.view(eye, *toward, limits)? else { return Ok(()) };
                self.look(usize::from(*query % 3), *method, view, truth, *keep, *seed)
            }
            Op::Ask { nudge, toward, limits, seed } => self.ask(*nudge, *toward, limits, *seed),
            Op::End { queries, kept } => self.end(*queries, *kept),
            Op::Clone { go_on_with_it } => self.part(*go_on_with_it),
            Op::Switch => {
                self.active = (self.active + 1) % self.worlds.len();
                Ok(())
            }
            Op::Forget => {
                if self.worlds.len() == 2 {
                    let gone = self.worlds.remove(1 - self.active).number;
                    self.active = 0;
                    self.kept.retain(|k| k.origin.world != gone);
                }
                Ok(())
            }
            Op::Cross => self.cross(),
            Op::Casters { query, receivers, light } => self.casters(*query, *receivers, *light),
            Op::List { query, least } => {
                let (world, (query, origin)) =
                    (&self.worlds[self.active], &self.queries[usize::from(*query % 3)]);
                if origin.is_some_and(|o| o.world == world.number) {
                    let mut options = DrawOptions::default();
                    options.least_size = *least;
                    let listed = query.pvs().draw_list(&world.scene, &options, &mut Vec::new());
                    listed.map_err(refused("a list"))?;
                }
                Ok(())
            }
        }
    }

    fn insert(&mut self, name: u16, form: &Form, hides: Hides, moves: Moves) -> Played {
        let occluder = hides.form(form, &self.config);
        let Some((bounds, cover)) = self.shapes(form, occluder.as_ref()) else { return Ok(()) };
        let mut desc = match moves {
            Moves::Fixed | Moves::FixedWithin(_) => ObjectDesc::fixed(bounds),
            _ => ObjectDesc::dynamic(bounds),
        };
        desc = match moves {
            Moves::Within(speed) | Moves::FixedWithin(speed) => desc.max_speed(speed),
            Moves::OnExpiry(speed) => desc.max_speed(speed).reported_on_expiry(),
            Moves::Fixed | Moves::Free => desc,
        };
        if let Some(cover) = cover {
            desc = desc.occluder(cover);
        }
        let odd = matches!(moves, Moves::FixedWithin(_));
        let id = match self.world().scene.insert(desc) {
            Ok(_) if odd && api::STRICT => {
                return Err((Kind::Answer, "a greatest speed of something fixed is taken".into()));
            }
            Ok(id) => id,
            Err(_) if odd => return Ok(()),
            Err(error) => return Err(refused("an insertion")(error)),
        };
        let (body, own_cover) = (Body::new(form), occluder.as_ref().map(Body::new));
        let own = self.worlds.len() == 2;
        self.note(|_| format!("thing {name} is {id}"));
        let world = self.world();
        world.changed = true;
        world.things.push(Thing {
            name,
            id,
            bounds: form.clone(),
            occluder,
            moves,
            body,
            cover: own_cover,
            way: 0.0,
            drift: DVec3::ZERO,
            held: false,
            found: false,
            owed: false,
            own,
        });
        Ok(())
    }

    /// The shapes of the library; `None` where it has none, as for a box that is cut away.
    fn shapes(
        &self,
        form: &Form,
        occluder: Option<&Form>,
    ) -> Option<(casca::Bounds, Option<casca::Occluder>)> {
        let (bounds, itself) = form.shapes(&self.shelf).ok()?;
        let cover = match occluder {
            Some(o) if o == form => Some(itself),
            Some(o) => Some(o.shapes(&self.shelf).ok()?.1),
            None => None,
        };
        Some((bounds?, cover))
    }

    fn shift(&mut self, who: u16, by: impl Fn(&Thing) -> Vec3) -> Played {
        let Some(i) = self.who(who) else { return Ok(()) };
        let thing = &self.world().things[i];
        let by = by(thing);
        let (bounds, occluder) = (thing.bounds.moved(by), thing.occluder.as_ref().map(|o| o.moved(by)));
        self.tell(i, bounds, occluder)
    }

    /// Updates an object.
    fn tell(&mut self, i: usize, bounds: Form, occluder: Option<Form>) -> Played {
        let Some((shape, cover)) = self.shapes(&bounds, occluder.as_ref()) else { return Ok(()) };
        let world = self.world();
        let thing = &mut world.things[i];
        let uncovers = thing.occluder.is_some() && occluder.is_none();
        match world.scene.update(thing.id, shape, cover) {
            Ok(()) if uncovers && api::STRICT => {
                Err((Kind::Answer, "an occluder is dropped silently".into()))
            }
            Ok(()) => {
                world.changed |= thing.bounds != bounds || thing.occluder != occluder;
                thing.told(bounds, occluder);
                let name = thing.name;
                self.note(|p| {
                    format!("thing {name} is told to be {:?}", p.worlds[p.active].things[i].bounds)
                });
                Ok(())
            }
            Err(_) if uncovers => Ok(()),
            Err(error) => Err(refused("an update")(error)),
        }
    }

    fn translate(&mut self, who: u16, by: Vec3) -> Played {
        let Some(i) = self.who(who) else { return Ok(()) };
        let world = self.world();
        let thing = &mut world.things[i];
        let mesh = |f: &Form| matches!(f, Form::Mesh { .. });
        let refusable = mesh(&thing.bounds) || thing.occluder.as_ref().is_some_and(mesh);
        match world.scene.translate(thing.id, by) {
            Ok(()) => {
                world.changed |= by != Vec3::ZERO;
                let occluder = thing.occluder.as_ref().map(|o| o.translated(by));
                thing.told(thing.bounds.translated(by), occluder);
                Ok(())
            }
            Err(_) if refusable => Ok(()),
            Err(error) => Err(refused("a translation")(error)),
        }
    }

    fn remove(&mut self, who: u16) -> Played {
        self.who(who).map_or(Ok(()), |i| self.take_out(i))
    }

    fn take_out(&mut self, i: usize) -> Played {
        let world = self.world();
        let thing = world.things.remove(i);
        world.scene.remove(thing.id).map_err(refused("a removal"))?;
        world.changed = true;
        world.gone.push(thing.id);
        if world.gone.len() > MOST_GONE {
            world.gone.remove(0);
        }
        let known = world.gone.iter().find(|id| world.scene.bounds(**id).is_ok());
        known.map_or(Ok(()), |id| Err((Kind::State, format!("{id} was removed and is known"))))
    }

    /// The direction to the wall of its volume that the middle of a hidden object is nearest to, and how far that is.
    fn wall(&self, i: usize) -> Option<(DVec3, f64)> {
        let world = &self.worlds[self.active];
        let (min, max) = world.scene.tbv(world.things[i].id).ok()??;
        let p = world.things[i].body.middle;
        let (low, high) = (p - min, max - p);
        let axis = low.min(high).min_position();
        let way = if low[axis] < high[axis] { -DVec3::AXES[axis] } else { DVec3::AXES[axis] };
        Some((way, low.min(high)[axis]))
    }

    /// Reports a hidden object nearer to one of the six walls of its volume.
    fn nearer(&mut self, i: usize, side: u8, share: f32) -> Played {
        let world = &self.worlds[self.active];
        let thing = &world.things[i];
        let Ok(Some((min, max))) = world.scene.tbv(thing.id) else { return Ok(()) };
        let (axis, up) = (usize::from(side) / 2 % 3, side % 2 == 1);
        let p = thing.body.middle;
        let way = if up { (max - p)[axis] - thing.body.radius } else { (min - p)[axis] + thing.body.radius };
        let by = self.config.snap((DVec3::AXES[axis] * way * f64::from(share)).as_vec3());
        let (bounds, occluder) = (thing.bounds.moved(by), thing.occluder.as_ref().map(|o| o.moved(by)));
        self.tell(i, bounds, occluder)
    }

    /// Moves an unreported object through the wall of its volume that it is nearest to, as far as it can.
    fn leave(&mut self, i: usize) {
        if let Some((way, _)) = self.wall(i) {
            let thing = &mut self.world().things[i];
            thing.drift_to(way * thing.way);
        }
    }

    fn begin(&mut self, dt: f64, due: Due, seed: u32) -> Played {
        let world = self.world();
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
    fn check_volumes(&self) -> Played {
        let world = &self.worlds[self.active];
        for thing in world.things.iter().filter(|t| t.on_expiry() && !t.owed) {
            let Ok(Some((min, max))) = world.scene.tbv(thing.id) else { continue };
            let (p, half) = (thing.body.middle, thing.body.extent() + thing.way);
            let out = (min - (p - half)).max(p + half - max).max_element();
            if out > ROUNDING * (1.0 + p.abs().max_element()) {
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
    fn report(&mut self, i: usize, dice: &mut Dice) -> Played {
        let thing = &self.worlds[self.active].things[i];
        let step = match dice.below(8) {
            0..=3 => Vec3::ZERO,
            4..=6 => direction(dice) * thing.way as f32 * dice.unit(),
            _ => direction(dice) * self.config.cell * 3.0,
        };
        let by = self.config.snap(thing.drift.as_vec3() + step);
        let (bounds, occluder) = (thing.bounds.moved(by), thing.occluder.as_ref().map(|o| o.moved(by)));
        self.tell(i, bounds, occluder)
    }

    /// The eye; a camera where there is no such object or volume.
    fn eye(&self, from: From) -> Vec3 {
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

    fn view(
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
    fn origin(&self) -> Origin {
        let differ = self.worlds.len() == 2 && self.worlds.iter().any(|w| w.changed);
        let parting = if differ { self.parting } else { 0 };
        Origin { world: self.worlds[self.active].number, parting }
    }

    fn look(
        &mut self,
        query: usize,
        method: Method,
        view: View,
        truth: TrueView,
        keep: bool,
        seed: u32,
    ) -> Played {
        let origin = self.origin();
        let world = &mut self.worlds[self.active];
        let (query, from) = &mut self.queries[query];
        let mut settings = *query.settings();
        settings.method = method;
        query.set_settings(settings).map_err(refused("a method"))?;
        let pvs = query.run(&world.scene, &view);
        *from = Some(origin);
        world.looked = true;
        for thing in &mut world.things {
            thing.found |= pvs.contains(thing.id);
        }
        let known = world.things.iter().filter(|t| pvs.contains(t.id)).count();
        if known != pvs.len() {
            return Err((Kind::State, format!("a set of {} holds {known} of the living", pvs.len())));
        }
        let lost = find_lost(
            &world.things,
            &truth,
            |t| pvs.contains(t.id),
            self.effort,
            &mut Dice::new(seed.into()),
        );
        self.checks += 1;
        let kept = keep.then(|| pvs.clone());
        let eye = truth.eye;
        self.note(|p| {
            let found = p.worlds[p.active].things.iter().filter(|t| t.found).map(|t| t.name);
            format!("eye {eye:?}, found in this frame: things {:?}", found.collect::<Vec<_>>())
        });
        if let Some(pvs) = kept {
            if self.kept.len() == KEPT {
                self.kept.remove(0);
            }
            self.kept.push(Kept { pvs, view, truth, origin });
        }
        lost.map_or(Ok(()), |s| Err((Kind::Lost, self.tell_lost(&s, &format!("{method:?}")))))
    }

    /// A lost object in words.
    fn tell_lost(&self, lost: &Sighting, by: &str) -> String {
        let world = &self.worlds[self.active];
        let thing = &world.things[lost.thing];
        format!(
            "{by} lacks thing {} ({}), {:?} {:?}, which is {} from there (it may be {:.9} away) and seen from {} at {} \
             from a share of {} on; its volume is {:?}, the time {}",
            thing.name,
            thing.id,
            thing.moves,
            thing.bounds,
            lost.drift,
            thing.way,
            lost.sight.eye,
            lost.sight.eye + lost.sight.way,
            lost.sight.start,
            world.scene.tbv(thing.id),
            world.now,
        )
    }

    fn ask(&mut self, nudge: Vec3, toward: Toward, limits: &Limits, seed: u32) -> Played {
        for k in 0..self.kept.len() {
            self.ask_one(k, None, seed)?;
            let Some(eye) = self.kept[k].truth.eye else { continue };
            let Ok(Some(other)) = self.view(eye.as_vec3() + nudge, toward, limits) else { continue };
            self.ask_one(k, Some(other), seed)?;
        }
        Ok(())
    }

    fn ask_one(&mut self, k: usize, other: Option<(View, TrueView)>, seed: u32) -> Played {
        let (world, kept) = (&self.worlds[self.active], &self.kept[k]);
        let (view, truth) = other.as_ref().map_or((&kept.view, &kept.truth), |(v, t)| (v, t));
        if !kept.pvs.holds(&world.scene, view) {
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

    fn end(&mut self, queries: u8, kept: u8) -> Played {
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
        api::end_frame(&mut world.scene, &sets).map_err(refused("the end of a frame"))?;
        if sets.iter().any(|(ran, _)| *ran) {
            world.ended = true;
            for thing in &mut world.things {
                thing.held = sets.iter().any(|(_, set)| set.contains(thing.id));
            }
        }
        Ok(())
    }

    fn part(&mut self, go_on_with_it: bool) -> Played {
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
            let id = api::id_in_clone(&scene, thing.id);
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
    fn cross(&mut self) -> Played {
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
            if api::end_frame(&mut here.scene, &[(true, set)]).is_ok() {
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

    fn casters(&mut self, query: u8, receivers: u8, light: Vec3) -> Played {
        let (query, receivers) = (usize::from(query % 3), usize::from(receivers % 3));
        let origin = self.origin();
        let world = &self.worlds[self.active];
        if self.queries[receivers].1.is_none_or(|o| o.world != origin.world) {
            return Ok(());
        }
        let set = self.queries[receivers].0.pvs().clone();
        let (query, from) = &mut self.queries[query];
        query.shadow_casters(&world.scene, &set, light, &mut Vec::new()).map_err(refused("casters"))?;
        *from = Some(origin);
        api::memory(&world.scene);
        Ok(())
    }

    /// Takes everything out.
    ///
    /// # Errors
    /// Says what is left behind.
    pub fn finish(&mut self) -> Played {
        for active in 0..self.worlds.len() {
            self.active = active;
            while !self.world().things.is_empty() {
                self.take_out(0)?;
            }
            if let Some(left) = api::leftovers(&self.world().scene) {
                return Err((Kind::State, format!("an emptied scene holds {left}")));
            }
        }
        Ok(())
    }
}
