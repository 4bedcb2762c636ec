//! Random scenes, cameras and lights, judged by exact rays.

use std::cell::Cell;
use std::collections::{HashMap, HashSet};

use casca_scenes::drive::Driver;
use casca_scenes::world::{Camera, Motion, Object};
use casca_truth::oracle::RayOracle;

use crate::common::*;
use crate::scenes::{SILENT, SPEED, object, place, way};

/// Seconds between frames.
const STEP: f64 = 0.25;

/// Where light rays start, in front of the point that they aim at.
const FAR: f64 = 200.0;

/// A camera, perspective or orthographic.
fn camera() -> impl Strategy<Value = (Camera, bool)> {
    (place(), way(), 15.0..120.0f32, 0.4..2.5f32, prop::bool::weighted(0.8)).prop_map(
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

/// A light, and the layers that cast its shadows.
#[derive(Debug, Clone)]
struct Lamp {
    shine: Shine,
    layers: u64,
}

/// Where a light's rays start.
#[derive(Debug, Clone)]
enum Shine {
    Sun(Vec3),
    Bulb { at: Vec3, range: f32 },
    Spot { camera: Camera, perspective: bool, exact_eye: bool },
}

/// The layers of a camera or of a light.
fn mask() -> impl Strategy<Value = u64> {
    prop_oneof![2 => Just(u64::MAX), 1 => 0..8u64]
}

fn lamp() -> impl Strategy<Value = Lamp> {
    let range = prop_oneof![2 => 1.0..30.0f32, 1 => Just(f32::INFINITY)];
    let shine = prop_oneof![
        2 => way().prop_map(Shine::Sun),
        2 => (place(), range).prop_map(|(at, range)| Shine::Bulb { at, range }),
        2 => (camera(), prop::bool::weighted(0.7))
            .prop_map(|((camera, perspective), exact_eye)| Shine::Spot { camera, perspective, exact_eye }),
    ];
    (shine, mask()).prop_map(|(shine, layers)| Lamp { shine, layers })
}

impl Lamp {
    fn light(&self) -> Light {
        let light = match &self.shine {
            Shine::Sun(direction) => Light::directional(*direction * 3.0),
            Shine::Bulb { at, range } => Light::point(*at, *range),
            Shine::Spot { camera, perspective, exact_eye } => {
                Light::spot(view_of(camera, *perspective, *exact_eye))
            }
        };
        light.with_layers(self.layers)
    }

    /// Where the light's ray to a point starts; `None` for points that it does not reach, or
    /// hardly.
    fn start(&self, point: DVec3) -> Option<DVec3> {
        match &self.shine {
            Shine::Sun(direction) => Some(point - direction.as_dvec3().normalize() * FAR),
            Shine::Bulb { at, range } => {
                let at = at.as_dvec3();
                (point.distance(at) < f64::from(*range) * 0.9999).then_some(at)
            }
            Shine::Spot { camera, .. } => {
                let matrix = camera.view_projection().as_dmat4();
                let clip = matrix * point.extend(1.0);
                let at = clip.truncate() / clip.w;
                let inside = clip.w > 0.0
                    && at.truncate().abs().max_element() < 0.9999
                    && (0.0001..0.9999).contains(&at.z);
                inside.then(|| matrix.inverse().project_point3(at.with_z(0.0)))
            }
        }
    }
}

fn view_of(camera: &Camera, perspective: bool, exact_eye: bool) -> View {
    let matrix = camera.view_projection();
    let view = match (perspective, exact_eye) {
        (false, _) => View::orthographic(-camera.view.row(2).truncate(), matrix),
        (true, true) => View::perspective(camera.eye, matrix),
        (true, false) => View::from_view_projection(matrix),
    };
    view.unwrap()
}

/// The layers of an object: by where it was first, so that they are many and the same in each
/// frame.
fn layers(number: usize) -> u64 {
    [u64::MAX, 1, 2, 6, u64::MAX][number % 5]
}

fn methods() -> impl Strategy<Value = Method> {
    let point = (20.0..640.0f32, prop_oneof![Just(0u32), Just(256)]).prop_map(|(pixels, squares)| {
        Method::Point(PointOptions::default().pixel_degrees(90.0 / pixels).refine_squares(squares))
    });
    prop_oneof![1 => Just(Method::cell()), 1 => Just(Method::Frustum), 6 => point]
}

/// The rays of those objects that `blocks` says block.
fn rays(objects: &[Object], blocks: impl Fn(usize) -> bool) -> RayOracle {
    let of = |(i, o): (usize, &Object)| Object { occludes: blocks(i), ..o.clone() };
    RayOracle::new(&objects.iter().enumerate().map(of).collect::<Vec<_>>())
}

/// Points that the camera sees through the middles of some pixels: of occluders, and of what else
/// is before them.
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

/// Whether the ray to a point, and four beside it, are blocked by all or by none; `None` where they
/// differ.
fn blocked(oracle: &RayOracle, start: DVec3, point: DVec3) -> Option<bool> {
    let (right, up) = (point - start).normalize_or(DVec3::X).any_orthonormal_pair();
    let beside = [DVec3::ZERO, right, -right, up, -up].map(|side| {
        let side = side * 1e-5;
        oracle.occluded(start + side, point + side, usize::MAX)
    });
    beside.iter().all(|&b| b == beside[0]).then_some(beside[0])
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn no_shadow_on_what_is_seen_is_lost(
        mut objects in prop::collection::vec(object(), 1..30),
        twins in 0..4usize,
        frames in prop::collection::vec((vector(-1.0..1.0), (camera(), mask()), lamp(), any::<bool>()), 1..6),
        methods in [methods(), methods()],
        exact_eye in prop::bool::weighted(0.7),
        cell in prop_oneof![Just(1.0f32), 0.4..2.0f32],
    ) {
        // Some objects lie in the same place.
        for i in 0..twins.min(objects.len()) {
            objects.push(objects[i].clone());
        }
        let silent = |o: &Object| o.name == SILENT && o.motion != Motion::Static;
        let inserted = Cell::new(0);
        let adapt = |o: &Object, desc: ObjectDesc| {
            let desc = desc.layers(layers(inserted.replace(inserted.get() + 1)));
            if silent(o) { desc.reported_on_expiry() } else { desc }
        };
        let mut driver =
            Driver::with(&objects, cell, None, adapt, |_| ()).unwrap();
        let index: HashMap<ObjectId, usize> = (0..objects.len()).map(|i| (driver.id(i), i)).collect();
        let [mut query, mut sun] = methods.map(query_by);
        let (mut kept, mut kept_sun) = (KeptQuery::new(), sun.clone());
        let (mut several, mut lists) = ([sun.clone(), sun.clone()], Vec::new());
        // What is new counts as seen.
        let mut reported: HashSet<usize> = (0..objects.len()).collect();
        for (number, (way, ((camera, perspective), seen), lamp, feed_light)) in frames.iter().enumerate() {
            for id in driver.scene.begin_frame(number as f64 * STEP).unwrap() {
                reported.insert(index[&id]);
            }
            let by = way.clamp_length_max(0.9) * SPEED * STEP as f32;
            let moving: Vec<usize> = (0..objects.len()).filter(|&i| objects[i].motion != Motion::Static).collect();
            for &i in &moving {
                objects[i].shape = objects[i].shape.moved(if i % 2 == 0 { by } else { -by });
            }
            let told: Vec<usize> =
                moving.into_iter().filter(|i| !silent(&objects[*i]) || reported.contains(i)).collect();
            driver.update(&objects, &told).unwrap();

            let view = view_of(camera, *perspective, exact_eye).with_layers(*seen);
            query.run(&driver.scene, &view);
            kept.run(&driver.scene, &view);
            let (mut casters, mut of_kept) = (Vec::new(), Vec::new());
            kept_sun.shadow_casters(&driver.scene, &kept, &lamp.light(), &mut of_kept).unwrap();
            sun.shadow_casters(&driver.scene, &query, &lamp.light(), &mut casters).unwrap();
            // Two lights and two cameras at once.
            let other = &frames[(number + 1) % frames.len()].2;
            let lights = [other.light(), lamp.light()];
            let cameras: [&dyn CameraQuery; 2] = [&query, &kept];
            Query::shadow_casters_of_all(&mut several, &driver.scene, &cameras, &lights, &mut lists).unwrap();

            let on = |i: usize, mask: u64| layers(i) & mask != 0;
            let all = rays(&objects, |i| on(i, *seen));
            let solid = rays(&objects, |i| on(i, *seen) && objects[i].occludes);
            let found = [(&casters, lamp), (&of_kept, lamp), (&lists[0], other), (&lists[1], lamp)];
            for (casters, lamp) in found {
                let cast: HashSet<usize> = casters.iter().map(|id| index[id]).collect();
                prop_assert_eq!(cast.len(), casters.len());
                prop_assert!(cast.iter().all(|&i| on(i, lamp.layers)), "{cast:?} not on {:#x}", lamp.layers);
                let blocking = rays(&objects, |i| on(i, lamp.layers));
                let casting = rays(&objects, |i| cast.contains(&i));
                for point in seen_points(camera, &solid, &all) {
                    let Some(start) = lamp.start(point) else { continue };
                    if blocked(&blocking, start, point) == Some(true) {
                        let stays = blocked(&casting, start, point) != Some(false);
                        let blocker = blocking.first_hit(start, point - start).map(|(i, _)| &objects[i]);
                        prop_assert!(stays, "frame {number}: the shadow at {point} is lost, {blocker:?}");
                    }
                }
            }
            let views = if *feed_light { vec![query.pvs(), sun.pvs()] } else { vec![query.pvs()] };
            reported = views.iter().flat_map(|p| p.visible()).map(|id| index[id]).collect();
            driver.scene.end_frame(views).unwrap();
        }
    }
}
