//! The radiosity cache beside a path tracer with all bounces, the cones of the laboratory, and
//! ambient light with a constant: the table of docs/radiosity.md.
//!
//! `radiosity [SCENE,..] [N,..] [RAYS] [SAMPLES] [FINER,..]`; cells are so many times finer around the
//! camera, up to a quarter of the scene's length from it (1 is not at all). Scenes are cornell, cornell-point, emissive,
//! house, gallery, street, cave, hall and aisle.

mod cases;

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use casca_lab::experiments::light::{Gather, LightVolume, Spot, Voxels};
use casca_radiosity::{Cache, Grid, Scene, Settings, Window};
use casca_scenes::lit::{self, LitScene};
use casca_scenes::world::Camera;
use casca_truth::oracle::path::{PathTracer, Quantity, Surface};
use glam::Vec3;
use rayon::prelude::*;

/// Pixels of pictures, and of the blocks that errors are means of.
const SIZE: (usize, usize) = (96, 72);
const BLOCK: usize = 4;
/// Bounces of the truth: a wall of an albedo of 0.8 keeps 1e-6 of the light after 64.
const BOUNCES: u32 = 64;
/// Passes end with the first that changes less than this share of the light, a tenth of the least
/// error in the table, and after so many.
const SETTLED: f64 = 1e-3;
const MOST_PASSES: u32 = 40;
/// The part of the scene's length that a window of finer cells reaches from the camera.
const WINDOW: f32 = 4.0;
/// For rays and bytes in millions.
const MILLION: f64 = 1e6;

use cases::{Case, SPONZA, case};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// The colours of a picture's pixels, row by row from the top.
type Picture = Vec<Vec3>;

fn mean(picture: &[Vec3]) -> f64 {
    picture.iter().map(|p| f64::from(p.element_sum())).sum::<f64>() / (3 * picture.len()) as f64
}

/// The root of the mean square of differences of blocks, over the mean of the truth.
fn error(truth: &[Vec3], found: &[Vec3]) -> f64 {
    let (width, height) = (SIZE.0 / BLOCK, SIZE.1 / BLOCK);
    let block = |picture: &[Vec3], x: usize, y: usize| {
        let of = |i: usize| picture[(y * BLOCK + i / BLOCK) * SIZE.0 + x * BLOCK + i % BLOCK].as_dvec3();
        (0..BLOCK * BLOCK).map(of).sum::<glam::DVec3>() / (BLOCK * BLOCK) as f64
    };
    let blocks = (0..width * height).map(|i| {
        let (x, y) = (i % width, i / width);
        (block(truth, x, y) - block(found, x, y)).length_squared() / 3.0
    });
    (blocks.sum::<f64>() / (width * height) as f64).sqrt() / mean(truth)
}

/// The truth of one camera: direct light, and all that was scattered more often.
struct Truth {
    surfaces: Vec<Option<Surface>>,
    direct: Picture,
    indirect: Picture,
    /// The standard error of the light of a block.
    noise: f64,
}

fn truth([tracer, dark]: &[PathTracer; 2], camera: &Camera, samples: u32) -> Outcome<Truth> {
    let surfaces = tracer.surfaces(camera, SIZE)?;
    // The path tracer counts light of the sky that was scattered once as direct, the cache does not.
    let direct = dark.render(camera, SIZE, &Quantity::Radiance(1..=1), samples, 7)?;
    let all = tracer.render(camera, SIZE, &Quantity::Radiance(1..=BOUNCES), samples, 7)?;
    let show = |i: usize, v: Vec3| if surfaces[i].is_some() { v } else { Vec3::ZERO };
    let picture = |image: &[Vec3]| (0..).zip(image).map(|(i, v)| show(i, *v)).collect::<Picture>();
    let (direct, all_light) = (picture(direct.image.pixels()), picture(all.image.pixels()));
    let error = all.error.pixels().iter().map(|p| p.as_dvec3().length_squared() / 3.0).sum::<f64>();
    let noise = (error / (SIZE.0 * SIZE.1) as f64).sqrt() / BLOCK as f64;
    let indirect: Picture = all_light.iter().zip(&direct).map(|(a, d)| *a - *d).collect();
    Ok(Truth { surfaces, direct, indirect, noise })
}

fn add(a: &[Vec3], b: &[Vec3]) -> Picture {
    a.iter().zip(b).map(|(a, b)| *a + *b).collect()
}

/// What cones gather of the light after the first: up to the third scattering, as measured in
/// docs/light.
fn by_cones(case: &Case, camera: &Camera, truth: &Truth, n: u32) -> Outcome<Picture> {
    let how = Gather::Cones { count: 6, step: 0.5, corrected: true };
    let voxels = Voxels::new(&case.scene, n)?;
    let is_lamps = case.scene.lights.is_empty();
    let mut sides = if is_lamps { voxels.emission() } else { voxels.direct(&case.scene.lights)? };
    let mut sky = case.scene.sky;
    let mut sum = vec![Vec3::ZERO; truth.surfaces.len()];
    for order in (if is_lamps { 1 } else { 2 })..=3 {
        let volume = LightVolume::new(&voxels, sides, sky);
        let pixel = |s: &Option<Surface>| -> Result<Vec3, casca::Error> {
            let Some(s) = s else { return Ok(Vec3::ZERO) };
            let (point, normal) = (s.point.as_vec3(), s.normal.as_vec3());
            let spot = Spot { point, normal, look: (point - camera.eye).normalize_or_zero() };
            volume.scattered(&spot, &case.scene.materials[s.material], how)
        };
        let light: Result<Picture, _> = truth.surfaces.par_iter().map(pixel).collect();
        // Direct light of lamps is the truth's.
        if order > 1 {
            sum = add(&sum, &light?);
        }
        sides = volume.bounce(how)?;
        sky = Vec3::ZERO;
    }
    Ok(sum)
}

/// The error of a picture less the noise of the truth, in squares; a bound where noise hides it.
fn less_noise(truth: &[Vec3], found: &[Vec3], noise: f64) -> String {
    let (all, noise) = (error(truth, found), noise / mean(truth));
    let rest = all * all - noise * noise;
    // The noise is itself an estimate.
    match rest > 0.1 * noise * noise {
        true => format!("{:.1}%", 100.0 * rest.sqrt()),
        false => format!("< {:.1}%", 100.0 * noise),
    }
}

fn row(case: &str, how: &str, n: u32, truth: &Truth, direct: &[Vec3], indirect: &[Vec3], time: &str) {
    let (all, found) = (add(&truth.direct, &truth.indirect), add(direct, indirect));
    println!(
        "| {case} | {how} | {n} | {:.3} | {} | {:.3} | {} | {time} |",
        mean(&found) / mean(&all),
        less_noise(&all, &found, truth.noise),
        mean(indirect) / mean(&truth.indirect),
        less_noise(&truth.indirect, indirect, truth.noise),
    );
}

/// Fills a cache for what the pixels show, and asks it; prints its row.
fn by_cache(
    name: &str,
    scene: &Scene,
    truth: &Truth,
    (n, rays): (u32, u32),
    window: Option<Window>,
    materials: &[lit::Material],
) -> Outcome<()> {
    let clock = Instant::now();
    let grid = Grid::around(&scene.objects, n);
    let mut cache =
        Cache::new(scene, Settings { threads: 2, windows: [window, None], ..Settings::new(grid) })?;
    let made = clock.elapsed();
    let shown: Vec<&Surface> = truth.surfaces.iter().flatten().collect();
    for s in &shown {
        cache.request(s.point.as_vec3(), s.normal.as_vec3())?;
    }
    let clock = Instant::now();
    cache.gather(rays)?;
    let gathered = clock.elapsed();
    let clock = Instant::now();
    cache.direct();
    let direct = clock.elapsed();
    let clock = Instant::now();
    let passes = cache.converge(SETTLED, MOST_PASSES);
    let passed = clock.elapsed() / passes;
    let clock = Instant::now();
    let pixel = |s: &Option<Surface>| -> Result<[Vec3; 2], casca_radiosity::LightError> {
        let Some(s) = s else { return Ok([Vec3::ZERO; 2]) };
        let light = cache.irradiance(s.point.as_vec3(), s.normal.as_vec3())?;
        let factor = materials[s.material].albedo / std::f32::consts::PI;
        Ok([light.direct * factor, light.indirect * factor])
    };
    let both: Vec<[Vec3; 2]> = truth.surfaces.iter().map(pixel).collect::<Result<_, _>>()?;
    let asked = clock.elapsed();
    let [of_lights, bounced]: [Picture; 2] = [0, 1].map(|k| both.iter().map(|b| b[k]).collect());
    let s = cache.statistics();
    let time = format!(
        "{:.2} s cells, {:.2} s gather ({:.2} M rays), {:.2} s direct, {passes} passes of {:.1} ms, {:.2} s pixels; {} of {} states, {:.1} MB, {:.3}% dark",
        made.as_secs_f64(),
        gathered.as_secs_f64(),
        s.rays as f64 / MILLION,
        direct.as_secs_f64(),
        passed.as_secs_f64() * 1e3,
        asked.as_secs_f64(),
        s.gathered,
        2 * s.entries,
        s.bytes as f64 / MILLION,
        100.0 * s.dark_rays as f64 / s.rays as f64,
    );
    let finer = window.map_or(String::new(), |w| format!(", {} times finer near the camera", w.finer));
    row(name, &format!("cache, {rays} rays{finer}"), n, truth, &of_lights, &bounced, &time);
    Ok(())
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let of = |i: usize, default: &str| arguments.get(i).cloned().unwrap_or(default.to_owned());
    let names = of(0, "cornell,cornell-point,emissive,house,gallery,street,cave,hall,aisle");
    let sizes = of(1, "128").split(',').map(str::parse).collect::<Result<Vec<u32>, _>>()?;
    let finer = of(4, "1").split(',').map(str::parse).collect::<Result<Vec<u32>, _>>()?;
    let (rays, samples): (u32, u32) = (of(2, "64").parse()?, of(3, "256").parse()?);
    println!("| scene | how | N | mean | block RMSE | indirect mean | its RMSE | times |");
    println!("|---|---|---|---|---|---|---|---|");
    for name in names.split(',') {
        if ["hall", "aisle"].contains(&name) && !Path::new(SPONZA).exists() {
            println!("skipped: {SPONZA} is not here");
            continue;
        }
        let mut case = case(name)?;
        case.scene.materials.iter_mut().for_each(|m| m.specular = Vec3::ZERO);
        let dark = LitScene { sky: Vec3::ZERO, ..case.scene.clone() };
        let tracers = [&case.scene, &dark].map(PathTracer::new);
        let scene = case.input();
        for (view, camera) in &case.cameras {
            let name = format!("{}, {view}", case.name);
            let truth = truth(&tracers, camera, samples)?;
            for &n in &sizes {
                for &finer in &finer {
                    let grid = Grid::around(&scene.objects, n);
                    let half = (grid.max - grid.min).max_element() / WINDOW;
                    let window = (finer > 1).then_some(Window { middle: camera.eye, half, finer });
                    by_cache(&name, &scene, &truth, (n, rays), window, &case.scene.materials)?;
                }
                if case.name != "sponza" || n <= 128 {
                    let cones = by_cones(&case, camera, &truth, n)?;
                    row(&name, "six cones, direct light of the truth", n, &truth, &truth.direct, &cones, "");
                }
            }
            let albedo =
                |s: &Option<Surface>| s.map_or(Vec3::ZERO, |s| case.scene.materials[s.material].albedo);
            let flat: Picture = truth.surfaces.iter().map(albedo).collect();
            // The best constant there is: that of the truth's own mean.
            let scale = (mean(&truth.indirect) / mean(&flat)) as f32;
            let flat: Picture = flat.iter().map(|p| *p * scale).collect();
            row(&name, "constant, best one, direct light of the truth", 0, &truth, &truth.direct, &flat, "");
        }
    }
    Ok(())
}
