//! Errors of the operators beside rays at the triangles that points are samples of.
//!
//! ```sh
//! cargo run --release -p casca-points --example accuracy -- KIND POINTS SPREAD NOISE SEED
//! ```
//!
//! For each scene: false visible and false hidden points over the truly visible ones, in percent,
//! of three eyes together. All words may be left out from the right: `KIND` is `tuned` or
//! `held-out`, `SPREAD` is `even` or `random`, `NOISE` is its standard deviation over the side of
//! the square that a point stands for. The defaults of `surface` were chosen on the scenes called
//! tuned, of seed 3, with even points; the others tell how well they hold.
//!
//! With `scans-` before a kind, points are the first hits of rays from scanners, as many as
//! `SPREAD` says (4), and `surface` is judged without and with the places of these.
//!
//! The word `thesis` alone repeats the experiments of Tavares 2009.

mod scans;
mod scenes;
mod thesis;
mod truth;

use std::error::Error;
use std::time::Instant;

use bitvec::vec::BitVec;
use casca_points::surface::Surface;
use casca_points::{AutoSettings, Camera, PointCloud, hpr, splat};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scenes::Scene;
use truth::{Spread, sample, seen};

/// Truly visible, false visible and false hidden points.
type Counts = [f64; 3];

fn count(sum: &mut Counts, truth: &BitVec, found: impl Iterator<Item = Option<bool>>) {
    for (truth, found) in truth.iter().by_vals().zip(found) {
        let Some(found) = found else { continue };
        let kinds = [truth, found && !truth, truth && !found];
        sum.iter_mut().zip(kinds).for_each(|(sum, is)| *sum += f64::from(u8::from(is)));
    }
}

fn text([visible, false_visible, false_hidden]: Counts) -> String {
    let percent = |n: f64| 100.0 * n / visible;
    let sum = percent(false_visible + false_hidden);
    format!("{sum:5.1} ({:4.1} + {:4.1})", percent(false_visible), percent(false_hidden))
}

/// Normally distributed numbers.
fn gauss() -> impl FnMut() -> f32 {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    // The sum of twelve uniform numbers is nearly Gaussian.
    move || (0..12).map(|_| random.random::<f32>()).sum::<f32>() - 6.0
}

/// The near plane of cameras over the distance of the farthest point.
const NEAR: f32 = 1e-4;

/// The points that a camera to each of six sides finds visible.
fn by_splats(points: &[Vec3], eye: Vec3, auto: &AutoSettings) -> Result<Vec<Option<bool>>, Box<dyn Error>> {
    let mut all = vec![None; points.len()];
    let farthest = points.iter().map(|p| p.distance(eye)).fold(0.0, f32::max);
    for (axis, up) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::Y)] {
        for way in [axis, -axis] {
            let right_angle = std::f32::consts::FRAC_PI_2;
            let (near, far) = (NEAR * farthest, 2.0 * farthest);
            let camera = Camera::look_at(eye, eye + way, up, right_angle, (1024, 1024), near, far)?;
            let found = splat::visible_points(points, &camera, &auto.splats())?.visible;
            for ((answer, found), p) in all.iter_mut().zip(found.iter().by_vals()).zip(points) {
                if camera.project(*p).is_some() {
                    *answer = Some(found);
                }
            }
        }
    }
    Ok(all)
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().collect();
    let word = |i: usize| args.get(i).map_or("", String::as_str);
    if word(1) == "thesis" {
        return thesis::print();
    }
    let points: usize = word(2).parse().unwrap_or(30_000);
    let spread = if word(3) == "random" { Spread::Random } else { Spread::Even };
    let noise: f32 = word(4).parse().unwrap_or(0.0);
    let seed: u64 = word(5).parse().unwrap_or(3);
    let all = if word(1).ends_with("held-out") { scenes::held_out(seed) } else { scenes::tuned(seed) };
    if word(1).starts_with("scans-") {
        return scans::print(&all, points, word(3).parse().unwrap_or(4), noise);
    }
    println!(
        "{points} points, {spread:?}, noise {noise}, seed {seed}: errors (false visible + false hidden) in percent"
    );
    println!(
        "scene            visible | surface, normals given | surface, estimated | hpr                  | splat                | ms build, eye, hpr"
    );
    for scene in &all {
        row(scene, points, spread, noise)?;
    }
    Ok(())
}

fn row(scene: &Scene, points: usize, spread: Spread, noise: f32) -> Result<(), Box<dyn Error>> {
    let samples = sample(scene, points, spread, 11);
    let mut gauss = gauss();
    let mut moved = |p: &Vec3| *p + Vec3::new(gauss(), gauss(), gauss()) * noise * samples.spacing;
    let positions: Vec<Vec3> = samples.points.iter().map(&mut moved).collect();
    let bare = PointCloud { positions, ..Default::default() };
    let with_normals = PointCloud { normals: samples.normals.clone(), ..bare.clone() };
    let given = Surface::new(&with_normals)?;
    let start = Instant::now();
    let estimated = Surface::new(&bare)?;
    let mut times = [start.elapsed().as_secs_f64() * 1e3, 0.0, 0.0];
    let auto = AutoSettings::new(&bare.positions)?;
    let places: Vec<_> = bare.positions.iter().map(|p| p.as_dvec3()).collect();
    let mut sums = [Counts::default(); 4];
    for &eye in &scene.eyes {
        let (truth, place) = (&seen(scene, &samples, eye), eye.as_dvec3());
        count(&mut sums[0], truth, given.visible(place)?.iter().by_vals().map(Some));
        let start = Instant::now();
        count(&mut sums[1], truth, estimated.visible(place)?.iter().by_vals().map(Some));
        times[1] += start.elapsed().as_secs_f64() * 1e3 / scene.eyes.len() as f64;
        let start = Instant::now();
        let found = hpr::visible_points(&places, place, auto.log10_radius(&places, place))?;
        times[2] += start.elapsed().as_secs_f64() * 1e3 / scene.eyes.len() as f64;
        count(&mut sums[2], truth, found.iter().by_vals().map(Some));
        count(&mut sums[3], truth, by_splats(&bare.positions, eye, &auto)?.into_iter());
    }
    let (visible, [build, one, hpr]) = (sums[0][0] / scene.eyes.len() as f64, times);
    let cells = sums.map(text).join(" | ");
    println!("{:16} {visible:7.0} | {cells} | {build:.0}, {one:.0}, {hpr:.0}", scene.name);
    Ok(())
}
