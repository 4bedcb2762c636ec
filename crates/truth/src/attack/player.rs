//! Plays operations on the library and on the truth, and compares the two.

mod frame;
mod look;

use casca::internals::SceneInternals;
use casca::{
    CellOptions, DrawOptions, Error, KeptOptions, KeptQuery, KeptResult, ObjectDesc, PointOptions, Pvs,
    Query, Scene, View,
};
use glam::{DVec3, Vec3};

use super::forms::{Form, Shelf};
use super::ops::{Config, Hides, Moves, Op};
use super::solid::Solid;
use super::truth::{Effort, Thing};
use super::views::{Limits, TrueView};

/// Sets that are kept.
const KEPT: usize = 4;
/// Ids of removed objects that are tried again.
const MOST_GONE: usize = 8;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A set lacks a visible object.
    Lost,
    /// A kept set is said to hold, and lacks a visible object.
    Held,
    /// A volume does not hold its object for sure.
    Volume,
    /// A set or an id passes for another scene's.
    Passed,
    /// A call is refused that should not be, or taken that should not be.
    Answer,
    /// Something is left behind in the matrices, or an answer contradicts itself.
    State,
    Panic,
}

#[derive(Debug, Clone)]
pub struct Failure {
    pub kind: Kind,
    pub at: usize,
    pub text: String,
}

/// Farther away than this, rounding may move an occluder out of its bounds, which is refused.
const ROUNDED: f32 = 2e5;

/// Whether a form lies farther away than [`ROUNDED`].
fn is_rounded(form: &Form) -> bool {
    form.center().abs().max_element() > ROUNDED
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
    limits: Limits,
    origin: Origin,
}

pub struct Player {
    config: Config,
    shelf: Shelf,
    worlds: Vec<World>,
    active: usize,
    queries: [(Query, Option<Origin>); 3],
    /// Of each query.
    options: [(PointOptions, CellOptions); 3],
    /// Kept queries that look along with the others.
    lasting: [KeptQuery; 3],
    /// What was made ready for one of them.
    ready: Option<(usize, KeptResult)>,
    kept: Vec<Kept>,
    effort: Effort,
    parting: u32,
    /// Notes on what was played, if they are wanted.
    pub notes: Option<Vec<String>>,
    /// Rounds of the check that looked for lost objects.
    pub checks: u64,
}

/// One of the queries; the last one shares its work among threads.
fn query(number: usize) -> Query {
    let mut query = Query::new();
    query.set_parallel(number == 2);
    query
}

fn refused(what: &str) -> impl Fn(Error) -> (Kind, String) + use<'_> {
    move |error| (Kind::Answer, format!("{what} is refused: {error}"))
}

impl Player {
    /// An empty scene. A thorough player looks at more points.
    pub fn new(config: &Config, thorough: bool) -> Result<Self, Error> {
        let scene = Scene::new(config.cell)?;
        let options = |degrees, mask| {
            if config.fine {
                return (PointOptions::default(), CellOptions::default());
            }
            let point = PointOptions::default().pixel_degrees(degrees).min_pixels(16);
            (point.refine_squares(64).refine_patches(100), CellOptions::default().mask_resolution(mask))
        };
        let (late, cells) = options(3.0, 128);
        let mut lasting = [(0.0, 0.0), (1.0, 2.0), (4.0, 8.0)].map(|(reach, turn)| {
            KeptQuery::with_options(KeptOptions::new().reach(reach).turn(turn)).unwrap_or_default()
        });
        for (kept, degrees) in lasting.iter_mut().zip([8.0, 3.0, 1.0]) {
            kept.set_point_options(options(degrees, 64).0.coherent(true))?;
        }
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
            queries: std::array::from_fn(|i| (query(i), None)),
            options: [options(1.0, 64), options(8.0, 64), (late.coherent(true), cells)],
            lasting,
            ready: None,
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

    fn who(&self, who: u16) -> Option<usize> {
        self.worlds[self.active].things.iter().position(|thing| thing.name == who)
    }

    /// Does something with a thing, if it is there.
    fn with(&mut self, who: u16, play: impl FnOnce(&mut Self, usize) -> Played) -> Played {
        self.who(who).map_or(Ok(()), |i| play(self, i))
    }

    pub fn play(&mut self, op: &Op) -> Played {
        match op {
            Op::Insert { name, form, hides, moves } => self.insert(*name, form, *hides, *moves),
            Op::Move { who, by } => self.with(*who, |p, i| p.shift(i, *by)),
            Op::Jump { who, to } => self.with(*who, |p, i| {
                let by = *to - p.world().things[i].bounds.center();
                p.shift(i, by)
            }),
            Op::Reshape { who, form, hides } => {
                self.with(*who, |p, i| p.tell(i, form.clone(), hides.form(form, &p.config)))
            }
            Op::Uncover { who } => {
                self.with(*who, |p, i| p.tell(i, p.worlds[p.active].things[i].bounds.clone(), None))
            }
            Op::Same { who } => self.with(*who, |p, i| {
                let thing = p.world().things[i].clone();
                p.tell(i, thing.bounds, thing.occluder)
            }),
            Op::Translate { who, by } => self.with(*who, |p, i| p.translate(i, *by)),
            Op::Remove { who } => self.with(*who, Self::take_out),
            Op::Drift { who, along, share } => self.with(*who, |p, i| {
                let thing = &mut p.world().things[i];
                thing.drift_to(along.as_dvec3() * thing.way * f64::from(*share));
                Ok(())
            }),
            Op::Nearer { who, side, share } => self.with(*who, |p, i| p.nearer(i, *side, *share)),
            Op::Leave { who } => self.with(*who, |p, i| {
                p.leave(i);
                Ok(())
            }),
            Op::Begin { dt, due, seed } => self.begin(*dt, *due, *seed),
            Op::Layers { who, mask } => self.with(*who, |p, i| p.relayer(i, *mask)),
            Op::Look(look) => self.look(look),
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
                    options.min_size = *least;
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
            Ok(_) if odd => {
                return Err((Kind::Answer, "a greatest speed of something fixed is taken".into()));
            }
            Ok(id) => id,
            Err(_) if odd || is_rounded(form) => return Ok(()),
            Err(error) => return Err(refused("an insertion")(error)),
        };
        let (body, own_cover) = (Solid::new(form), occluder.as_ref().map(Solid::new));
        let own = self.worlds.len() == 2;
        self.note(|_| format!("thing {name} is {id}"));
        let world = self.world();
        world.changed = true;
        world.things.push(Thing {
            name,
            id,
            bounds: form.clone(),
            occluder,
            layers: u64::MAX,
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

    fn shift(&mut self, i: usize, by: Vec3) -> Played {
        let thing = &self.world().things[i];
        let (bounds, occluder) = (thing.bounds.moved(by), thing.occluder.as_ref().map(|o| o.moved(by)));
        self.tell(i, bounds, occluder)
    }

    fn tell(&mut self, i: usize, bounds: Form, occluder: Option<Form>) -> Played {
        let Some((shape, cover)) = self.shapes(&bounds, occluder.as_ref()) else { return Ok(()) };
        let world = self.world();
        let thing = &mut world.things[i];
        let rounded = is_rounded(&thing.bounds) || is_rounded(&bounds);
        let uncovers = thing.occluder.is_some() && occluder.is_none();
        // Applications report moves one by one, or all of a frame together.
        let told = match cover {
            None if i.is_multiple_of(2) => {
                world.scene.update_many([(thing.id, shape)]).map_err(|(_, why)| why)
            }
            cover => world.scene.update(thing.id, shape, cover),
        };
        match told {
            Ok(()) if uncovers => Err((Kind::Answer, "an occluder is dropped silently".into())),
            Ok(()) => {
                world.changed |= thing.bounds != bounds || thing.occluder != occluder;
                thing.told(bounds, occluder);
                let name = thing.name;
                self.note(|p| {
                    format!("thing {name} is told to be {:?}", p.worlds[p.active].things[i].bounds)
                });
                Ok(())
            }
            Err(_) if uncovers || rounded => Ok(()),
            Err(error) => Err(refused("an update")(error)),
        }
    }

    fn translate(&mut self, i: usize, by: Vec3) -> Played {
        let world = self.world();
        let thing = &mut world.things[i];
        let mesh = |f: &Form| matches!(f, Form::Mesh { .. });
        let refusable =
            is_rounded(&thing.bounds) || mesh(&thing.bounds) || thing.occluder.as_ref().is_some_and(mesh);
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

    fn relayer(&mut self, i: usize, mask: u64) -> Played {
        let world = self.world();
        let thing = &mut world.things[i];
        world.scene.set_layers(thing.id, mask).map_err(refused("a change of layers"))?;
        world.changed |= thing.layers != mask;
        thing.layers = mask;
        Ok(())
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

    pub fn finish(&mut self) -> Played {
        for active in 0..self.worlds.len() {
            self.active = active;
            while !self.world().things.is_empty() {
                self.take_out(0)?;
            }
            let scene = &self.world().scene;
            let (entries, volumes) = (scene.id_matrix().entries(), scene.tbv_matrix().volumes());
            let opaque = (scene.static_opacity().count(), scene.dynamic_opacity().count());
            if !scene.is_empty() || (entries, volumes) != (0, 0) || opaque != (0, 0) {
                let (left, text) = (scene.len(), "an emptied scene holds");
                let text =
                    format!("{text} {left} objects, {entries} entries, {volumes} volumes, {opaque:?} cells");
                return Err((Kind::State, text));
            }
        }
        Ok(())
    }
}
