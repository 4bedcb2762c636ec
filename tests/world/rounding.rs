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
fn check(world: &World, id: ObjectId, min: DVec3, max: DVec3) -> f64 {
    let scene = world.scene();
    let (min, max) = (min - world.origin(), max - world.origin());
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
    // A few steps of single precision at a few thousand units.
    assert!(most < 2e-3, "{most}");
    most
}

#[test]
fn bounds_contain_shapes_at_their_places_and_occluders_lie_in_them() {
    let mut random = Random(11);
    let mut rounded = 0;
    for round in 0..40 {
        let far = [100.0, 1e4, 1e6, 3e7][round % 4];
        let options = WorldOptions::new(1.0).reach(2).budget(usize::MAX);
        let mut world = World::new(options).unwrap();
        let mut eye = point(&mut random, -far, far);
        world.begin_frame(0.0, eye).unwrap();
        let mut objects = Vec::new();
        for i in 0..40 {
            // Few digits, so that the corners are exact.
            let middle = (random.point(0.0, 512.0) * 1024.0).round().as_vec3() / 1024.0;
            let half = (random.within(1.0, 4.0) * 256.0).round() as f32 / 256.0;
            let (bounds, occluder) = shapes(i % 4, middle, half);
            let desc = ObjectDesc::dynamic(bounds).occluder(occluder).user_data(i as u64);
            let (place, id) = if i % 8 < 4 {
                let place = point(&mut random, -500.0, 500.0) + eye;
                (place, world.insert(desc, place).unwrap())
            } else {
                let page = world.page_at(eye).unwrap();
                let n = i as i32;
                let page = PageId::new(page.x + n % 3 - 1, page.y, page.z - n % 2);
                world.load(page, PageObjects::new([desc]).unwrap()).unwrap();
                world.settle(eye).unwrap();
                (world.corner(page), *world.page_objects(page).last().unwrap())
            };
            objects.push((id, place, middle.as_dvec3(), f64::from(half)));
        }
        for _ in 0..4 {
            for &(id, place, middle, half) in &objects {
                let (min, max) = (place + middle - half, place + middle + half);
                let off = check(&world, id, min, max);
                rounded += usize::from(off > 0.0);
            }
            // The origin follows, and each object moves on its own.
            eye += point(&mut random, -1000.0, 1000.0);
            world.settle(eye).unwrap();
            for (id, place, _, _) in &mut objects {
                *place += point(&mut random, -50.0, 50.0);
                world.set_place(*id, *place).unwrap();
            }
        }
    }
    assert!(rounded > 1000, "places are between the steps of single precision: {rounded}");
}

#[test]
fn shapes_with_few_digits_are_the_same_after_every_shift() {
    let options = WorldOptions::new(1.0).reach(2).budget(usize::MAX);
    let mut world = World::new(options).unwrap();
    let page = PageId::new(123_456, -7, 1 << 20);
    let wall = Aabb::new(Vec3::new(0.125, 3.5, 511.75), Vec3::new(40.0, 9.25, 512.5));
    let desc = ObjectDesc::fixed(wall).occluder(wall);
    world.load(page, PageObjects::new([desc]).unwrap()).unwrap();
    for step in 0..20 {
        let eye = world.corner(page) + DVec3::new(700.0 * f64::from(step % 5), 90.0 * f64::from(step), 1.0);
        world.settle(eye).unwrap();
        let id = world.page_objects(page)[0];
        let by = (world.corner(page) - world.origin()).as_vec3();
        assert_eq!(world.scene().bounds(id).unwrap().aabb(), Aabb::new(wall.min + by, wall.max + by));
        let Some(Occluder::Box(occluder)) = world.scene().occluder(id).unwrap() else { panic!() };
        assert_eq!(*occluder, Aabb::new(wall.min + by, wall.max + by));
    }
}

#[test]
fn an_eye_far_from_the_origin_sees_through_a_slit() {
    for far in [0.0, 1e6, 3e7, 1e9] {
        let mut world = World::new(WorldOptions::new(1.0).budget(usize::MAX)).unwrap();
        let eye = DVec3::new(far + 0.37, 100.13, -far - 0.71);
        world.begin_frame(0.0, eye).unwrap();
        // The eye is before the middle of a slit of 2 cm, and a ball of 1 cm beyond it.
        for side in [-1.0, 1.0] {
            let wall = Aabb::from_center(Vec3::ZERO, Vec3::new(0.5, 20.0, 20.0));
            let at = eye + DVec3::new(10.0, 0.0, side * 20.01);
            world.insert(ObjectDesc::fixed(wall).occluder(wall), at).unwrap();
        }
        let ball = |world: &mut World, z: f64| {
            let ball = ObjectDesc::fixed(Sphere::new(Vec3::ZERO, 0.005));
            world.insert(ball, eye + DVec3::new(30.0, 0.0, z)).unwrap()
        };
        let (seen, hidden) = (ball(&mut world, 0.0), ball(&mut world, 1.0));
        let around = around(Vec3::ZERO);
        let view = world.scene().view(eye, &around).unwrap();
        assert_eq!(view.eye(), Some(eye - world.origin()));
        let mut query = Query::new();
        let pvs = query.run(world.scene(), &view);
        assert!(pvs.contains(seen) && !pvs.contains(hidden), "at {far}");
    }
}
