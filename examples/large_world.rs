//! A world that is too large for single precision, and for memory. Tiles of a city come and go around
//! an eye that flies over them, 4,300 km from the origin of the world; the scene has an origin in
//! double precision, which follows the eye from time to time.
//!
//! `cargo run --release --example large_world`, or with a number of metres: `-- 10000`. What is found
//! is compared with exact visibility every 200 m.

use std::collections::BTreeMap;
use std::error::Error;
use std::time::Instant;

use casca::glam::{DVec3, IVec2, Vec3, Vec3Swizzles};
use casca::{Aabb, ObjectDesc, ObjectId, Query, Scene, Sphere, View};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::{Camera, Motion, Object, Shape};
use casca_truth::oracle::{Oracle, OracleOptions};

/// Metres along an edge of a tile.
const TILE: f64 = 200.0;
/// Tiles up to so far from that of the eye are there.
const AROUND: i32 = 3;
/// Objects that come in a frame, at most; twice as many go.
const MOST: usize = 600;
/// Metres that the eye flies in a frame.
const STEP: f64 = 2.0;
const START: DVec3 = DVec3::new(4_194_304.0, 0.0, -1_048_576.0);
/// The origin follows when the eye is so far away from it. In a quarter of a millimetre, the
/// precision of single precision there, nothing is to be seen.
const FAR: f64 = 4000.0;
/// Origins are multiples of this, and coordinates of a 64th: so nothing is ever rounded.
const GRID: f64 = 512.0;

/// An object of a tile, with the corner of the tile at a place relative to the origin.
fn moved(object: &Object, to: DVec3) -> Object {
    let at = |v: Vec3| (v * 64.0).round() / 64.0 + to.as_vec3();
    let shape = match object.shape {
        Shape::Box { min, max } => Shape::Box { min: at(min), max: at(max) },
        Shape::Sphere { center, radius } => Shape::Sphere { center: at(center), radius },
        Shape::Mesh { .. } => object.shape.clone(),
    };
    Object { name: String::new(), shape, motion: Motion::Static, ..*object }
}

fn described(object: &Object) -> ObjectDesc {
    let (min, max) = object.shape.bounds();
    let (solid, ball) = (Aabb::new(min, max), Sphere::new((min + max) / 2.0, (max.x - min.x) / 2.0));
    match object.shape {
        Shape::Sphere { .. } => ObjectDesc::fixed(ball).occluder(ball),
        _ => ObjectDesc::fixed(solid).occluder(solid),
    }
}

fn corner(tile: IVec2) -> DVec3 {
    DVec3::new(tile.x.into(), 0.0, tile.y.into()) * TILE
}

/// Brings tiles near the eye, and takes those away that are not. What is there of a tile is its
/// beginning.
fn stream(
    scene: &mut Scene,
    tile: &[Object],
    there: &mut BTreeMap<[i32; 2], Vec<ObjectId>>,
    middle: IVec2,
) -> Result<(), casca::Error> {
    let side = 2 * AROUND + 1;
    let around = |i: i32| middle + IVec2::new(i % side, i / side) - AROUND;
    let mut wanted: Vec<IVec2> = (0..side * side).map(around).collect();
    wanted.sort_by_key(|tile| (tile - middle).length_squared());
    // At first all of them come at once.
    let (mut come, mut go) = (if there.is_empty() { usize::MAX } else { MOST }, 2 * MOST);
    for at in wanted {
        let (ids, to) = (there.entry(at.into()).or_default(), corner(at) - scene.origin());
        while ids.len() < tile.len() && come > 0 {
            ids.push(scene.insert(described(&moved(&tile[ids.len()], to)))?);
            come -= 1;
        }
    }
    for (at, ids) in there.iter_mut() {
        let far = (IVec2::from(*at) - middle).abs().max_element() > AROUND;
        let left = if far { ids.len().saturating_sub(go) } else { ids.len() };
        go -= ids.len() - left;
        ids.drain(left..).try_for_each(|id| scene.remove(id))?;
    }
    there.retain(|_, ids| !ids.is_empty());
    Ok(())
}

/// Compares a set with what can be seen: the numbers of visible objects, and of those that it lacks.
fn judge(
    tile: &[Object],
    there: &BTreeMap<[i32; 2], Vec<ObjectId>>,
    camera: &Camera,
    query: &Query,
    origin: DVec3,
) -> (usize, usize) {
    let placed = |(at, ids): (&[i32; 2], &Vec<ObjectId>)| {
        let to = corner((*at).into()) - origin;
        tile[..ids.len()].iter().map(move |object| moved(object, to)).collect::<Vec<_>>()
    };
    let objects: Vec<Object> = there.iter().flat_map(placed).collect();
    let ids: Vec<ObjectId> = there.values().flatten().copied().collect();
    let options = OracleOptions { width: 960, height: 540, ..OracleOptions::default() };
    let sees = |i: usize| query.pvs().contains(ids[i]);
    let verdict = Oracle::new(&objects, options).frame(&objects, &[], camera, &sees);
    (verdict.exact.len(), verdict.false_negatives.len())
}

fn main() -> Result<(), Box<dyn Error>> {
    let metres = std::env::args().nth(1).map_or(Ok(1000.0), |word| word.parse::<f64>())?;
    let tile = build(SceneKind::City, &SceneOptions::default()).objects;
    let (mut scene, mut query) = (Scene::new(2.0)?, Query::new());
    scene.set_origin(START)?;
    let mut there = BTreeMap::new();
    let (mut frames, mut queries, mut shifts) = (Vec::new(), Vec::new(), Vec::new());
    let (mut most, mut visible, mut lost) = ((0, 0), 0, 0);
    for frame in 0..(metres.clamp(0.0, 1e6) / STEP) as u32 {
        let along = f64::from(frame) * STEP;
        // Up and down between the middle of a street and above the roofs.
        let eye = START + DVec3::new(along, 17.0 - 14.0 * (along / 150.0).cos(), 6.0);
        let forward = Vec3::new(1.0, -0.1, 0.6 * (along / 90.0).sin() as f32);
        // As a renderer has it that draws relative to the eye.
        let camera = Camera::look_at(Vec3::ZERO, forward, 60.0, 16.0 / 9.0, 0.1, 2000.0);
        if (eye - scene.origin()).abs().max_element() > FAR {
            let start = Instant::now();
            scene.set_origin((eye / GRID).round() * GRID)?;
            shifts.push(start.elapsed().as_secs_f64() * 1e3);
        }
        let start = Instant::now();
        scene.begin_frame(f64::from(frame) / 60.0)?;
        stream(&mut scene, &tile, &mut there, (eye.xz() / TILE).floor().as_ivec2())?;
        let view = scene.view(eye, &View::perspective(Vec3::ZERO, camera.view_projection())?)?;
        let of_query = Instant::now();
        query.run(&scene, &view);
        queries.push(of_query.elapsed().as_secs_f64() * 1e3);
        scene.end_frame([query.pvs()])?;
        if frame > 0 {
            frames.push(start.elapsed().as_secs_f64() * 1e3);
        }
        most = most.max((scene.len(), scene.memory().total()));
        if along % 200.0 == 0.0 {
            let camera = camera.at((eye - scene.origin()).as_vec3());
            let (seen, missed) = judge(&tile, &there, &camera, &query, scene.origin());
            (visible, lost) = (visible + seen, lost + missed);
        }
    }
    println!("{} objects at most, {:.0} MB", most.0, most.1 as f64 / 1e6);
    for (what, mut times) in [("frames", frames), ("queries", queries), ("shifts of the origin", shifts)] {
        times.sort_by(f64::total_cmp);
        let of =
            |share: usize| times.get((times.len() * share).div_ceil(100).saturating_sub(1)).unwrap_or(&0.0);
        println!(
            "{} {what}, ms: median {:.2}, 99th percentile {:.2}, most {:.2}",
            times.len(),
            of(50),
            of(99),
            of(100)
        );
    }
    println!("{lost} of {visible} visible objects are lost");
    assert_eq!(lost, 0);
    Ok(())
}
