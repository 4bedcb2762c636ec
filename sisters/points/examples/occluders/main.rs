//! What occluders estimated from points hide rightly and wrongly, beside rays at the triangles that
//! the points are samples of.
//!
//! ```sh
//! cargo run --release -p casca-points --features bricks --example occluders -- POINTS BRICK SPREAD NOISE SEED FOLDER
//! ```
//!
//! `POINTS` is the number of points (300,000), `BRICK` the most points of a brick (1,000), `SPREAD`
//! is `random` or `even`, `NOISE` its standard deviation over the side of the square that a point
//! stands for. With a `FOLDER`, its `.glb` files take the place of generated buildings, on which
//! the constants were chosen. Each eye looks to all sides.
//!
//! - *lost*: truly visible points whose brick was culled, over the truly visible points;
//! - *spared*: points of culled bricks, over all points;
//! - *could*: points of bricks that hold no visible point, over all points.

#[path = "../accuracy/files.rs"]
mod files;
#[path = "../accuracy/scenes.rs"]
#[allow(dead_code, reason = "its scenes are not buildings")]
mod scenes;
#[path = "../accuracy/truth.rs"]
#[allow(dead_code, reason = "it makes no scans")]
mod truth;

mod buildings;

use std::collections::HashSet;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use casca::{GridSpec, Query, View};
use casca_points::bricks::{Bricks, BuildOptions, Builder, Loader, Want};
use casca_points::occluders::{OccluderOptions, Occluders};
use casca_points::{Camera, PointCloud};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scenes::Scene;
use truth::{Spread, sample, seen};

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().collect();
    let word = |i: usize| args.get(i).map_or("", String::as_str);
    let points: usize = word(1).parse().unwrap_or(300_000);
    let brick: u32 = word(2).parse().unwrap_or(1000);
    let spread = if word(3) == "even" { Spread::Even } else { Spread::Random };
    let noise: f32 = word(4).parse().unwrap_or(0.0);
    let seed: u64 = word(5).parse().unwrap_or(1);
    let all = match word(6) {
        "" => buildings::all(seed),
        folder => files::scenes(Path::new(folder))?,
    };
    println!("{points} points, at most {brick} a brick, {spread:?}, noise {noise}, seed {seed}");
    println!("scene            spacing   cell | bricks boxes seconds | lost % spared % could %");
    for scene in &all {
        row(scene, points, brick, spread, noise)?;
    }
    Ok(())
}

fn row(scene: &Scene, points: usize, brick: u32, spread: Spread, noise: f32) -> Result<(), Box<dyn Error>> {
    let samples = sample(scene, points, spread, 11);
    let mut random = Pcg64Mcg::seed_from_u64(5);
    // The sum of twelve uniform numbers is nearly Gaussian.
    let mut gauss = || (0..12).map(|_| random.random::<f32>()).sum::<f32>() - 6.0;
    let mut moved = |p: &Vec3| *p + Vec3::new(gauss(), gauss(), gauss()) * noise * samples.spacing;
    let positions: Vec<Vec3> = samples.points.iter().map(&mut moved).collect();
    // The number of a point is its colour, so that its brick is found again.
    let number = |i: usize| [i as u8, (i >> 8) as u8, (i >> 16) as u8];
    let colours = (0..positions.len()).map(number).collect();
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("bricks");
    let options = BuildOptions { most_points: brick, ..BuildOptions::default() };
    let mut builder = Builder::create(&path, options)?;
    builder.push(&PointCloud { positions, colours, ..PointCloud::default() })?;
    builder.finish(|_, _| ())?;
    let bricks = Bricks::open(&path)?;
    let home = homes(&path, samples.points.len())?;
    let start = Instant::now();
    let found = Occluders::estimate(&bricks, &OccluderOptions::default())?;
    let seconds = start.elapsed().as_secs_f64();
    let mut scene_of_bricks =
        casca::Scene::new(&GridSpec::fit(bricks.bounds(), bricks.len() + found.boxes.len())?)?;
    bricks.insert_grown(&mut scene_of_bricks, found.margin)?;
    found.insert_into(&mut scene_of_bricks)?;
    let mut sizes = vec![0_u32; bricks.len()];
    home.iter().for_each(|&b| sizes[b as usize] += 1);
    let [mut visible, mut lost, mut spared, mut could] = [0.0_f64; 4];
    for &eye in &scene.eyes {
        let truth = seen(scene, &samples, eye);
        let kept = kept(&scene_of_bricks, &bricks, eye)?;
        let needed: HashSet<u32> = truth.iter_ones().map(|i| home[i]).collect();
        visible += truth.count_ones() as f64;
        lost += truth.iter_ones().filter(|&i| !kept.contains(&home[i])).count() as f64;
        let outside = |set: &HashSet<u32>| {
            let sizes = sizes.iter().zip(0..).filter(|(_, i)| !set.contains(i));
            sizes.map(|(&n, _)| f64::from(n)).sum::<f64>()
        };
        spared += outside(&kept);
        could += outside(&needed);
    }
    let all = (home.len() * scene.eyes.len().max(1)) as f64 / 100.0;
    println!(
        "{:16} {:7.3} {:6.3} | {:6} {:5} {seconds:7.2} | {:6.2} {:8.1} {:7.1}",
        scene.name,
        samples.spacing,
        found.resolution,
        bricks.len(),
        found.boxes.len(),
        100.0 * lost / visible.max(1.0),
        spared / all,
        could / all
    );
    Ok(())
}

/// The brick of each point.
fn homes(path: &Path, points: usize) -> Result<Vec<u32>, Box<dyn Error>> {
    let mut home = vec![0; points];
    let bricks = Arc::new(Bricks::open(path)?);
    let loader = Loader::new(bricks.clone(), 1 << 30)?;
    for brick in 0..bricks.len() as u32 {
        let want = [Want { brick, points: u32::MAX }];
        loader.want(&want);
        loader.settle();
        for [a, b, c] in loader.gather(&want).colours {
            home[u32::from_le_bytes([a, b, c, 0]) as usize] = brick;
        }
    }
    loader.take_error().map_or(Ok(home), |e| Err(e.into()))
}

/// The bricks that may be seen from an eye, to all sides.
fn kept(scene: &casca::Scene, bricks: &Bricks, eye: Vec3) -> Result<HashSet<u32>, Box<dyn Error>> {
    let bounds = bricks.bounds();
    let far = 2.0 * ((bounds.max - bounds.min).length() + eye.distance(bounds.center()));
    let mut kept = HashSet::new();
    let mut query = Query::new();
    for (axis, up) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::Y)] {
        for way in [axis, -axis] {
            let angle = std::f32::consts::FRAC_PI_2;
            let camera = Camera::look_at(eye, eye + way, up, angle, (1024, 1024), 1e-4 * far, far)?;
            let view = View::perspective(eye, camera.view_projection())?;
            let numbers = query.run(scene, &view).iter();
            kept.extend(numbers.filter_map(|id| u32::try_from(scene.user_data(id).ok()?).ok()));
        }
    }
    Ok(kept)
}
