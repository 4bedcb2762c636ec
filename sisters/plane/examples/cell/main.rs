//! The planar method of the thesis, measured again: what extended occluders add, and how temporal
//! bounding volumes behave over time. Prints tables in Markdown.
//!
//! ```sh
//! cargo run --release -p casca-plane --features maps --example cell
//! ```

mod caps;
mod circle;
mod volumes;

use std::time::Instant;

use casca_plane::maps::MapKind;
use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles};
use glam::{IVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::caps::Walk;

/// Cells along each side of a map.
const SIDE: u32 = 128;
/// Viewpoints on each map.
const VIEWS: u32 = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("Extended occluders: {SIDE}x{SIDE} cells, means of {VIEWS} cells.\n");
    println!("| map | occluders | drawn | cells hidden | µs |");
    println!("|---|---|---|---|---|");
    for kind in MapKind::ALL {
        let map = kind.generate(SIDE, SIDE, 7);
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let eyes: Vec<IVec2> = (0..VIEWS).map(|_| place(&map, &mut random).as_ivec2()).collect();
        for (name, l_shaped) in [("straight", false), ("L-shaped", true)] {
            print(kind, name, &eyes, |eye| {
                let walk = Walk::run(&map, eye, l_shaped);
                (walk.seen.count(), walk.drawn)
            });
        }
        let (opaque, mut fov) = (OpaqueTiles::new(map), FieldOfView::new());
        let exact = |eye: IVec2| {
            let seen = fov.run_from_tile(&opaque, eye.x as u32, eye.y as u32, &FovOptions::default());
            (seen.map_or(0, BitGrid::count), 0)
        };
        print(kind, "`FieldOfView::run_from_tile`, exact", &eyes, exact);
    }
    println!();
    volumes::print();
    Ok(())
}

/// A row of the table, of what is seen from some cells.
fn print(kind: MapKind, name: &str, eyes: &[IVec2], mut run: impl FnMut(IVec2) -> (u64, u32)) {
    let (mut seen, mut drawn) = (0, 0);
    let start = Instant::now();
    for &eye in eyes {
        let (cells, occluders) = run(eye);
        (seen, drawn) = (seen + cells, drawn + occluders);
    }
    let n = eyes.len() as f64;
    let micros = start.elapsed().as_secs_f64() * 1e6 / n;
    let hidden = 100.0 * (1.0 - seen as f64 / n / f64::from(SIDE * SIDE));
    let drawn = f64::from(drawn) / n;
    println!("| {} | {name} | {drawn:.0} | {hidden:.2}% | {micros:.0} |", kind.name());
}

/// A place in an open cell, a third of a cell from its sides.
fn place(map: &BitGrid, random: &mut Pcg64Mcg) -> Vec2 {
    loop {
        let (x, y) = (random.random_range(0..map.width()), random.random_range(0..map.height()));
        if !map.get(x, y) {
            let inner = Vec2::new(random.random_range(0.34..0.66), random.random_range(0.34..0.66));
            return Vec2::new(x as f32, y as f32) + inner;
        }
    }
}
