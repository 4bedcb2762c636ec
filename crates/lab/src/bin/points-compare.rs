//! Hidden point removal of `casca-points` for `crates/points/compare/compare.py`, which runs it
//! beside Open3D and qhull.
//!
//! - `cloud NAME COUNT FILE` writes the points of a cloud, relative to the eye: little-endian
//!   doubles, three for each point.
//! - `time FILE LOG10_RADIUS ANSWER` reads them, removes hidden points once, prints the seconds of
//!   that alone, and writes a byte for each point: 1 if it is visible.

use std::error::Error;

use casca_lab::experiments::points::cloud::Cloud;
use casca_lab::experiments::points::hare::hare;
use casca_points::hpr::{Kernel, visible_points};
use casca_scenes::measure::timed_by_wall;
use glam::DVec3;

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
        _ => Err("usage: cloud sphere|hare|scan COUNT FILE, or time FILE LOG10_RADIUS ANSWER".into()),
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

fn read(bytes: &[u8]) -> Vec<DVec3> {
    let number = |b: &[u8]| f64::from_le_bytes(std::array::from_fn(|i| b[i]));
    bytes.chunks_exact(24).map(|p| DVec3::new(number(p), number(&p[8..]), number(&p[16..]))).collect()
}
