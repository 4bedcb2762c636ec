//! A game that is played by events, and that knows what its camera sees.

use crate::common::worlds::{SIZE, Solid, World, planes_of, point, seen, solid};
use crate::common::*;

/// Seconds from frame to frame.
pub const TICK: f64 = 1.0 / 30.0;

/// A dynamic object as the test knows it.
#[derive(Debug, Clone, Copy)]
pub struct Mover {
    pub id: ObjectId,
    ball: Sphere,
    velocity: Vec3,
    hides: bool,
    /// Whether it is only reported when it is asked for.
    on_expiry: bool,
    layers: u64,
}

impl Mover {
    fn desc(&self) -> ObjectDesc {
        let desc = ObjectDesc::dynamic(self.ball).max_speed(4.0).layers(self.layers);
        let desc = if self.on_expiry { desc.reported_on_expiry() } else { desc };
        if self.hides { desc.occluder(self.ball) } else { desc }
    }

    fn occluder(&self) -> Option<Occluder> {
        self.hides.then(|| self.ball.into())
    }

    fn report(&self, scene: &mut Scene) {
        scene.update(self.id, self.ball, self.occluder()).unwrap();
    }
}

/// One thing that happens before a frame.
#[derive(Debug, Clone)]
pub enum Event {
    Insert(Vec3, f32, Vec3, bool, bool),
    Remove(usize),
    Jump(usize, Vec3),
    Layers(usize, u64),
    AddWall(Solid),
    RemoveWall(usize),
    /// The camera is elsewhere, and looks elsewhere.
    Teleport(Vec3, Quat),
    /// The camera walks and turns from now on: by this much in each frame.
    Walk(Vec3, Vec3),
    /// A job starts, or the oldest ends.
    Prepare,
    Install,
    /// The game goes on with a copy of the scene.
    Copy,
    /// A frame ends without its result.
    Unended,
    Mask(u64),
    /// Two frames at once.
    Late,
}

pub fn event() -> impl Strategy<Value = Event> {
    let small = |by: f32| points(-by..by, by);
    prop_oneof![
        3 => (point(), 0.1f32..0.9, small(2.0), any::<bool>(), any::<bool>())
            .prop_map(|(p, r, v, hides, on_expiry)| Event::Insert(p, r, v, hides, on_expiry)),
        1 => any::<usize>().prop_map(Event::Remove),
        2 => (any::<usize>(), point()).prop_map(|(who, to)| Event::Jump(who, to)),
        1 => (any::<usize>(), prop_oneof![Just(1u64), Just(2), Just(u64::MAX)]).prop_map(|(who, l)| Event::Layers(who, l)),
        1 => solid().prop_map(Event::AddWall),
        1 => any::<usize>().prop_map(Event::RemoveWall),
        1 => (point(), rotation()).prop_map(|(p, r)| Event::Teleport(p, r)),
        6 => (small(0.06), small(0.02)).prop_map(|(step, turn)| Event::Walk(step, turn)),
        3 => Just(Event::Prepare),
        3 => Just(Event::Install),
        1 => Just(Event::Copy),
        1 => Just(Event::Unended),
        1 => prop_oneof![Just(1u64), Just(3), Just(u64::MAX)].prop_map(Event::Mask),
        1 => Just(Event::Late),
    ]
}

/// A game that is played by events.
pub struct Game {
    pub world: World,
    walls: Vec<(ObjectId, Solid)>,
    pub movers: Vec<Mover>,
    eye: Vec3,
    rotation: Quat,
    step: Vec3,
    turn: Vec3,
    mask: u64,
    now: f64,
    pub query: KeptQuery,
    /// The results of jobs, each of which ran when it was made ready or is run only when it is
    /// installed.
    done: Vec<KeptResult>,
    ends: bool,
}

impl Game {
    pub fn new(walls: &[Solid], targets: &[Sphere], query: KeptQuery) -> Self {
        let mut world = World::new(&[], targets);
        let mut insert = |&solid: &Solid| (world.scene.solid(solid), solid);
        let walls = walls.iter().map(&mut insert).collect();
        Self {
            world,
            walls,
            movers: Vec::new(),
            eye: Vec3::splat(SIZE * 0.5),
            rotation: Quat::IDENTITY,
            step: Vec3::ZERO,
            turn: Vec3::ZERO,
            mask: u64::MAX,
            now: 0.0,
            query,
            done: Vec::new(),
            ends: true,
        }
    }

    fn matrix(&self) -> Mat4 {
        let (forward, up) = (self.rotation * Vec3::NEG_Z, self.rotation * Vec3::Y);
        directx::perspective(1.1, 1.5, 0.05, 80.0) * look_to_mat4(self.eye, forward, up)
    }

    fn view(&self) -> View {
        View::perspective(self.eye, self.matrix()).unwrap().with_layers(self.mask)
    }

    pub fn apply(&mut self, event: &Event) {
        let scene = &mut self.world.scene;
        let who = |who: usize, all: usize| (all > 0).then(|| who % all.max(1));
        match *event {
            Event::Insert(at, radius, velocity, hides, on_expiry) => {
                let ball = Sphere::new(at, radius);
                let id = self.world.targets[0].0;
                let mover = Mover { id, ball, velocity, hides, on_expiry, layers: u64::MAX };
                self.movers.push(Mover { id: scene.insert(mover.desc()).unwrap(), ..mover });
            }
            Event::Remove(i) => {
                if let Some(i) = who(i, self.movers.len()) {
                    scene.remove(self.movers.swap_remove(i).id).unwrap();
                }
            }
            Event::Jump(i, to) => {
                if let Some(i) = who(i, self.movers.len()) {
                    self.movers[i].ball.center = to;
                    self.movers[i].report(scene);
                }
            }
            Event::Layers(i, layers) => {
                if let Some(i) = who(i, self.movers.len()) {
                    self.movers[i].layers = layers;
                    scene.set_layers(self.movers[i].id, layers).unwrap();
                }
            }
            Event::AddWall(solid) => self.walls.push((scene.solid(solid), solid)),
            Event::RemoveWall(i) => {
                if let Some(i) = who(i, self.walls.len()) {
                    scene.remove(self.walls.swap_remove(i).0).unwrap();
                }
            }
            Event::Teleport(to, rotation) => (self.eye, self.rotation) = (to, rotation),
            Event::Walk(step, turn) => (self.step, self.turn) = (step, turn),
            Event::Prepare => {
                let view = self.view();
                let job = self.query.prepare(&self.world.scene, &view);
                self.done.push(job.run());
            }
            Event::Install => {
                if !self.done.is_empty() {
                    self.query.install(self.done.remove(0), &self.world.scene);
                }
            }
            Event::Copy => self.world.scene = self.world.scene.clone(),
            Event::Unended => self.ends = false,
            Event::Mask(mask) => self.mask = mask,
            Event::Late => self.now += TICK,
        }
    }

    /// Moves everything and the camera.
    fn go_on(&mut self) {
        self.now += TICK;
        let due = self.world.scene.begin_frame(self.now).unwrap();
        let last: Vec<ObjectId> = self.query.pvs().visible().to_vec();
        for mover in &mut self.movers {
            mover.ball.center += mover.velocity * TICK as f32;
            let inside =
                mover.ball.center.cmpge(Vec3::ZERO).all() && mover.ball.center.cmple(Vec3::splat(SIZE)).all();
            if !inside {
                mover.velocity = -mover.velocity;
            }
            if !mover.on_expiry || due.contains(&mover.id) || last.contains(&mover.id) {
                mover.report(&mut self.world.scene);
            }
        }
        self.eye = (self.eye + self.step).clamp(Vec3::splat(-2.0), Vec3::splat(SIZE + 2.0));
        self.rotation = (Quat::from_scaled_axis(self.turn) * self.rotation).normalize();
    }

    /// The objects on the layers of the view that are tested, with their shapes.
    fn targets(&self) -> Vec<(ObjectId, Solid)> {
        let shown = self.movers.iter().filter(|m| m.layers & self.mask != 0);
        let movers = shown.map(|m| (m.id, m.ball.into()));
        self.world.targets.iter().copied().chain(movers).collect()
    }

    /// The objects that the eye sees.
    fn visible(&self) -> Vec<ObjectId> {
        // An object hides in the views that show it.
        let hides = |m: &&Mover| m.hides && m.layers & self.mask != 0;
        let hiding = self.movers.iter().filter(hides).map(|m| Solid::Ball(m.ball));
        let solids: Vec<Solid> = self.walls.iter().map(|w| w.1).chain(hiding).collect();
        seen(&solids, &self.targets(), self.eye.as_dvec3(), &planes_of(self.matrix()))
    }

    pub fn frame(&mut self) -> Result<(), TestCaseError> {
        self.go_on();
        let (view, visible) = (self.view(), self.visible());
        let pvs = self.query.run(&self.world.scene, &view);
        for &id in &visible {
            prop_assert!(pvs.contains(id), "{id} from {} at {}", self.eye, self.now);
        }
        prop_assert!(pvs.is_valid_for(&self.world.scene, &view));
        let sight = self.query.sight(&self.world.scene).unwrap();
        prop_assert!(sight.has_occlusion());
        for (id, target) in self.targets().into_iter().filter(|target| visible.contains(&target.0)) {
            prop_assert!(sight.may_see_bounds(&target.into()), "{id} from {} at {}", self.eye, self.now);
        }
        prop_assert!(self.query.is_valid_for(&self.world.scene, &view));
        if std::mem::replace(&mut self.ends, true) {
            self.world.scene.end_frame([self.query.pvs()]).unwrap();
        }
        Ok(())
    }
}
