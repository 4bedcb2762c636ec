//! Errors of the operators beside rays at the triangles that points are samples of.
//!
//! ```sh
//! cargo run --release -p casca-points --example accuracy -- KIND
//! ```
//!
//! For each scene of the `KIND` `tuned` or `held-out`: false visible and false hidden points over the
//! truly visible ones, in percent, of three eyes together. The defaults of `surface` were chosen on
//! the scenes called tuned; the others tell how well they hold. The kind `thesis` repeats the
//! experiments of Tavares 2009, and `stations` takes two real scans.

mod scans;
mod scenes;
mod stations;
mod thesis;
mod truth;

use casca_points::surface::Surface;
use casca_points::{AutoSettings, Camera, PointCloud, hpr, splat};
use glam::Vec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use scenes::Scene;
use std::error::Error;
use std::f32::consts::FRAC_PI_2;
use std::time::Instant;
use truth::{Mesh, Sample, sample};

/// Truly visible, false visible and false hidden points.
type Counts = [f64; 3];

/// Counts the points that have a truth and an answer.
fn count(sum: &mut Counts, truth: &[Option<bool>], found: impl IntoIterator<Item: Into<Option<bool>>>) {
    for (truth, found) in truth.iter().zip(found).filter_map(|(truth, found)| truth.zip(found.into())) {
        let kinds = [truth, found && !truth, truth && !found];
        sum.iter_mut().zip(kinds).for_each(|(sum, is)| *sum += f64::from(u8::from(is)));
    }
}

/// A normally distributed number: the sum of twelve uniform ones is nearly such.
fn gauss(random: &mut Pcg64Mcg) -> f32 {
    (0..12).map(|_| random.random::<f32>()).sum::<f32>() - 6.0
}

fn text([visible, shown, lost]: Counts) -> String {
    let [sum, shown, lost] = [shown + lost, shown, lost].map(|n| 100.0 * n / visible);
    format!("{sum:5.1} ({shown:4.1} + {lost:4.1})")
}

/// The planes of cameras, in distances of the farthest point: no point lies before the first or
/// beyond the second.
const NEAR_PLANE: f32 = 1e-4;
const FAR_PLANE: f32 = 2.0;

/// The points that a camera to each of six sides finds visible.
fn by_splats(points: &[Vec3], eye: Vec3, auto: &AutoSettings) -> Result<Vec<Option<bool>>, Box<dyn Error>> {
    let mut all = vec![None; points.len()];
    let farthest = points.iter().map(|p| p.distance(eye)).fold(0.0, f32::max);
    let (near, far) = (NEAR_PLANE * farthest, FAR_PLANE * farthest);
    for way in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        let up = if way.y == 0.0 { Vec3::Y } else { Vec3::Z };
        let camera = Camera::look_at(eye, eye + way, up, FRAC_PI_2, (1024, 1024), near, far)?;
        let found = splat::visible_points(points, &camera, &auto.splats())?;
        for ((answer, found), p) in all.iter_mut().zip(found).zip(points) {
            if camera.project(*p).is_some() {
                *answer = Some(found);
            }
        }
    }
    Ok(all)
}

/// Points of a scene.
const POINTS: usize = 30_000;

/// The steps of ranges of scans that have some, in metres.
const STEP: f32 = 0.01;

/// How far from the automatic one the radii of `hpr` are that are tried on scans, as logarithms.
const RADII: [f64; 7] = [-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0];

fn main() -> Result<(), Box<dyn Error>> {
    let kind = std::env::args().nth(1);
    let (all, scans) = match kind.as_deref() {
        Some("thesis") => return thesis::print(),
        Some("stations") => return stations::print(&std::env::args().skip(2).collect::<Vec<_>>()),
        Some("held-out") => scenes::held_out(),
        _ => scenes::tuned(),
    };
    println!("errors (false visible + false hidden) in percent");
    println!(
        "scene            visible | surface, normals given | surface, estimated | hpr                  | \
         splat                | us build, eye, hpr | found of strays, of others"
    );
    for scene in &all {
        row(scene.name, scene, &sample(scene, POINTS), &[0.0])?;
    }
    for mut plan in scans {
        row(plan.0.name, &plan.0, &scans::scan(&plan), &RADII)?;
        plan.2[3..].fill(0.0);
        row(&format!("{}, clean", plan.0.name), &plan.0, &scans::scan(&plan), &RADII)?;
        plan.2[2] = STEP;
        row(&format!("{}, steps", plan.0.name), &plan.0, &scans::scan(&plan), &RADII)?;
    }
    Ok(())
}

/// Prints one line.
fn row(name: &str, scene: &Scene, samples: &[Sample], radii: &[f64]) -> Result<(), Box<dyn Error>> {
    let bare = PointCloud { positions: samples.iter().map(|s| s.at).collect(), ..Default::default() };
    let given =
        Surface::new(&PointCloud { normals: samples.iter().map(|s| s.normal).collect(), ..bare.clone() })?;
    let start = Instant::now();
    let estimated = Surface::new(&bare)?;
    let mut times = [start.elapsed().as_secs_f64() * 1e6, 0.0, 0.0];
    let auto = AutoSettings::new(&bare.positions)?;
    let positions: Vec<_> = bare.positions.iter().map(|p| p.as_dvec3()).collect();
    let (mesh, on): (_, Vec<_>) = (Mesh::new(&scene.triangles), samples.iter().map(|s| s.place).collect());
    let mut sums = [Counts::default(); 3];
    let mut by_radius = vec![Counts::default(); radii.len()];
    let eyes = scene.eyes.len() as f64;
    for &eye in &scene.eyes {
        let (seen, place) = (mesh.seen(&on, eye, |i, t| samples[i].triangle == Some(t)), eye.as_dvec3());
        let truth: Vec<_> = seen.iter().zip(samples).map(|(seen, s)| s.triangle.map(|_| *seen)).collect();
        count(&mut sums[0], &truth, given.visible(place)?);
        let start = Instant::now();
        count(&mut sums[1], &truth, estimated.visible(place)?);
        times[1] += start.elapsed().as_secs_f64() * 1e6 / eyes;
        count(&mut sums[2], &truth, by_splats(&bare.positions, eye, &auto)?);
        for (sum, more) in by_radius.iter_mut().zip(radii) {
            let start = Instant::now();
            let found = hpr::visible_points(&positions, place, auto.log10_radius(&positions, place) + more)?;
            times[2] += start.elapsed().as_secs_f64() * 1e6 / eyes / radii.len() as f64;
            count(sum, &truth, found);
        }
    }
    let wrong = |sum: &Counts| (sum[1] + sum[2]) / sum[0];
    let hpr = by_radius.into_iter().min_by(|a, b| wrong(a).total_cmp(&wrong(b))).unwrap_or_default();
    let [build, one, by_hull] = times.map(|time| time / bare.len() as f64);
    let cells = [sums[0], sums[1], hpr, sums[2]].map(text).join(" | ");
    let visible = sums[0][0] / eyes;
    let strays = estimated.strays();
    let found = [false, true].map(|real| {
        let of: Vec<usize> = (0..bare.len()).filter(|&i| samples[i].triangle.is_some() == real).collect();
        let found = of.iter().filter(|&&i| strays[i]).count();
        format!("{:.2}", 100.0 * found as f64 / of.len().max(1) as f64)
    });
    println!("{name:16} {visible:7.0} | {cells} | {build:.1}, {one:.1}, {by_hull:.1} | {}", found.join(", "));
    Ok(())
}
