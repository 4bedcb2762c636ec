//! The time of a view against the number of walls in the scene and in sight.
//!
//! Names are `scene/walls in the scene/pieces of the visible region`; among few walls, the calls, and
//! a sweep in floats.

mod sweep;

use casca_plane::{Disc, GridSpec, ObjectDesc, Query, Scene, Segment, View, visible_region};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{UVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// A point of a square.
fn point(random: &mut Pcg32, size: f32) -> Vec2 {
    Vec2::new(random.random_range(0.0..1.0), random.random_range(0.0..1.0)) * size
}

/// A step of a length in any direction.
fn step(random: &mut Pcg32, length: f32) -> Vec2 {
    Vec2::from_angle(random.random_range(0.0..std::f32::consts::TAU)) * length
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
    let mut random = Pcg32::seed_from_u64(1);
    let mut scene = scene(size);
    for i in 0..rooms * rooms {
        let corner = Vec2::new((i % rooms) as f32, (i / rooms) as f32) * ROOM;
        for along in [Vec2::X, Vec2::Y] {
            let door = random.random_range(1.0..ROOM - 2.0);
            add_wall(&mut scene, corner, corner + along * door);
            add_wall(&mut scene, corner + along * (door + 1.0), corner + along * ROOM);
        }
        let guard = Disc::new(corner + 1.0 + point(&mut random, ROOM - 2.0), 0.4);
        scene.insert(ObjectDesc::new(guard)).unwrap();
    }
    (scene, size)
}

/// The length of a wall that hides next to nothing.
const POST: f32 = 1e-4;

/// Posts, one for each 16 square units: everything is in sight.
fn open(walls: u32) -> (Scene, f32) {
    let size = (walls as f32 * 16.0).sqrt().round();
    let mut random = Pcg32::seed_from_u64(3);
    let mut scene = scene(size);
    for _ in 0..walls {
        let a = point(&mut random, size);
        add_wall(&mut scene, a, a + step(&mut random, POST));
    }
    (scene, size)
}

fn views(criterion: &mut Criterion) {
    for (name, make) in [("floor plan", floor_plan as fn(u32) -> (Scene, f32)), ("open", open)] {
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10);
        for walls in WALLS {
            let (scene, size) = make(walls);
            let mut random = Pcg32::seed_from_u64(4);
            let views: Vec<View> = (0..VIEWS)
                .map(|_| View::all_round(size * 0.25 + point(&mut random, size * 0.5)).unwrap())
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

/// Views that are run in turn: so many that their branches are not learned.
const FEW_VIEWS: usize = 1000;

/// Buildings, four walls each, in a square field with four more around it: no walls cross.
fn buildings(count: u32) -> (Vec<Segment>, f32) {
    let (side, mut walls) = ((count as f32).sqrt().ceil() as u32, Vec::new());
    let mut add = |[a, c]: [Vec2; 2]| {
        let ring = [a, Vec2::new(c.x, a.y), c, Vec2::new(a.x, c.y)];
        walls.extend((0..4).map(|i| Segment::new(ring[i], ring[(i + 1) % 4])));
    };
    let size = side as f32 * 4.0;
    add([Vec2::ZERO, Vec2::splat(size)]);
    for i in 0..count {
        let corner = Vec2::new((i % side) as f32, (i / side) as f32) * 4.0;
        add([corner + 1.5, corner + 2.5]);
    }
    (walls, size)
}

fn few_walls(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("few walls");
    for count in [2, 7, 14, 24] {
        let (walls, size) = buildings(count);
        let mut scene = scene(size);
        walls.iter().for_each(|wall| add_wall(&mut scene, wall.a, wall.b));
        let mut random = Pcg32::seed_from_u64(5);
        let eyes: Vec<Vec2> = (0..FEW_VIEWS).map(|_| point(&mut random, size)).collect();
        let (mut query, mut sweep) = (Query::new(), sweep::Sweep::default());
        let mut run = |name: &str, look: &mut dyn FnMut(Vec2) -> usize| {
            let mut eyes = eyes.iter().cycle();
            let id = BenchmarkId::new(name, walls.len());
            group.bench_function(id, |bencher| bencher.iter(|| eyes.next().map(|&eye| look(eye))));
        };
        run("sweep in floats", &mut |eye| sweep.run(&walls, eye).len());
        run("sweep in floats, new", &mut |eye| sweep::Sweep::default().run(&walls, eye).len());
        run("Query::run", &mut |eye| query.run(&scene, &View::all_round(eye).unwrap()).len());
        run("visible_region", &mut |eye| visible_region(&walls, eye, 2.0 * size).unwrap().len());
    }
}

criterion_group!(benches, few_walls, views);
criterion_main!(benches);
