//! Which cells and objects are hidden by straight and L-shaped occluders, and by all chains of
//! cells.

use casca_plane::maps::MapKind;
use casca_plane::{BitGrid, CellOptions, FieldOfView, FovOptions, Fusion, Method, OpaqueTiles, Query, View};

use crate::setup::{Failure, Level, SIDE, count, micros, seen_from_cell};

/// Viewpoints on each map.
const VIEWS: u32 = 40;

/// Means over views.
#[derive(Default)]
struct Means {
    hidden: f64,
    pvs: f64,
    occluders: f64,
    micros: f64,
}

fn measure(level: &mut Level, eyes: &[glam::Vec2], options: CellOptions) -> Result<Means, Failure> {
    let mut query = Query::with_method(Method::Cell)?;
    query.set_cell_options(options)?;
    let mut sums = Means::default();
    for &eye in eyes {
        let view = View::all_round(eye)?;
        query.run(&level.scene, &view);
        let seen = query.seen_cells(&level.scene).map_or(0, |cells| cells.count());
        sums.hidden += 1.0 - seen as f64 / f64::from(SIDE * SIDE);
        sums.pvs += count(&level.scene, query.pvs());
        sums.occluders += f64::from(query.pvs().stats().occluders_drawn);
        sums.micros += micros(|| {
            query.run(&level.scene, &view);
        });
    }
    let n = eyes.len() as f64;
    Ok(Means {
        hidden: sums.hidden / n,
        pvs: sums.pvs / n,
        occluders: sums.occluders / n,
        micros: sums.micros / n,
    })
}

/// The three kinds of fusion on three maps.
pub fn print() -> Result<(), Failure> {
    println!("Extended occluders: {SIDE}x{SIDE} cells, 600 objects, means of {VIEWS} views all round.\n");
    println!(
        "| map | occluders | cells hidden | PVS | PVS / seen from the cell | PVS / seen from the eye | µs |"
    );
    println!("|---|---|---|---|---|---|---|");
    for kind in MapKind::ALL {
        let mut level = Level::new(kind, 600)?;
        let eyes: Vec<_> = (0..VIEWS).map(|_| level.place()).collect();
        let (mut from_cell, mut from_eye) = (0.0, 0.0);
        let mut point = Query::with_method(Method::Point)?;
        for &eye in &eyes {
            from_cell += seen_from_cell(&level.scene, eye)? / f64::from(VIEWS);
            from_eye +=
                count(&level.scene, point.run(&level.scene, &View::all_round(eye)?)) / f64::from(VIEWS);
        }
        for (name, fusion) in
            [("straight", Fusion::Straight), ("L-shaped", Fusion::LShaped), ("masks", Fusion::Masks)]
        {
            let found = measure(&mut level, &eyes, CellOptions::new().fusion(fusion))?;
            println!(
                "| {} | {name} | {:.2}% | {:.1} | {:.2} | {:.2} | {:.0} |",
                kind.name(),
                100.0 * found.hidden,
                found.pvs,
                found.pvs / from_cell,
                found.pvs / from_eye,
                found.micros,
            );
        }
        let (hidden, time) = from_tiles(&level, &eyes)?;
        println!(
            "| {} | `FieldOfView::run_from_tile` | {:.2}% | - | - | - | {time:.0} |",
            kind.name(),
            100.0 * hidden
        );
    }
    println!();
    Ok(())
}

/// The share of the tiles that fields of view from whole tiles hide, and the time of one in
/// microseconds. Exact.
fn from_tiles(level: &Level, eyes: &[glam::Vec2]) -> Result<(f64, f64), Failure> {
    let (opaque, mut fov) = (OpaqueTiles::new(level.map.clone()), FieldOfView::new());
    let (mut hidden, mut time) = (0.0, 0.0);
    for eye in eyes {
        let (x, y) = (eye.x as u32, eye.y as u32);
        let seen = fov.run_from_tile(&opaque, x, y, &FovOptions::default())?.count();
        hidden += 1.0 - seen as f64 / f64::from(SIDE * SIDE);
        time += micros(|| {
            let _ = fov.run_from_tile(&opaque, x, y, &FovOptions::default());
        });
    }
    let n = eyes.len() as f64;
    Ok((hidden / n, time / n))
}

/// The choice of occluders by angle.
pub fn print_angles() -> Result<(), Failure> {
    println!("Occluders by least angle: fields, {SIDE}x{SIDE} cells, 600 objects.\n");
    println!("| occluders | least angle | drawn | cells hidden | PVS | µs |");
    println!("|---|---|---|---|---|---|");
    let mut level = Level::new(MapKind::Fields, 600)?;
    let eyes: Vec<_> = (0..VIEWS).map(|_| level.place()).collect();
    for (name, fusion) in [("L-shaped", Fusion::LShaped), ("masks", Fusion::Masks)] {
        for angle in [0.0, 0.05, 0.1, 0.2, 0.4] {
            let found = measure(&mut level, &eyes, CellOptions::new().fusion(fusion).min_angle(angle))?;
            let (hidden, drawn) = (100.0 * found.hidden, found.occluders);
            println!(
                "| {name} | {angle} | {drawn:.0} | {hidden:.2}% | {:.1} | {:.0} |",
                found.pvs, found.micros
            );
        }
    }
    println!();
    Ok(())
}

/// Time by the size of the map.
pub fn print_sizes() -> Result<(), Failure> {
    println!(
        "Time of a view all round with masks, in µs (cells in sight), 1000 objects, means of 10 views. Noise: single opaque cells.\n"
    );
    println!("| map | 256² | 1024² | 4096² |");
    println!("|---|---|---|---|");
    let noise = |side: u32, every: u32| {
        let mut map = BitGrid::new(side, side);
        let scattered = |x: u32, y: u32| {
            (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77)).wrapping_mul(0xc2b2_ae3d) >> 8
        };
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            map.set(x, y, scattered(x, y) % every == 0);
        }
        map
    };
    type Make<'a> = (&'static str, Box<dyn Fn(u32) -> BitGrid + 'a>);
    let maps: [Make; 7] = [
        ("rooms", Box::new(|side| MapKind::Rooms.generate(side, side, 7))),
        ("caves", Box::new(|side| MapKind::Caves.generate(side, side, 7))),
        ("fields", Box::new(|side| MapKind::Fields.generate(side, side, 7))),
        ("empty", Box::new(|side| BitGrid::new(side, side))),
        ("noise, 1 of 10", Box::new(|side| noise(side, 10))),
        ("noise, 1 of 100", Box::new(|side| noise(side, 100))),
        ("noise, 1 of 1000", Box::new(|side| noise(side, 1000))),
    ];
    for (name, map) in maps {
        print!("| {name} |");
        for side in [256, 1024, 4096] {
            let mut level = Level::from_map(map(side), 1000)?;
            let mut query = Query::with_method(Method::Cell)?;
            let (mut time, mut seen) = (0.0, 0);
            for _ in 0..10 {
                let view = View::all_round(level.place())?;
                time += micros(|| {
                    query.run(&level.scene, &view);
                }) / 10.0;
                let stats = query.pvs().stats();
                seen += (stats.cells_visited - stats.cells_hidden) / 10;
            }
            print!(" {time:.0} ({seen}) |");
        }
        println!();
    }
    println!();
    Ok(())
}
