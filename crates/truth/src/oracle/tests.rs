use std::sync::Arc;

use glam::camera::rh::proj::directx;
use glam::{Affine3A, DVec3, Mat4, Quat, Vec3};
use rand::RngExt;

use super::*;
use casca_scenes::random::generator;
use casca_scenes::world::{Mesh, Motion};

fn object(shape: Shape) -> Object {
    Object { name: String::new(), shape, motion: Motion::Static, occludes: true, tested: true }
}

fn sphere(x: f32, y: f32, z: f32, radius: f32) -> Object {
    object(Shape::Sphere { center: Vec3::new(x, y, z), radius })
}

fn cuboid(min: [f32; 3], max: [f32; 3]) -> Object {
    object(Shape::Box { min: min.into(), max: max.into() })
}

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]], transform: Affine3A) -> Object {
    let mesh = Mesh {
        positions: positions.iter().map(|&p| p.into()).collect(),
        triangles: triangles.to_vec(),
        ..Mesh::default()
    };
    object(Shape::Mesh { mesh: Arc::new(mesh), transform })
}

/// A square of two triangles.
fn quad(corners: [[f32; 3]; 4], transform: Affine3A) -> Object {
    mesh(&corners, &[[0, 1, 2], [0, 2, 3]], transform)
}

fn ghost(object: Object) -> Object {
    Object { occludes: false, ..object }
}

fn dynamic(object: Object) -> Object {
    Object { motion: Motion::Dynamic { max_speed: 1.0 }, ..object }
}

/// Looks along -z from the origin.
fn ahead() -> Camera {
    Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 16.0 / 9.0, 0.1, 500.0)
}

fn orthographic() -> Camera {
    Camera {
        projection: directx::orthographic(-8.0, 8.0, -4.5, 4.5, 0.1, 500.0),
        ..Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, -3.0), 60.0, 1.0, 0.1, 10.0)
    }
}

fn render(objects: &[Object], camera: &Camera) -> ItemBuffer {
    let mut buffer = ItemBuffer::new(320, 180);
    buffer.render(objects, camera);
    buffer
}

fn small(samples: usize) -> OracleOptions {
    OracleOptions { width: 320, height: 180, samples_per_object: samples, ..OracleOptions::default() }
}

fn judge(objects: &[Object], camera: &Camera, samples: usize, pvs: &dyn Fn(usize) -> bool) -> FrameVerdict {
    Oracle::new(objects, small(samples)).frame(objects, &[], camera, pvs)
}

const WALL: ([f32; 3], [f32; 3]) = ([-2.0, -2.0, -11.0], [2.0, 2.0, -10.0]);

#[test]
fn a_sphere_behind_a_wall_is_hidden_until_it_peeks_out() {
    let wall = cuboid(WALL.0, WALL.1);
    // The eye sees past the wall's front edge: x / 10 = 2 / 10.
    let hidden = [wall.clone(), sphere(0.0, 0.0, -15.0, 1.5)];
    let verdict = judge(&hidden, &ahead(), 64, &|i| i == 0);
    assert_eq!(verdict.exact, [0]);
    assert!(verdict.false_negatives.is_empty() && verdict.unconfirmed.is_empty());
    assert_eq!((verdict.rays, verdict.candidates), (64, 1));

    // Tangent to the plane x = -z / 5, then 1 cm beyond.
    let edge = (1.0_f64 + 0.04).sqrt();
    for (shift, seen) in [(-0.01, false), (0.01, true)] {
        let x = 3.0 - edge + shift;
        let scene = [wall.clone(), sphere(x as f32, 0.0, -15.0, 1.0)];
        let verdict = judge(&scene, &ahead(), 4096, &|i| i == 0);
        assert_eq!(verdict.exact.contains(&1), seen, "{shift}");
        assert_eq!(verdict.false_negatives.iter().any(|f| f.object == 1), seen);
    }
}

#[test]
fn no_light_passes_between_abutting_boxes() {
    // The seam at x = 0 is met exactly by the middle column of rays.
    let objects = [
        cuboid([-20.0, -20.0, -11.0], [0.0, 20.0, -10.0]),
        cuboid([0.0, -20.0, -11.0], [20.0, 20.0, -10.0]),
        sphere(0.0, 0.0, -20.0, 3.0),
    ];
    for width in [320, 321] {
        let mut buffer = ItemBuffer::new(width, 181);
        buffer.render(&objects, &ahead());
        assert!(buffer.items().iter().all(|&i| i < 2));
    }
    let oracle = RayOracle::new(&objects);
    for x in [0.0, 1e-12, -1e-12, 1e-7, 1e-3] {
        assert!(oracle.occluded(DVec3::ZERO, DVec3::new(x, 0.1, -17.0), 2));
    }
    assert!(judge(&objects, &ahead(), 256, &|i| i < 2).false_negatives.is_empty());
}

#[test]
fn a_sphere_that_holds_the_eye_is_visible_and_does_not_hide() {
    let objects = [sphere(0.0, 0.0, 0.0, 2.0), sphere(0.0, 0.0, -15.0, 1.0), cuboid([-3.0; 3], [3.0; 3])];
    let verdict = judge(&objects, &ahead(), 4, &|i| i == 1);
    assert_eq!(verdict.exact, [0, 1, 2]);
    assert_eq!(verdict.false_negatives.iter().map(|f| f.object).collect::<Vec<_>>(), [0, 2]);
    assert!(!RayOracle::new(&objects).occluded(DVec3::ZERO, DVec3::NEG_Z * 14.0, 1));
    // Wholly before the near plane: cut away.
    let tiny = [sphere(0.0, 0.0, 0.0, 0.05)];
    assert!(judge(&tiny, &ahead(), 4, &|_| false).exact.is_empty());
}

#[test]
fn the_near_plane_cuts_solids_and_meshes() {
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 16.0 / 9.0, 5.0, 100.0);
    let wide = |z: f32| {
        let corners = [[-20.0, -20.0, z], [20.0, -20.0, z], [20.0, 20.0, z], [-20.0, 20.0, z]];
        quad(corners, Affine3A::IDENTITY)
    };
    // Entered before the near plane, wholly before it, and beyond it.
    let objects =
        [cuboid([-9.0, -9.0, -6.0], [9.0, 9.0, -4.0]), wide(-3.0), sphere(0.0, 0.0, -4.0, 2.0), wide(-50.0)];
    let buffer = render(&objects, &camera);
    assert!(buffer.items().iter().all(|&i| i == 3 || i == NONE));
    assert!(buffer.visible()[3] > 0);
    let verdict = judge(&objects, &camera, 32, &|_| false);
    assert_eq!(verdict.exact, [3]);
    assert!(verdict.unconfirmed.is_empty());
    // Beyond the far plane.
    assert!(judge(&[wide(-101.0), sphere(0.0, 0.0, -120.0, 3.0)], &camera, 32, &|_| false).exact.is_empty());
}

#[test]
fn a_mesh_quad_is_exact_seamless_and_two_sided() {
    let positions = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let camera = ahead();
    for triangles in [[[0, 1, 2], [0, 2, 3]], [[0, 2, 1], [0, 3, 2]]] {
        let place = Affine3A::from_translation(Vec3::NEG_Z * 4.0);
        let buffer = render(&[mesh(&positions, &triangles, place)], &camera);
        let frustum = Frustum::new(&camera);
        for (pixel, &item) in buffer.items().iter().enumerate() {
            let (origin, step) = buffer.pixel_ray(&frustum, pixel);
            let at = origin + step * (4.0 - frustum.near());
            let inside = at.x.abs() <= 1.0 && at.y.abs() <= 1.0;
            assert_eq!(item == 0, inside, "{at}");
            if inside {
                assert!((buffer.depths()[pixel] - 4.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn what_does_not_occlude_hides_nothing_and_is_hidden() {
    let objects = [
        ghost(sphere(0.0, 0.0, -5.0, 1.0)),
        ghost(sphere(0.0, 0.0, -8.0, 1.0)),
        cuboid(WALL.0, WALL.1),
        ghost(sphere(0.0, 0.0, -15.0, 1.0)),
        Object { tested: false, ..ghost(sphere(0.0, 0.0, -4.0, 1.0)) },
        Object { tested: false, ..sphere(0.0, 0.0, -30.0, 8.0) },
    ];
    let buffer = render(&objects, &ahead());
    let visible = buffer.visible();
    assert!(visible[0] > 0 && visible[1] > 0 && visible[2] > 0);
    assert_eq!((visible[3], visible[4]), (0, 0));
    let verdict = judge(&objects, &ahead(), 32, &|_| false);
    assert_eq!(verdict.exact, [0, 1, 2]);
    assert_eq!(verdict.false_negatives.len(), 3);
    assert!(verdict.false_negatives.iter().all(|f| f.found_by == FoundBy::ItemBuffer));
}

#[test]
fn rays_find_what_lies_between_pixels() {
    // Far smaller than a pixel, and not on a pixel's centre.
    let objects = [sphere(0.013, 0.011, -100.0, 0.01), cuboid([-1.0, -1.0, -50.0], [-0.5, 1.0, -49.0])];
    let buffer = render(&objects, &ahead());
    assert_eq!(buffer.visible()[0], 0);
    let verdict = judge(&objects, &ahead(), 4, &|i| i == 1);
    assert_eq!(verdict.exact, [0, 1]);
    let found = verdict.false_negatives[0];
    assert_eq!((found.object, found.found_by, verdict.rays), (0, FoundBy::Ray, 1));
    assert!((found.target.distance(DVec3::new(0.013, 0.011, -100.0)) - 0.01).abs() < 1e-6);
}

#[test]
fn own_triangles_hide_and_do_not_hide() {
    // A closed tetrahedron is seen; so is a quad standing on a box.
    let tetra = mesh(
        &[[0.0, 1.0, 0.0], [1.0, -1.0, 1.0], [-1.0, -1.0, 1.0], [0.0, -1.0, -1.0]],
        &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        Affine3A::from_rotation_translation(Quat::from_rotation_y(0.3), Vec3::new(0.0, 0.0, -7.0)),
    );
    let objects = [tetra];
    let oracle = RayOracle::new(&objects);
    let report = oracle.probe(&objects, DVec3::ZERO, &[0], 64, 3, |_| true);
    assert_eq!(report.seen.len(), 1);
    // Nothing of it may be seen from behind a wall, all round.
    let objects = [objects[0].clone(), cuboid(WALL.0.map(|v| v / 2.0), WALL.1.map(|v| v / 2.0))];
    let mut oracle = oracle;
    oracle.update(&objects, &[]);
    let report = oracle.probe(&objects, DVec3::ZERO, &[0], 64, 3, |_| true);
    assert!(report.seen.is_empty());
    assert_eq!(report.rays, 64);
}

#[test]
fn orthographic_rays_are_parallel() {
    // Eye at (1, 2, 3), looking along -z.
    let objects = [
        cuboid([0.0, 1.0, -11.0], [2.0, 3.0, -10.0]),
        sphere(1.0, 2.0, -40.0, 0.99),
        sphere(1.8, 2.0, -30.0, 0.21),
        quad(
            [[-2.0, 2.0, -5.0], [-1.0, 2.0, -5.0], [-1.0, 3.0, -5.0], [-2.0, 3.0, -5.0]],
            Affine3A::IDENTITY,
        ),
        sphere(1.0, 2.0, 5.0, 1.0),
    ];
    let camera = orthographic();
    let frustum = Frustum::new(&camera);
    assert!(!frustum.is_perspective());
    assert!((frustum.near() - 0.1).abs() < 1e-5 && (frustum.far() - 500.0).abs() < 0.1);
    let buffer = render(&objects, &camera);
    // 20 pixels a metre.
    assert_eq!(buffer.visible()[0], 1600);
    assert_eq!(buffer.visible()[3], 400);
    assert_eq!((buffer.visible()[1], buffer.visible()[4]), (0, 0));
    let pixel = (90 - 10) * 320 + 160 - 50;
    assert_eq!(buffer.items()[pixel], 3);
    assert!((buffer.depths()[pixel] - 8.0).abs() < 1e-9);
    let verdict = judge(&objects, &camera, 4096, &|i| i == 0);
    assert_eq!(verdict.exact, [0, 2, 3]);
    assert_eq!(verdict.false_negatives.len(), 2);
    assert!(verdict.unconfirmed.is_empty());
}

#[test]
fn clip_volumes_are_the_same_for_all_depths_conventions() {
    let base = Camera::look_at(Vec3::new(3.0, 4.0, 5.0), Vec3::new(1.0, 2.0, -3.0), 50.0, 1.5, 0.5, 80.0);
    let (fov, aspect) = (50.0_f32.to_radians(), 1.5);
    let reverse = Mat4::from_cols_array(&[
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 1.0,
    ]);
    let cameras = [
        (base.projection, 80.0),
        (reverse * base.projection, 80.0),
        (directx::perspective_infinite(fov, aspect, 0.5), 1e9),
        (directx::perspective_infinite_reverse(fov, aspect, 0.5), 1e9),
    ];
    let mut random = generator(5, 0);
    for (projection, far) in cameras {
        let camera = Camera { projection, ..base };
        let frustum = Frustum::new(&camera);
        assert!((frustum.near() - 0.5).abs() < 1e-5, "{}", frustum.near());
        assert!(frustum.far() >= far * 0.999, "{}", frustum.far());
        let mut inside = 0;
        for _ in 0..20_000 {
            let point = DVec3::from_array(std::array::from_fn(|_| random.random_range(-40.0..40.0)));
            let view = camera.view.as_dmat4().transform_point3(point);
            let tan = (f64::from(fov) * 0.5).tan();
            let ratio = (view.y / -view.z / tan).abs().max((view.x / -view.z / tan / aspect as f64).abs());
            let depth = -view.z;
            if (ratio - 1.0).abs() < 1e-5 || (depth - 0.5).abs() < 1e-4 {
                continue;
            }
            let expected = depth > 0.5 && ratio < 1.0;
            assert_eq!(frustum.surely_contains(point), expected, "{point}");
            inside += usize::from(expected);
            if expected {
                assert!(frustum.may_meet_sphere(point, 0.0) && frustum.may_meet_box(point, point));
                assert!((frustum.depth(frustum.start(point)) - frustum.near()).abs() < 1e-9);
            }
        }
        assert!(inside > 100);
    }
}

fn random_scene(count: usize, size: f32, extent: f32, seed: u64) -> Vec<Object> {
    let mut random = generator(seed, 0);
    let mut near = |scale: f32| Vec3::from_array([(); 3].map(|()| random.random_range(-1.0..1.0) * scale));
    (0..count)
        .map(|i| {
            let center = near(extent);
            let center = center + center.normalize_or(Vec3::X) * size * 4.0;
            let made = match i % 3 {
                0 => object(Shape::Sphere { center, radius: near(size).x.abs() + 0.01 }),
                1 => {
                    let half = near(size).abs() + 0.01;
                    object(Shape::Box { min: center - half, max: center + half })
                }
                _ => {
                    let turn = near(3.0);
                    let vertices: Vec<[f32; 3]> = (0..6).map(|_| near(size).to_array()).collect();
                    mesh(
                        &vertices,
                        &[[0, 1, 2], [0, 2, 3], [3, 4, 5], [1, 4, 5]],
                        Affine3A::from_rotation_translation(
                            Quat::from_euler(glam::EulerRot::XYZ, turn.x, turn.y, turn.z),
                            center,
                        ),
                    )
                }
            };
            let made = if i % 2 == 0 { dynamic(made) } else { made };
            if i % 7 == 6 { ghost(made) } else { made }
        })
        .collect()
}

#[test]
fn pixels_agree_with_a_test_of_all_objects() {
    for (seed, orthogonal, near) in [(1, false, 0.01), (2, false, 0.01), (3, true, 0.1), (4, false, 8.0)] {
        let mut objects = random_scene(600, 3.0, 30.0, seed);
        let camera = if orthogonal {
            orthographic()
        } else {
            Camera::look_at(Vec3::ZERO, Vec3::new(0.3, 0.2, -1.0), 80.0, 16.0 / 9.0, near, 1000.0)
        };
        // Some move before they are drawn again.
        let mut buffer = ItemBuffer::new(320, 180);
        buffer.render(&objects, &camera);
        for object in objects.iter_mut().step_by(4) {
            object.shape = object.shape.moved(Vec3::Y * 0.5);
        }
        buffer.render(&objects, &camera);
        let frustum = Frustum::new(&camera);
        let shown: Vec<Vec<usize>> = (0..objects.len()).map(|i| buffer.pixels_of(i).collect()).collect();
        let counts: Vec<u32> = shown.iter().map(|pixels| pixels.len() as u32).collect();
        let least = |i: usize| counts[i].max(u32::from(buffer.holding_eye().contains(&(i as u32))));
        assert_eq!(buffer.visible(), (0..objects.len()).map(least).collect::<Vec<_>>());
        for pixel in (0..320 * 180).step_by(7) {
            let (origin, step) = buffer.pixel_ray(&frustum, pixel);
            let hits: Vec<(usize, f64)> = (objects.iter().enumerate())
                .filter_map(|(i, object)| Some((i, enter_shape(&object.shape, origin, step)?)))
                .collect();
            let hiding = hits.iter().filter(|hit| objects[hit.0].occludes);
            let first = hiding.min_by(|a, b| a.1.total_cmp(&b.1)).copied();
            let (item, end) = first.map_or((NONE, f64::INFINITY), |(i, t)| (i as u32, t));
            assert_eq!((buffer.items()[pixel], buffer.depths()[pixel]), (item, frustum.near() + end));
            for (i, pixels) in shown.iter().enumerate() {
                let is_there = hits
                    .iter()
                    .any(|&(j, t)| i == j && if objects[i].occludes { item == i as u32 } else { t <= end });
                assert_eq!(pixels.binary_search(&pixel).is_ok(), is_there, "{i} {pixel}");
            }
        }
        assert!(buffer.items().iter().filter(|&&i| i != NONE).count() > 5_000);
    }
}

#[test]
fn nine_rays_see_a_box_by_its_corners_and_centre_only() {
    // A slit that shows neither a corner nor the centre of the box behind it.
    let objects = [cuboid([-9.0, -9.0, -5.0], [0.4, 9.0, -4.0]), cuboid([0.6, -9.0, -5.0], [9.0, 9.0, -4.0])];
    let rays = RayOracle::new(&objects);
    let sees = |x: f32, z: f32| {
        rays.nine_rays(Vec3::ZERO, Vec3::new(x - 2.0, -2.0, z - 2.0), Vec3::new(x + 2.0, 2.0, z))
    };
    assert!(!sees(0.0, -10.0));
    assert!(sees(0.0, -3.0), "a corner before the wall");
    assert!(sees(1.21, -10.0), "the centre behind the slit");
}

#[test]
fn a_closed_mesh_has_no_holes() {
    let mesh = Arc::new(Mesh::ball(4));
    for i in 0..6 {
        let turn = i as f32;
        let transform = Affine3A::from_scale_rotation_translation(
            Vec3::new(30.0, 10.0 + turn, 20.0),
            Quat::from_euler(glam::EulerRot::XYZ, 0.7 * turn, turn, 0.3 * turn),
            Vec3::new(turn, 0.1, -1.0),
        );
        let objects = [object(Shape::Mesh { mesh: Arc::clone(&mesh), transform })];
        let buffer = render(&objects, &ahead());
        assert!(buffer.items().iter().all(|&i| i == 0));
    }
}

#[test]
fn sightings_and_pixels_agree_on_what_is_seen() {
    let objects = random_scene(2000, 2.0, 40.0, 9);
    let camera = Camera::look_at(Vec3::ZERO, Vec3::new(0.3, 0.2, -1.0), 80.0, 16.0 / 9.0, 0.01, 1000.0);
    let verdict = judge(&objects, &camera, 16, &|_| false);
    // With an empty set all that is seen is missing, and each is confirmed.
    assert!(verdict.exact.len() > 50);
    let found: Vec<usize> = verdict.false_negatives.iter().map(|f| f.object).collect();
    assert_eq!(found, verdict.exact);
    assert!(verdict.unconfirmed.is_empty(), "{:?}", verdict.unconfirmed);
    // Each sighting stands up to a test of all objects, one by one.
    for found in &verdict.false_negatives {
        let step = found.target - found.origin;
        for (i, object) in objects.iter().enumerate() {
            if i != found.object && object.occludes {
                assert!(enter_shape(&object.shape, found.origin, step).is_none_or(|t| t >= 1.0));
            }
        }
    }
    // With a full set nothing is.
    let full = judge(&objects, &camera, 16, &|_| true);
    assert!(full.false_negatives.is_empty() && full.rays == 0);
}

#[test]
fn first_hits_agree_with_a_test_of_all_objects() {
    let mut objects = random_scene(300, 2.0, 20.0, 4);
    let mut oracle = RayOracle::new(&objects);
    let mut random = generator(6, 0);
    for round in 0..12 {
        // Moves some, refits, and at times builds anew.
        let moved: Vec<usize> = (0..objects.len()).filter(|i| i % 4 == 0).collect();
        for &i in &moved {
            let by = Vec3::new(random.random_range(-3.0..3.0), random.random_range(-3.0..3.0), 1.0);
            objects[i].shape = objects[i].shape.moved(by);
        }
        oracle.update(&objects, &moved);
        for _ in 0..300 {
            // Some start far away.
            let far = if round % 2 == 0 { 1.0 } else { 1e5 };
            let mut point = |scale: f64| -> DVec3 {
                DVec3::from_array(std::array::from_fn(|_| random.random_range(-scale..scale)))
            };
            let origin = point(20.0 * far);
            let direction = point(20.0) - origin;
            let best = objects
                .iter()
                .enumerate()
                .filter(|(_, object)| object.occludes)
                .filter_map(|(i, object)| Some((i, enter_shape(&object.shape, origin, direction)?)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            assert_eq!(oracle.first_hit(origin, direction), best);
            let blocked = best.is_some_and(|(_, t)| t < 1.0 - 1e-6);
            assert_eq!(oracle.occluded(origin, origin + direction, usize::MAX), blocked);
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let objects = random_scene(1500, 2.0, 40.0, 11);
    let camera = Camera::look_at(Vec3::ZERO, Vec3::new(-0.3, 0.2, -1.0), 80.0, 16.0 / 9.0, 0.01, 1000.0);
    let run = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(|| {
            let mut oracle = Oracle::new(&objects, small(8));
            let verdict = oracle.frame(&objects, &[], &camera, &|i| i % 5 == 0);
            let buffer = oracle.buffer();
            (verdict, buffer.items().to_vec(), buffer.depths().to_vec(), buffer.visible().to_vec())
        })
    };
    assert!(run(1) == run(2));
    assert!(run(1) == run(5));
}

#[test]
fn capped_candidates_take_turns() {
    // Small ones behind a wall, all hidden.
    let mut objects = vec![cuboid([-90.0, -90.0, -11.0], [90.0, 90.0, -10.0])];
    objects.extend((0..10).map(|i| sphere(i as f32, 0.0, -20.0, 0.3)));
    let options = OracleOptions { max_candidates: 4, ..small(2) };
    let mut oracle = Oracle::new(&objects, options);
    for _ in 0..5 {
        let verdict = oracle.frame(&objects, &[], &ahead(), &|i| i == 0);
        assert_eq!((verdict.candidates, verdict.rays), (10, 8));
        assert_eq!(verdict.exact, [0]);
    }
    // A glimpse of each comes within three frames.
    objects[0] = cuboid([50.0, 50.0, -11.0], [51.0, 51.0, -10.0]);
    let mut found = Vec::new();
    let mut oracle = Oracle::new(&objects, OracleOptions { height: 0, ..options });
    for _ in 0..3 {
        found.extend(oracle.frame(&objects, &[], &ahead(), &|i| i == 0).exact);
    }
    found.sort_unstable();
    found.dedup();
    assert_eq!(found, (1..11).collect::<Vec<_>>());
}

#[test]
fn odd_input_is_survived() {
    let objects = [
        mesh(&[], &[], Affine3A::IDENTITY),
        mesh(
            &[[0.0, 0.0, -3.0], [0.0, 0.0, -3.0], [1.0, 0.0, -3.0]],
            &[[0, 1, 2], [0, 0, 0]],
            Affine3A::IDENTITY,
        ),
        sphere(f32::NAN, 0.0, 0.0, 1.0),
        sphere(0.0, 0.0, -5.0, 0.0),
        cuboid([f32::NEG_INFINITY; 3], [f32::NAN; 3]),
        cuboid([1.0, 1.0, -9.0], [-1.0, -1.0, -8.0]),
        sphere(0.0, 0.0, -9.0, 1.0),
    ];
    let verdict = judge(&objects, &ahead(), 8, &|_| false);
    assert_eq!(verdict.exact, [6]);
    let mut empty = Oracle::new(&[], OracleOptions { width: 0, height: 0, ..small(1) });
    assert_eq!(empty.frame(&[], &[], &ahead(), &|_| false).exact, Vec::<usize>::new());
}

#[test]
fn thousands_of_equal_objects_are_no_deep_tree() {
    let mut objects: Vec<Object> =
        (0..10_000).map(|_| cuboid([-1.0, -1.0, -6.0], [1.0, 1.0, -5.0])).collect();
    objects.push(cuboid([-0.5, -0.5, -9.0], [0.5, 0.5, -8.0]));
    objects.push(cuboid([2.0, -0.5, -9.0], [3.0, 0.5, -8.0]));
    let seen = judge(&objects, &ahead(), 4, &|_| true).exact;
    assert!(seen.contains(&10_001) && !seen.contains(&10_000), "{seen:?}");
}
