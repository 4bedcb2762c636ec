//! Errors of the operators beside rays at the triangles that points are samples of.
//!
//! ```sh
//! cargo run --release -p casca-points --example accuracy -- KIND
//! ```
//!
//! For each scene of the `KIND` `tuned` or `held-out`: false visible and false hidden points over the
//! truly visible ones, in percent, of three eyes together. The defaults of `surface` were chosen on
//! the scenes called tuned; the others tell how well they hold. The kind `thesis` repeats the
//! experiments of Tavares 2009.

mod scans;
mod scenes;
mod thesis;
mod truth;

use std::error::Error;
use std::time::Instant;

use casca_points::surface::Surface;
use casca_points::{AutoSettings, Camera, PointCloud, hpr, splat};
use glam::Vec3;
use scenes::Scene;
use truth::{Samples, sample, seen};

/// Truly visible, false visible and false hidden points.
type Counts = [f64; 3];

/// Counts the points that have a truth and an answer.
fn count(sum: &mut Counts, truth: &[Option<bool>], found: impl Iterator<Item = Option<bool>>) {
    for (truth, found) in truth.iter().zip(found).filter_map(|(truth, found)| truth.zip(found)) {
        let kinds = [truth, found && !truth, truth && !found];
        sum.iter_mut().zip(kinds).for_each(|(sum, is)| *sum += f64::from(u8::from(is)));
    }
}

fn text([visible, false_visible, false_hidden]: Counts) -> String {
    let percent = |n: f64| 100.0 * n / visible;
    let sum = percent(false_visible + false_hidden);
    format!("{sum:5.1} ({:4.1} + {:4.1})", percent(false_visible), percent(false_hidden))
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
            let found = splat::visible_points(points, &camera, &auto.splats())?;
            for ((answer, found), p) in all.iter_mut().zip(found.iter().by_vals()).zip(points) {
                if camera.project(*p).is_some() {
                    *answer = Some(found);
                }
            }
        }
    }
    Ok(all)
}

/// Points of a scene, and the seed of the scenes.
const POINTS: usize = 30_000;
const SEED: u64 = 3;

/// How far from the automatic one the radii of `hpr` are that are tried on scans, as logarithms.
const RADII: [f64; 7] = [-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0];

fn main() -> Result<(), Box<dyn Error>> {
    let kind = std::env::args().nth(1);
    let (all, scans) = match kind.as_deref() {
        Some("thesis") => return thesis::print(),
        Some("held-out") => (scenes::held_out(SEED), scans::held_out(SEED)),
        _ => (scenes::tuned(SEED), scans::tuned(SEED)),
    };
    println!("errors (false visible + false hidden) in percent");
    println!(
        "scene            visible | surface, normals given | surface, estimated | hpr                  | splat                | us build, eye, hpr | found of strays, of others"
    );
    for scene in &all {
        let Samples { points, normals, triangle } = sample(scene, POINTS);
        let samples = Samples { points: points.clone(), normals: normals.clone(), triangle };
        row(scene.name, scene, &samples, [points, normals], &[true; POINTS], &[0.0])?;
    }
    for mut plan in scans {
        for (name, part) in [("", 1.0), (", clean", 0.0)] {
            (plan.mixed, plan.strays) = (plan.mixed * part, plan.strays * part);
            let scan = scans::scan(&plan);
            let name = format!("{}{name}", plan.scene.name);
            row(&name, &plan.scene, &scan.samples, [scan.points, scan.normals], &scan.real, &RADII)?;
        }
    }
    Ok(())
}

/// One line: `points` are those of the surfaces, moved, and others that are not `real`.
fn row(
    name: &str,
    scene: &Scene,
    samples: &Samples,
    [positions, normals]: [Vec<Vec3>; 2],
    real: &[bool],
    radii: &[f64],
) -> Result<(), Box<dyn Error>> {
    let bare = PointCloud { positions, ..Default::default() };
    let with_normals = PointCloud { normals, ..bare.clone() };
    let given = Surface::new(&with_normals)?;
    let start = Instant::now();
    let estimated = Surface::new(&bare)?;
    let mut times = [start.elapsed().as_secs_f64() * 1e6, 0.0, 0.0];
    let auto = AutoSettings::new(&bare.positions)?;
    let places: Vec<_> = bare.positions.iter().map(|p| p.as_dvec3()).collect();
    let mut sums = [Counts::default(); 3];
    let mut by_radius = vec![Counts::default(); radii.len()];
    let eyes = scene.eyes.len() as f64;
    for &eye in &scene.eyes {
        let (truth, place) = (seen(scene, samples, eye), eye.as_dvec3());
        let truth: Vec<_> = truth.iter().by_vals().zip(real).map(|(t, real)| real.then_some(t)).collect();
        count(&mut sums[0], &truth, given.visible(place)?.iter().by_vals().map(Some));
        let start = Instant::now();
        count(&mut sums[1], &truth, estimated.visible(place)?.iter().by_vals().map(Some));
        times[1] += start.elapsed().as_secs_f64() * 1e6 / eyes;
        count(&mut sums[2], &truth, by_splats(&bare.positions, eye, &auto)?.into_iter());
        for (sum, more) in by_radius.iter_mut().zip(radii) {
            let start = Instant::now();
            let found = hpr::visible_points(&places, place, auto.log10_radius(&places, place) + more)?;
            times[2] += start.elapsed().as_secs_f64() * 1e6 / eyes / radii.len() as f64;
            count(sum, &truth, found.iter().by_vals().map(Some));
        }
    }
    let wrong = |sum: &Counts| (sum[1] + sum[2]) / sum[0];
    let hpr = by_radius.into_iter().min_by(|a, b| wrong(a).total_cmp(&wrong(b))).unwrap_or_default();
    let [build, one, by_hull] = times.map(|time| time / bare.len() as f64);
    let cells = [sums[0], sums[1], hpr, sums[2]].map(text).join(" | ");
    let visible = sums[0][0] / eyes;
    // Of points that are not real, and of others.
    let found = [false, true].map(|is| {
        let (mut all, mut found) = (0.0, 0.0);
        for (_, stray) in
            real.iter().zip(estimated.strays().iter().by_vals()).filter(|(real, _)| **real == is)
        {
            (all, found) = (all + 1.0, found + 100.0 * f64::from(u8::from(stray)));
        }
        format!("{:.2}", found / f64::max(all, 1.0))
    });
    println!("{name:16} {visible:7.0} | {cells} | {build:.1}, {one:.1}, {by_hull:.1} | {}", found.join(", "));
    Ok(())
}
