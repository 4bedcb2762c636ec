//! Places in single precision: bounds contain the shape at its place, and it contains the occluder.

use crate::common::*;

/// All places and corners are multiples of this and below 2^25, so that their sums are exact.
const DIGIT: f64 = 1.0 / (1u64 << 22) as f64;

fn point(random: &mut Random, lo: f64, hi: f64) -> DVec3 {
    (random.point(lo, hi) / DIGIT).round() * DIGIT
}

/// Shapes of some kind around a middle; all of them reach as far along each axis.
fn shapes(kind: usize, middle: Vec3, half: f32) -> (Bounds, Occluder) {
    let b = Aabb::from_center(middle, Vec3::splat(half));
    match kind {
        0 => (b.into(), b.into()),
        1 => (Sphere::new(middle, half).into(), Sphere::new(middle, half).into()),
        2 => {
            let obb = Obb::new(middle, Vec3::splat(half), Quat::IDENTITY);
            (obb.into(), obb.into())
        }
        _ => {
            let corners: Vec<Vec3> = (0..8)
                .map(|i| {
                    Vec3::from_array([0, 1, 2].map(|a| if i >> a & 1 == 0 { b.min[a] } else { b.max[a] }))
                })
                .collect();
            (b.into(), Arc::new(Convex::from_points(&corners).unwrap()).into())
        }
    }
}

fn block_of(occluder: &Occluder) -> (DVec3, DVec3) {
    match occluder {
        Occluder::Box(b) => (b.min.as_dvec3(), b.max.as_dvec3()),
        Occluder::Sphere(s) => {
            let (c, r) = (s.center.as_dvec3(), f64::from(s.radius));
            (c - r, c + r)
        }
        Occluder::Oriented(b) => {
            (b.center.as_dvec3() - b.half.as_dvec3(), b.center.as_dvec3() + b.half.as_dvec3())
        }
        Occluder::Convex(solid) => {
            let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            solid.vertices().fold(none, |(lo, hi), v| (lo.min(v), hi.max(v)))
        }
        _ => unreachable!("no other shapes are played with"),
    }
}

/// Compares an object with its exact box; how much larger its bounds are.
fn check(scene: &Scene, id: ObjectId, min: DVec3, max: DVec3) -> f64 {
    let (min, max) = (min - scene.origin(), max - scene.origin());
    // Their box alone is a little larger than the shapes.
    let (low, high) = match scene.bounds(id).unwrap() {
        Bounds::Sphere(s) => block_of(&(*s).into()),
        Bounds::Oriented(b) => block_of(&(*b).into()),
        bounds => (bounds.aabb().min.as_dvec3(), bounds.aabb().max.as_dvec3()),
    };
    assert!(low.cmple(min).all() && high.cmpge(max).all(), "bounds {low} {high} of {min} {max}");
    let (inner, outer) = block_of(scene.occluder(id).unwrap().expect("it is thick enough"));
    assert!(inner.cmpge(min).all() && outer.cmple(max).all(), "occluder {inner} {outer} of {min} {max}");
    let most = (min - low).max(high - max).max(inner - min).max(max - outer).max_element();
    // A few steps of single precision at a few thousand units, in each of a few shifts.
    assert!(most < 4e-3, "{most}");
    most
}

#[test]
fn bounds_contain_shapes_at_their_places_and_occluders_lie_in_them() {
    let mut random = Random(11);
    let mut rounded = 0;
    for round in 0..40 {
        let far = [100.0, 1e4, 1e6, 3e7][round % 4];
        let mut scene = Scene::new(1.0).unwrap();
        let mut origin = point(&mut random, -far, far);
        scene.set_origin(origin).unwrap();
        let mut objects = Vec::new();
        for i in 0..40 {
            // Few digits, so that the corners are exact.
            let middle = (random.point(0.0, 512.0) * 1024.0).round().as_vec3() / 1024.0;
            let half = (random.within(1.0, 4.0) * 256.0).round() as f32 / 256.0;
            let (bounds, occluder) = shapes(i % 4, middle, half);
            let desc = if i % 8 < 4 { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
            let id = scene.insert(desc.occluder(occluder)).unwrap();
            let (at, half) = (origin + middle.as_dvec3(), f64::from(half));
            objects.push((id, at - half, at + half));
        }
        for _ in 0..4 {
            for &(id, min, max) in &objects {
                rounded += usize::from(check(&scene, id, min, max) > 0.0);
            }
            origin += point(&mut random, -1000.0, 1000.0);
            scene.set_origin(origin).unwrap();
        }
    }
    assert!(rounded > 500, "places are between the steps of single precision: {rounded}");
}

#[test]
fn shapes_with_few_digits_are_the_same_after_every_shift() {
    let mut scene = Scene::new(1.0).unwrap();
    let start = DVec3::new(123_456.0 * 512.0, -7.0 * 512.0, 512.0 * f64::from(1 << 20));
    scene.set_origin(start).unwrap();
    let wall = Aabb::new(Vec3::new(0.125, 3.5, 511.75), Vec3::new(40.0, 9.25, 512.5));
    let id = scene.solid(wall);
    for step in 0..20 {
        let by = DVec3::new(512.0 * f64::from(step % 5), 512.0 * f64::from(step), -512.0);
        scene.set_origin(start + by).unwrap();
        let moved = Aabb::new(wall.min - by.as_vec3(), wall.max - by.as_vec3());
        assert_eq!(scene.bounds(id).unwrap().aabb(), moved);
        let Some(Occluder::Box(occluder)) = scene.occluder(id).unwrap() else { panic!() };
        assert_eq!(*occluder, moved);
    }
}

#[test]
fn an_eye_far_from_the_origin_sees_through_a_slit() {
    for far in [0.0, 1e6, 3e7, 1e9] {
        let mut scene = Scene::new(1.0).unwrap();
        let eye = DVec3::new(far + 0.37, 100.13, -far - 0.71);
        scene.set_origin(eye).unwrap();
        // The eye is before the middle of a slit of 2 cm, and a ball of 1 cm beyond it.
        for side in [-1.0, 1.0] {
            scene.solid(Aabb::from_center(Vec3::new(10.0, 0.0, side * 20.01), Vec3::new(0.5, 20.0, 20.0)));
        }
        let [seen, hidden] = [0.0, 1.0].map(|z| scene.fixed(Sphere::new(Vec3::new(30.0, 0.0, z), 0.005)));
        for origin in [eye, DVec3::new(far, 0.0, -far), DVec3::new(far + 800.3, 20.0, -far)] {
            scene.set_origin(origin).unwrap();
            let view = scene.view(eye, &around(Vec3::ZERO)).unwrap();
            assert_eq!(view.eye(), Some(eye - scene.origin()));
            let mut query = Query::new();
            let pvs = query.run(&scene, &view);
            assert!(pvs.contains(seen) && !pvs.contains(hidden), "at {far} from {origin}");
        }
    }
}
