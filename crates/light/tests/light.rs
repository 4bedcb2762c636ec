//! Light against closed forms, brute force, and itself done another way. Needs any adapter; a
//! software one will do. (`missing_docs` holds for tests, too.)

mod common;

use std::f32::consts::PI;

use casca_light::cones::ConeCount;
use casca_light::culling::{Culling, may_see};
use casca_light::picture::Layer;
use casca_light::renderer::{Renderer, Settings, Updated};
use casca_light::volume::Volume;
use casca_scenes::lit::{Falloff, Kind, Light, LightKind, LitScene, Material};
use casca_scenes::world::Camera;
use casca_stage::gpu::Gpu;
use casca_stage::timing::Clock;
use common::{ball, draw, gpu, light, texels, wall_scene};
use glam::{Affine3A, Vec3};

/// A wide cone reads a wall in parts, from two mips. The parts do not always add up to 1. This is
/// the greatest loss of light that the test accepts, on the mean of the pixels.
const FURNACE: f32 = 0.05;
/// The greatest loss of light that the test accepts in one pixel.
const FURNACE_PIXEL: f32 = 0.15;
/// The share of bricks that pictures of the hall may read.
const HALL_READ: f64 = 0.75;
/// Numbers from 0 to 1 in half floats, after five steps.
const HALF: f32 = 1e-3;

fn settings(resolution: u32) -> Settings {
    Settings { resolution, ..Settings::default() }
}

fn updated(gpu: &Gpu, scene: &LitScene, settings: Settings) -> Renderer {
    let mut renderer = Renderer::new(gpu, scene, settings).unwrap();
    renderer.update(gpu, None, &mut Clock::off()).unwrap();
    renderer
}

#[test]
fn in_a_furnace_every_surface_gathers_what_the_walls_emit() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Kind::Furnace.build();
    // A ball that emits as much, for its voxels are among those that it gathers from.
    scene.materials.push(Material { emission: Vec3::ONE, ..Material::matt(Vec3::ONE) });
    scene.objects.push(ball(scene.materials.len() as u32 - 1, Vec3::new(2.0, 1.5, 1.2), 0.5));
    for (step, cones) in [(0.25, ConeCount::Six), (1.0, ConeCount::Six), (1.0, ConeCount::Sixteen)] {
        let mut renderer = updated(&gpu, &scene, Settings { step, cones, bounce: false, ..settings(48) });
        let gathered = draw(&gpu, &mut renderer, &scene, Layer::Indirect);
        // The walls reflect nothing.
        let albedo = draw(&gpu, &mut renderer, &scene, Layer::Albedo);
        let both = gathered.iter().zip(&albedo);
        let on_ball: Vec<f32> = both.filter(|(_, albedo)| albedo[0] > 0.5).map(|(p, _)| p[0]).collect();
        assert!(on_ball.len() > 100, "{}", on_ball.len());
        let (least, most) = on_ball.iter().fold((f32::MAX, 0.0_f32), |(a, b), v| (a.min(*v), b.max(*v)));
        let mean = on_ball.iter().sum::<f32>() / on_ball.len() as f32;
        println!("step {step}, {cones:?}: {least} to {most}, mean {mean}");
        assert!(mean > 1.0 - FURNACE && least > 1.0 - FURNACE_PIXEL && most < 1.0 + HALF);
    }
}

#[test]
fn a_stray_object_far_away_leaves_the_light_as_it_is() {
    let Some(gpu) = gpu() else { return };
    let scene = Kind::CornellPoint.build();
    let mut other = scene.clone();
    let far = Vec3::splat(1e30);
    other.objects.push(ball(0, far, 1e29));
    let pictures = [&scene, &other].map(|scene| {
        let mut renderer = updated(&gpu, scene, settings(32));
        draw(&gpu, &mut renderer, scene, Layer::Picture)
    });
    assert!(pictures[0].iter().any(|p| p[0] > 0.1));
    assert_eq!(pictures[0], pictures[1]);
}

#[test]
fn walls_stay_opaque_along_their_normals_in_all_mips_and_become_thin_across() {
    let Some(gpu) = gpu() else { return };
    for axis in 0..3 {
        let mut scene = wall_scene(axis);
        scene.objects[0].moves = true;
        let mut renderer = Renderer::new(&gpu, &scene, settings(64)).unwrap();
        // The wall goes beyond the border of the grid, so that all texels that hold it are full.
        let mut scale = Vec3::splat(1.3);
        scale[axis] = 1.0;
        renderer.move_object(&gpu, 0, Affine3A::from_scale(scale)).unwrap();
        renderer.update(&gpu, None, &mut Clock::off()).unwrap();
        let (base, mips) = renderer.shading().textures();
        let base = texels(&gpu, base, 0);
        assert!(base.iter().any(|t| t[3] == 1.0));
        for (direction, texture) in mips.iter().enumerate() {
            for level in 0..5 {
                let mut full: Vec<f32> =
                    texels(&gpu, texture, level).iter().map(|t| t[3]).filter(|a| *a > 0.0).collect();
                full.sort_unstable_by(f32::total_cmp);
                // Most texels that hold anything hold a piece of the wall, one of 2^(level + 1)
                // cells thick. Looked at along the wall, half of the columns of a texel hold its
                // halves, one behind the other.
                let across = (0..level).fold(0.5_f32, |a, _| 0.5 * (1.0 - (1.0 - a) * (1.0 - a)));
                let expected = if direction / 2 == axis { 1.0 } else { across };
                let most = full[full.len() / 2];
                let off = (most - expected).abs();
                assert!(off < HALF, "axis {axis}, direction {direction}, level {level}: {most}");
                assert!(direction / 2 != axis || off == 0.0);
            }
        }
    }
}

#[test]
fn direct_light_in_voxels_is_that_of_the_formulas() {
    let Some(gpu) = gpu() else { return };
    let mut scene = wall_scene(1);
    scene.materials[0] = Material::matt(Vec3::new(0.8, 0.4, 0.2));
    let falloff = Falloff { constant: 0.5, linear: 0.25, quadratic: 2.0 };
    let lamp = Vec3::new(0.1, 1.4, -0.2);
    let sun = LightKind::Directional { direction: Vec3::new(0.6, -0.8, 0.0), half_angle: 0.0 };
    let spot =
        |position, direction| LightKind::Spot { position, direction, radius: 0.0, inner: 0.3, outer: 0.6 };
    let lights = [
        Light { kind: sun, color: Vec3::splat(3.0), falloff },
        Light { kind: LightKind::Point { position: lamp, radius: 0.0 }, color: Vec3::splat(5.0), falloff },
        Light { kind: spot(lamp, Vec3::NEG_Y), color: Vec3::splat(7.0), falloff },
    ];
    for lights in [&lights[..1], &lights[1..2], &lights[2..], &lights[..]] {
        scene.lights = lights.to_vec();
        let mut renderer = updated(&gpu, &scene, Settings { bounce: false, ..settings(64) });
        let image = draw(&gpu, &mut renderer, &scene, Layer::Direct);
        let voxels = draw(&gpu, &mut renderer, &scene, Layer::Voxels);
        let cell = renderer.volume().cell;
        let mut looked_at = 0;
        for (at, (direct, voxel)) in common::wall_points(&scene).into_iter().zip(image.iter().zip(&voxels)) {
            let Some(at) = at else { continue };
            let expected: Vec3 = lights
                .iter()
                .filter_map(|l| l.incident(at))
                .map(|i| i.irradiance * i.direction.y.max(0.0))
                .sum();
            let expected = expected * scene.materials[0].albedo / PI;
            let direct = Vec3::from_slice(direct);
            assert!(
                direct.abs_diff_eq(expected, 1e-3 * expected.max_element() + 1e-5),
                "{at}: {direct}, not {expected}"
            );
            // A voxel stands for all points of its cell, up to a cell away.
            let near = [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z]
                .map(|d| light(lights, at + d * 1.5 * cell, &scene));
            let (low, high) = near.iter().fold((expected, expected), |(a, b), v| (a.min(*v), b.max(*v)));
            let voxel = Vec3::from_slice(voxel);
            let room = 0.12 * high.max_element() + 1e-3;
            assert!(
                voxel.cmpge(low - room).all() && voxel.cmple(high + room).all(),
                "{at}: {voxel}, {low} to {high}"
            );
            looked_at += 1;
        }
        assert!(looked_at > 200, "{looked_at}");
    }
}

#[test]
fn updates_on_need_and_of_several_changes_equal_an_update_of_everything() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Kind::CornellPoint.build();
    scene.objects.push(ball(0, Vec3::new(1.5, 2.5, 2.0), 0.4));
    scene.objects.push(ball(1, Vec3::new(4.0, 4.5, 3.0), 0.4));
    let last = scene.objects.len() - 1;
    let mut renderer = updated(&gpu, &scene, settings(32));
    let before = draw(&gpu, &mut renderer, &scene, Layer::Picture);
    // A light and two objects change in one frame.
    scene.lights[0].color *= 0.5;
    for (object, to) in [(last - 1, Vec3::new(2.0, 3.0, 1.0)), (last, Vec3::new(1.0, 1.0, 4.0))] {
        scene.objects[object].transform =
            Affine3A::from_scale_rotation_translation(Vec3::splat(0.4), glam::Quat::IDENTITY, to);
        renderer.move_object(&gpu, object, scene.objects[object].transform).unwrap();
    }
    renderer.set_lights(&gpu, &scene.lights).unwrap();
    let done = renderer.update(&gpu, None, &mut Clock::off()).unwrap();
    assert!(done.merged > 0 && done.merged < done.bricks / 2, "{done:?}");
    let on_need = draw(&gpu, &mut renderer, &scene, Layer::Picture);
    let everything = draw(&gpu, &mut updated(&gpu, &scene, settings(32)), &scene, Layer::Picture);
    assert_ne!(before, on_need);
    assert!(on_need == everything);
    // Nothing changed: nothing is done.
    let done = renderer.update(&gpu, None, &mut Clock::off()).unwrap();
    assert_eq!((done.merged, done.shaded, done.bounced, done.written), (0, 0, 0, 0));
    // A light alone changes no voxels.
    renderer.set_lights(&gpu, &[]).unwrap();
    let done = renderer.update(&gpu, None, &mut Clock::off()).unwrap();
    assert_eq!((done.merged, done.shaded), (0, done.bricks));
}

/// Draws frames twice: once with an update of all light, and once with an update of the light that
/// changed and that the picture can read. The pictures must be equal bit by bit. In each frame the
/// last object moves or the camera turns. Returns for each frame the bricks that were updated and
/// the share of bricks that the picture may read.
fn culled(
    gpu: &Gpu,
    scene: &LitScene,
    how: Settings,
    frames: &[(Option<Vec3>, Camera)],
) -> Vec<(Updated, f64)> {
    let [mut all, mut some] = [0, 1].map(|_| Renderer::new(gpu, scene, how).unwrap());
    let mut culling = Culling::new(scene, all.volume()).unwrap();
    let (moving, mut seen, mut done) = (scene.objects.len() - 1, scene.clone(), Vec::new());
    for (frame, (place, camera)) in frames.iter().enumerate() {
        if let Some(place) = place {
            let to = Affine3A { translation: (*place).into(), ..scene.objects[moving].transform };
            all.move_object(gpu, moving, to).unwrap();
            some.move_object(gpu, moving, to).unwrap();
            culling.move_object(moving, to).unwrap();
        }
        seen.camera = *camera;
        let sight = culling.look(camera).unwrap().unwrap();
        let reach = some.reach(&|b| may_see(&sight, b));
        // Marks all light.
        all.set_lights(gpu, &scene.lights).unwrap();
        all.update(gpu, None, &mut Clock::off()).unwrap();
        let updated = some.update(gpu, Some(&reach), &mut Clock::off()).unwrap();
        for layer in [Layer::Picture, Layer::Voxels] {
            let pictures = [&mut all, &mut some].map(|r| draw(gpu, r, &seen, layer));
            assert!(pictures[0] == pictures[1], "frame {frame}, {layer:?}");
            // Rays that leave the grid meet no voxels.
            assert!(layer == Layer::Voxels || pictures[0].iter().any(|p| p[0] > 0.01));
        }
        let read = some.layers().bricks().iter().filter(|b| reach.lit[**b as usize]).count();
        done.push((updated, read as f64 / updated.bricks as f64));
    }
    done
}

#[test]
fn culled_pictures_are_the_same_bit_by_bit_while_objects_move_and_the_camera_turns() {
    let Some(gpu) = gpu() else { return };
    let scene = common::long_hall();
    let start = Vec3::from(scene.objects.last().unwrap().transform.translation);
    // In the last frames only the camera turns: what it did not see is still to be done.
    let frames =
        [0, 1, 2, 3].map(|i| ((i < 2).then_some(start + Vec3::X * 0.7 * i as f32), common::hall_camera(i)));
    let done = culled(&gpu, &scene, Settings { reach: 0.08, ..settings(192) }, &frames);
    done.iter().for_each(|(updated, share)| println!("{updated:?}, may be read: {share:.2}"));
    // From the first two, the camera sees one room of six; from the others, it looks through a row
    // of doors.
    assert!(done[..2].iter().all(|(updated, share)| updated.bricks > 200 && *share < HALL_READ));
}

/// A Cornell box with a small ball, in a grid whose cones read bricks next to theirs; and places in
/// it by cells.
fn box_with_ball(radius: f32) -> (LitScene, Settings, impl Fn([f32; 3]) -> Vec3) {
    let mut scene = Kind::CornellPoint.build();
    let volume = Volume::new(scene.bounds(), 96).unwrap();
    scene.objects.push(ball(0, Vec3::splat(2.0), radius));
    let at = move |cells: [f32; 3]| volume.origin + Vec3::from(cells) * volume.cell;
    (scene, Settings { reach: 0.01, ..settings(96) }, at)
}

#[test]
fn what_jumps_into_sight_is_lit_where_it_lands() {
    let Some(gpu) = gpu() else { return };
    let (scene, how, at) = box_with_ball(0.15);
    // From the middle of a brick to that of the third one beside it, far from all other bricks in
    // sight.
    let frames = [28.0, 52.0].map(|x| (Some(at([x, 60.0, 12.0])), scene.camera));
    let done = culled(&gpu, &scene, how, &frames);
    // Of what may be read, only bricks are lit again in which the ball's shadow may fall.
    let (updated, share) = done[1];
    println!("{updated:?}, may be read: {share:.2}");
    assert!(
        updated.shaded > 0 && (updated.shaded as f64) < 0.9 * share * updated.bricks as f64,
        "{updated:?}"
    );
}

#[test]
fn what_leaves_a_brick_that_nobody_reads_casts_no_shadow_from_there() {
    let Some(gpu) = gpu() else { return };
    let (mut scene, how, at) = box_with_ball(0.2);
    scene.lights[0].kind = LightKind::Point { position: Vec3::new(2.78, 5.2, 2.8), radius: 0.3 };
    // From the middle of one brick between lamp and block to a corner of eight, for which there is
    // no memory yet.
    let (from, to) = (at([44.0, 68.0, 44.0]), at([80.0, 72.0, 72.0]));
    // Voxels exist from the first frame on, so that there is memory for one brick.
    scene.objects.last_mut().unwrap().transform.translation = from.into();
    let camera =
        Camera::look_at(Vec3::new(1.4, 2.6, -0.5), Vec3::new(1.8, 1.6, 1.7), 40.0, 4.0 / 3.0, 0.01, 20.0);
    let done = culled(&gpu, &scene, how, &[(Some(from), camera), (Some(to), camera)]);
    assert!(done[1].1 < 1.0 && done[1].0.merged == done[1].0.bricks + 1, "{done:?}");
}

#[test]
fn what_leaves_the_grid_gathers_light_from_it() {
    let Some(gpu) = gpu() else { return };
    let (scene, how, at) = box_with_ball(0.3);
    // Through the open front. The camera sees nothing but a part of the ball, and bricks without
    // voxels.
    let [eye, target] = [15.0, 0.0].map(|z| at([48.0, 12.0, z]));
    let camera = Camera::look_at(eye, target, 8.0, 4.0 / 3.0, 0.01, 20.0);
    let places = [[48.0, 12.0, 4.0], [48.0, 12.0, -1.0], [48.0, 12.0, -5.5], [48.0, 12.0, -30.0]];
    let frames = places.map(|place| (Some(at(place)), camera));
    // First with no light from earlier frames.
    culled(&gpu, &scene, Settings { reach: 0.2, ..how }, &frames[2..3]);
    culled(&gpu, &scene, Settings { reach: 0.2, ..how }, &frames);
}

#[test]
fn light_decreases_as_its_formula_says_near_it_and_where_it_is_not_positive() {
    let Some(gpu) = gpu() else { return };
    // A scene of a millimetre.
    let size = 2e-4;
    let mut scene = wall_scene(1);
    for object in &mut scene.objects {
        let mut mesh = (*object.mesh).clone();
        mesh.positions.iter_mut().for_each(|p| *p *= size);
        object.mesh = mesh.into();
    }
    let [eye, target] = [Vec3::new(0.3, 1.6, 0.4), Vec3::new(0.0, -0.6, -0.1)].map(|p| p * size);
    scene.camera = Camera::look_at(eye, target, 60.0, 4.0 / 3.0, 0.01 * size, 20.0 * size);
    let negative = Falloff { constant: 1.0, linear: 0.0, quadratic: -1e8 };
    for falloff in [Falloff::INVERSE_SQUARE, negative] {
        let kind = LightKind::Point { position: Vec3::new(0.1, 1.4, -0.2) * size, radius: 0.0 };
        scene.lights = vec![Light { kind, color: Vec3::splat(1e-6), falloff }];
        let mut renderer = updated(&gpu, &scene, settings(32));
        let image = draw(&gpu, &mut renderer, &scene, Layer::Direct);
        let mut looked_at = 0;
        for (at, direct) in common::wall_points(&scene).into_iter().zip(&image) {
            let Some(at) = at.filter(|at| at.x.abs().max(at.z.abs()) < 1.8 * size) else { continue };
            let expected = light(&scene.lights, at, &scene).x;
            assert!(
                (direct[0] - expected).abs() <= 2e-3 * expected,
                "{falloff:?}, {at}: {} {expected}",
                direct[0]
            );
            looked_at += 1;
        }
        assert!(looked_at > 200, "{looked_at}");
    }
}

#[test]
fn rays_beside_the_grid_meet_no_voxels() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Kind::CornellPoint.build();
    let mut renderer = updated(&gpu, &scene, settings(32));
    assert!(draw(&gpu, &mut renderer, &scene, Layer::Voxels).iter().any(|p| p[3] > 0.0));
    // Along the green wall, three metres beside it.
    let [eye, target] = [2.8, 9.0].map(|z| Vec3::new(-3.0, 2.7, z));
    scene.camera = Camera::look_at(eye, target, 60.0, 4.0 / 3.0, 0.1, 100.0);
    assert!(draw(&gpu, &mut renderer, &scene, Layer::Voxels).iter().all(|p| *p == [0.0; 4]));
}

#[test]
fn rooms_are_as_bright_as_by_the_path_tracer() {
    let Some(gpu) = gpu() else { return };
    for (kind, room) in [(Kind::CornellPoint, 0.12), (Kind::LightBox, 0.1), (Kind::Emissive, 0.08)] {
        let scene = kind.build();
        let mut renderer = updated(&gpu, &scene, settings(64));
        let image = draw(&gpu, &mut renderer, &scene, Layer::Picture);
        let truth = common::truth(&scene, 32);
        let mean = |image: &[Vec3]| image.iter().sum::<Vec3>() / image.len() as f32;
        let image: Vec<Vec3> = image.iter().map(|p| Vec3::from_slice(p)).collect();
        let (found, expected) = (mean(&image), mean(&truth));
        println!("{}: {found}, by the path tracer {expected}", scene.name);
        let off = ((found - expected) / expected).abs().max_element();
        assert!(off < room, "{}: {found}, not {expected}", scene.name);
    }
}

/// How bright rooms are that surfaces light, beside the path tracer's; the command is that of the
/// next test.
#[test]
#[ignore = "prints measurements"]
fn rooms_that_surfaces_light() {
    let Some(gpu) = gpu() else { return };
    let mean = |image: &[Vec3]| image.iter().map(|p| p.x).sum::<f32>() / image.len() as f32;
    for scene in [Kind::Emissive.build(), Kind::Cornell.build()] {
        let expected = mean(&common::truth(&scene, 128));
        for (n, cones) in
            [32, 64, 128].into_iter().flat_map(|n| [ConeCount::Six, ConeCount::Sixteen].map(|c| (n, c)))
        {
            let mut renderer = updated(&gpu, &scene, Settings { cones, ..settings(n) });
            let image = draw(&gpu, &mut renderer, &scene, Layer::Picture);
            let image: Vec<Vec3> = image.iter().map(|p| Vec3::from_slice(p)).collect();
            println!(
                "{}, {n} cells, {cones:?}: {:.4}, by the path tracer {expected:.4}",
                scene.name,
                mean(&image)
            );
        }
    }
}

/// What an update saves in a large scene: `cargo test --release -p casca-light --test light --
/// --ignored --nocapture`.
#[test]
#[ignore = "prints measurements"]
fn sponza_with_twenty_moving_balls() {
    let Some(gpu) = gpu() else { return };
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes/sponza.glb");
    let Ok(mut scene) = casca_scenes::import::load_lit(std::path::Path::new(path)) else {
        return println!("skipped: no {path}");
    };
    let (min, max) = scene.bounds();
    let place = |i: usize, frame: usize| {
        let angle = 2.4 * i as f32 + 0.05 * frame as f32;
        let share = (i as f32 + 0.5) / 20.0 * 0.4;
        min + (max - min) * Vec3::new(0.5 + share * angle.cos(), 0.3, 0.5 + share * angle.sin())
    };
    let first = scene.objects.len();
    scene.objects.extend((0..20).map(|i| ball(0, place(i, 0), 0.04 * (max - min).min_element())));
    let kind = LightKind::Directional { direction: Vec3::new(0.25, -1.0, 0.12), half_angle: 0.0 };
    scene.lights.push(Light { kind, color: Vec3::splat(10.0), falloff: Falloff::INVERSE_SQUARE });
    for reach in [1.0, 0.1, 0.05, 0.02] {
        for (all_light, cull) in [(true, false), (false, false), (false, true)] {
            let how = Settings { reach, ..settings(128) };
            let mut renderer = updated(&gpu, &scene, how);
            let mut culling = Culling::new(&scene, renderer.volume()).unwrap();
            for i in 0..20 {
                let to = Affine3A { translation: place(i, 1).into(), ..scene.objects[first + i].transform };
                renderer.move_object(&gpu, first + i, to).unwrap();
                culling.move_object(first + i, to).unwrap();
            }
            if all_light {
                renderer.set_lights(&gpu, &scene.lights).unwrap();
            }
            let sight = culling.look(&scene.camera).unwrap().unwrap();
            let reached = cull.then(|| renderer.reach(&|b| may_see(&sight, b)));
            let mut clock = Clock::on();
            let done = renderer.update(&gpu, reached.as_ref(), &mut clock).unwrap();
            let ms = |name: &str| {
                clock.stages().iter().filter(|s| s.0 == name).map(|s| s.1.as_secs_f64() * 1e3).sum::<f64>()
            };
            let times = ["shade", "bounce", "write voxels", "mips"].map(|name| (name, ms(name).round()));
            println!("reach {reach}, all light {all_light}, culled {cull}: {done:?}; ms {times:?}");
        }
    }
}
