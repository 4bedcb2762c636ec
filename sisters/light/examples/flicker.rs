//! What frames show while something moves: `flicker [N,..] [RAYS,..] [STATES,..]`. Two rooms with a
//! door; a lamp, the door or a chest moves for 40 frames and rests for 20. A frame gathers and lights
//! so many states at most, passes twice and smooths twice; it is compared with a cache of many other
//! rays that does all in each frame.
//!
//! *Lag* is the root mean square of the difference of indirect light at points of both rooms, over
//! the mean; *flicker* that of the difference of changes from one frame to the next, which are
//! blotches that move; *rest* is the flicker of the last ten frames, in which nothing moves.

use std::error::Error;
use std::time::Instant;

use casca_radiosity::{Cache, Grid, Light, Material, Object, Scene, Settings, Triangle};
use glam::{DVec3, Vec3};

const MOVING: u32 = 40;
const FRAMES: u32 = 60;
/// The last frames, in which nothing moves.
const LAST: u32 = 10;
/// Rays of each state of the cache that frames are compared with.
const MANY: u32 = 512;
/// States of one part of a frame.
const PART: u32 = 100;
const PASSES: u32 = 2;
const MEANS: u32 = 2;
/// The cache that is compared with passes until a pass changes less than this share.
const SETTLED: f64 = 1e-4;
const MOST_PASSES: u32 = 40;

/// A box, with its fronts inside for a room.
fn cuboid(min: Vec3, max: Vec3, is_room: bool) -> Vec<Triangle> {
    let mut all = Vec::new();
    for axis in 0..3 {
        for (end, at) in [(false, min), (true, max)] {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |a: bool, b: bool| {
                let mut c = at;
                c[u] = if a { max[u] } else { min[u] };
                c[v] = if b { max[v] } else { min[v] };
                c
            };
            let [a, b, c, d] =
                [(false, false), (true, false), (true, true), (false, true)].map(|(a, b)| corner(a, b));
            for corners in [[a, b, c], [a, c, d]] {
                let [a, b, c] = corners;
                let corners = if end != is_room { corners } else { [a, c, b] };
                all.push(Triangle { corners, material: 0 });
            }
        }
    }
    all
}

/// The door, open by so many metres.
fn door(open: f32) -> Object {
    cuboid(Vec3::new(3.95, 0.0, 3.0 - open), Vec3::new(4.05, 2.9, 4.0 - open), false).into()
}

fn chest(x: f32) -> Object {
    cuboid(Vec3::new(x, 0.0, 1.0), Vec3::new(x + 0.6, 0.8, 1.8), false).into()
}

fn lamp(x: f32) -> Light {
    Light::Point { position: Vec3::new(x, 2.2, 1.9), intensity: Vec3::splat(10.0), radius: 0.0 }
}

#[derive(Debug, Clone, Copy)]
enum Mover {
    Lamp,
    Door,
    Chest,
}

impl Mover {
    fn start(self) -> Scene {
        let mut walls = cuboid(Vec3::ZERO, Vec3::new(8.0, 3.0, 4.0), true);
        walls.extend(cuboid(Vec3::new(3.9, 0.0, 0.0), Vec3::new(4.1, 3.0, 3.0), false));
        let open = if matches!(self, Self::Door) { 0.0 } else { 0.9 };
        Scene {
            objects: vec![walls.into(), door(open), chest(0.7)],
            materials: vec![Material::new(Vec3::splat(0.6), Vec3::ZERO)],
            lights: vec![lamp(1.2)],
            ..Scene::default()
        }
    }

    fn step(self, cache: &mut Cache, frame: u32) -> Result<(), Box<dyn Error>> {
        let along = frame as f32 / MOVING as f32;
        match self {
            Self::Lamp => cache.set_lights(&[lamp(1.2 + 2.0 * along)])?,
            Self::Door => _ = cache.set_object(1, door(0.9 * along))?,
            Self::Chest => _ = cache.set_object(2, chest(0.7 + 2.0 * along))?,
        }
        Ok(())
    }
}

/// Points of the floor, of the ceiling and of a wall, of both rooms, which the chest does not pass.
fn points() -> Vec<(Vec3, Vec3)> {
    let mut all = Vec::new();
    for i in 0..60 {
        let (u, v) = ((i as f32 + 0.5) / 60.0, (i as f32 * 0.618).fract());
        let x = 0.1 + 7.8 * u;
        let x = if (3.8..4.2).contains(&x) { 5.0 } else { x };
        all.push((Vec3::new(x, 0.0, 2.1 + 1.8 * v), Vec3::Y));
        all.push((Vec3::new(x, 3.0, 0.1 + 3.8 * v), -Vec3::Y));
        all.push((Vec3::new(x, 0.1 + 2.8 * v, 0.0), Vec3::Z));
    }
    all
}

fn light(cache: &Cache) -> Result<Vec<DVec3>, Box<dyn Error>> {
    let ask = |(p, n): &(Vec3, Vec3)| Ok(cache.irradiance(*p, *n)?.indirect.as_dvec3());
    points().iter().map(ask).collect()
}

fn apart(a: &[DVec3], b: &[DVec3]) -> f64 {
    let of = |(a, b): (&DVec3, &DVec3)| (*a - *b).length_squared() / 3.0;
    (a.iter().zip(b).map(of).sum::<f64>() / a.len() as f64).sqrt()
}

fn change(after: &[DVec3], before: &[DVec3]) -> Vec<DVec3> {
    after.iter().zip(before).map(|(a, b)| *a - *b).collect()
}

/// A cache in which everything is done.
fn settled(scene: &Scene, cells: u32, rays: u32, seed: u32) -> Result<Cache, Box<dyn Error>> {
    let grid = Grid { min: Vec3::ZERO, max: Vec3::new(8.0, 3.0, 4.0), cells };
    let mut cache = Cache::new(scene, Settings { seed, threads: 2, ..Settings::new(grid) })?;
    settle(&mut cache, rays)?;
    Ok(cache)
}

fn settle(cache: &mut Cache, rays: u32) -> Result<(), Box<dyn Error>> {
    for (point, normal) in points() {
        cache.request(point, normal)?;
    }
    cache.gather(rays)?;
    cache.direct();
    cache.converge(SETTLED, MOST_PASSES);
    Ok(())
}

/// The light of each frame with much work.
fn truth(mover: Mover, cells: u32) -> Result<Vec<Vec<DVec3>>, Box<dyn Error>> {
    let mut cache = settled(&mover.start(), cells, MANY, 1)?;
    let mut all = vec![light(&cache)?];
    for frame in 1..=FRAMES {
        if frame <= MOVING {
            mover.step(&mut cache, frame)?;
            settle(&mut cache, MANY)?;
            all.push(light(&cache)?);
        } else {
            all.push(all[MOVING as usize].clone());
        }
    }
    Ok(all)
}

/// What the frames of one setting show.
#[derive(Debug, Default)]
struct Shown {
    lag: f64,
    flicker: f64,
    worst: f64,
    rest: f64,
    /// Milliseconds a frame, without the answers.
    ms: f64,
}

/// Frames of so many rays of a state, and so many states of a frame, beside the truth.
fn shown(
    mover: Mover,
    truth: &[Vec<DVec3>],
    (cells, rays, states): (u32, u32, u32),
) -> Result<Shown, Box<dyn Error>> {
    let of_frame = |t: &Vec<DVec3>| t.iter().map(|l| l.element_sum()).sum::<f64>() / (3 * t.len()) as f64;
    let mean = truth.iter().map(of_frame).sum::<f64>() / truth.len() as f64;
    let mut cache = settled(&mover.start(), cells, rays, 0)?;
    cache.smooth(MEANS);
    let mut before = light(&cache)?;
    let mut found = Shown::default();
    for frame in 1..=FRAMES {
        let clock = Instant::now();
        if frame <= MOVING {
            mover.step(&mut cache, frame)?;
        }
        for (point, normal) in points() {
            cache.request(point, normal)?;
        }
        for _ in 0..states / PART {
            cache.gather_part((rays, rays.div_ceil(4)), PART as usize)?;
            cache.direct_part(PART as usize);
        }
        (0..PASSES).for_each(|_| _ = cache.pass());
        cache.smooth(MEANS);
        found.ms += clock.elapsed().as_secs_f64() * 1e3 / f64::from(FRAMES);
        let now = light(&cache)?;
        let (t, b) = (&truth[frame as usize], &truth[frame as usize - 1]);
        let jump = apart(&change(&now, &before), &change(t, b)) / mean;
        if frame <= MOVING {
            found.lag += apart(&now, t) / mean / f64::from(MOVING);
            found.flicker += jump / f64::from(MOVING);
            found.worst = found.worst.max(jump);
        } else if frame > FRAMES - LAST {
            found.rest += jump / f64::from(LAST);
        }
        before = now;
    }
    Ok(found)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let of = |i: usize, default: &str| {
        let text = arguments.get(i).map_or(default, |a| a);
        text.split(',').map(str::parse::<u32>).collect::<Result<Vec<_>, _>>()
    };
    let (sizes, rays, states) = (of(0, "32,64")?, of(1, "16,64,256")?, of(2, "300,1000")?);
    println!("| what moves | N | rays | states a frame | lag | flicker | worst | rest | ms a frame |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for mover in [Mover::Lamp, Mover::Door, Mover::Chest] {
        for &cells in &sizes {
            let truth = truth(mover, cells)?;
            for &rays in &rays {
                for &states in &states {
                    let found = shown(mover, &truth, (cells, rays, states))?;
                    let shares = [found.lag, found.flicker, found.worst, found.rest];
                    let [lag, flicker, worst, rest] = shares.map(|s| 100.0 * s);
                    println!(
                        "| {mover:?} | {cells} | {rays} | {states} | {lag:.2}% | {flicker:.2}% | {worst:.2}% | {rest:.3}% | {:.1} |",
                        found.ms
                    );
                }
            }
        }
    }
    Ok(())
}
