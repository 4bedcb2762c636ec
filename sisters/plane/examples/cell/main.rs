//! The planar method of the thesis, measured again: what extended occluders add, and how temporal
//! bounding volumes behave over time. Prints tables in Markdown.
//!
//! ```sh
//! cargo run --release -p casca-plane --example cell
//! ```

mod caps;
mod volumes;

use std::time::Instant;

use casca_maps::Drawing;
use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles};
use glam::{IVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::caps::Walk;

/// Cells along each side of the map.
const SIDE: u32 = 128;
/// Viewpoints on it.
const VIEWS: u32 = 40;

fn main() {
    let map = Drawing::rooms(SIDE, SIDE, 7).walls;
    println!("Extended occluders: rooms, {SIDE}x{SIDE} cells, means of {VIEWS} cells.\n");
    println!("| occluders | drawn | cells hidden | µs |");
    println!("|---|---|---|---|");
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let eyes: Vec<IVec2> = (0..VIEWS).map(|_| place(&map, &mut random).as_ivec2()).collect();
    for (name, l_shaped) in [("straight", false), ("L-shaped", true)] {
        print(name, &eyes, |eye| {
            let walk = Walk::run(&map, eye, l_shaped);
            (walk.seen.count(), walk.drawn)
        });
    }
    let (opaque, mut fov) = (OpaqueTiles::new(map.clone()), FieldOfView::new());
    print("`FieldOfView::run_from_tile`, exact", &eyes, |eye| {
        let seen = fov.run_from_tile(&opaque, eye.x as u32, eye.y as u32, &FovOptions::default());
        (seen.map_or(0, BitGrid::count), 0)
    });
    println!();
    volumes::print(&map);
}

/// A row of the table, of what is seen from some cells.
fn print(name: &str, eyes: &[IVec2], run: impl FnMut(IVec2) -> (u64, u32)) {
    let start = Instant::now();
    let found: Vec<(u64, u32)> = eyes.iter().copied().map(run).collect();
    let n = eyes.len() as f64;
    let micros = start.elapsed().as_secs_f64() * 1e6 / n;
    let seen: u64 = found.iter().map(|(cells, _)| cells).sum();
    let drawn: u32 = found.iter().map(|(_, occluders)| occluders).sum();
    let hidden = 100.0 * (1.0 - seen as f64 / n / f64::from(SIDE * SIDE));
    println!("| {name} | {:.0} | {hidden:.2}% | {micros:.0} |", f64::from(drawn) / n);
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
