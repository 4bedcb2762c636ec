//! No shadow on what can be seen is ever lost: with the casters found alone, every light ray that something
//! blocks stays blocked. Judged by exact rays, which share no code with the library.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use casca::{
    Aabb, Error, GridSpec, Light, Method, ObjectDesc, ObjectId, Plane, PointOptions, Query, Scene, Sphere,
    TriMesh, View,
};
use casca_lab::cases;
use casca_lab::drive::Driver;
use casca_lab::oracle::RayOracle;
use casca_lab::world::{Camera, Mesh, Motion, Object, Shape};
use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Affine3A, DVec3, EulerRot, Quat, UVec3, Vec3};
use proptest::prelude::*;

const SIZE: f32 = 16.0;

/// Seconds between frames, and the greatest speed of what moves.
const STEP: f64 = 0.25;
const SPEED: f32 = 3.0;

/// Where light rays start, in front of the point that they aim at.
const FAR: f64 = 200.0;

/// The name of objects that are reported on expiry only.
const SILENT: &str = "silent";

fn vector(range: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(range).prop_map(Vec3::from_array)
}

fn direction() -> impl Strategy<Value = Vec3> {
    let any = vector(-1.0..1.0).prop_map(|d| d.normalize_or(Vec3::X));
    let axis = (0..6usize).prop_map(|i| if i % 2 == 0 { Vec3::AXES[i / 2] } else { -Vec3::AXES[i / 2] });
    prop_oneof![3 => any, 1 => axis]
}

fn shape() -> impl Strategy<Value = Shape> {
    let place = || prop_oneof![6 => vector(0.0..SIZE), 1 => vector(-SIZE..2.0 * SIZE)];
    let sphere = (place(), 0.1..3.0f32).prop_map(|(center, radius)| Shape::Sphere { center, radius });
    let free = (place(), vector(0.05..5.0)).prop_map(|(min, size)| Shape::Box { min, max: min + size });
    // Such boxes share faces.
    let on_cells = (prop::array::uniform3(-1..15i8), prop::array::uniform3(1..6i8)).prop_map(|(p, s)| {
        let min = Vec3::from_array(p.map(f32::from));
        Shape::Box { min, max: min + Vec3::from_array(s.map(f32::from)) }
    });
    let slab = (0..3usize, 0..16i8).prop_map(|(axis, at)| {
        let (mut min, mut max) = (Vec3::ZERO, Vec3::splat(SIZE));
        (min[axis], max[axis]) = (f32::from(at), f32::from(at) + 1.0);
        Shape::Box { min, max }
    });
    let mesh = (place(), vector(-3.0..3.0), 0.2..4.0f32, any::<bool>()).prop_map(|(at, turn, size, open)| {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let triangles = if open { triangles[..2].to_vec() } else { triangles };
        let turn = Quat::from_euler(EulerRot::XYZ, turn.x, turn.y, turn.z);
        let transform = Affine3A::from_scale_rotation_translation(Vec3::splat(size), turn, at);
        Shape::Mesh { mesh: Arc::new(Mesh { positions, triangles }), transform }
    });
    prop_oneof![3 => sphere, 3 => free, 3 => on_cells, 1 => slab, 2 => mesh]
}

fn object() -> impl Strategy<Value = Object> {
    (shape(), 0..5u8, prop::bool::weighted(0.8)).prop_map(|(shape, kind, occludes)| Object {
        name: if kind == 0 { SILENT.into() } else { String::new() },
        shape,
        motion: if kind < 3 { Motion::Dynamic { max_speed: SPEED } } else { Motion::Static },
        occludes,
        tested: true,
    })
}

/// A camera, perspective or orthographic.
fn camera() -> impl Strategy<Value = (Camera, bool)> {
    let eye = prop_oneof![5 => vector(0.0..SIZE), 1 => vector(-SIZE..2.0 * SIZE)];
    (eye, direction(), 15.0..120.0f32, 0.4..2.5f32, prop::bool::weighted(0.8)).prop_map(
        |(eye, forward, fov, aspect, perspective)| {
            let up = if forward.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
            let (w, h) = (fov * 0.1 * aspect, fov * 0.1);
            let projection = if perspective {
                directx::perspective(fov.to_radians(), aspect, 0.05, 80.0)
            } else {
                directx::orthographic(-w, w, -h, h, 0.05, 80.0)
            };
            (Camera { eye, view: look_to_mat4(eye, forward, up), projection }, perspective)
        },
    )
}

fn methods() -> impl Strategy<Value = Method> {
    let point = (20.0..640.0f32, prop_oneof![Just(0u32), Just(256)]).prop_map(|(pixels, squares)| {
        Method::Point(PointOptions::default().pixel_degrees(90.0 / pixels).refine_squares(squares))
    });
    prop_oneof![1 => Just(Method::cell()), 1 => Just(Method::Frustum), 6 => point]
}

fn moved_by(shape: &Shape, by: Vec3) -> Shape {
    match shape {
        Shape::Sphere { center, radius } => Shape::Sphere { center: *center + by, radius: *radius },
        Shape::Box { min, max } => Shape::Box { min: *min + by, max: *max + by },
        Shape::Mesh { mesh, transform } => {
            let transform = Affine3A::from_translation(by) * *transform;
            Shape::Mesh { mesh: mesh.clone(), transform }
        }
    }
}

/// The rays of those objects that `blocks` says block.
fn rays(objects: &[Object], blocks: impl Fn(usize) -> bool) -> RayOracle {
    let of = |(i, o): (usize, &Object)| Object { occludes: blocks(i), ..o.clone() };
    RayOracle::new(&objects.iter().enumerate().map(of).collect::<Vec<_>>())
}

/// Points that the camera sees through the middles of some pixels: of occluders, and of what else is before them.
fn seen_points(camera: &Camera, solid: &RayOracle, all: &RayOracle) -> Vec<DVec3> {
    const PIXELS: [i32; 2] = [24, 18];
    let inverse = camera.view_projection().as_dmat4().inverse();
    let mut points = Vec::new();
    for y in 0..PIXELS[1] {
        for x in 0..PIXELS[0] {
            let ndc = |i: i32, n: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
            let at = |z| inverse.project_point3(DVec3::new(ndc(x, PIXELS[0]), ndc(y, PIXELS[1]), z));
            // Rays end a little before the far plane.
            let (near, far) = (at(0.0), at(0.9999));
            let hidden = solid.first_hit(near, far - near).map_or(1.0, |(_, t)| t);
            let first = all.first_hit(near, far - near).map_or(1.0, |(_, t)| t);
            let mut hits = vec![first, hidden];
            hits.dedup();
            points.extend(hits.into_iter().filter(|&t| t < 1.0).map(|t| near + (far - near) * t));
        }
    }
    points
}

/// Whether the light's ray to a point, and four beside it, are blocked by all or by none; `None` where they differ.
fn blocked(oracle: &RayOracle, point: DVec3, light: DVec3) -> Option<bool> {
    let (right, up) = light.any_orthonormal_pair();
    let beside = [DVec3::ZERO, right, -right, up, -up].map(|side| {
        let point = point + side * 1e-5;
        oracle.occluded(point - light * FAR, point, usize::MAX)
    });
    beside.iter().all(|&b| b == beside[0]).then_some(beside[0])
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn no_shadow_on_what_is_seen_is_lost(
        mut objects in prop::collection::vec(object(), 1..30),
        twins in 0..4usize,
        frames in prop::collection::vec((vector(-1.0..1.0), camera(), direction(), any::<bool>()), 1..6),
        methods in [methods(), methods()],
        exact_eye in prop::bool::weighted(0.7),
        cell in prop_oneof![Just(1.0f32), 0.4..2.0f32],
    ) {
        // Some objects lie in the same place.
        for i in 0..twins.min(objects.len()) {
            objects.push(objects[i].clone());
        }
        let dims = UVec3::splat((SIZE / cell).ceil() as u32);
        let silent = |o: &Object| o.name == SILENT && o.motion != Motion::Static;
        let adapt = |o: &Object, desc: ObjectDesc| if silent(o) { desc.reported_on_expiry() } else { desc };
        let mut driver =
            Driver::with(&objects, &GridSpec { min: Vec3::ZERO, cell, dims }, adapt, |_| ()).unwrap();
        let index: HashMap<ObjectId, usize> = (0..objects.len()).map(|i| (driver.id(i), i)).collect();
        let [mut query, mut sun] = methods.map(|m| Query::with_method(m).unwrap());
        // What is new counts as seen.
        let mut reported: HashSet<usize> = (0..objects.len()).collect();
        for (number, (way, (camera, perspective), light, feed_light)) in frames.iter().enumerate() {
            for id in driver.scene.begin_frame(number as f64 * STEP).unwrap() {
                reported.insert(index[&id]);
            }
            let by = way.clamp_length_max(0.9) * SPEED * STEP as f32;
            let moving: Vec<usize> = (0..objects.len()).filter(|&i| objects[i].motion != Motion::Static).collect();
            for &i in &moving {
                objects[i].shape = moved_by(&objects[i].shape, if i % 2 == 0 { by } else { -by });
            }
            let told: Vec<usize> =
                moving.into_iter().filter(|i| !silent(&objects[*i]) || reported.contains(i)).collect();
            driver.update(&objects, &told).unwrap();

            let matrix = camera.view_projection();
            let view = match (perspective, exact_eye) {
                (false, _) => View::orthographic(-camera.view.row(2).truncate(), matrix),
                (true, true) => View::perspective(camera.eye, matrix),
                (true, false) => View::from_view_projection(matrix),
            };
            query.run(&driver.scene, &view.unwrap());
            let mut casters = Vec::new();
            let sunlight = Light::Directional(*light * 3.0);
            sun.shadow_casters(&driver.scene, &query, &sunlight, &mut casters).unwrap();

            let cast: HashSet<usize> = casters.iter().map(|id| index[id]).collect();
            prop_assert_eq!(cast.len(), casters.len());
            let (all, casting) = (rays(&objects, |_| true), rays(&objects, |i| cast.contains(&i)));
            let solid = rays(&objects, |i| objects[i].occludes);
            let light = light.as_dvec3().normalize();
            for point in seen_points(camera, &solid, &all) {
                if blocked(&all, point, light) == Some(true) {
                    let kept = blocked(&casting, point, light) != Some(false);
                    let blocker = all.first_hit(point - light * FAR, light).map(|(i, _)| &objects[i]);
                    prop_assert!(kept, "frame {number}: the shadow at {point} is lost, {blocker:?}");
                }
            }
            let views = if *feed_light { vec![query.pvs(), sun.pvs()] } else { vec![query.pvs()] };
            reported = views.iter().flat_map(|p| p.visible()).map(|id| index[id]).collect();
            driver.scene.end_frame(views).unwrap();
        }
    }
}

/// An empty scene of 64x32x64 cells.
fn street() -> Scene {
    Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::new(64, 32, 64) }).unwrap()
}

fn solid(scene: &mut Scene, min: [f32; 3], max: [f32; 3]) -> ObjectId {
    let b = Aabb::new(min.into(), max.into());
    scene.insert(ObjectDesc::fixed(b).occluder(b)).unwrap()
}

/// Looks along -z from (32, 4, 50), as far as 40.
fn ahead() -> View {
    let eye = Vec3::new(32.0, 4.0, 50.0);
    let matrix = directx::perspective(0.8, 1.5, 0.1, 40.0) * look_to_mat4(eye, Vec3::NEG_Z, Vec3::Y);
    View::perspective(eye, matrix).unwrap()
}

fn casters(scene: &Scene, view: &View, light: Vec3) -> Vec<ObjectId> {
    let (mut camera, mut out) = (Query::new(), Vec::new());
    camera.run(scene, view);
    Query::new().shadow_casters(scene, &camera, &Light::Directional(light), &mut out).unwrap();
    out
}

#[test]
fn casters_are_those_whose_shadow_may_be_seen() {
    let mut scene = street();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let wall = solid(&mut scene, [20.0, 1.0, 28.0], [44.0, 12.0, 30.0]);
    // Behind the camera, with the sun behind it: its shadow falls before the camera.
    let tower = solid(&mut scene, [28.0, 1.0, 56.0], [36.0, 28.0, 58.0]);
    // Beside the view, and so is its shadow.
    let beside = solid(&mut scene, [2.0, 1.0, 40.0], [4.0, 20.0, 42.0]);
    // In the shadow of the tower, and so is all that it might shade.
    let shaded = solid(&mut scene, [31.0, 6.0, 51.0], [33.0, 8.0, 53.0]);
    // In sight of the camera, but in the shadow of the tower.
    let seen = solid(&mut scene, [31.0, 1.0, 42.0], [33.0, 2.0, 44.0]);
    let mut camera = Query::new();
    let pvs = camera.run(&scene, &ahead()).clone();
    for (id, visible) in [(ground, true), (wall, true), (tower, false), (shaded, false), (seen, true)] {
        assert_eq!(pvs.contains(id), visible, "{id}");
    }
    let found = casters(&scene, &ahead(), Vec3::new(0.0, -1.0, -1.0));
    for id in [ground, wall, tower] {
        assert!(found.contains(&id), "{id} of {found:?}");
    }
    for id in [beside, shaded, seen] {
        assert!(!found.contains(&id), "{id} of {found:?}");
    }
    // From the front the tower's shadow falls away from what is seen, and the other two stand in the light.
    let found = casters(&scene, &ahead(), Vec3::new(0.0, -1.0, 1.0));
    assert!(!found.contains(&tower) && !found.contains(&beside), "{found:?}");
    assert!(found.contains(&seen), "{found:?}");
    // From the side, what stands beside the view is a caster.
    let found = casters(&scene, &ahead(), Vec3::new(1.0, -0.4, 0.0));
    assert!(found.contains(&beside) && !found.contains(&tower), "{found:?}");
}

#[test]
fn what_lies_behind_all_receivers_casts_nothing_on_them() {
    let mut scene = street();
    // None hides another; only depth along the light tells them apart.
    let mut ball =
        |y: f32| scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(32.0, y, 30.0), 1.5))).unwrap();
    let (above, seen, below) = (ball(25.0), ball(4.0), ball(0.9));
    let plane = |y: f32, way: f32| Plane { normal: Vec3::Y * way, offset: -y * way };
    let eye = Vec3::new(32.0, 5.0, 50.0);
    // Seen is the part of the middle ball above y = 4.
    let view = View::from_planes(eye, &[plane(4.0, 1.0), plane(6.0, -1.0)]).unwrap();
    let mut camera = Query::new();
    assert_eq!(camera.run(&scene, &view).visible(), [seen]);
    assert_eq!(casters(&scene, &view, Vec3::NEG_Y), [above, seen]);
    assert_eq!(casters(&scene, &view, Vec3::Y), [below, seen]);
    // Across, the others are beside the rays.
    assert_eq!(casters(&scene, &view, Vec3::X), [seen]);
    let mut all = casters(&scene, &View::omnidirectional(eye).unwrap(), Vec3::NEG_Y);
    all.sort_unstable();
    assert_eq!(all, [above, seen, below]);
}

#[test]
fn casters_may_lie_deeper_than_the_nearest_point_of_a_receiver() {
    let mut scene = street();
    // A slope, and a ball close above its lower end.
    let corners = [[31.0, 5.9, 30.0], [31.0, 5.9, 31.9], [32.9, 4.0, 31.9], [32.9, 4.0, 30.0]];
    let slope = TriMesh::new(corners.map(Vec3::from).to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let slope = scene.insert(ObjectDesc::fixed(Arc::new(slope))).unwrap();
    let ball = Sphere::new(Vec3::new(32.8, 4.35, 31.0), 0.05);
    let ball = scene.insert(ObjectDesc::fixed(ball).occluder(ball)).unwrap();
    // Below the ball, the shadow is in sight.
    let ceiling = Plane { normal: Vec3::NEG_Y, offset: 4.2 };
    let view = View::from_planes(Vec3::new(40.0, 4.1, 31.0), &[ceiling]).unwrap();
    assert_eq!(Query::new().run(&scene, &view).visible(), [slope]);
    let found = casters(&scene, &view, Vec3::NEG_Y);
    assert!(found.contains(&slope) && found.contains(&ball), "{found:?}");
}

#[test]
fn moving_casters_that_no_camera_sees_are_found_in_their_volumes() {
    let mut scene = street();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let bird = Sphere::new(Vec3::new(32.0, 28.0, 30.0), 0.5);
    let dynamic = ObjectDesc::dynamic(bird).max_speed(4.0).occluder(bird);
    let reported = scene.insert(dynamic.clone()).unwrap();
    let silent = scene.insert(dynamic.reported_on_expiry()).unwrap();
    let (mut camera, mut sun, mut out) = (Query::new(), Query::new(), Vec::new());
    for frame in 0..5 {
        let due = scene.begin_frame(f64::from(frame) * 0.1).unwrap();
        assert!(due.is_empty(), "{due:?}");
        let pvs = camera.run(&scene, &ahead());
        assert_eq!(pvs.visible(), [ground]);
        sun.shadow_casters(&scene, &camera, &Light::Directional(Vec3::NEG_Y), &mut out).unwrap();
        assert!(out.contains(&reported) && out.contains(&silent), "{frame} {out:?}");
        // One of them moves in its volume and tells so.
        let away = Sphere::new(bird.center + Vec3::Y, bird.radius);
        scene.update(reported, away, Some(away.into())).unwrap();
        scene.end_frame([camera.pvs()]).unwrap();
        assert!(scene.tbv(silent).unwrap().is_some());
    }
    // A strip of ground beside the place where both were: only the silent one may have flown there.
    let strip = [(Vec3::X, 34.2), (Vec3::NEG_X, -34.5), (Vec3::NEG_Y, -2.0)];
    let strip = strip.map(|(normal, at)| Plane { normal, offset: -at });
    let pvs = camera.run(&scene, &View::from_planes(Vec3::new(34.3, 1.5, 60.0), &strip).unwrap());
    assert_eq!(pvs.visible(), [ground]);
    sun.shadow_casters(&scene, &camera, &Light::Directional(Vec3::NEG_Y), &mut out).unwrap();
    assert!(out.contains(&silent) && !out.contains(&reported), "{out:?}");
    // Beside the rays, neither is a caster.
    camera.run(&scene, &ahead());
    sun.shadow_casters(&scene, &camera, &Light::Directional(Vec3::new(-1.0, -0.1, 0.0)), &mut out).unwrap();
    assert!(!out.contains(&reported) && !out.contains(&silent), "{out:?}");
}

#[test]
fn receivers_of_unknown_place_may_be_shaded_by_all_that_the_light_meets() {
    let mut scene = street();
    let ball = Sphere::new(Vec3::new(32.0, 4.0, 30.0), 0.5);
    let lost = ObjectDesc::dynamic(ball).max_speed(4.0).reported_on_expiry();
    let lost = scene.insert(lost).unwrap();
    let far = solid(&mut scene, [2.0, 28.0, 2.0], [4.0, 30.0, 4.0]);
    let below = solid(&mut scene, [2.5, 2.0, 2.5], [3.5, 4.0, 3.5]);
    assert_eq!(casters(&scene, &ahead(), Vec3::NEG_Y), [lost]);
    let away = Plane { normal: Vec3::NEG_X, offset: 1.0 };
    let mut query = Query::new();
    scene.begin_frame(0.0).unwrap();
    query.run(&scene, &View::from_planes(Vec3::ZERO, &[away]).unwrap());
    scene.end_frame([query.pvs()]).unwrap();
    assert_eq!(scene.begin_frame(1e6).unwrap(), [lost]);
    let found = casters(&scene, &ahead(), Vec3::NEG_Y);
    assert!(found.contains(&lost) && found.contains(&far) && !found.contains(&below), "{found:?}");
}

#[test]
fn what_makes_no_sense_is_refused_and_nothing_seen_gets_no_casters() {
    let mut scene = street();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let huge = Sphere::new(Vec3::ZERO, 3e38);
    let (mut camera, mut sun) = (Query::new(), Query::new());
    let mut out = Vec::new();
    let unrun = sun.shadow_casters(&scene, &camera, &Light::Directional(Vec3::NEG_Y), &mut out);
    assert_eq!(unrun, Err(Error::ForeignPvs));
    camera.run(&scene, &ahead());
    sun.shadow_casters(&scene, &camera, &Light::Directional(Vec3::NEG_Y * 1e-40), &mut out).unwrap();
    assert_eq!(out, [ground]);
    for light in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NAN, 1.0)] {
        let message = sun
            .shadow_casters(&scene, &camera, &Light::Directional(light), &mut out)
            .unwrap_err()
            .to_string();
        assert!(message.contains("direction of the light"), "{message}");
    }
    assert_eq!(
        sun.shadow_casters(&street(), &camera, &Light::Directional(Vec3::NEG_Y), &mut out),
        Err(Error::ForeignPvs)
    );
    assert_eq!((out.as_slice(), sun.pvs().visible()), (&[ground][..], &[ground][..]));

    let nothing = Plane { normal: Vec3::Y, offset: -1000.0 };
    let nothing = View::from_planes(Vec3::splat(32.0), &[nothing]).unwrap();
    camera.run(&scene, &nothing);
    sun.shadow_casters(&scene, &camera, &Light::Directional(Vec3::NEG_Y), &mut out).unwrap();
    assert!(out.is_empty() && sun.pvs().is_empty());
    scene.end_frame([camera.pvs(), sun.pvs()]).unwrap();
    assert!(!sun.pvs().is_valid_for(&scene, &nothing));

    // Huge bounds are taken.
    let huge = scene.insert(ObjectDesc::fixed(huge)).unwrap();
    let everywhere = Aabb::new(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX));
    let everywhere = scene.insert(ObjectDesc::fixed(everywhere)).unwrap();
    for light in [Vec3::NEG_Y, Vec3::new(0.3, -1.0, 0.2), Vec3::splat(f32::MAX)] {
        for view in [ahead(), View::omnidirectional(Vec3::splat(3.0)).unwrap()] {
            let found = casters(&scene, &view, light);
            assert!([ground, huge, everywhere].iter().all(|id| found.contains(id)), "{found:?}");
        }
    }
    // Receivers removed since are left out.
    camera.run(&scene, &ahead());
    for id in [ground, huge, everywhere] {
        scene.remove(id).unwrap();
    }
    sun.shadow_casters(&scene, &camera, &Light::Directional(Vec3::NEG_Y), &mut out).unwrap();
    assert!(out.is_empty());
    // The light's view of a point has no width.
    let point = Sphere::new(Vec3::new(32.0, 4.0, 30.0), 0.0);
    let point = scene.insert(ObjectDesc::fixed(point)).unwrap();
    assert_eq!(casters(&scene, &ahead(), Vec3::NEG_Y), [point]);
}
