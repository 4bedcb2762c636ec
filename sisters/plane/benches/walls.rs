//! `Method::Point` beside a plain sweep in floating point: microseconds of a view, by scene.
//!
//! `cargo bench -p casca-plane --bench walls` prints medians of the views, each measured by one
//! method after the other, and the time of `Method::Point` for each wall. `-- ring 1000` measures one
//! scene only.

use std::hint::black_box;
use std::time::Instant;

use casca_plane::{GridSpec, ObjectDesc, Query, Rect, Scene, Segment, View};
use glam::Vec2;

#[path = "random/mod.rs"]
mod random;
#[path = "sweep/mod.rs"]
mod sweep;

use random::Random;

/// Views of a scene, and how often each is measured.
const VIEWS: usize = 16;
const ROUNDS: usize = 15;

const COUNTS: [usize; 3] = [100, 1_000, 10_000];

/// A kind of scene by its name.
type Maker = (&'static str, fn(usize) -> Plan);

/// Walls with the size of their square.
type Plan = (Vec<Segment>, f32);

fn side(walls: usize) -> f32 {
    (walls as f32 * 16.0).sqrt().round()
}

/// Walls of 0.2 to 1.2 units, one for each 16 square units.
fn field(walls: usize) -> Plan {
    let (size, mut random) = (side(walls), Random(2));
    let wall = |_| {
        let a = random.point(size);
        let b = a + random.direction() * (0.2 + random.next());
        Segment::new(a, b.clamp(Vec2::ZERO, Vec2::splat(size)))
    };
    ((0..walls).map(wall).collect(), size)
}

/// Long walls that cross each other often.
fn crossing(walls: usize) -> Plan {
    let (size, mut random) = (side(walls), Random(5));
    let wall = |_| {
        let a = random.point(size);
        let b = a + random.direction() * size * 0.2 * random.next();
        Segment::new(a, b.clamp(Vec2::ZERO, Vec2::splat(size)))
    };
    ((0..walls).map(wall).collect(), size)
}

/// A ring of walls around the middle, at distances that differ a little, all in sight.
fn ring(walls: usize) -> Plan {
    let (size, mut random) = (side(walls), Random(3));
    let middle = Vec2::splat(size / 2.0);
    let wall = |i| {
        let at = |share: f32| Vec2::from_angle((i as f32 + share) * std::f32::consts::TAU / walls as f32);
        let far = size * (0.4 + 0.05 * random.next());
        Segment::new(middle + at(0.05) * far, middle + at(0.95) * far)
    };
    ((0..walls).map(wall).collect(), size)
}

/// The length of a post, in metres.
const POST: f32 = 1e-4;

/// Posts that hide next to nothing: everything is in sight.
fn open(walls: usize) -> Plan {
    let (size, mut random) = (side(walls), Random(4));
    let wall = |_| {
        let a = random.point(size);
        Segment::new(a, a + random.direction() * POST)
    };
    ((0..walls).map(wall).collect(), size)
}

/// Rooms of 8 by 8 units with a door in each wall.
fn rooms(walls: usize) -> Plan {
    const ROOM: f32 = 8.0;
    let rooms = (walls as f32 / 4.0).sqrt().round() as u32;
    let mut random = Random(1);
    let mut plan = Vec::new();
    for i in 0..rooms * rooms {
        let corner = Vec2::new((i % rooms) as f32, (i / rooms) as f32) * ROOM;
        for along in [Vec2::X, Vec2::Y] {
            let door = 1.0 + random.next() * (ROOM - 3.0);
            plan.push(Segment::new(corner, corner + along * door));
            plan.push(Segment::new(corner + along * (door + 1.0), corner + along * ROOM));
        }
    }
    (plan, rooms as f32 * ROOM)
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let (only, counts) = (words.first(), words.get(1).and_then(|word| word.parse().ok()));
    let counts: Vec<usize> = counts.map_or(COUNTS.to_vec(), |count| vec![count]);
    println!("| scene | walls | in sight | plain sweep, us | Method::Point, us | ratio | ns a wall |");
    println!("|---|---|---|---|---|---|---|");
    let makers: [Maker; 5] =
        [("field", field), ("crossing", crossing), ("ring", ring), ("open", open), ("rooms", rooms)];
    for (name, make) in makers.into_iter().filter(|m| only.is_none_or(|only| only == m.0)) {
        for &count in &counts {
            let (walls, size) = make(count);
            let around = Rect::new(Vec2::NEG_ONE, Vec2::splat(size + 1.0));
            let mut scene = Scene::new(&GridSpec::covering(around, 1.0).unwrap()).unwrap();
            for &wall in &walls {
                scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
            }
            let mut random = Random(7);
            let near = |p: Vec2| if name == "ring" { 0.45 * size + p * 0.1 } else { 0.25 * size + p * 0.5 };
            let eyes: Vec<Vec2> = (0..VIEWS).map(|_| near(random.point(size))).collect();
            let (mut query, mut plain) = (Query::new(), sweep::Sweep::default());
            let [mut ours, mut theirs] = [Vec::new(), Vec::new()];
            let mut seen = 0;
            let rounds = (ROUNDS * 1_000 / count).clamp(3, ROUNDS);
            for _ in 0..rounds {
                seen = 0;
                for &eye in &eyes {
                    let start = Instant::now();
                    black_box(plain.run(&walls, eye));
                    theirs.push(start.elapsed().as_secs_f64() * 1e6);
                    let view = View::all_round(eye).unwrap();
                    let start = Instant::now();
                    seen += black_box(query.run(&scene, &view).len());
                    ours.push(start.elapsed().as_secs_f64() * 1e6);
                }
            }
            let (ours, theirs) = (median(&mut ours), median(&mut theirs));
            println!(
                "| {name} | {} | {} | {theirs:.1} | {ours:.1} | {:.2} | {:.0} |",
                walls.len(),
                seen / VIEWS,
                ours / theirs,
                ours * 1e3 / walls.len() as f64
            );
        }
    }
}
