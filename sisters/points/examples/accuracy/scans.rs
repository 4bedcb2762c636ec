//! Points as scanners at a few places find them: the first hits of rays at even angles.

use crate::scenes::Scene;
use crate::truth::{Hit, Mesh, Samples, seen};
use crate::{Counts, count, gauss, text};
use bitvec::vec::BitVec;
use casca_points::PointCloud;
use casca_points::surface::Surface;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::error::Error;
use std::f64::consts::{PI, TAU};

/// Scanners stand at the eyes, turned about the middle of the scene by this angle and nearer to it
/// by this factor.
const TURN: f32 = 0.5;
const NEARER: f32 = 0.9;
/// Rows of the first scan, whose hits tell how many rows find as many points as wanted.
const TRIAL: usize = 100;

/// One scan: the hits of rays in `rows` rows from the zenith down.
fn scan(mesh: &Mesh, place: DVec3, rows: usize) -> Vec<Hit> {
    let step = PI / rows as f64;
    let of_row = |row: usize| {
        let (sine, up) = ((row as f64 + 0.5) * step).sin_cos();
        let ray = move |column: usize| {
            let (z, x) = ((column as f64 + 0.5) * step).sin_cos();
            DVec3::new(sine * x, up, sine * z)
        };
        let hits = (0..(TAU / step) as usize).filter_map(move |column| mesh.first_hit(place, ray(column)));
        hits.collect::<Vec<_>>()
    };
    (0..rows).into_par_iter().flat_map_iter(of_row).collect()
}

/// Where up to six scanners stand: all but those within bodies.
fn places(scene: &Scene, mesh: &Mesh) -> Vec<DVec3> {
    let corners = scene.triangles.iter().flatten();
    let low = corners.clone().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = corners.copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let middle = (low + high) / 2.0;
    let turned = |&eye: &Vec3, angle: f32| {
        (middle + NEARER * glam::Quat::from_rotation_y(angle).mul_vec3(eye - middle)).as_dvec3()
    };
    let all =
        [TURN, -TURN].into_iter().flat_map(|angle| scene.eyes.iter().map(move |eye| turned(eye, angle)));
    let is_free = |place: &DVec3| {
        let hits = scan(mesh, *place, TRIAL);
        let front = hits.iter().filter(|hit| hit.front).count();
        2 * front > hits.len()
    };
    all.filter(is_free).collect()
}

/// About `count` points from at most `scanners` places, each with as many rays, moved along their
/// rays by `noise` times the distance of neighbouring rays there.
pub fn samples(
    scene: &Scene,
    count: usize,
    scanners: usize,
    mut noise: impl FnMut() -> f32,
) -> (Samples, PointCloud) {
    let mesh = Mesh::new(&scene.triangles);
    let mut places = places(scene, &mesh);
    places.truncate(scanners);
    let trial: usize = places.iter().map(|&place| scan(&mesh, place, TRIAL).len()).sum();
    let rows = (TRIAL as f64 * (count as f64 / trial.max(1) as f64).sqrt()) as usize;
    let mut samples = Samples { points: Vec::new(), normals: Vec::new(), triangle: Vec::new(), spacing: 0.0 };
    let mut cloud = PointCloud { scanners: places.clone(), ..Default::default() };
    let mut spacings = Vec::new();
    for (number, &place) in places.iter().enumerate() {
        for hit in scan(&mesh, place, rows) {
            let way = hit.at - place;
            let step = PI / rows as f64;
            samples.points.push(hit.at.as_vec3());
            samples.normals.push(mesh.normal(hit.triangle));
            samples.triangle.push(hit.triangle);
            spacings.push((way.length() * step) as f32);
            cloud.positions.push((hit.at + way * (step * f64::from(noise()))).as_vec3());
            cloud.seen_by.push(number as u32);
        }
    }
    spacings.sort_by(f32::total_cmp);
    samples.spacing = spacings.get(spacings.len() / 2).copied().unwrap_or(1.0);
    (samples, cloud)
}

/// Errors of points of scans, without and with the places of the scanners.
pub fn print(scenes: &[Scene], points: usize, scanners: usize, noise: f32) -> Result<(), Box<dyn Error>> {
    println!(
        "about {points} points of at most {scanners} scanners, noise {noise}: \
         errors (false visible + false hidden) in percent"
    );
    println!(
        "scene             points scanners visible | positions only      | and scanners        | and normals         | all three"
    );
    for scene in scenes {
        let mut gauss = gauss();
        let (samples, cloud) = samples(scene, points, scanners, || gauss() * noise);
        let bare = PointCloud { seen_by: Vec::new(), ..cloud.clone() };
        let normals = samples.normals.clone();
        let all = [
            bare.clone(),
            cloud.clone(),
            PointCloud { normals: normals.clone(), ..bare },
            PointCloud { normals, ..cloud },
        ];
        let truths: Vec<BitVec> = scene.eyes.iter().map(|&eye| seen(scene, &samples, eye)).collect();
        let mut sums = [Counts::default(); 4];
        for (cloud, sum) in all.iter().zip(&mut sums) {
            let surface = Surface::new(cloud)?;
            for (eye, truth) in scene.eyes.iter().zip(&truths) {
                let found = surface.visible(eye.as_dvec3())?;
                count(sum, truth, found.iter().by_vals().map(Some));
            }
        }
        println!(
            "{:16} {:7} {:8} {:7.0} | {}",
            scene.name,
            samples.points.len(),
            all[0].scanners.len(),
            sums[0][0] / scene.eyes.len() as f64,
            sums.map(text).join(" | ")
        );
    }
    Ok(())
}
