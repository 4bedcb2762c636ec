//! Nodes that move.

use super::*;

/// The corner of the moving triangle at the origin of its mesh.
fn origin(world: &mut World, frame: usize) -> Vec3 {
    world.set_frame(frame);
    triangles(world, 0)[0][0]
}

#[test]
fn animations_interpolate_as_asked() {
    let mut parts = timed();
    let values = parts.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 4.0]);
    for (interpolation, expected) in [
        ("STEP", [(0, 0.0), (14, 0.0), (15, 1.0), (29, 1.0), (30, 2.0), (45, 2.0)]),
        ("LINEAR", [(0, 0.0), (3, 0.2), (15, 1.0), (24, 1.6), (30, 2.0), (45, 1.0)]),
    ] {
        let mut world = parts.animated(0, "translation", values, interpolation).unwrap();
        for (frame, x) in expected {
            let found = origin(&mut world, frame).x - 3.0;
            assert!((found - x).abs() < 1e-4, "{interpolation} {frame}: {found}");
        }
    }
    // A spline with tangents of 0: halfway between two keys the mean, a quarter on 5/32 of the way.
    let key = |x: f32| [0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, 0.0, 0.0];
    let spline = parts.floats("VEC3", &[key(0.0), key(0.0), key(0.0), key(32.0)].concat());
    let mut world = parts.animated(0, "translation", spline, "CUBICSPLINE").unwrap();
    assert!((origin(&mut world, 45).x - 19.0).abs() < 1e-3);
    let quarter = origin(&mut world, 37).x - 3.0;
    let t = 7.0f32 / 30.0;
    assert!((quarter - 32.0 * (3.0 * t * t - 2.0 * t * t * t)).abs() < 1e-3, "{quarter}");
    says(
        parts.animated(0, "translation", values, "CUBICSPLINE"),
        &["accessor 2 (animation values)", "not as long"],
    );
    let mut parts = timed();
    parts.accessors[1] = parts.accessors[1].replace(r#""count":4"#, r#""count":1"#);
    parts.floats("VEC3", &[f32::NAN, 0.0, 0.0]);
    says(parts.animated(0, "scale", 2, "STEP"), &["accessor 2", "not finite"]);
    let mut parts = triangle();
    parts.floats("SCALAR", &[1.0, 0.5]);
    parts.floats("VEC3", &[0.0; 6]);
    says(parts.animated(0, "scale", 2, "STEP"), &["(animation times)", "order"]);
}

#[test]
fn normalized_rotations_turn_nodes() {
    let turns = [[0, 0, 0, 32767], [0, 0, 23170, 23170], [0, 0, 32767, 0], [0, 0, 23170, -23170]];
    let mut parts = timed();
    let shorts = parts.dense(5122, "VEC4", &rotation_bytes(&turns), r#","normalized":true"#);
    let bytes: Vec<u8> = turns.iter().flatten().map(|&v| (v >> 8) as i8 as u8).collect();
    let bytes = parts.dense(5120, "VEC4", &bytes, r#","normalized":true"#);
    let raw = parts.dense(5122, "VEC4", &rotation_bytes(&turns), "");
    for (output, within) in [(shorts, 1e-3), (bytes, 0.05)] {
        let mut world = parts.animated(0, "rotation", output, "LINEAR").unwrap();
        for (frame, angle) in [(0, 0.0f32), (15, 90.0), (20, 120.0), (30, 180.0), (45, 225.0)] {
            let expected = Quat::from_rotation_z(angle.to_radians()) * (Vec3::X * 3.0);
            let found = origin(&mut world, frame);
            assert!(found.distance(expected) < within, "{frame}: {found} is not {expected}");
        }
    }
    says(parts.animated(0, "rotation", raw, "LINEAR"), &["(animation values)", "type"]);
    says(parts.animated(0, "translation", shorts, "LINEAR"), &["(animation values)", "type"]);
    let none = parts.floats("VEC4", &[0.0; 16]);
    says(parts.animated(0, "rotation", none, "STEP"), &["rotation of no"]);
}

#[test]
fn of_two_animations_the_first_is_used() {
    let mut parts = timed();
    let ones = parts.floats("VEC3", &[1.0; 12]);
    let twos = parts.floats("VEC3", &[2.0; 12]);
    let (first, second) =
        (animated(1, "translation", ones, "STEP"), animated(1, "translation", twos, "STEP"));
    for (animations, x) in [(format!("[{first},{second}]"), 1.0), (format!("[{second},{first}]"), 2.0)] {
        assert_eq!(origin(&mut parts.read(&moved(&animations)).unwrap(), 1).x, x);
    }
    // Different properties go together.
    let scale = animated(1, "scale", twos, "STEP");
    let mut world = parts.read(&moved(&format!("[{first},{scale}]"))).unwrap();
    world.set_frame(1);
    assert_eq!(triangles(&world, 0)[0][1], Vec3::new(3.0, 1.0, 1.0));
    // What is not used is checked all the same.
    let short = parts.floats("VEC3", &[2.0; 3]);
    let broken = animated(1, "translation", short, "STEP");
    says(parts.read(&moved(&format!("[{first},{broken}]"))), &["not as long"]);
}

#[test]
fn speeds_bound_every_point_and_bounds_hold_all_frames() {
    let mut parts = Parts::default();
    parts.floats("VEC3", &[0.0, 0.0, 0.0, 4.0, 0.5, 0.0, -1.0, 2.0, 3.0]);
    parts.floats("SCALAR", &[0.0, 0.5, 1.0, 2.0]);
    let wild: Vec<f32> = (0..48).map(|i| ((i * 7 % 11) as f32 - 5.0) * 0.3 + 0.1).collect();
    let way = parts.floats("VEC3", &wild[..36]);
    let turn = parts.floats("VEC4", &wild);
    let turns = parts.floats("VEC4", &wild[..16]);
    let sizes = parts.floats("VEC3", &wild[5..17]);
    for animations in [
        vec![animated(0, "translation", way, "CUBICSPLINE")],
        vec![animated(0, "rotation", turns, "LINEAR")],
        vec![animated(0, "rotation", turn, "CUBICSPLINE")],
        vec![animated(0, "rotation", turns, "STEP"), animated(1, "scale", sizes, "LINEAR")],
        vec![
            animated(1, "rotation", turn, "CUBICSPLINE"),
            animated(0, "scale", sizes, "STEP"),
            animated(0, "translation", way, "CUBICSPLINE"),
        ],
    ] {
        let mut world = parts.read(&moved(&format!("[{}]", animations.join(",")))).unwrap();
        let Motion::Dynamic { max_speed } = world.objects[0].motion else { panic!("it moves") };
        let (mut fastest, mut last) = (0f64, None);
        for frame in 0..world.frames {
            assert_eq!(world.set_frame(frame), [0]);
            let now = triangles(&world, 0)[0];
            assert!(now.iter().all(|p| p.cmpge(world.grid.min).all() && p.cmple(world.grid.max).all()));
            for (p, q) in now.iter().zip(last.unwrap_or(now)) {
                fastest = fastest.max(p.as_dvec3().distance(q.as_dvec3()) / FRAME_SECONDS);
            }
            last = Some(now);
        }
        assert!(fastest > 0.1 && fastest <= f64::from(max_speed), "{fastest} {max_speed}");
        // The box is larger than the triangle, but not by much.
        assert!(f64::from(max_speed) < 2.0 * fastest, "{fastest} {max_speed}");
    }
    // What is animated but stays has no speed.
    let still = parts.floats("VEC3", &[2.0; 12]);
    let world = parts.animated(0, "translation", still, "LINEAR").unwrap();
    assert_eq!(world.objects[0].motion, Motion::Dynamic { max_speed: 0.0 });
}

#[test]
fn speeds_bound_what_is_rounded() {
    // Far out, roundings of single points are as large as their way.
    let mut parts = Parts::default();
    let points: Vec<f32> = (0..90).map(|i| 1e5 + (i * 37 % 91) as f32).collect();
    parts.floats("VEC3", &points);
    parts.floats("SCALAR", &[0.0, 0.5, 1.0, 2.0]);
    let turn = |angle: f32| Quat::from_rotation_z(angle).to_array();
    let turns = parts.floats("VEC4", &[turn(0.8), turn(0.8), turn(0.800_003), turn(0.800_003)].concat());
    let moved = moved(&format!("[{}]", animated(1, "rotation", turns, "STEP")));
    let mut world = parts.read(&moved).unwrap();
    let Motion::Dynamic { max_speed } = world.objects[0].motion else { panic!("it moves") };
    let mut last = triangles(&world, 0);
    for frame in 1..world.frames {
        world.set_frame(frame);
        let now = triangles(&world, 0);
        for (p, q) in now.iter().flatten().zip(last.iter().flatten()) {
            let speed = p.as_dvec3().distance(q.as_dvec3()) / FRAME_SECONDS;
            assert!(speed <= f64::from(max_speed), "{frame}: {speed} {max_speed}");
        }
        last = now;
    }
}

#[test]
fn instances_move_with_their_nodes() {
    let (mut parts, rest) = instanced(PLACED);
    parts.floats("SCALAR", &[0.0, 1.0]);
    let way = parts.floats("VEC3", &[10.0, 0.0, 0.0, 10.0, 0.0, 6.0]);
    let animation = animated(0, "translation", way, "LINEAR").replace(r#""input":1"#, r#""input":5"#);
    let mut world = parts.read(&format!(r#"{rest},"animations":[{animation}]"#)).unwrap();
    assert_eq!(world.set_frame(15), [0, 1, 2]);
    for object in 0..3 {
        let Motion::Dynamic { max_speed } = world.objects[object].motion else { panic!("it moves") };
        assert!((6.0..6.2).contains(&max_speed), "{max_speed}");
        assert!((triangles(&world, object)[0][0].z - 3.0).abs() < 1e-4);
    }
}
