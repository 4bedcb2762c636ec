//! Hidden point removal of `casca-points` for `sisters/points/compare/compare.py`, which runs it
//! beside Open3D and qhull.
//!
//! - `cloud NAME COUNT FILE` writes the points of a cloud, relative to the eye: little-endian
//!   doubles, three for each point.
//! - `time FILE LOG10_RADIUS ANSWER` reads them, removes hidden points once, prints the seconds of
//!   that alone, and writes a byte for each point: 1 if it is visible.

use std::error::Error;
use std::f64::consts::TAU;

use casca_lab::experiments::points::cloud::Cloud;
use casca_lab::experiments::points::hare::hare;
use casca_points::hpr::{Kernel, visible_points};
use casca_scenes::measure::timed_by_wall;
use casca_scenes::random::generator;
use glam::DVec3;
use rand::RngExt;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["cloud", name, count, file] => {
            let points = cloud(name, count.parse()?)?;
            let bytes = points.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes);
            Ok(std::fs::write(file, Vec::from_iter(bytes))?)
        }
        ["time", file, log10_radius, answer] => {
            let points = read(&std::fs::read(file)?);
            let kernel = Kernel::Relative { log10_radius: log10_radius.parse()? };
            // As the programs beside it are timed, whose threads are not known.
            let (visible, time) = timed_by_wall(|| visible_points(&points, DVec3::ZERO, kernel));
            let visible = visible?;
            println!("{}", time.as_secs_f64());
            Ok(std::fs::write(answer, visible.iter().map(|bit| u8::from(*bit)).collect::<Vec<_>>())?)
        }
        _ => Err("usage: cloud sphere|hare|scan|facade|terrain|torus|copies COUNT FILE, or time FILE LOG10_RADIUS ANSWER".into()),
    }
}

/// Points relative to the eye.
fn cloud(name: &str, count: usize) -> Result<Vec<DVec3>, Box<dyn Error>> {
    let cloud = match name {
        "sphere" => Cloud::sphere(count),
        "hare" => {
            Cloud::of_mesh("hare", hare(110), count, 1, Cloud::hare(1000).look).map_err(|e| e.to_string())?
        }
        "scan" => return Ok(scan(count)),
        "facade" => return Ok(facade(count)),
        "terrain" => return Ok(terrain(count)),
        "torus" => return Ok(torus(count)),
        "copies" => return Ok(copies(count)),
        _ => return Err(format!("no cloud has the name {name}").into()),
    };
    Ok(cloud.places().into_iter().map(|p| p - cloud.look.eye.as_dvec3()).collect())
}

/// A scan of a room from a place in it: a point in each of `count` directions, all of them visible.
fn scan(count: usize) -> Vec<DVec3> {
    let directions = Cloud::sphere(count).places();
    let (low, high) = (DVec3::new(-3.0, -1.5, -2.0), DVec3::new(4.0, 1.5, 5.0));
    let side = |d: DVec3, i: usize| ((if d[i] > 0.0 { high[i] } else { low[i] }) / d[i]).abs();
    let reach = |d: DVec3| side(d, 0).min(side(d, 1)).min(side(d, 2));
    directions.into_iter().map(|d| d * reach(d)).collect()
}

/// The front of a house from the street: points at random on a wall with 12 x 6 windows, which lie
/// deeper than the wall and return no depth between.
fn facade(count: usize) -> Vec<DVec3> {
    let random = &mut generator(1, 0);
    let mut place = || {
        let (x, y) = (random.random_range(0.0..36.0), random.random_range(0.0..18.0));
        let window = x % 3.0 > 1.0 && y % 3.0 > 1.0;
        DVec3::new(x - 15.0, y - 1.7, if window { -20.3 } else { -20.0 })
    };
    (0..count).map(|_| place()).collect()
}

/// Hills of four wave lengths, with points at random, from above one corner.
fn terrain(count: usize) -> Vec<DVec3> {
    let random = &mut generator(2, 0);
    let hill = |x: f64, z: f64| [7.0, 31.0, 61.0, 127.0].map(|f| (x * f).sin() * (z * f + f).cos() / f);
    let mut place = || {
        let (x, z) = (random.random::<f64>(), random.random::<f64>());
        DVec3::new(x, hill(x, z).iter().sum::<f64>() - 0.5, z)
    };
    (0..count).map(|_| place()).collect()
}

/// A torus with points at random in both of its angles, from outside.
fn torus(count: usize) -> Vec<DVec3> {
    let random = &mut generator(3, 0);
    let mut place = || {
        let (u, v) = (random.random_range(0.0..TAU), random.random_range(0.0..TAU));
        let from_axis = 3.0 + v.cos();
        DVec3::new(from_axis * u.cos(), v.sin() - 4.0, from_axis * u.sin() - 9.0)
    };
    (0..count).map(|_| place()).collect()
}

/// The torus, each point of it four times and far apart in the list, as where scans were joined.
fn copies(count: usize) -> Vec<DVec3> {
    torus(count / 4).repeat(4)
}

fn read(bytes: &[u8]) -> Vec<DVec3> {
    let number = |b: &[u8]| f64::from_le_bytes(std::array::from_fn(|i| b[i]));
    bytes.chunks_exact(24).map(|p| DVec3::new(number(p), number(&p[8..]), number(&p[16..]))).collect()
}
