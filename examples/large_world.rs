//! A world that is too large for single precision, and for memory. Tiles of a city come and go around
//! an eye that flies over them, 4,300 km from the origin of the world; the scene has an origin in
//! double precision, which follows the eye from time to time.
//!
//! `cargo run --release --example large_world`, or with a number of metres: `-- 10000`.
//! The test `tests/world/flight.rs` flies the same way, and compares sets with exact visibility.

use std::collections::BTreeMap;
use std::error::Error;
use std::time::Instant;

use casca::glam::{DVec3, IVec2, Mat4, Vec3, Vec3Swizzles, Vec4};
use casca::{Aabb, ObjectDesc, ObjectId, Query, Scene, View};

/// Metres along an edge of a tile.
const TILE: f64 = 200.0;
/// Tiles up to so far from that of the eye are there.
const AROUND: i32 = 3;
/// Objects that come in a frame, at most; twice as many go.
const MOST: usize = 600;
/// Metres that the eye flies in a frame.
const STEP: f64 = 2.0;
const START: DVec3 = DVec3::new(4_194_304.0, 0.0, -1_048_576.0);
/// The origin follows when the eye is so far away from it: single precision is a quarter of a
/// millimetre there.
const FAR: f64 = 4000.0;
/// Origins are multiples of this, and coordinates of a 64th of a metre: so nothing is ever rounded.
const GRID: f64 = 512.0;

/// The objects of a tile by its corner: ground, houses along streets, and small things around them.
pub fn tile() -> Vec<Aabb> {
    let mut state = 1u64;
    let mut random = |most: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % (most * 64)) as f32 / 64.0
    };
    let mut all = vec![Aabb::new(Vec3::new(0.0, -1.0, 0.0), Vec3::new(TILE as f32, 0.0, TILE as f32))];
    for block in 0..25 {
        let corner =
            Vec3::new((block % 5) as f32, 0.0, (block / 5) as f32) * 40.0 + Vec3::new(12.0, 0.0, 12.0);
        for side in [Vec3::ZERO, Vec3::X * 15.0, Vec3::Z * 15.0, Vec3::new(15.0, 0.0, 15.0)] {
            let house = corner + side;
            all.push(Aabb::new(house, house + Vec3::new(13.0, 8.0 + random(18), 13.0)));
        }
        for _ in 0..120 {
            let at = corner + Vec3::new(random(38) - 10.0, 0.0, random(38) - 10.0);
            all.push(Aabb::new(at, at + Vec3::new(random(1), random(1), random(1)) + 0.25));
        }
    }
    all
}

/// A frame of the flight. The test reads more of it than this program.
#[allow(dead_code)]
pub struct Frame<'a> {
    /// In the world.
    pub eye: DVec3,
    /// From coordinates relative to the eye to those of the camera.
    pub look: Mat4,
    /// From there to clip space.
    pub projection: Mat4,
    /// After the frame.
    pub scene: &'a Scene,
    /// With the set of the frame.
    pub query: &'a Query,
    /// The objects that are there, with their boxes relative to the scene's origin.
    pub there: &'a dyn Fn() -> Vec<(ObjectId, Aabb)>,
    /// Milliseconds of the frame, of its query and of the shift of its origin, if there was one.
    pub times: [Option<f64>; 3],
}

fn corner(tile: IVec2) -> DVec3 {
    DVec3::new(tile.x.into(), 0.0, tile.y.into()) * TILE
}

fn placed(object: &Aabb, to: DVec3) -> Aabb {
    Aabb::new(object.min + to.as_vec3(), object.max + to.as_vec3())
}

/// Brings tiles near the eye, and takes those away that are not. What is there of a tile is its
/// beginning.
fn stream(
    scene: &mut Scene,
    tile: &[Aabb],
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
            let solid = placed(&tile[ids.len()], to);
            ids.push(scene.insert(ObjectDesc::fixed(solid).occluder(solid))?);
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

/// Flies so far, and shows every frame.
pub fn fly(metres: f64, show: &mut dyn FnMut(&Frame)) -> Result<(), casca::Error> {
    let (tile, mut scene, mut query) = (tile(), Scene::new(2.0)?, Query::new());
    scene.set_origin(START)?;
    let mut there = BTreeMap::new();
    let ms = |start: Instant| start.elapsed().as_secs_f64() * 1e3;
    for frame in 0..(metres.clamp(0.0, 1e6) / STEP) as u32 {
        let along = f64::from(frame) * STEP;
        // Up and down between the middle of a street and above the roofs.
        let eye = START + DVec3::new(along, 17.0 - 14.0 * (along / 150.0).cos(), 6.0);
        let forward = Vec3::new(1.0, -0.1, 0.6 * (along / 90.0).sin() as f32).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let rows = [right, right.cross(forward), -forward].map(|row| row.extend(0.0));
        let look = Mat4::from_cols(rows[0], rows[1], rows[2], Vec4::W).transpose();
        // 60 degrees high, 16:9, depth from 0 at 0.1 m to 1 at 2 km.
        let depth = 2000.0 / (0.1 - 2000.0);
        let (into, near) = (Vec4::new(0.0, 0.0, depth, -1.0), Vec4::Z * (0.1 * depth));
        let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, into, near);
        let mut shift = None;
        if (eye - scene.origin()).abs().max_element() > FAR {
            let start = Instant::now();
            scene.set_origin((eye / GRID).round() * GRID)?;
            shift = Some(ms(start));
        }
        let start = Instant::now();
        scene.begin_frame(f64::from(frame) / 60.0)?;
        stream(&mut scene, &tile, &mut there, (eye.xz() / TILE).floor().as_ivec2())?;
        let view = scene.view(eye, &View::perspective(Vec3::ZERO, projection * look)?)?;
        let of_query = Instant::now();
        query.run(&scene, &view);
        let of_query = ms(of_query);
        scene.end_frame([query.pvs()])?;
        let times = [(frame > 0).then(|| ms(start)), Some(of_query), shift];
        let listed = || {
            let of_tile = |(at, ids): (&[i32; 2], &Vec<ObjectId>)| {
                let to = corner((*at).into()) - scene.origin();
                ids.iter().zip(&tile).map(|(id, object)| (*id, placed(object, to))).collect::<Vec<_>>()
            };
            there.iter().flat_map(of_tile).collect()
        };
        show(&Frame { eye, look, projection, scene: &scene, query: &query, there: &listed, times });
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let metres = std::env::args().nth(1).map_or(Ok(1000.0), |word| word.parse::<f64>())?;
    let (mut all, mut most) = ([const { Vec::new() }; 3], (0, 0));
    fly(metres, &mut |frame| {
        all.iter_mut().zip(frame.times).for_each(|(all, time)| all.extend(time));
        most = most.max((frame.scene.len(), frame.scene.memory().total()));
    })?;
    println!("{} objects at most, {:.0} MB", most.0, most.1 as f64 / 1e6);
    for (what, mut times) in ["frames", "queries", "shifts of the origin"].into_iter().zip(all) {
        times.sort_by(f64::total_cmp);
        let of =
            |part: usize| times.get((times.len() * part).div_ceil(100).saturating_sub(1)).unwrap_or(&0.0);
        let count = times.len();
        println!(
            "{count} {what}, ms: median {:.2}, 99th percentile {:.2}, most {:.2}",
            of(50),
            of(99),
            of(100)
        );
    }
    Ok(())
}
