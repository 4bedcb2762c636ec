//! Sets of cells beside exact visibility and beside bakes by samples, as engines make them.
//!
//! `cargo run --release -p casca-bake --features charts --example compare -- --help`
//!
//! From random eyes in each cell, six pictures are cast, and rays at each object that no eye saw
//! yet. A bake by samples has the objects in the pictures of its first eyes. Seconds are those of
//! one thread's clock.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Instant;

use casca_bake::{Finder, Level, Places, bounds_of, eyes_of};
use casca_scenes::generated::SceneOptions;
use casca_scenes::measure::ThreadTime;
use casca_scenes::name::SceneName;
use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{Camera, Motion, Object, Shape};
use casca_tools::pictures::palette::{POINT, RAYS};
use casca_tools::pictures::{Axis, Line, lines};
use casca_truth::oracle::{Oracle, OracleOptions, Seen};
use clap::Parser;
use glam::Vec3;
use rand::RngExt;

/// Pixels of each of the six pictures from an eye, along an edge.
const PIXELS: usize = 128;
/// Rays from each of the six directions of an eye to each object that the smallest set lacks, and
/// how many of these objects are looked at.
const RAYS_EACH: usize = 1;
const LOOKED_AT: usize = 500;
/// Rays from an eye to each object that none saw yet: many objects are smaller than a pixel.
const PROBES: usize = 2;
/// Bakes by samples: so many eyes each.
const SAMPLES: [usize; 6] = [1, 4, 16, 64, 256, 1024];
/// The near plane. Its corners are nearer than [`CLEAR`]: a camera whose near plane reaches into a
/// wall looks through it.
const NEAR: f32 = 0.0005;
/// Eyes keep that far from solids, in metres.
const CLEAR: f32 = 0.001;
const SEED: u64 = 11;

/// Whether a place is in a solid box or ball.
fn in_solid(objects: &[Object], place: Vec3) -> bool {
    objects.iter().filter(|o| o.occludes).any(|object| match &object.shape {
        Shape::Sphere { center, radius } => center.distance(place) <= *radius + CLEAR,
        Shape::Box { min, max } => place.cmpge(min - CLEAR).all() && place.cmple(max + CLEAR).all(),
        Shape::Mesh { mesh, .. } => {
            mesh.triangles.len() == 12 && mesh.is_closed() && bounds_of(&object.shape).contains(place)
        }
    })
}

#[derive(Parser)]
struct Arguments {
    /// A generated scene or a glTF file.
    scene: String,
    /// The edge of a cell, in metres.
    cell: f32,
    /// The least and the greatest height of an eye over the floor, as 0.2:2.0.
    height: String,
    /// How many cells are looked at.
    cells: usize,
    /// Eyes in each.
    eyes: usize,
    /// The chart.
    out: PathBuf,
    /// Most queries a cell, of each bake by casca.
    queries: Vec<u32>,
}

struct Tally {
    name: String,
    seconds: f64,
    size: usize,
    lost: usize,
}

fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    // All on one thread, and by its own clock: other programs may run beside it.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one.install(compare)
}

fn compare() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let Arguments { scene, cell, height, cells: count, eyes, out, queries } = Arguments::parse();
    let (least, most) = height.split_once(':').ok_or("heights as 0.2:2.0")?;
    let places = Places { edge: cell, height: Some((least.parse()?, most.parse()?)), within: None };
    let mut world = scene.parse::<SceneName>()?.open(&SceneOptions::default())?;
    let path: Vec<Vec3> = (0..world.frames).map(|frame| world.camera(frame, 1.0).eye).collect();
    let is_static = |object: &Object| object.motion == Motion::Static;
    // As the file itself says, for the truth; with the numbers of the level.
    let mut judged = Seen::of(&world).objects(&world.objects).to_vec();
    judged.retain(is_static);
    world.objects.retain(is_static);
    let began = Instant::now();
    let level = Level::new(&world, None, false)?;
    println!("{} objects, made ready in {:.1} s", level.len(), began.elapsed().as_secs_f64());
    let grid = places.cells(&level)?;
    let all = places.numbers(&level)?;
    // Where the camera's path passes, and some of all others if these are too few.
    let on_path: BTreeSet<u32> = path.iter().filter_map(|p| grid.at(p.as_dvec3().to_array())).collect();
    let spread = |cells: Vec<u32>, count: usize| {
        let step = (cells.len() / count.max(1)).max(1);
        cells.into_iter().step_by(step).take(count).collect::<Vec<_>>()
    };
    let (on_path, others): (Vec<u32>, _) = all.iter().partition(|cell| on_path.contains(cell));
    let mut chosen = spread(on_path, count);
    chosen.extend(spread(others, count - chosen.len()));
    println!("{} of {} cells looked at", chosen.len(), all.len());

    let mut tallies: Vec<Tally> = Vec::new();
    let mut sets: Vec<Vec<Vec<u32>>> = Vec::new();
    for &most in &queries {
        let mut finder = Finder::new(&level, most);
        let began = ThreadTime::now();
        let found: Vec<Vec<u32>> =
            chosen.iter().filter_map(|&cell| Some(finder.set(eyes_of(&grid, cell)?))).collect();
        let seconds = began.elapsed().as_secs_f64() / chosen.len() as f64;
        let size = found.iter().map(Vec::len).sum();
        tallies.push(Tally { name: format!("casca, {most} queries"), seconds, size, lost: 0 });
        sets.push(found);
    }

    let options = OracleOptions {
        width: PIXELS,
        height: PIXELS,
        samples_per_object: RAYS_EACH,
        max_candidates: LOOKED_AT,
        seed: SEED,
    };
    let mut oracle = Oracle::new(&judged, options);
    let mut random: Generator = generator(SEED, 0);
    let (mut exact, mut in_pictures, mut sampled, mut looking) = (0, 0, [0; SAMPLES.len()], 0.0);
    let mut looked = 0;
    for (i, &cell) in chosen.iter().enumerate() {
        let Some(room) = eyes_of(&grid, cell) else { continue };
        let smallest: BTreeSet<usize> = sets
            .iter()
            .map(|of| &of[i])
            .min_by_key(|set| set.len())
            .map_or_else(BTreeSet::new, |set| set.iter().map(|&o| o as usize).collect());
        let (mut shown, mut seen, mut lost) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
        let mut at = 0;
        for _ in 0..4 * eyes {
            if at == eyes {
                break;
            }
            let mut share = || random.random_range(0.0..1.0f32);
            let eye = room.min + Vec3::new(share(), share(), share()) * (room.max - room.min);
            if in_solid(&world.objects, eye) {
                continue;
            }
            let began = ThreadTime::now();
            for forward in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
                let camera = Camera::look_at(eye, eye + forward, 90.0, 1.0, NEAR, 1000.0);
                let verdict = oracle.frame(&judged, &[], &camera, &|o| smallest.contains(&o));
                shown.extend(verdict.exact);
                for found in verdict.false_negatives {
                    if lost.insert(found.object) {
                        println!("lost: object {} from {eye} in cell {cell}: {found:?}", found.object);
                    }
                }
            }
            looking += began.elapsed().as_secs_f64();
            let unseen: Vec<usize> = (0..world.objects.len()).filter(|o| !seen.contains(o)).collect();
            let seed = (cell as usize * eyes + at) as u64;
            let found = oracle.rays().probe(&judged, eye.as_dvec3(), &unseen, PROBES, seed, |_| true);
            for sighting in found.seen {
                seen.insert(sighting.object);
                if !smallest.contains(&sighting.object) && lost.insert(sighting.object) {
                    println!("lost: object {} from {eye} in cell {cell}: {sighting:?}", sighting.object);
                }
            }
            at += 1;
            if let Some(which) = SAMPLES.iter().position(|&n| n == at) {
                sampled[which] += shown.len();
            }
        }
        looked += at;
        in_pictures += shown.len();
        seen.extend(shown);
        exact += seen.len();
        for (tally, of) in tallies.iter_mut().zip(&sets) {
            tally.lost += lost.iter().filter(|&&o| of[i].binary_search(&(o as u32)).is_err()).count();
        }
    }
    let each = |n: usize| n as f64 / chosen.len() as f64;
    println!("{looked} eyes; a cell sees {:.1} objects, {:.1} in pictures", each(exact), each(in_pictures));
    println!("\n| method | seconds a cell | set | over seen | lost |\n|---|---|---|---|---|");
    let row = |name: &str, seconds: f64, size: usize, lost: usize| {
        println!(
            "| {name} | {seconds:.2} | {:.1} | {:.2} | {lost} |",
            each(size),
            size as f64 / exact as f64
        );
    };
    let level_size = level.len() as usize * chosen.len();
    row("everything", 0.0, level_size, 0);
    for tally in &tallies {
        row(&tally.name, tally.seconds, tally.size, tally.lost);
    }
    let per_eye = looking / looked.max(1) as f64;
    let mut of_samples = Vec::new();
    for (&n, &size) in SAMPLES.iter().zip(&sampled).filter(|&(&n, _)| n <= eyes) {
        row(&format!("samples, {n} eyes"), per_eye * n as f64, size, in_pictures - size);
        of_samples.push((per_eye * n as f64, size as f64 / exact as f64));
    }
    let of_casca = tallies.iter().map(|t| (t.seconds, t.size as f64 / exact as f64)).collect();
    let (x, y) = (Axis::log("seconds a cell"), Axis::log("objects of the set, over those that any eye saw"));
    let title =
        format!("{scene}: casca's sets lose nothing and shrink with time; those by samples lose objects");
    lines(
        &out,
        &title,
        &format!(
            "cells of {cell} m, {} of them, {eyes} eyes each; below 1 visible objects are missing",
            chosen.len()
        ),
        (&x, &y),
        &[Line::new("casca", POINT, of_casca), Line::new("samples, six pictures an eye", RAYS, of_samples)],
    )?;
    Ok(())
}
