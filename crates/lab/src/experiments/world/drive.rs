//! A drive through a land larger than a grid, with pages loaded and dropped on the way.

use std::collections::BTreeMap;
use std::sync::Arc;

use casca::{
    Aabb, KeptOptions, KeptQuery, ObjectDesc, ObjectId, PageId, PageObjects, Query, View, World, WorldFrame,
    WorldOptions,
};
use casca_scenes::measure::timed;
use casca_scenes::world::{Camera, Motion, Object, Shape};
use casca_truth::oracle::{Oracle, OracleOptions};
use glam::{BVec3, DVec3, UVec3, Vec3};

use super::super::{ASPECT, LabError};
use super::land::{Land, PAGE, SQUARE, Thing};

/// How far the drive goes, and how closely it is looked at.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Frames, 30 a second.
    pub frames: usize,
    /// Metres of a frame.
    pub step: f64,
    /// Pages that are loaded around the eye's, in each direction.
    pub radius: i32,
    /// Pages of the window along x and z.
    pub window: u32,
    /// The budget of a frame.
    pub budget: usize,
    /// How much stands on the ground, as a share of what a full run has.
    pub density: f32,
    /// One frame of so many is compared with exact visibility.
    pub judge: usize,
    /// Pixels of a row of the item buffer.
    pub width: usize,
    /// Rays to each object that a set leaves out.
    pub rays: usize,
    /// Cars that drive about.
    pub cars: usize,
    /// Seed of the land and the rays.
    pub seed: u64,
}

/// Milliseconds of the steps of a frame, with what it did.
#[derive(Debug, Clone, Copy, Default)]
pub struct Frame {
    /// Metres driven.
    pub way: f64,
    /// `World::begin_frame`.
    pub begin: f64,
    /// Moves of all cars, and those that come and go.
    pub moves: f64,
    /// `Query::run`.
    pub query: f64,
    /// `KeptQuery::run`, in every fourth frame; else 0.
    pub kept: f64,
    /// `World::end_frame`.
    pub end: f64,
    /// Objects in the scene.
    pub objects: usize,
    /// Objects found.
    pub found: usize,
    /// Whether pages were coming or going.
    pub streams: bool,
    /// Whether the window was moving.
    pub shifting: bool,
    /// Whether it has moved in this frame.
    pub shifted: bool,
    /// Bytes of the world, where they were counted; else 0.
    pub bytes: usize,
}

/// What a drive measured.
#[derive(Debug, Clone, Default)]
pub struct Drive {
    /// The frames.
    pub frames: Vec<Frame>,
    /// Pages loaded and dropped.
    pub loaded: usize,
    /// Pages dropped.
    pub dropped: usize,
    /// Milliseconds to make and check the objects of a page, on any thread.
    pub prepare: Vec<f64>,
    /// Objects of a page.
    pub page_objects: Vec<f64>,
    /// Milliseconds to drop a scene that was replaced, on any thread.
    pub retire: Vec<f64>,
    /// Milliseconds of `Scene::shift_origin` on the scene at the end of the drive.
    pub shift_origin: f64,
    /// Milliseconds to move the window at once, at the end.
    pub at_once: f64,
    /// Frames compared with exact visibility.
    pub judged: usize,
    /// Visible objects in those.
    pub visible: usize,
    /// Objects of the sets in those.
    pub found: usize,
    /// Visible objects that the sets of queries and of kept queries lacked.
    pub lost: [usize; 2],
}

/// The corner of the land: far from the origin.
const CORNER: PageId = PageId::new(4096, 0, -8192);
/// The land has so many pages along x and z: 10 km.
const PAGES: i32 = 20;
/// Between two counts of the memory, in frames.
const COUNT_MEMORY: usize = 40;
/// A kept query runs in one frame of so many.
const KEPT: usize = 4;
/// Metres a car goes in a frame.
const CAR_STEP: f64 = 0.5;

struct Car {
    id: ObjectId,
    place: DVec3,
    way: DVec3,
}

struct Driver<'a> {
    sampling: &'a Sampling,
    land: Land,
    world: World,
    /// By the index of an id: the thing and its place.
    things: Vec<Option<(ObjectId, Arc<Thing>, DVec3)>>,
    /// The things of pages that were handed over.
    handed: BTreeMap<PageId, Vec<Arc<Thing>>>,
    cars: Vec<Car>,
    car: Arc<Thing>,
    drive: Drive,
}

/// Drives and measures.
///
/// # Errors
/// As the library's.
pub fn drive(sampling: &Sampling, mut progress: impl FnMut(usize)) -> Result<Drive, LabError> {
    let options = WorldOptions::new(1.0)
        .window(UVec3::new(sampling.window, 2, sampling.window))
        .still(BVec3::new(false, true, false))
        .budget(sampling.budget);
    let shape = Shape::Box { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 1.5, 1.0) };
    let mut driver = Driver {
        sampling,
        land: Land { seed: sampling.seed, density: sampling.density },
        world: World::new(options)?,
        things: Vec::new(),
        handed: BTreeMap::new(),
        cars: Vec::new(),
        car: Arc::new(Thing { shape, hides: true }),
        drive: Drive::default(),
    };
    let (mut query, mut kept) =
        (Query::new(), KeptQuery::with_options(KeptOptions::new().reach(2.0).turn(0.05))?);
    driver.stream(driver.eye(0.0))?;
    let report = driver.world.settle(driver.eye(0.0))?;
    driver.learn(&report);
    for frame in 0..sampling.frames {
        driver.frame(frame, &mut query, &mut kept)?;
        progress(frame + 1);
    }
    driver.compare_shifts()?;
    Ok(driver.drive)
}

impl Driver<'_> {
    /// The eye after some way: along streets, in turns along x and z.
    fn eye(&self, way: f64) -> DVec3 {
        const LEG: f64 = 1024.0;
        let (legs, rest) = ((way / LEG).floor(), way % LEG);
        let (along_x, along_z) = ((legs / 2.0).ceil() * LEG, (legs / 2.0).floor() * LEG);
        let on_x = legs as i64 % 2 == 0;
        let at =
            DVec3::new(along_x + if on_x { rest } else { 0.0 }, 0.0, along_z + if on_x { 0.0 } else { rest });
        let start = self.world.corner(CORNER) + DVec3::new(2048.0, 0.0, 2048.0);
        let at = ((start + at) * 16.0).round() / 16.0;
        DVec3 { y: f64::from(self.land.ground(at)) + 2.5, ..at }
    }

    fn camera(&self, way: f64) -> Camera {
        let ahead = self.eye(way + 1.0) - self.eye(way);
        let level = Vec3::new(ahead.x as f32, 0.0, ahead.z as f32).normalize_or(Vec3::X);
        Camera::look_at(Vec3::ZERO, level, 60.0, ASPECT, 0.1, 3000.0)
    }

    /// Hands over the pages around the eye that are not there, and drops those that are far.
    fn stream(&mut self, eye: DVec3) -> Result<(), LabError> {
        let center = self.world.page_at(eye)?;
        let radius = self.sampling.radius;
        let far = |page: &PageId| (page.x - center.x).abs().max((page.z - center.z).abs()) > radius;
        for page in self.handed.keys().copied().filter(far).collect::<Vec<_>>() {
            self.world.drop_page(page)?;
            self.handed.remove(&page);
        }
        let inside = |v: i32, corner: i32| (corner..corner + PAGES).contains(&v);
        let around = (-radius..=radius).flat_map(|z| (-radius..=radius).map(move |x| (x, z)));
        let mut wanted: Vec<PageId> = around
            .map(|(x, z)| PageId::new(center.x + x, 0, center.z + z))
            .filter(|page| inside(page.x, CORNER.x) && inside(page.z, CORNER.z))
            .filter(|page| !self.handed.contains_key(page))
            .collect();
        wanted.sort_by_key(|page| (page.x - center.x).abs().max((page.z - center.z).abs()));
        for page in wanted {
            let ((things, objects), time) = timed(|| {
                let things: Vec<Arc<Thing>> = self.land.things(page).into_iter().map(Arc::new).collect();
                let objects = PageObjects::new(things.iter().map(|thing| thing.desc()));
                (things, objects)
            });
            self.drive.prepare.push(time.as_secs_f64() * 1e3);
            self.drive.page_objects.push(things.len() as f64);
            self.world.load(page, objects?)?;
            self.handed.insert(page, things);
        }
        Ok(())
    }

    /// Takes note of the pages that came and went.
    fn learn(&mut self, report: &WorldFrame) {
        self.drive.loaded += report.loaded.len();
        self.drive.dropped += report.dropped.len();
    }

    /// The things in the scene with their ids and places.
    fn known(&mut self) -> Vec<(ObjectId, Arc<Thing>, DVec3)> {
        for (&page, things) in &self.handed {
            let corner = self.world.corner(page);
            for (&id, thing) in self.world.page_objects(page).iter().zip(things) {
                note(&mut self.things, (id, thing.clone(), corner));
            }
        }
        for car in &self.cars {
            note(&mut self.things, (car.id, self.car.clone(), car.place));
        }
        let scene = self.world.scene();
        self.things.iter().flatten().filter(|(id, ..)| scene.contains(*id)).cloned().collect()
    }

    /// Cars drive along the streets, through all pages; those that are far go, and others come.
    fn move_cars(&mut self, eye: DVec3) -> Result<(), LabError> {
        let (near, mut kept) = (1200.0, Vec::new());
        for mut car in std::mem::take(&mut self.cars) {
            car.place += car.way * CAR_STEP;
            car.place.y = f64::from(self.land.ground(car.place));
            if (car.place - eye).length() > near {
                self.world.remove(car.id)?;
                continue;
            }
            self.world.set_place(car.id, car.place)?;
            kept.push(car);
        }
        self.cars = kept;
        let Shape::Box { min, max } = self.car.shape else { return Ok(()) };
        let (b, side) = (Aabb::new(min, max), f64::from(SQUARE));
        while self.cars.len() < self.sampling.cars {
            let n = (self.cars.len() + self.drive.frames.len() * 7) as f64;
            let off = |by: f64| (((n * by).fract() - 0.5) * 30.0).round() * side;
            let place = (eye / side).round() * side + DVec3::new(off(0.754_877), 0.0, off(0.569_840));
            let way = [DVec3::X, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Z][n as usize % 4];
            let place = DVec3 { y: f64::from(self.land.ground(place)), ..place };
            let speed = CAR_STEP as f32 * 60.0;
            let id = self.world.insert(ObjectDesc::dynamic(b).occluder(b).max_speed(speed), place)?;
            self.cars.push(Car { id, place, way });
        }
        Ok(())
    }

    fn frame(&mut self, frame: usize, query: &mut Query, kept: &mut KeptQuery) -> Result<(), LabError> {
        let way = frame as f64 * self.sampling.step;
        let eye = self.eye(way);
        self.stream(eye)?;
        let ms = |time: std::time::Duration| time.as_secs_f64() * 1e3;
        let before = self.world.scene().len();
        let (report, begin) = timed(|| self.world.begin_frame(frame as f64 / 30.0, eye));
        let report = report?;
        self.learn(&report);
        let after = self.world.scene().len();
        let (old, time) = timed(|| self.world.take_retired().map(drop));
        if old.is_some() {
            self.drive.retire.push(ms(time));
        }
        let (moved, moves) = timed(|| self.move_cars(eye));
        moved?;
        let camera = self.camera(way);
        let view = View::perspective(Vec3::ZERO, camera.view_projection())?;
        let view = self.world.view(eye, &view)?;
        let scene = self.world.scene();
        let (found, time) = timed(|| query.run(scene, &view).len());
        let judged = frame.is_multiple_of(self.sampling.judge) || report.shifted;
        let asked = judged || frame.is_multiple_of(KEPT);
        let (_, kept_time) = timed(|| asked.then(|| kept.run(scene, &view).len()));
        if judged {
            self.judge(eye, &camera, [query.pvs(), kept.pvs()]);
        }
        let (ended, end) = timed(|| self.world.end_frame([query.pvs()]));
        ended?;
        self.drive.frames.push(Frame {
            way,
            begin: ms(begin),
            moves: ms(moves),
            query: ms(time),
            kept: if asked { ms(kept_time) } else { 0.0 },
            end: ms(end),
            objects: self.world.scene().len(),
            found,
            streams: before != after || !report.loaded.is_empty() || !report.dropped.is_empty(),
            shifting: self.world.is_shifting() || report.shifted,
            shifted: report.shifted,
            bytes: if frame.is_multiple_of(COUNT_MEMORY) { self.world.memory_bytes() } else { 0 },
        });
        Ok(())
    }

    /// Compares sets with exact visibility, relative to the eye.
    fn judge(&mut self, eye: DVec3, camera: &Camera, sets: [&casca::Pvs; 2]) {
        let known = self.known();
        let objects: Vec<Object> = known
            .iter()
            .map(|(_, thing, place)| Object {
                name: String::new(),
                shape: thing.seen_from(*place, eye),
                motion: Motion::Static,
                occludes: thing.hides,
                tested: true,
            })
            .collect();
        let options = OracleOptions {
            width: self.sampling.width,
            height: self.sampling.width * 9 / 16,
            samples_per_object: self.sampling.rays,
            max_candidates: 20_000,
            seed: self.sampling.seed + self.drive.judged as u64,
        };
        let mut oracle = Oracle::new(&objects, options);
        let [fresh, kept] = sets;
        let verdict = oracle.frame(&objects, &[], camera, &|i| fresh.contains(known[i].0));
        self.drive.lost[0] += verdict.false_negatives.len();
        self.drive.visible += verdict.exact.len();
        self.drive.found += fresh.len();
        // The other set is looked at as closely only where it lacks something.
        if verdict.exact.iter().any(|&i| !kept.contains(known[i].0)) {
            let verdict = oracle.frame(&objects, &[], camera, &|i| kept.contains(known[i].0));
            self.drive.lost[1] += verdict.false_negatives.len();
        }
        self.drive.judged += 1;
    }

    /// What it costs to move everything at once, by either way.
    fn compare_shifts(&mut self) -> Result<(), LabError> {
        let mut scene = self.world.scene().clone();
        let (shifted, time) = timed(|| scene.shift_origin(Vec3::new(PAGE as f32, 0.0, 0.0)));
        shifted?;
        self.drive.shift_origin = time.as_secs_f64() * 1e3;
        drop(scene);
        let eye = self.eye(self.sampling.frames as f64 * self.sampling.step);
        let there = eye + DVec3::X * f64::from(PAGE) * f64::from(self.sampling.window);
        let (settled, time) = timed(|| self.world.settle(there));
        settled?;
        self.drive.at_once = time.as_secs_f64() * 1e3;
        Ok(())
    }
}

fn note(things: &mut Vec<Option<(ObjectId, Arc<Thing>, DVec3)>>, entry: (ObjectId, Arc<Thing>, DVec3)) {
    let at = entry.0.index();
    if things.len() <= at {
        things.resize_with(at + 1, || None);
    }
    things[at] = Some(entry);
}
