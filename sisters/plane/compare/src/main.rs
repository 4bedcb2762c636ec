//! Fields of view on tiles side by side: casca-plane and the crates that tile games use, in one
//! process, on the same maps and eyes.
//!
//! `cargo run --release -- [--csv FILE] [--eyes N] [--largest SIZE]` prints a table: the median
//! time of a view, and how many tiles a method misses or shows wrongly in a view, against exact
//! visibility. Exact visibility comes from rays between all corners, which share no code with the
//! library, where a view has a range or the map is small; on large maps without a range from
//! casca-plane.
//!
//! The times hold all that a view needs in a program that asks for one view after the other;
//! doryen-fov has to clear a byte for each tile of the map first.

mod methods;
mod table;
mod truth;

use std::collections::BTreeSet;
use std::time::Instant;

use casca_plane::OpaqueTiles;
use casca_plane::maps::MapKind;

use crate::methods::{Map, Method};
use crate::table::Line;

/// The maps' sides, in tiles.
const SIZES: [u32; 4] = [64, 256, 1024, 4096];
/// How far viewers see, in tiles; 0 for all the map.
const RANGES: [u32; 2] = [20, 0];
/// How often each view is measured.
const ROUNDS: usize = 3;
/// Views whose tiles are compared with exact visibility.
const CHECKED: usize = 12;
/// Maps without a range up to this size are checked by rays.
const RAYS_UP_TO: u32 = 256;
/// The seed of maps and eyes.
const SEED: u64 = 1;
/// Crates that call themselves for each row need it on large maps.
const STACK: usize = 1 << 30;

struct Options {
    csv: Option<String>,
    eyes: usize,
    largest: u32,
}

fn options() -> Result<Options, String> {
    let mut options = Options { csv: None, eyes: 100, largest: 4096 };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        let number = || value.parse::<u32>().map_err(|error| format!("{word} {value}: {error}"));
        match word.as_str() {
            "--csv" => options.csv = Some(value),
            "--eyes" => options.eyes = number()?.max(1) as usize,
            "--largest" => options.largest = number()?,
            _ => return Err(format!("unknown option {word}; there are --csv, --eyes and --largest")),
        }
    }
    Ok(options)
}

fn main() -> Result<(), String> {
    let options = options()?;
    let run = move || compare(&options);
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(run);
    thread.map_err(|error| error.to_string())?.join().map_err(|_| "a method panicked".to_string())?
}

fn compare(options: &Options) -> Result<(), String> {
    let mut lines = Vec::new();
    for kind in MapKind::ALL {
        for size in SIZES.into_iter().filter(|&size| size <= options.largest) {
            let map = Map::new(kind.generate(size, size, SEED));
            let eyes = eyes(&map.opaque, options.eyes);
            for range in RANGES {
                lines.extend(measure(kind, &map, &eyes, range));
                table::print(&lines[lines.len() - Method::ALL.len()..], lines.len() == Method::ALL.len());
            }
        }
    }
    match &options.csv {
        Some(file) => std::fs::write(file, table::csv(&lines)).map_err(|error| format!("{file}: {error}")),
        None => Ok(()),
    }
}

/// Free tiles, drawn by chance.
fn eyes(opaque: &OpaqueTiles, count: usize) -> Vec<(u32, u32)> {
    let mut state = SEED;
    let mut next = |below: u32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % u64::from(below)) as u32
    };
    let places = std::iter::repeat_with(|| (next(opaque.width()), next(opaque.height())));
    places.filter(|&(x, y)| !opaque.get(x, y)).take(count).collect()
}

/// All methods on one map: the view of each eye by one method after the other, so that disturbances
/// hit all of them.
fn measure(kind: MapKind, map: &Map, eyes: &[(u32, u32)], range: u32) -> Vec<Line> {
    let mut methods: Vec<_> =
        Method::ALL.into_iter().map(|method| (method, method.runner(map, range))).collect();
    let mut times = vec![Vec::new(); methods.len()];
    for _ in 0..ROUNDS {
        for &eye in eyes {
            for ((_, runner), times) in methods.iter_mut().zip(&mut times) {
                let Some(runner) = runner else { continue };
                let start = Instant::now();
                runner.run(eye);
                times.push(start.elapsed().as_secs_f64() * 1e6);
            }
        }
    }
    let by_rays = range != 0 || map.opaque.width() <= RAYS_UP_TO;
    let mut lines: Vec<_> = methods
        .iter()
        .zip(times)
        .map(|((method, runner), times)| {
            Line::new(kind, map.opaque.width(), range, *method, times, runner.is_some())
        })
        .collect();
    let checked = &eyes[..eyes.len().min(CHECKED)];
    for &eye in checked {
        // Ranges differ by up to a tile among the crates: only tiles well inside are compared.
        let inside = |&(x, y): &(u32, u32)| {
            let apart = |a: u32, b: u32| (i64::from(a) - i64::from(b)).pow(2);
            range == 0 || apart(x, eye.0) + apart(y, eye.1) <= i64::from(range - 1).pow(2)
        };
        let truth: BTreeSet<_> = match by_rays {
            true => truth::seen(map.opaque.bits(), eye, range).into_iter().filter(inside).collect(),
            false => {
                let mut casca = Method::Casca.runner(map, range).expect("casca has no limits");
                casca.run(eye);
                casca.seen().into_iter().collect()
            }
        };
        for ((_, runner), line) in methods.iter_mut().zip(&mut lines) {
            let Some(runner) = runner else { continue };
            runner.run(eye);
            let shown: BTreeSet<_> = runner.seen().into_iter().filter(inside).collect();
            line.compare(&map.opaque, &truth, &shown, checked.len());
        }
    }
    lines
}
