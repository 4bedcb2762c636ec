//! The time of a look-up: `cargo run --release -p casca-bake --example look_up -- FILE.pvs`

use std::hint::black_box;
use std::time::Instant;

use casca_bake::Baked;
use casca_scenes::random::generator;
use rand::RngExt;

/// Places that are looked up.
const PLACES: usize = 1_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("FILE.pvs")?;
    let bytes = std::fs::read(path)?;
    let began = Instant::now();
    let baked = Baked::read(&bytes)?;
    println!("{} bytes, read and checked in {:.2} ms", bytes.len(), began.elapsed().as_secs_f64() * 1e3);
    let cells = baked.cells();
    let mut random = generator(1, 0);
    let places: Vec<[f64; 3]> = (0..PLACES)
        .map(|_| {
            std::array::from_fn(|i| {
                cells.low[i] + random.random_range(0.0..1.0) * cells.size[i] * f64::from(cells.dims[i])
            })
        })
        .collect();
    let time = |name: &str, look: &mut dyn FnMut([f64; 3]) -> usize| {
        let began = Instant::now();
        let sum: usize = places.iter().map(|&place| look(place)).sum();
        let each = began.elapsed().as_secs_f64() * 1e9 / PLACES as f64;
        println!("{name}: {each:.0} ns, {:.1} in the mean", black_box(sum) as f64 / PLACES as f64);
    };
    time("the set of an eye", &mut |place| usize::from(baked.set_at(place).is_some()));
    time("whether it has one object", &mut |place| {
        usize::from(baked.set_at(place).is_some_and(|set| set.contains(baked.objects() / 2)))
    });
    time("all of its objects", &mut |place| baked.set_at(place).map_or(0, |set| set.iter().count()));
    Ok(())
}
