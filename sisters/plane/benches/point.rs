//! The time of a view against the number of walls in the scene and in sight.
//!
//! Names are `scene/walls in the scene/pieces of the visible region`.

use casca_plane::{Disc, GridSpec, ObjectDesc, Query, Scene, Segment, View};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{UVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// Random numbers from 0 to 1.
struct Random(Pcg32);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// The next one.
    fn next(&mut self) -> f32 {
        self.0.random_range(0.0..1.0)
    }

    /// A point of a square.
    fn point(&mut self, size: f32) -> Vec2 {
        Vec2::new(self.next(), self.next()) * size
    }
}

const VIEWS: u32 = 8;

const WALLS: [u32; 4] = [100, 1_000, 10_000, 100_000];

fn scene(size: f32) -> Scene {
    let dims = UVec2::splat(size as u32 + 2);
    Scene::new(&GridSpec { min: Vec2::NEG_ONE, cell: 1.0, dims }).unwrap()
}

fn add_wall(scene: &mut Scene, a: Vec2, b: Vec2) {
    let wall = Segment::new(a, b);
    scene.insert(ObjectDesc::new(wall).occluder(wall)).unwrap();
}

/// Rooms of 8 by 8 units with a door in each wall, and a guard in each room.
fn floor_plan(walls: u32) -> (Scene, f32) {
    const ROOM: f32 = 8.0;
    let rooms = (walls as f32 / 4.0).sqrt().round() as u32;
    let size = rooms as f32 * ROOM;
    let mut random = Random::new(1);
    let mut scene = scene(size);
    for i in 0..rooms * rooms {
        let corner = Vec2::new((i % rooms) as f32, (i / rooms) as f32) * ROOM;
        for along in [Vec2::X, Vec2::Y] {
            let door = 1.0 + random.next() * (ROOM - 3.0);
            add_wall(&mut scene, corner, corner + along * door);
            add_wall(&mut scene, corner + along * (door + 1.0), corner + along * ROOM);
        }
        let guard = Disc::new(corner + 1.0 + random.point(ROOM - 2.0), 0.4);
        scene.insert(ObjectDesc::new(guard)).unwrap();
    }
    (scene, size)
}

/// Short walls, one for each 16 square units.
fn field(walls: u32) -> (Scene, f32) {
    let size = (walls as f32 * 16.0).sqrt().round();
    let mut random = Random::new(2);
    let mut scene = scene(size);
    for _ in 0..walls {
        let a = random.point(size);
        let b = a + Vec2::from_angle(random.next() * std::f32::consts::TAU) * (0.2 + random.next());
        add_wall(&mut scene, a, b.clamp(Vec2::ZERO, Vec2::splat(size)));
    }
    (scene, size)
}

/// The length of a wall that hides next to nothing.
const POST: f32 = 1e-4;

/// Posts in rings around the eye, and nothing that hides most of them: everything is in sight.
fn open(walls: u32) -> (Scene, f32) {
    let size = (walls as f32 * 16.0).sqrt().round();
    let mut random = Random::new(3);
    let mut scene = scene(size);
    for _ in 0..walls {
        let a = random.point(size);
        add_wall(&mut scene, a, a + Vec2::from_angle(random.next() * std::f32::consts::TAU) * POST);
    }
    (scene, size)
}

fn views(criterion: &mut Criterion) {
    for (name, make) in
        [("floor plan", floor_plan as fn(u32) -> (Scene, f32)), ("field", field), ("open", open)]
    {
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10);
        for walls in WALLS {
            let (scene, size) = make(walls);
            let mut random = Random::new(4);
            let views: Vec<View> = (0..VIEWS)
                .map(|_| View::all_round(size * 0.25 + random.point(size * 0.5)).unwrap())
                .collect();
            let mut query = Query::new();
            let pieces: u32 = views.iter().map(|view| query.run(&scene, view).stats().pieces).sum();
            let mut next = 0;
            group.bench_function(BenchmarkId::new(walls.to_string(), pieces / VIEWS), |bencher| {
                bencher.iter(|| {
                    next = (next + 1) % views.len();
                    query.run(&scene, &views[next]).len()
                });
            });
        }
    }
}

criterion_group!(benches, views);
criterion_main!(benches);
