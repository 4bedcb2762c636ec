//! Scenes far from the origin of their file.

use glam::DVec3;

use super::*;

/// A room of walls that only just overlap, with a camera that moves; `at` is where it lies, by a
/// node above it, by the nodes themselves or by the positions of meshes.
fn room(at: DVec3, by: &str) -> World {
    let mut parts = Parts::default();
    let shift = if by == "positions" { at.as_vec3() } else { Vec3::ZERO };
    let corners = SQUARE.chunks_exact(3).map(|c| Vec3::from_slice(c) * 4.0 + shift);
    parts.floats("VEC3", &corners.flat_map(|c| c.to_array()).collect::<Vec<_>>());
    parts.floats("SCALAR", &[0.0, 1.0]);
    let eye = if by == "parent" { Vec3::ZERO } else { at.as_vec3() } + Vec3::new(2.0, 1.5, 3.0);
    parts.floats("VEC3", &[eye, eye + Vec3::X].map(|e| e.to_array()).concat());
    let own = if by == "nodes" { at } else { DVec3::ZERO };
    let node = |x: f64| {
        let place = own + DVec3::X * x;
        format!(r#"{{"mesh":0,"translation":[{},{},{}]}}"#, place.x, place.y, place.z)
    };
    let top = if by == "parent" { at } else { DVec3::ZERO };
    let top = format!(r#"{{"children":[1,2,3],"translation":[{},{},{}]}}"#, top.x, top.y, top.z);
    // A hundredth of a millimetre, which no float tells at 500 km.
    let nodes = [top, node(0.0), node(4.00001), r#"{"camera":0}"#.to_owned()].join(",");
    let camera = r#""cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}]"#;
    let clip = animated(3, "translation", 2, "LINEAR");
    let mesh = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}]"#;
    parts.read(&format!(r#""nodes":[{nodes}],{mesh},"animations":[{clip}],{camera}"#)).unwrap()
}

#[test]
fn scenes_far_from_the_origin_are_moved_to_one_of_their_own() {
    let near = room(DVec3::ZERO, "nodes");
    assert_eq!(near.source.origin, DVec3::ZERO);
    for at in [DVec3::new(500_000.0, 0.0, 100.0), DVec3::new(447_212.0, 31.5, -5_414_016.0)] {
        for by in ["parent", "nodes", "positions"] {
            let far = room(at, by);
            let origin = far.source.origin;
            let offset = (at - origin).as_vec3();
            assert!(offset.abs().max_element() < 16.0 && origin == origin.round(), "{by}: {origin}");
            assert_eq!(origin, origin.as_vec3().as_dvec3());
            // Positions in floats have the precision of floats; all else is as near the origin.
            let within = if by == "positions" { 1.0 } else { 1e-5 };
            for object in 0..2 {
                for (a, b) in
                    triangles(&near, object).iter().flatten().zip(triangles(&far, object).iter().flatten())
                {
                    assert!((*a + offset).abs_diff_eq(*b, within), "{by} {object}: {a} {b}");
                }
            }
            // Children come last first.
            let gap = |world: &World| triangles(world, 0)[0][0].x - triangles(world, 1)[0][1].x;
            if by != "positions" {
                assert!((gap(&far) - gap(&near)).abs() < 2e-6 && gap(&far) > 5e-6, "{by}: {}", gap(&far));
            }
            for frame in [0, 15, 30] {
                let (a, b) = (near.camera(frame, 1.0).eye, far.camera(frame, 1.0).eye);
                let within = if by == "parent" { 1e-5 } else { 1.0 };
                assert!((a + offset).abs_diff_eq(b, within), "{by} {frame}: {a} {b}");
            }
            assert!((far.grid.cell - near.grid.cell).abs() < 0.01, "{by}: {}", far.grid.cell);
        }
    }
    // A scene that is large beside its distance stays.
    assert_eq!(room(DVec3::X * 300.0, "nodes").source.origin, DVec3::ZERO);
}

#[test]
fn what_moves_is_moved_with_its_scene() {
    let far = DVec3::new(500_000.0, 0.0, 0.0);
    let mut parts = timed();
    let values = parts.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let clip = animated(1, "translation", values, "LINEAR");
    let rest = moved(&format!("[{clip}]"))
        .replace(r#"{"children":[1]}"#, r#"{"children":[1],"translation":[500000.25,0,0]}"#);
    let mut world = parts.read(&rest).unwrap();
    for (frame, x) in [(0, 0.25), (3, 0.45), (15, 1.25), (30, 2.25)] {
        world.set_frame(frame);
        let found = f64::from(triangles(&world, 0)[0][0].x) + world.source.origin.x - far.x;
        assert!((found - x).abs() < 1e-5, "{frame}: {found}");
    }
    let Motion::Dynamic { max_speed } = world.objects[0].motion else { panic!("it moves") };
    assert!((2.0..2.1).contains(&max_speed), "{max_speed}");
}
