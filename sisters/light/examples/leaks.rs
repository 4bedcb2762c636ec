//! The light that crosses walls: rooms beside a lit one, and boxes under the sky, as the table of
//! docs/radiosity.md.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{leak, sealed, turned};
use glam::Affine3A;

/// Thicknesses of walls in metres; 0 is a sheet.
const WALLS: [f32; 6] = [0.0, 0.02, 0.05, 0.1, 0.4, 1.0];

/// Rays of a state.
const RAYS: u32 = 32;

fn main() {
    println!("| N | place | wall | dark room over lit one: mean | most | sealed box over its roof: most |");
    println!("|---|---|---|---|---|---|");
    for cells in [64, 128] {
        for (name, place) in [("along the axes", Affine3A::IDENTITY), ("turned", turned())] {
            for wall in WALLS {
                let (mean, most) = leak(wall, cells, RAYS, place);
                // A box of 2 metres has room for walls of less than 1.
                let sealed = sealed(wall.min(0.8), cells, RAYS, place);
                println!("| {cells} | {name} | {wall} m | {mean:.1e} | {most:.1e} | {sealed:.1e} |");
            }
        }
    }
}
