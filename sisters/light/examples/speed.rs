//! How fast rays are gathered: `speed [FILE.glb] [N] [RAYS] [STEP]`. Every STEP-th triangle of the
//! scene asks for the states around its middle on both sides, and one ring is gathered. Prints a
//! number for the answers, which stays if no bit of them changes.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use casca_radiosity::{Cache, Grid, Light, Object, Scene, Settings, Sky, Triangle};
use casca_scenes::import::load_lit;
use casca_scenes::lit::{Kind, LitScene};
use glam::Vec3;

fn input(scene: &LitScene) -> Scene {
    let direction = Vec3::new(0.25, -1.0, 0.12);
    Scene {
        lights: vec![Light::Sun { direction, irradiance: Vec3::splat(10.0), half_angle: 0.01 }],
        sky: Sky::Even(Vec3::new(0.6, 0.8, 1.0)),
        ..scene.into()
    }
}

/// A box of a size around a middle.
fn cuboid(middle: Vec3, size: f32) -> Vec<Triangle> {
    let faces = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    let of = |normal: Vec3| {
        let (u, v) = normal.any_orthonormal_pair();
        let at = |a: f32, b: f32| middle + (normal + u * a + v * b) * (0.5 * size);
        let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        [[a, b, c], [a, c, d]].map(|corners| Triangle { corners, material: 0 })
    };
    faces.flat_map(of).collect()
}

/// Moves a box about, and says how long that takes.
fn moves(cache: &mut Cache, object: usize, chest: impl Fn(f32) -> Object) -> Result<(), Box<dyn Error>> {
    let mut times = Vec::new();
    for step in 1..=6 {
        let clock = Instant::now();
        let moved = cache.set_object(object, chest(step as f32))?;
        times.push(clock.elapsed().as_secs_f64() * 1e3);
        if step == 6 {
            println!("{:.1} ms the first move, then {:.1?}; {moved:?}", times[0], &times[1..]);
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let of = |i: usize, default: &str| arguments.get(i).cloned().unwrap_or(default.to_owned());
    let scene = match of(0, "cornell") {
        file if Path::new(&file).exists() => load_lit(Path::new(&file))?,
        name => name.parse::<Kind>()?.build(),
    };
    let (cells, rays, step): (u32, u32, usize) =
        (of(1, "128").parse()?, of(2, "64").parse()?, of(3, "8").parse()?);
    let mut scene = input(&scene);
    let grid = Grid::around(&scene.objects, cells);
    let chest = |along: f32| {
        let size = (grid.max - grid.min).min_element() / 20.0;
        Object::from(cuboid(grid.min.lerp(grid.max, 0.4 + 0.01 * along), size))
    };
    scene.objects.push(chest(0.0));
    let clock = Instant::now();
    let mut cache = Cache::new(&scene, Settings::new(grid))?;
    println!("{:.2} s cells", clock.elapsed().as_secs_f64());
    let middle = |t: &Triangle| {
        let [a, b, c] = t.corners;
        ((a + b + c) / 3.0, (b - a).cross(c - a).normalize_or(Vec3::Y))
    };
    let spots: Vec<_> = scene.objects.iter().flat_map(|o| &o.triangles).step_by(step).map(middle).collect();
    let clock = Instant::now();
    for (point, normal) in &spots {
        cache.request(*point, *normal)?;
        cache.request(*point, -*normal)?;
    }
    println!("{:.2} s requests of {} points", clock.elapsed().as_secs_f64(), 2 * spots.len());
    let clock = Instant::now();
    let waiting = cache.gather_ring(rays)?;
    let seconds = clock.elapsed().as_secs_f64();
    let s = cache.statistics();
    println!(
        "{seconds:.2} s gather: {} states, {} rays, {:.0} rays/s, {:.3}% dark, {} wait; {} entries, {} references",
        s.gathered,
        s.rays,
        s.rays as f64 / seconds,
        100.0 * s.dark_rays as f64 / s.rays as f64,
        waiting,
        s.entries,
        s.references
    );
    let clock = Instant::now();
    cache.direct();
    println!("{:.2} s direct", clock.elapsed().as_secs_f64());
    (0..4).for_each(|_| _ = cache.pass());
    let mut number = 0_u64;
    for (point, normal) in spots.iter().step_by(16) {
        let light = cache.irradiance(*point, *normal)?;
        for c in [light.direct, light.indirect].iter().flat_map(|c| c.to_array()) {
            number = (number ^ u64::from(c.to_bits())).wrapping_mul(0x100_0000_01b3);
        }
    }
    println!("answers {number:016x}");
    moves(&mut cache, scene.objects.len() - 1, chest)
}
