//! The cell method: against the procedure of the thesis, and under growing
//! numbers of hidden objects. Prints the ratios of medians at the end.
//!
//! `cargo bench --bench cell`; accuracy at the same settings: `casca-lab walk`.

use std::time::{Duration, Instant};

use casca::internals::{SceneInternals, occlusion_by_caps, occlusion_by_lattice};
use casca::{CellOptions, Method, ObjectDesc, ObjectId, Query, Scene, Sphere, View};
use casca_scenes::drive::{Driver, grid_for, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::{Settled, median, ratio};
use casca_scenes::world::{FRAME_SECONDS, Motion, Shape, World};
use criterion::Criterion;

fn spheres(hidden_extra: usize) -> World {
    let options = SceneOptions { bunker: true, hidden_extra, ..SceneOptions::default() };
    let mut world = build(SceneKind::Spheres, &options);
    world.set_frame(0);
    world
}

fn settled(hidden_extra: usize) -> Settled {
    Settled::new(&spheres(hidden_extra), Method::cell()).unwrap()
}

/// Masks against the thesis' caps, both in all directions.
fn against_the_thesis(c: &mut Criterion) {
    let world = build(SceneKind::Spheres, &SceneOptions::default());
    let driver = Driver::new(&world, &grid_for(&world.grid, None).unwrap(), |_| ()).unwrap();
    let scene = &driver.scene;
    let eye = world.camera(75, 1.0).eye;
    let viewer = scene.grid().cell_of(eye.as_dvec3());
    let view = View::omnidirectional(eye).unwrap();
    let mut group = c.benchmark_group("occlusion 100x60x100");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    for resolution in [128, 256, 512, 1024] {
        let options = CellOptions::default().mask_resolution(resolution);
        let mut query = Query::with_method(Method::Cell(options)).unwrap();
        group.bench_function(format!("masks {resolution}"), |b| b.iter(|| query.run(scene, &view).len()));
    }
    let opaque = &*scene.static_opacity();
    group.bench_function("caps", |b| b.iter(|| occlusion_by_caps(opaque, viewer).0.count()));
    group.bench_function("lattice", |b| b.iter(|| occlusion_by_lattice(opaque, viewer).count()));
    group.finish();
}

/// The query of the walk while hidden dynamic objects are added.
fn hidden_objects(c: &mut Criterion) {
    let scenes = [0, 10_000, 50_000].map(|n| (n, settled(n)));
    let mut group = c.benchmark_group("walk of 150 queries");
    group.sample_size(10).measurement_time(Duration::from_secs(7)).warm_up_time(Duration::from_secs(1));
    for (n, s) in &scenes {
        let mut query = Query::with_method(Method::cell()).unwrap();
        group.bench_function(format!("{n} hidden"), |b| {
            b.iter(|| s.views.iter().map(|v| query.run(&s.driver.scene, v).len()).sum::<usize>());
        });
    }
    group.finish();
}

/// A scene of hidden dynamic spheres, and what the application does for them each frame.
fn upkeep(c: &mut Criterion) {
    let world = spheres(10_000);
    let first = world.objects.len() - 10_000;
    let mut group = c.benchmark_group("upkeep of 10000 hidden, a frame");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_secs(1));
    for on_expiry in [true, false] {
        let name = if on_expiry { "reported on expiry" } else { "reported always" };
        group.bench_function(name, |b| {
            let mut run = Upkeep::new(&world, first, on_expiry);
            b.iter_custom(|frames| run.frames(frames));
        });
    }
    group.finish();
}

struct Upkeep<'a> {
    world: &'a World,
    scene: Scene,
    ids: Vec<ObjectId>,
    first: usize,
    on_expiry: bool,
    query: Query,
    view: View,
    frame: usize,
}

impl<'a> Upkeep<'a> {
    fn new(world: &'a World, first: usize, on_expiry: bool) -> Self {
        let grid = grid_for(&world.grid, None).unwrap();
        let mut scene = Scene::new(&grid).unwrap();
        let mut ids = Vec::new();
        for (i, o) in world.objects.iter().enumerate() {
            let (bounds, speed): (casca::Bounds, f32) = match (&o.shape, o.motion) {
                (Shape::Sphere { center, radius }, Motion::Dynamic { max_speed }) => {
                    (Sphere::new(*center, *radius).into(), max_speed)
                }
                (Shape::Box { min, max }, _) => (casca::Aabb::new(*min, *max).into(), 0.0),
                _ => continue,
            };
            let desc = match (i >= first, &bounds) {
                (true, _) => {
                    let desc = ObjectDesc::dynamic(bounds).max_speed(speed);
                    if on_expiry { desc.reported_on_expiry() } else { desc }
                }
                (false, casca::Bounds::Box(wall)) => ObjectDesc::fixed(*wall).occluder(*wall),
                _ => continue,
            };
            let id = scene.insert(desc).unwrap();
            if i >= first {
                ids.push(id);
            }
        }
        let view = view_of(&world.camera(0, 16.0 / 9.0)).unwrap();
        let mut run = Self {
            world,
            scene,
            ids,
            first,
            on_expiry,
            query: Query::with_method(Method::cell()).unwrap(),
            view,
            frame: 0,
        };
        run.query.run(&run.scene, &run.view);
        run.frames(2000);
        run
    }

    fn bounds(&self, i: usize) -> Sphere {
        match &self.world.objects[self.first + i].shape {
            Shape::Sphere { center, radius } => {
                // A slow sway of a tenth of a metre.
                let sway = (self.frame as f32 * 0.05 + i as f32).sin() * 0.1;
                Sphere::new(*center + glam::Vec3::X * sway, *radius)
            }
            _ => Sphere::new(glam::Vec3::ZERO, 0.0),
        }
    }

    /// Time spent on upkeep in a number of frames.
    fn frames(&mut self, frames: u64) -> Duration {
        let mut spent = Duration::ZERO;
        let index: std::collections::HashMap<ObjectId, usize> =
            self.ids.iter().enumerate().map(|(i, &id)| (id, i)).collect();
        for _ in 0..frames {
            self.frame += 1;
            let moved: Vec<Sphere> = if self.on_expiry {
                Vec::new()
            } else {
                (0..self.ids.len()).map(|i| self.bounds(i)).collect()
            };
            let start = Instant::now();
            let due = self.scene.begin_frame(self.frame as f64 * FRAME_SECONDS).unwrap();
            for id in due {
                let sphere = self.bounds(index[&id]);
                self.scene.update(id, sphere, None).unwrap();
            }
            for (i, sphere) in moved.into_iter().enumerate() {
                self.scene.update(self.ids[i], sphere, None).unwrap();
            }
            // Nothing in sight changes: the first result stands for every frame's.
            self.scene.end_frame([self.query.pvs()]).unwrap();
            spent += start.elapsed();
        }
        spent
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    against_the_thesis(&mut criterion);
    hidden_objects(&mut criterion);
    upkeep(&mut criterion);
    criterion.final_summary();
    let (thesis, walk) = ("occlusion 100x60x100", "walk of 150 queries");
    let query = median(walk, "10000 hidden").map(|ns| ns / 150.0);
    println!("\nratios of medians");
    ratio("caps of the thesis / masks of 256", median(thesis, "caps"), median(thesis, "masks 256"));
    ratio(
        "lattice rule over all shells / masks of 256",
        median(thesis, "lattice"),
        median(thesis, "masks 256"),
    );
    ratio("query with 50,000 hidden / without", median(walk, "50000 hidden"), median(walk, "0 hidden"));
    let upkeep = "upkeep of 10000 hidden, a frame";
    ratio("upkeep of 10,000 reported on expiry / query", median(upkeep, "reported on expiry"), query);
    ratio("upkeep of 10,000 reported in every frame / query", median(upkeep, "reported always"), query);
}
