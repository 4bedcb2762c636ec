use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use casca::soft::March;
use glam::Vec3;

use super::case::{Case, LAST, generated};
use super::rows::{CONES, WALKS};
use super::shadows::shadow;
use super::voxels::OFF;
use super::*;
use casca_scenes::lit::{HdrImage, Kind, Light, LightKind, LitScene, Material};
use casca_scenes::world::{Camera, Mesh};
use casca_truth::oracle::path::{Quantity, Surface};

const SIZE: (usize, usize) = (20, 15);

/// The picture of a volume of light that is gathered at the surfaces of a scene of white things.
fn gathered(case: &Case, volume: &LightVolume, how: Gather) -> Vec<f32> {
    let image = case.image(|at| volume.gather(at.point.as_vec3(), at.normal.as_vec3(), how, 0.3)).unwrap();
    image.pixels().iter().map(|p| p.x).collect()
}

/// The sum of all pixels and channels.
fn sum(image: &HdrImage) -> f32 {
    image.pixels().iter().map(|p| p.element_sum()).sum()
}

fn truth(case: &Case, order: u32, samples: u32) -> HdrImage {
    let quantity = Quantity::Radiance(order..=order);
    case.tracer.render(&case.scene.camera, case.size, &quantity, samples, 1).unwrap().image
}

#[test]
fn in_a_furnace_all_gather_its_emission() {
    let case = Case::new(Kind::Furnace.build(), SIZE).unwrap();
    for n in [16, 32] {
        let voxels = Voxels::new(&case.scene, n).unwrap();
        // Nothing leaks past exact walks.
        let volume = LightVolume::new(&voxels, voxels.emission(), Vec3::ZERO);
        for value in gathered(&case, &volume, Gather::Walks(32)) {
            assert!((value - 1.0).abs() < 1e-5, "{value}");
        }
        // Cones leak through walls of one cell, and gain no light.
        for value in gathered(&case, &volume, CONES) {
            assert!((0.6..1.0 + 1e-3).contains(&value), "{value}");
        }
        // Where the sky is as bright, leaks do not matter.
        let volume = LightVolume::new(&voxels, voxels.emission(), Vec3::ONE);
        for step in [0.1, 0.5, 2.5] {
            for value in gathered(&case, &volume, Gather::Cones { count: 16, step, corrected: true }) {
                assert!((value - 1.0).abs() < 2e-3, "step {step}: {value}");
            }
        }
    }
}

#[test]
fn bounces_come_near_the_path_tracer() {
    let case = Case::new(Kind::Cornell.build(), SIZE).unwrap();
    let voxels = Voxels::new(&case.scene, 48).unwrap();
    assert_eq!(case.orders(), 1..=LAST);
    for (order, stage) in case.orders().zip(case.stages(&voxels, WALKS).unwrap()) {
        let truth = truth(&case, order, 200);
        for how in [Gather::Walks(1024), CONES] {
            // A few wide cones find a small lamp by luck.
            if how == CONES && order == 1 {
                continue;
            }
            let image = case.gathered(&stage.volume, how).unwrap().0;
            let Difference { rmse, flip } = difference(&truth, &image).unwrap();
            assert!(rmse < 0.7 && flip < 0.35, "order {order}, {how:?}: {rmse} {flip}");
            let share = sum(&image) / sum(&truth);
            assert!((0.6..1.4).contains(&share), "order {order}, {how:?}: {share}");
        }
    }
}

/// The pictures of all orders from the second on.
fn later(scene: LitScene) -> Vec<HdrImage> {
    let case = Case::new(scene, SIZE).unwrap();
    let voxels = Voxels::new(&case.scene, 24).unwrap();
    let stages = case.stages(&voxels, WALKS).unwrap();
    let from_second = stages.iter().skip(1 - case.held as usize);
    from_second.map(|s| case.gathered(&s.volume, WALKS).unwrap().0).collect()
}

#[test]
fn lights_and_emitters_together_give_the_sum_of_each_alone() {
    let lamp = generated(Kind::Cornell);
    let both = LitScene { lights: generated(Kind::CornellPoint).lights, ..lamp.clone() };
    let mut point = both.clone();
    point.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
    let [lamp, point, both] = [lamp, point, both].map(later);
    assert_eq!([lamp.len(), point.len(), both.len()], [2; 3]);
    for ((a, b), c) in lamp.iter().zip(&point).zip(&both) {
        assert!(sum(a) > 0.1 * sum(c) && sum(b) > 0.1 * sum(c));
        for ((a, b), c) in a.pixels().iter().zip(b.pixels()).zip(c.pixels()) {
            assert!((*a + *b - *c).abs().max_element() <= 1e-3 * (1.0 + c.max_element()), "{a} {b} {c}");
        }
    }
}

#[test]
fn light_of_the_sky_enters_once() {
    let mut scene = generated(Kind::Plane);
    scene.objects.truncate(1);
    scene.sky = Vec3::ONE;
    // Nothing lies above the plate: it scatters light once.
    scene.lights.clear();
    let case = Case::new(scene.clone(), SIZE).unwrap();
    let voxels = Voxels::new(&case.scene, 24).unwrap();
    let stages = case.stages(&voxels, WALKS).unwrap();
    let light = |stage: &case::Stage| sum(&case.gathered(&stage.volume, WALKS).unwrap().0);
    assert!(light(&stages[0]) > 1.0);
    assert_eq!([light(&stages[1]), light(&stages[2])], [0.0; 2]);
    // The same beside a light that gives nothing.
    scene.lights.push(Light::point(Vec3::Y, Vec3::ZERO));
    assert!(later(scene).iter().all(|image| sum(image) == 0.0));
}

#[test]
fn reflections_come_near_the_path_tracer() {
    for gloss in [0.0, 0.4, 0.8] {
        let case = Case::new(gloss::scene(gloss), SIZE).unwrap();
        assert!(case.surfaces.iter().flatten().all(|s| case.materials[s.material].specular.x > 0.0));
        let voxels = Voxels::new(&case.scene, 48).unwrap();
        let stages = case.stages(&voxels, WALKS).unwrap();
        let truth = truth(&case, 2, 400);
        for (how, most) in [(Gather::Walks(256), 0.15), (CONES, 0.35)] {
            // A single cone as wide as a dull lobe sinks into the floor.
            if how == CONES && gloss < 0.4 {
                continue;
            }
            let image = case.gathered(&stages[1].volume, how).unwrap().0;
            let (share, found) = (sum(&image) / sum(&truth), difference(&truth, &image).unwrap());
            assert!((1.0 - most..1.0 + most).contains(&share), "{gloss} {how:?}: {share}");
            // A sharp reflection shows the single voxels around the lamp.
            assert!(found.rmse < if gloss < 0.5 { 0.4 } else { 0.9 }, "{gloss} {how:?}: {found:?}");
        }
    }
}

#[test]
fn a_lobe_under_an_even_sky_reflects_the_cosine() {
    let scene = LitScene { objects: Vec::new(), ..Kind::Plane.build() };
    let voxels = Voxels::new(&scene, 8).unwrap();
    let volume = LightVolume::new(&voxels, Vec::new(), Vec3::ONE);
    for (gloss, slope) in [(0.9, 0.5f32), (0.9, 0.1), (0.5, 0.0)] {
        let look = Vec3::new(slope, -1.0, 0.0).normalize();
        let at = Spot { point: Vec3::ZERO, normal: Vec3::Y, look };
        let material = Material { specular: Vec3::splat(0.5), gloss, ..Material::matt(Vec3::ZERO) };
        for how in [CONES, Gather::Walks(512)] {
            let light = volume.scattered(&at, &material, how).unwrap().x;
            assert!((light + 0.5 * look.y).abs() < 0.01, "{gloss} {slope} {how:?}: {light}");
        }
        // Looked at from below it shows nothing.
        let below = Spot { look: -look, ..at };
        assert_eq!(volume.scattered(&below, &material, CONES).unwrap(), Vec3::ZERO);
    }
}

#[test]
fn shadows_of_a_sun_that_grazes_a_wall_err_by_the_start_of_rays_not_by_voxels() {
    let mut scene = Kind::Plane.build();
    scene.objects.truncate(2);
    // A wall, and a ledge on it that shades the two metres below.
    let boxes = [([-0.5, 0.0, -2.0], [0.0, 4.0, 2.0]), ([0.0, 3.0, -2.0], [0.24, 3.2, 2.0])];
    for (object, (min, max)) in scene.objects.iter_mut().zip(boxes) {
        object.mesh = Arc::new(Mesh::cuboid(min.into(), max.into()));
    }
    let sun = Vec3::new(0.12, 1.0, 0.0).normalize();
    scene.lights[0].kind = LightKind::Directional { direction: -sun, half_angle: 0.0 };
    scene.camera = Camera::look_at(Vec3::new(4.0, 2.0, 0.0), Vec3::Y * 2.0, 60.0, 4.0 / 3.0, 0.01, 100.0);
    let case = Case::new(scene, (48, 36)).unwrap();
    let truth = case.tracer.render(&case.scene.camera, case.size, &Quantity::Shadow(0), 1, 1).unwrap().image;
    let exact = |off: f32| {
        let open = |at: &Surface| {
            let hit = || case.tracer.hit(at.point + at.normal * f64::from(off), sun.as_dvec3());
            at.normal.dot(sun.as_dvec3()) > 0.0 && hit().is_none()
        };
        case.image(|at| Ok::<_, LabError>(Vec3::splat(f32::from(u8::from(open(at)))))).unwrap()
    };
    let error = |image: &HdrImage| difference(&truth, image).unwrap().rmse;
    assert!(error(&exact(1e-4)) < 0.05);
    let mut before = f64::INFINITY;
    for n in [32, 64, 128] {
        let voxels = Voxels::new(&case.scene, n).unwrap();
        let share = |at: &Surface| shadow(&case, &voxels, at, &March::Rays(1)).map(Vec3::splat);
        let (found, start) = (error(&case.image(share).unwrap()), error(&exact(OFF * voxels.cell)));
        println!("N = {n}: voxels err by {found:.2}, exact rays from the same start by {start:.2}");
        // Cells make the ledge wider by less than a cell, which mends a part of what the start
        // errs.
        assert!(
            start > 0.5 && start < before && (0.6..1.1).contains(&(found / start)),
            "{n}: {found} {start}"
        );
        before = start;
    }
}

#[test]
fn lamps_light_the_surface_that_they_are_near() {
    let scene = Kind::Plane.build();
    let voxels = Voxels::new(&scene, 32).unwrap();
    let (point, off) = (Vec3::new(0.6, 0.0, 0.7), voxels.cell);
    let lit = |cells: f32, side: f32| {
        let lamp = Light::point(point + Vec3::new(0.1, 1.0, 0.0) * (cells * off), Vec3::ONE);
        voxels.lit(&[lamp], point, Vec3::Y * side).unwrap().x
    };
    for cells in [0.2, 0.9, 1.7, 1.9, 2.6, 3.4, 3.7, 6.0] {
        let expected = 1.0 / (cells * off).powi(2) / (1.0f32 + 0.01).powf(1.5);
        let found = lit(cells, 1.0);
        assert!((found / expected - 1.0).abs() < 1e-3, "{cells} cells: {found}, not {expected}");
        assert_eq!(lit(cells, -1.0), 0.0);
    }
    // The block hides a lamp behind it.
    let hidden = Light::point(Vec3::new(-1.6, 0.3, -0.85), Vec3::ONE);
    assert_eq!(voxels.lit(&[hidden], Vec3::new(0.0, 0.0, -0.85), Vec3::Y).unwrap(), Vec3::ZERO);
}

#[test]
fn rooms_are_not_filled_and_solids_are() {
    let inside = Vec3::new(2.0, 1.25, 1.5);
    let mut scene = Kind::Emissive.build();
    scene.objects.truncate(1);
    let room = scene.objects[0].clone();
    let filled = |before: &[[u32; 3]], turned: bool| {
        let mut mesh = Mesh::clone(&room.mesh);
        mesh.positions.extend([Vec3::new(1.0, 0.1, 0.1), Vec3::new(1.1, 0.1, 0.1), Vec3::new(1.0, 0.2, 0.1)]);
        if turned {
            mesh.triangles.iter_mut().for_each(|t| t.reverse());
        }
        mesh.triangles.splice(0..0, before.iter().copied());
        let mut scene = scene.clone();
        scene.objects[0].materials = vec![room.materials[0]; mesh.triangles.len()].into();
        scene.objects[0].mesh = Arc::new(mesh);
        let voxels = Voxels::new(&scene, 24).unwrap();
        voxels.at(voxels.to_cells(inside).floor().as_ivec3()).is_some()
    };
    // Triangles without area, and a loose one.
    let (point, line, loose) = ([0, 0, 0], [0, 1, 1], [8, 9, 10]);
    for before in [&[][..], &[point], &[line], &[loose], &[point, line, loose], &[line, point]] {
        assert!(!filled(before, false), "{before:?}");
    }
    assert!(filled(&[], true) && filled(&[point], true));
}

#[test]
fn a_sheet_is_lit_on_one_side_only() {
    let mut scene = Kind::Plane.build();
    scene.lights[0] = Light::point(Vec3::new(0.0, 4.0, 0.0), Vec3::ONE);
    let voxels = Voxels::new(&scene, 32).unwrap();
    let sides = voxels.direct(&scene.lights).unwrap();
    let plate: Vec<usize> = (0..voxels.voxels.len()).filter(|&v| voxels.voxels[v].normal.y > 0.99).collect();
    assert!(plate.len() > 300);
    let lit = plate.iter().filter(|&&v| sides[v][0].x > 0.0).count();
    assert!(lit > plate.len() / 2, "{lit}");
    assert!(plate.iter().all(|&v| sides[v][1] == Vec3::ZERO));
    // Every voxel has a share of its material: white.
    assert!(plate.iter().all(|&v| (voxels.voxels[v].albedo - 0.73).abs().max_element() < 1e-4));
}

#[test]
fn differences_are_those_of_the_reference_implementation() {
    // A ramp, and the same with a bright square.
    let ramp: Vec<Vec3> = (0..64 * 48).map(|i| Vec3::splat((i % 64) as f32 / 63.0)).collect();
    let mut square = ramp.clone();
    for y in 16..32 {
        square[y * 64 + 24..y * 64 + 40].fill(Vec3::new(1.0, 0.2, 0.2));
    }
    let (a, b) = (HdrImage::new(64, 48, ramp).unwrap(), HdrImage::new(64, 48, square).unwrap());
    assert_eq!(difference(&a, &a).unwrap(), Difference::default());
    let found = difference(&a, &b).unwrap();
    assert!((found.flip - REFERENCE).abs() < 2e-3, "{found:?}");
    assert!(difference(&a, &HdrImage::new(48, 64, Vec::new()).unwrap()).is_err());
    let map = metric::flip_map(&a, &b);
    // Black where they are equal.
    assert!(map[..3].iter().all(|&c| c < 8) && map[3 * (24 * 64 + 32)] > 100, "{:?}", &map[..3]);
}

#[test]
fn noise_is_known_and_taken_out_of_errors() {
    let case = Case::new(generated(Kind::Emissive), SIZE).unwrap();
    let truth = |seed| {
        let lab =
            Lab { quick: true, seed, files: Vec::new(), folder: std::env::temp_dir(), progress: &|_| () };
        case.truth(&lab, &Quantity::Ambient(1.0)).unwrap()
    };
    let (a, b) = (truth(1), truth(2));
    // Two pictures with the same noise differ by the root of the sum of both squares.
    let apart = difference(&a.image, &b.image).unwrap().rmse;
    let noise = a.noise.hypot(b.noise);
    assert!(noise > 0.05 && (apart / noise - 1.0).abs() < 0.1, "{apart} {noise}");
    assert!((metric::less_noise(0.5, 0.3) - 0.4).abs() < 1e-12);
    assert_eq!(metric::less_noise(0.5, 0.0), 0.5);
    // What noise hides is left out of tables and charts.
    assert_eq!(rows::digits(metric::less_noise(0.3, 0.29)), "");
    assert_eq!(rows::mean_of([1.0, f64::NAN, 3.0].into_iter()), 2.0);
}

#[test]
fn what_cannot_be_compared_is_no_perfect_match() {
    let image = |v: Vec3| HdrImage::new(2, 2, vec![v; 4]).unwrap();
    let error = |truth, found| difference(&image(truth), &image(found)).unwrap_err().to_string();
    assert!(error(Vec3::ONE, Vec3::NAN).contains("4 of 4 pixels of the picture that was found"));
    assert!(error(Vec3::INFINITY, Vec3::ONE).contains("of the truth"));
    assert!(error(Vec3::ZERO, Vec3::ZERO).contains("black"));
    // What the library refuses is refused.
    let case = Case::new(Kind::Plane.build(), (4, 3)).unwrap();
    let voxels = Voxels::new(&case.scene, 8).unwrap();
    let volume = LightVolume::new(&voxels, voxels.emission(), Vec3::ZERO);
    let broken = case.image(|at| volume.gather(at.point.as_vec3() * f32::NAN, Vec3::Y, WALKS, 0.0));
    assert!(broken.unwrap_err().to_string().contains("finite"));
}

#[test]
fn broken_triangles_and_materials_are_left_out() {
    let mut scene = Kind::Plane.build();
    let whole = Voxels::new(&scene, 16).unwrap();
    let mut object = scene.objects[0].clone();
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::NAN, Vec3::Y];
    let triangles = vec![[0, 1, 2], [0, 1, 9], [u32::MAX, 0, 1], [0, 1, 3], [0, 0, 0], [0, 1, 1]];
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    assert!(!mesh.is_closed());
    object.mesh = Arc::new(mesh);
    object.materials = vec![0, 0, 0, 77, 0, 0].into();
    scene.objects.push(object);
    let found = Voxels::new(&scene, 16).unwrap();
    assert_eq!(found.voxels.len(), whole.voxels.len());
    scene.materials.iter_mut().for_each(|m| (m.albedo, m.emission) = (Vec3::NAN, Vec3::INFINITY));
    let voxels = Voxels::new(&scene, 16).unwrap();
    assert!(voxels.voxels.iter().all(|v| v.albedo == Vec3::ZERO && v.emission == Vec3::ZERO));
    scene.objects[0].transform.translation.x = 3e38;
    scene.objects[1].transform.translation.x = -3e38;
    // What is so far away is left out as well.
    let far = Voxels::new(&scene, 16).unwrap();
    scene.objects.drain(..2);
    assert_eq!(far.voxels.len(), Voxels::new(&scene, 16).unwrap().voxels.len());
}

#[test]
fn light_is_gathered_at_surfaces_alone() {
    let voxels = Voxels::new(&Kind::Plane.build(), 64).unwrap();
    let deep = voxels.voxels.iter().filter(|v| v.point.is_none()).count();
    assert!(deep > 10, "the plate has cells inside: {deep}");
    let asked = AtomicUsize::new(0);
    let sides = voxels
        .sides(|v, point, _| {
            asked.fetch_add(1, Ordering::Relaxed);
            assert!(v.albedo.x > 0.0 && point.y > -1.0);
            Ok(Vec3::ONE)
        })
        .unwrap();
    assert_eq!(asked.into_inner(), 2 * (voxels.voxels.len() - deep));
    let black = |(v, s): (&Voxel, &[Vec3; 2])| (s[0] == Vec3::ZERO) == v.point.is_none();
    assert!(voxels.voxels.iter().zip(&sides).all(black));
}

/// What NVIDIA's flip-evaluator 1.7 says of these pictures.
const REFERENCE: f64 = 0.0945;

#[test]
fn sizes_out_of_range_are_refused_and_an_empty_scene_is_dark() {
    let mut scene = Kind::Plane.build();
    for n in [0, 7, 257, u32::MAX] {
        assert!(Voxels::new(&scene, n).err().unwrap().to_string().contains("8 to 256"));
    }
    scene.objects.clear();
    let voxels = Voxels::new(&scene, 8).unwrap();
    let volume = LightVolume::new(&voxels, voxels.emission(), Vec3::ZERO);
    for how in [CONES, Gather::Walks(8), Gather::Walks(0)] {
        assert_eq!(volume.gather(Vec3::ZERO, Vec3::Y, how, 0.0).unwrap(), Vec3::ZERO);
    }
}
