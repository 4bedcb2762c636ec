//! Against closed forms.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec2, Vec3, Vec4};

use super::*;
use crate::lit::{Kind, LitObject};
use casca_scenes::random::generator;
use casca_scenes::world::Mesh;

/// A scene of meshes, each of one material, without light.
fn scene(parts: Vec<(Mesh, Material)>) -> LitScene {
    let mut scene = Kind::CornellPoint.build();
    (scene.objects, scene.materials, scene.lights) = (Vec::new(), Vec::new(), Vec::new());
    for (i, (mesh, material)) in parts.into_iter().enumerate() {
        let materials = vec![i as u32; mesh.triangles.len()].into();
        let (mesh, transform) = (Arc::new(mesh), Affine3A::IDENTITY);
        scene.objects.push(LitObject { mesh, materials, uv: Arc::default(), transform });
        scene.materials.push(material);
    }
    scene
}

fn quad(corners: [Vec3; 4]) -> Mesh {
    Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// The square of 2 `half` metres at a height.
fn square(height: f32, half: f32) -> Mesh {
    let at = |x: f32, z: f32| Vec3::new(x * half, height, z * half);
    quad([at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)])
}

const WHITE: Material = Material::matt(Vec3::ONE);

/// The radiance of an order that leaves the surface straight above or below `point` along the way
/// to it, and its standard error.
fn look(
    tracer: &PathTracer,
    from: DVec3,
    to: DVec3,
    orders: RangeInclusive<u32>,
    samples: u32,
) -> (f64, f64) {
    let direction = (to - from).normalize();
    let seen = tracer.hit(from, direction);
    let mut random = generator(7, 0);
    let (mean, error) = mean(samples, || tracer.radiance(seen, direction, &orders, &mut random));
    (f64::from(mean.x), f64::from(error.x))
}

fn near(found: f64, truth: f64, error: f64) {
    assert!((found - truth).abs() <= error, "{found} instead of {truth}, {error} allowed");
}

#[test]
fn in_a_furnace_every_order_has_its_share_of_the_emission() {
    let walls = Material { albedo: Vec3::splat(0.5), emission: Vec3::splat(2.0), ..WHITE };
    let tracer = PathTracer::new(&scene(vec![
        (Mesh::cuboid(Vec3::ZERO, Vec3::new(2.0, 1.0, 1.5)), walls),
        (Mesh::cuboid(Vec3::splat(0.3), Vec3::splat(0.6)), walls),
    ]));
    for target in [DVec3::new(1.7, 0.01, 0.02), DVec3::new(0.45, 0.6, 0.45), DVec3::new(1.0, 1.0, 1.0)] {
        for order in 0..5 {
            let truth = 2.0 * 0.5f64.powi(order);
            let (found, error) =
                look(&tracer, DVec3::new(1.1, 0.7, 0.7), target, order as u32..=order as u32, 4000);
            assert!(error < 0.03 * truth, "{error}");
            near(found, truth, 5.0 * error + 1e-6);
        }
        // All orders: E / (1 - albedo).
        let (found, error) = look(&tracer, DVec3::new(1.1, 0.7, 0.7), target, 0..=40, 2000);
        near(found, 4.0, 5.0 * error);
    }
    // A surface that reflects all of it under a sky that is as bright everywhere cannot be told
    // from the sky.
    let mut open = scene(vec![(Mesh::ball(2), WHITE)]);
    open.sky = Vec3::splat(3.0);
    open.camera = Camera::look_at(Vec3::new(2.6, 2.4, 3.4), Vec3::ZERO, 60.0, 1.0, 0.01, 100.0);
    let image = PathTracer::new(&open).render(&open.camera, (16, 12), &(0..=1), 4, 1).unwrap().image;
    assert!(image.iter().all(|p| (*p - open.sky).abs().max_element() < 1e-5));
}

#[test]
fn a_light_over_a_plane_shines_as_its_closed_form_says() {
    let mut plane = scene(vec![(square(0.0, 5.0), Material::matt(Vec3::splat(0.5)))]);
    let position = Vec3::new(0.5, 2.0, 0.25);
    // A ball of light with all of it above the horizon gives as much as its centre; it is chosen by
    // chance.
    for (radius, samples) in [(0.0, 1), (0.5, 20_000)] {
        plane.lights = vec![Light::Point { position, intensity: Vec3::splat(10.0), radius }];
        let tracer = PathTracer::new(&plane);
        for x in [-3.0, 0.0, 2.0] {
            let to = DVec3::new(x, 0.0, 1.0);
            let way = position.as_dvec3() - to;
            let truth = 0.5 / PI * 10.0 * way.y / way.length().powi(3);
            let (found, error) = look(&tracer, DVec3::new(0.0, 1.0, 0.0), to, 1..=1, samples);
            near(found, truth, 5.0 * error + 1e-6 * truth);
            assert!(radius == 0.0 || error > 0.0);
        }
    }
    // The sun, and nothing of it below the plane.
    let direction = Vec3::new(0.0, -3.0, 4.0);
    plane.lights = vec![Light::Sun { direction, irradiance: Vec3::splat(2.0), half_angle: 0.1 }];
    let tracer = PathTracer::new(&plane);
    let (found, error) = look(&tracer, DVec3::Y, DVec3::X, 1..=1, 5000);
    near(found, 0.5 / PI * 2.0 * 0.6, 5.0 * error);
    assert_eq!(look(&tracer, DVec3::NEG_Y, DVec3::X, 0..=3, 50).0, 0.0);
}

/// Lambert's formula (1760) for the irradiance by a polygon of radiance 1 that lies above the
/// horizon.
fn lambert(corners: &[DVec3], point: DVec3, normal: DVec3) -> f64 {
    let units: Vec<DVec3> = corners.iter().map(|c| (*c - point).normalize()).collect();
    let sum: f64 = (0..units.len())
        .map(|i| {
            let (a, b) = (units[i], units[(i + 1) % units.len()]);
            a.angle_between(b) * a.cross(b).normalize().dot(normal)
        })
        .sum();
    sum.abs() / 2.0
}

#[test]
fn lights_and_emitters_together_shine_as_the_sum_of_their_closed_forms() {
    let floor = |gloss| match gloss {
        0.0 => Material::matt(Vec3::splat(0.5)),
        _ => Material { specular: Vec3::splat(0.3), gloss, ..Material::matt(Vec3::splat(0.5)) },
    };
    let lit = |lamp: &Mesh, gloss: f32, emission: f32, intensity: f32| {
        let emitter = Material::emitter(Vec3::splat(emission));
        let mut all = scene(vec![(square(0.0, 5.0), floor(gloss)), (lamp.clone(), emitter)]);
        // Two lights below the lamp: one of them is a ball.
        let at = |position, radius| Light::Point { position, intensity: Vec3::splat(intensity), radius };
        all.lights = vec![at(Vec3::new(0.5, 1.0, 0.25), 0.0), at(Vec3::new(-1.0, 1.5, 0.0), 0.3)];
        PathTracer::new(&all)
    };
    for (x, tilt) in [(-1.5, 0.6), (0.0, 0.0), (2.0, -0.3)] {
        let mut lamp = square(0.0, 0.7);
        lamp.positions.iter_mut().for_each(|p| *p = Quat::from_rotation_x(tilt) * *p + Vec3::Y * 2.0);
        let corners: Vec<DVec3> = lamp.positions.iter().map(|p| p.as_dvec3()).collect();
        let (from, to) = (DVec3::new(x + 0.4, 0.5, 0.2), DVec3::new(x, 0.0, 0.5));
        let (found, error) = look(&lit(&lamp, 0.0, 3.0, 4.0), from, to, 1..=1, 20_000);
        let by = |position: DVec3| 4.0 * position.y / (position - to).length().powi(3);
        let lights = by(DVec3::new(0.5, 1.0, 0.25)) + by(DVec3::new(-1.0, 1.5, 0.0));
        let truth = 0.5 / PI * (3.0 * lambert(&corners, to, DVec3::Y) + lights);
        assert!(error < 0.01 * truth, "{error} of {truth}");
        near(found, truth, 5.0 * error);
        // A glossy floor has no closed form: the parts add up.
        for gloss in [0.3, 0.8] {
            let parts = [(3.0, 4.0), (3.0, 0.0), (0.0, 4.0)];
            let of = |(l, p)| look(&lit(&lamp, gloss, l, p), from, to, 1..=2, 20_000);
            let [both, lamps, lights] = parts.map(of);
            near(both.0, lamps.0 + lights.0, 5.0 * (both.1 + lamps.1 + lights.1));
        }
    }
}

#[test]
fn a_ceiling_takes_its_form_factor_of_the_sky() {
    let ceiling = square(1.0, 0.7);
    let corners: Vec<DVec3> = ceiling.positions.iter().map(|p| p.as_dvec3()).collect();
    let grey = Material::matt(Vec3::splat(0.5));
    let mut room = scene(vec![(square(0.0, 5.0), grey), (ceiling, Material::matt(Vec3::ZERO))]);
    room.sky = Vec3::splat(3.0);
    let tracer = PathTracer::new(&room);
    for x in [0.0, 0.8, 2.0] {
        let to = DVec3::new(x, 0.0, 0.3);
        let open = 1.0 - lambert(&corners, to, DVec3::Y) / PI;
        let from = to + DVec3::Y * 0.5;
        let (found, error) = look(&tracer, from, to, 1..=1, 10_000);
        near(found, 0.5 * 3.0 * open, 5.0 * error);
    }
}

#[test]
fn glossy_surfaces_lose_light_but_make_none() {
    for gloss in [0.0, 0.4, 0.9] {
        let shiny = Material { specular: Vec3::ONE, gloss, ..Material::matt(Vec3::ZERO) };
        let mut open = scene(vec![(square(0.0, 4.0), shiny)]);
        open.sky = Vec3::ONE;
        let tracer = PathTracer::new(&open);
        for (from, least) in [(DVec3::Y, 0.98), (DVec3::new(0.0, 1.0, 4.0), 0.1)] {
            let (found, error) = look(&tracer, from, DVec3::ZERO, 1..=1, 4000);
            // With exponent 2 a third of the lobe's factor n + 2 over n + 1 is lost to the cosine,
            // head-on.
            let least = if gloss == 0.0 { 0.5 * least } else { least };
            assert!(found <= 1.0 + 5.0 * error && found > least, "{gloss}: {found} +- {error}");
        }
        // A lamp in the mirror direction: found by its points as well as by scattered rays.
        let mut lit =
            scene(vec![(square(0.0, 4.0), shiny), (square(1.0, 0.8), Material::emitter(Vec3::ONE))]);
        lit.sky = Vec3::ZERO;
        let (found, error) =
            look(&PathTracer::new(&lit), DVec3::new(0.0, 0.5, 0.0), DVec3::ZERO, 1..=1, 20_000);
        // The lobe around straight up, over the square, in cells.
        let exponent = (11.0 * f64::from(gloss) + 1.0).exp2();
        let n = 1000;
        let place = |k: i32| 1.6 * ((f64::from(k) + 0.5) / f64::from(n) - 0.5);
        let cell = (1.6 / f64::from(n)).powi(2);
        let cells = (0..n * n).map(|i| DVec3::new(place(i % n), 1.0, place(i / n)).length_squared());
        let truth: f64 = cells
            .map(|s| (exponent + 2.0) / (2.0 * PI) * s.sqrt().recip().powf(exponent + 2.0) / s * cell)
            .sum();
        near(found, truth, 5.0 * error + 1e-3);
    }
}

#[test]
fn an_edge_before_the_middle_of_a_ball_of_light_hides_half_of_it() {
    let at = |x: f32, z: f32| Vec3::new(x, 1.5, z);
    let shade = quad([at(0.001, 99.0), at(0.001, 101.0), at(9.0, 101.0), at(9.0, 99.0)]);
    let mut shaded = scene(vec![(square(0.0, 100.0), WHITE), (shade, WHITE)]);
    let (eye, target) = (DVec3::new(0.05, 1.0, 100.0), DVec3::new(0.001, 0.0, 100.0));
    let position = Vec3::new(0.001, 3.0, 100.0);
    shaded.lights = vec![Light::Point { position, intensity: Vec3::ONE, radius: 0.5 }];
    let (half, error) = look(&PathTracer::new(&shaded), eye, target, 1..=1, 4000);
    shaded.objects.pop();
    let (whole, _) = look(&PathTracer::new(&shaded), eye, target, 1..=1, 4000);
    near(half / whole, 0.5, 5.0 * error / whole + 0.01);
}

#[test]
fn pictures_do_not_depend_on_threads_but_on_the_seed() {
    let scene = Kind::Cornell.build();
    let tracer = PathTracer::new(&scene);
    let picture = |seed| tracer.render(&scene.camera, (12, 9), &(0..=3), 8, seed).unwrap();
    let here = picture(1).image;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| picture(1)).image, here);
    assert_ne!(picture(2).image, here);
    // The red wall is on the left, the green one on the right.
    let row = &here[4 * 12..5 * 12];
    assert!(row[2].x > 2.0 * row[2].y && row[9].y > 1.5 * row[9].x, "{row:?}");
}

#[test]
fn broken_input_gives_errors_or_darkness() {
    let mut broken = Kind::Cornell.build();
    let size = |w, h| PathTracer::new(&broken).render(&broken.camera, (w, h), &(1..=1), 1, 1);
    assert_eq!(size(0, 5).unwrap_err(), SizeError { width: 0, height: 5 });
    assert!(size(usize::MAX, 2).unwrap_err().to_string().contains("must be 1 to"));
    for m in &mut broken.materials {
        (m.albedo, m.emission, m.gloss) = (Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY), f32::NAN);
    }
    broken.sky = Vec3::NAN;
    broken.lights = vec![Light::point(Vec3::NAN, Vec3::ONE), Light::point(Vec3::ONE, Vec3::NAN)];
    let black = |scene: &LitScene| {
        let tracer = PathTracer::new(scene);
        let render = tracer.render(&scene.camera, (4, 3), &(0..=u32::MAX), 1, 1).unwrap();
        assert!(render.image.iter().all(|p| *p == Vec3::ZERO));
    };
    black(&broken);
    broken.camera.eye = Vec3::NAN;
    black(&broken);
    broken.objects.clear();
    black(&broken);
}

#[test]
fn light_passes_panes_and_the_backs_of_single_sided_sheets() {
    let sides = |sides| Material { sides, ..Material::matt(Vec3::ZERO) };
    let lamp = |sides| Material { sides, ..Material::emitter(Vec3::ONE) };
    // A floor, a sheet over it whose front looks up, and a light over both.
    let lit = |sheet: Material, over: Option<Material>| {
        let mut all = scene(vec![(square(0.0, 5.0), WHITE), (square(1.0, 2.0), sheet)]);
        if let Some(over) = over {
            let lamp = scene(vec![(square(2.0, 1.0), over)]);
            all.objects
                .extend(lamp.objects.into_iter().map(|o| LitObject { materials: vec![2; 2].into(), ..o }));
            all.materials.push(over);
        } else {
            all.lights = vec![Light::point(Vec3::new(0.0, 2.0, 0.0), Vec3::ONE)];
        }
        let tracer = PathTracer::new(&all);
        look(&tracer, DVec3::new(0.0, 0.5, 0.2), DVec3::new(0.0, 0.0, 0.2), 1..=1, 200).0
    };
    use casca_scenes::world::Sides::{Both, Front, Neither};
    // What looks at the back of a sheet sees the light behind it.
    assert_eq!(lit(sides(Both), None), 0.0);
    assert!(lit(sides(Front), None) > 0.0 && lit(sides(Front), None) == lit(sides(Neither), None));
    assert!(lit(sides(Front), Some(lamp(Both))) > 0.0);
    assert!(lit(sides(Neither), Some(lamp(Both))) > 0.0);
    assert_eq!(lit(sides(Neither), Some(lamp(Front))), 0.0);
    // From below, the sheet shows its back: the light above is seen through it.
    let mut all = scene(vec![(square(1.0, 2.0), sides(Front)), (square(2.0, 1.0), lamp(Both))]);
    all.sky = Vec3::ZERO;
    let through = |all: &LitScene, y: f64, to: f64| {
        PathTracer::new(all).hit(DVec3::new(0.3, y, 0.2), DVec3::new(0.0, to, 0.0)).map(|s| s.material)
    };
    assert_eq!((through(&all, 0.0, 1.0), through(&all, 1.5, -1.0)), (Some(1), Some(0)));
    // A mirror does not turn the front of an object: the same sheet, upside down.
    all.objects[0].transform = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
    assert_eq!((through(&all, -2.0, 1.0), through(&all, 0.0, -1.0)), (Some(0), None));
}

#[test]
fn textures_have_their_colours_and_holes_where_they_are_painted() {
    let paint = Material { texture: Some(0), ..WHITE };
    let mut all = scene(vec![(square(0.0, 4.0), WHITE), (square(1.0, 4.0), paint)]);
    all.textures = vec![Texture::new(2, 2, [Vec4::ONE, Vec4::W, Vec4::ZERO, Vec4::ONE]).unwrap()];
    // Tiles of half a metre.
    let [a, b, c, d] = [Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X].map(|p| p * 16.0);
    all.objects[1].uv = [[a, b, c], [a, c, d]].into();
    let down = Vec3::new(0.0, -1.0, 0.0);
    all.lights = vec![Light::Sun { direction: down, irradiance: Vec3::splat(2.0), half_angle: 0.0 }];
    let tracer = PathTracer::new(&all);
    for i in 0..200 {
        let point = DVec3::new(f64::from(i % 20) * 0.31 - 3.033, 0.0, f64::from(i / 20) * 0.57 - 2.9);
        let tile = [point.x, point.z].map(|c| ((c + 4.0) * 2.0).fract() < 0.5);
        let is_open = tile == [true, false];
        let seen = tracer.hit(point + DVec3::Y * 3.0, down.as_dvec3()).unwrap();
        assert_eq!((seen.point.y, seen.material), if is_open { (0.0, 0) } else { (1.0, 1) }, "{point}");
        let colour = if tile == [false, true] { Vec3::ZERO } else { Vec3::ONE };
        assert_eq!(seen.colour, colour, "{point}");
        // What the sun gives the floor through holes, and the sheet, whose texels reflect it.
        let found = look(&tracer, point + DVec3::Y * 0.5, point, 1..=1, 1).0;
        near(found, if is_open { 2.0 / PI } else { 0.0 }, 1e-6);
        let found = look(&tracer, point + DVec3::Y * 3.0, point, 1..=1, 1).0;
        near(found, 2.0 / PI * f64::from(colour.x), 1e-6);
    }
}
