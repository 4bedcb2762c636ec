//! How much of the work is saved if only states that a picture reads are gathered, and at which
//! error: the table of docs/radiosity.md. `culled [SCENE,..] [N] [SPONZA.glb]`; scenes are cornell,
//! house, town and sponza.
//!
//! All states with 64 rays are the measure; errors are of blocks of 4 x 4 pixels, over the mean.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use casca_radiosity::lit::load_lit;
use casca_radiosity::lit::path::{PathTracer, Surface};
use casca_radiosity::lit::{self, Kind, LightKind, LitObject, LitScene};
use casca_radiosity::{Cache, Grid, Scene, Settings};
use casca_scenes::world::{Camera, Mesh};
use glam::{Affine3A, Vec3};

const SIZE: (usize, usize) = (96, 72);
const BLOCK: usize = 4;
const PASSES: u32 = 24;

/// Rays of the first ring, the next one and so on; the last number is that of all others, and 0
/// gathers no more.
type Rings = &'static [u32];

/// Rooms of 5 metres in a square with doors between all neighbours, furniture, and a light in every
/// second one.
fn rooms(side: usize, camera: Camera) -> LitScene {
    let size = 5.0;
    let all = side as f32 * size;
    let mut parts: Vec<[f32; 6]> =
        vec![[-0.2, -0.2, -0.2, all + 0.2, 0.0, all + 0.2], [-0.2, 3.0, -0.2, all + 0.2, 3.2, all + 0.2]];
    for i in 0..=side {
        let at = i as f32 * size;
        for k in 0..side {
            let (low, high) = (k as f32 * size, (k as f32 + 1.0) * size);
            // A door of a metre at a place that differs from wall to wall.
            let door = low + 0.8 + 2.6 * ((i * 7 + k * 3) as f32 * 0.618).fract();
            let is_outside = i == 0 || i == side;
            let spans = if is_outside { vec![(low, high)] } else { vec![(low, door), (door + 1.0, high)] };
            for (from, to) in spans {
                parts.push([at - 0.1, 0.0, from, at + 0.1, 3.0, to]);
                parts.push([from, 0.0, at - 0.1, to, 3.0, at + 0.1]);
            }
        }
    }
    let mut lights = Vec::new();
    for i in 0..side * side {
        let (x, z) = ((i % side) as f32 * size, (i / side) as f32 * size);
        parts.push([x + 1.2, 0.0, z + 3.0, x + 2.4, 0.8, z + 3.9]);
        parts.push([x + 3.4, 0.0, z + 0.6, x + 3.9, 1.9, z + 1.6]);
        if i % 2 == 0 {
            let place = Vec3::new(x + 2.5, 2.6, z + 2.4);
            lights.push(lit::Light::point(place, Vec3::new(9.0, 8.0, 6.5)));
        }
    }
    let object = |(i, [a, b, c, d, e, f]): (usize, &[f32; 6])| {
        let mesh = Mesh::cuboid(Vec3::new(*a, *b, *c), Vec3::new(*d, *e, *f));
        let materials = vec![(i % 3) as u32; mesh.triangles.len()].into();
        let transform = Affine3A::IDENTITY;
        LitObject { name: String::new(), materials, mesh: Arc::new(mesh), transform, moves: false }
    };
    let colours = [[0.75, 0.72, 0.68], [0.6, 0.65, 0.7], [0.7, 0.4, 0.3]];
    LitScene {
        name: "rooms".to_owned(),
        objects: parts.iter().enumerate().map(object).collect(),
        materials: colours.map(|c| lit::Material::matt(Vec3::from_array(c))).into(),
        lights,
        sky: Vec3::ZERO,
        camera,
    }
}

fn camera(eye: [f32; 3], target: [f32; 3]) -> Camera {
    Camera::look_at(Vec3::from_array(eye), Vec3::from_array(target), 65.0, lit::ASPECT, 0.01, 100.0)
}

fn case(name: &str, sponza: &str) -> Result<Option<LitScene>, Box<dyn Error>> {
    Ok(match name {
        "house" => Some(rooms(2, camera([0.6, 1.6, 0.5], [5.0, 1.2, 5.0]))),
        "town" => Some(rooms(10, camera([20.6, 1.6, 20.5], [25.0, 1.2, 25.0]))),
        "sponza" if !Path::new(sponza).exists() => {
            println!("skipped: {sponza} is not here");
            None
        }
        "sponza" => {
            let mut scene = load_lit(Path::new(sponza))?;
            scene.camera = camera([-9.0, 2.0, 0.2], [8.0, 4.0, 0.4]);
            scene.sky = Vec3::new(0.6, 0.8, 1.0);
            let mut sun = lit::Light::point(Vec3::ZERO, Vec3::new(12.0, 11.0, 10.0));
            sun.kind = LightKind::Directional { direction: Vec3::new(0.25, -1.0, 0.12), half_angle: 0.01 };
            scene.lights = vec![sun];
            Some(scene)
        }
        _ => Some(name.parse::<Kind>()?.build()),
    })
}

/// What one way of gathering gave.
struct Found {
    states: usize,
    rays: usize,
    /// Seconds of rays and of direct light.
    seconds: [f64; 2],
    /// The indirect light of blocks of pixels.
    blocks: Vec<Vec3>,
}

fn found(
    scene: &Scene,
    settings: Settings,
    shown: &[Option<Surface>],
    rings: Option<Rings>,
) -> Result<Found, Box<dyn Error>> {
    let mut cache = Cache::new(scene, settings)?;
    let clock = Instant::now();
    match rings {
        None => {
            cache.request_all();
            cache.gather(64)?;
        }
        Some(rings) => {
            for s in shown.iter().flatten() {
                cache.request(s.point.as_vec3(), s.normal.as_vec3())?;
            }
            let mut waiting = 1;
            let last = rings.last().copied().unwrap_or(0);
            for rays in rings.iter().copied().chain(std::iter::repeat(last)).take_while(|r| *r > 0) {
                if waiting == 0 {
                    break;
                }
                waiting = cache.gather_part((rays, rays), usize::MAX)?;
            }
        }
    }
    let gathered = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    cache.direct();
    let lit = clock.elapsed().as_secs_f64();
    (0..PASSES).for_each(|_| _ = cache.pass());
    let statistics = cache.statistics();
    let mut blocks = vec![Vec3::ZERO; SIZE.0 / BLOCK * (SIZE.1 / BLOCK)];
    for (i, s) in shown.iter().enumerate().filter_map(|(i, s)| s.map(|s| (i, s))) {
        let light = cache.irradiance(s.point.as_vec3(), s.normal.as_vec3())?;
        blocks[i / SIZE.0 / BLOCK * (SIZE.0 / BLOCK) + i % SIZE.0 / BLOCK] += light.indirect;
    }
    Ok(Found { states: statistics.gathered, rays: statistics.rays, seconds: [gathered, lit], blocks })
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names = arguments.first().map_or("cornell-point,house,town", |s| s);
    let cells = arguments.get(1).map_or(Ok(96), |n| n.parse())?;
    let sponza = arguments.get(2).map_or("../shared/scenes/sponza.glb", |s| s);
    println!("| scene | gathered | states | rays | time of rays | of direct light | mean | block RMSE |");
    println!("|---|---|---|---|---|---|---|---|");
    for name in names.split(',') {
        let Some(lit) = case(name, sponza)? else { continue };
        let shown = PathTracer::new(&lit).surfaces(&lit.camera, SIZE)?;
        let scene = Scene::from(&lit);
        let settings = Settings::new(Grid::around(&scene.objects, cells));
        let all = found(&scene, settings, &shown, None)?;
        let sum = |f: &Found| f64::from(f.blocks.iter().map(|b| b.element_sum()).sum::<f32>());
        let row = |how: &str, f: &Found| {
            let squares =
                f.blocks.iter().zip(&all.blocks).map(|(a, b)| f64::from((*a - *b).length_squared()) / 3.0);
            let error = (squares.sum::<f64>() / f.blocks.len() as f64).sqrt();
            let mean = sum(&all) / (3 * f.blocks.len()) as f64;
            let share = |a: f64, b: f64| 100.0 * a / b;
            println!(
                "| {name} | {how} | {} ({:.1}%) | {:.2} M ({:.1}%) | {:.1} s ({:.1}%) | {:.1} s ({:.1}%) | {:.3} | {:.1}% |",
                f.states,
                share(f.states as f64, all.states as f64),
                f.rays as f64 / 1e6,
                share(f.rays as f64, all.rays as f64),
                f.seconds[0],
                share(f.seconds[0], all.seconds[0]),
                f.seconds[1],
                share(f.seconds[1], all.seconds[1]),
                sum(f) / sum(&all),
                100.0 * error / mean,
            );
        };
        row("all states, 64 rays", &all);
        row(
            "the same with other directions",
            &found(&scene, Settings { seed: 1, ..settings }, &shown, None)?,
        );
        let ways: [(&str, Rings); 5] = [
            ("what pixels read, and what that reads: 64 rays", &[64]),
            ("64 rays, then 16", &[64, 16]),
            ("64, 16, then 4", &[64, 16, 4]),
            ("64, 16, 4, no more", &[64, 16, 4, 0]),
            ("64, 16, no more", &[64, 16, 0]),
        ];
        for (how, rings) in ways {
            row(how, &found(&scene, settings, &shown, Some(rings))?);
        }
    }
    Ok(())
}
