//! Nodes, their roles, cameras and scenes.

use super::*;

/// Whether the only object is a box that hides nothing, from a corner to another in its space, and
/// whether the only warning has all of `parts`.
fn is_boxed(world: &World, low: Vec3, high: Vec3, parts: &[&str]) {
    let [object] = &world.objects[..] else { panic!("one object") };
    let (min, max) = match &object.shape {
        Shape::Mesh { mesh, .. } => mesh.bounds(&glam::Affine3A::IDENTITY),
        Shape::Box { min, max } => (*min, *max),
        Shape::Sphere { .. } => panic!("a sphere"),
    };
    assert!(min.cmple(low).all() && high.cmple(max).all(), "{min} to {max}");
    assert!(min.abs_diff_eq(low, 0.1) && max.abs_diff_eq(high, 0.1), "{min} to {max}");
    assert!(!object.occludes && object.tested && object.motion != Motion::Static);
    let [told] = &world.source.warnings[..] else { panic!("{:?}", world.source.warnings) };
    assert!(parts.iter().all(|part| told.contains(part)), "{told}");
}

#[test]
fn deformed_meshes_count_as_their_boxes_and_hide_nothing() {
    let mut parts = timed();
    parts.floats("SCALAR", &[0.0, 1.0, -2.0, 1.0]);
    let targets = r#""POSITION":0},"targets":[{"POSITION":0}]}"#;
    let morphed = |rest: &str| rest.replace(r#""POSITION":0}}"#, targets);
    let one = |node: &str| ONE.replace(r#"{"mesh":0}"#, node);
    // Targets that are not used change nothing.
    for rest in [morphed(ONE), morphed(&one(r#"{"mesh":0,"weights":[0]}"#))] {
        let world = parts.read(&rest).unwrap();
        assert!(world.objects[0].occludes && world.source.warnings.is_empty());
    }
    let at_node = morphed(&one(r#"{"mesh":0,"name":"face","weights":[0.5]}"#));
    let (unit, half) = (Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.5, 1.5, 0.0));
    is_boxed(&parts.read(&at_node).unwrap(), Vec3::ZERO, half, &["node 0 (\"face\")", "morph targets"]);
    let at_mesh = morphed(ONE).replace(r#""primitives""#, r#""weights":[0.5],"primitives""#);
    is_boxed(&parts.read(&at_mesh).unwrap(), Vec3::ZERO, half, &["node 0", "morph targets"]);
    // The weights of a node count before those of its mesh.
    let at_rest = at_mesh.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"weights":[0]}"#);
    assert!(parts.read(&at_rest).unwrap().objects[0].occludes);
    // Keys from -2 to 1.
    let animated = |how: &str| moved(&format!("[{}]", animated(1, "weights", 2, how)));
    assert!(parts.read(&animated("LINEAR")).unwrap().objects[0].occludes);
    let world = parts.read(&morphed(&animated("LINEAR"))).unwrap();
    is_boxed(&world, -2.0 * unit, 2.0 * unit, &["node 1 (\"leaf\")", "morph targets"]);
    drive(world);
}

/// A file of three nodes: two have a mesh, the third has none. `said` goes into the second node,
/// `mesh` behind the positions of its mesh, and `rest` to the end.
fn two(said: &str, mesh: &str, rest: &str) -> String {
    let mesh = format!(r#"{{"primitives":[{{"attributes":{{"POSITION":0{mesh}}}]}}"#);
    let first = r#"{"primitives":[{"attributes":{"POSITION":0}}]}"#;
    format!(r#""nodes":[{{"mesh":0}},{{"mesh":1,"name":"body"{said}}},{{}}],"meshes":[{first},{mesh}]{rest}"#)
}

#[test]
fn what_has_no_bounds_is_left_out_with_a_word_and_the_rest_is_read() {
    let mut parts = timed();
    parts.floats("SCALAR", &[0.0; 12]);
    parts.dense(5121, "VEC4", &[0; 12], "");
    parts.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    parts.floats("VEC3", &[-5.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    // A turn that goes through none, as all of it is taken back.
    let key = |w: f32| [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, w, 0.0, 0.0, 0.0, 0.0];
    parts.floats("VEC4", &[key(1.0), key(1.0), key(1.0), key(-1.0)].concat());
    let target =
        r#"{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/meshes/1/weights"}}}"#;
    let pointer = format!(r#"{{"channels":[{{"sampler":0,"target":{target}}}]}}"#);
    let moved = |clip: &str| format!(r#","animations":[{clip}]"#);
    let morphed = |clip: &str| two("", r#"},"targets":[{"POSITION":0}]"#, &moved(clip));
    let extended = |what: &str| two(&format!(r#","extensions":{{{what}}}"#), "}", "");
    let body = |motion: &str| extended(&format!(r#""KHR_physics_rigid_bodies":{{"motion":{motion}}}"#));
    let skinned = |said: &str, mesh: &str, rest: &str| {
        two(&format!(r#","skin":0{said}"#), mesh, &format!(r#","skins":[{{"joints":[2]}}]{rest}"#))
    };
    let crowd = |name: &str| {
        let placed = format!(r#","extensions":{{"{name}":{{"attributes":{{"TRANSLATION":0}}}}}}"#);
        skinned(&placed, r#","JOINTS_0":3,"WEIGHTS_0":4}"#, "")
    };
    for kept in [body(r#"{"type":"static"}"#), crowd("OTHER"), extended(r#""MSFT_lod":{"ids":[0]}"#)] {
        assert_eq!(parts.read(&kept).unwrap().objects.len(), 2, "{kept}");
    }
    for left in [
        skinned("", "}", ""),
        skinned("", r#","JOINTS_0":3,"WEIGHTS_0":4}"#, &moved(&animated(2, "rotation", 6, "CUBICSPLINE"))),
        crowd("EXT_mesh_gpu_instancing"),
        morphed(&animated(1, "weights", 2, "CUBICSPLINE")),
        morphed(&pointer),
        two("", r#"},"targets":[{"POSITION":5}]"#, "").replace(r#""body""#, r#""body","weights":[1]"#),
        body("{}"),
        extended(r#""MSFT_lod":{"ids":[0,7]}"#),
        extended(r#""MSFT_lod":{"ids":[0]}},"translation":[0,0,1],"extras":{"#),
        two("", r#"},"mode":0,"extensions":{"KHR_gaussian_splatting":{}}"#, ""),
    ] {
        let world = parts.read(&left).unwrap_or_else(|why| panic!("{left}: {why}"));
        assert_eq!(world.objects.len(), 1, "{left}");
        let [told] = &world.source.warnings[..] else { panic!("{:?}", world.source.warnings) };
        assert!(told.starts_with("node 1 (\"body\")") && told.contains("always draw it"), "{told}");
    }
}

#[test]
fn levels_of_detail_hide_nothing_and_count_as_one_box() {
    let mut parts = triangle();
    parts.floats("VEC3", &SQUARE.map(|c| 3.0 * c - 1.0));
    let levels = r#""nodes":[{"mesh":0,"extensions":{"MSFT_lod":{"ids":[1]}}},{"mesh":1},{"mesh":1}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},{"primitives":[{"attributes":{"POSITION":1},"mode":5}]}]"#;
    let found = |scenes: &str| {
        let world = drive(parts.read(&format!("{levels}{scenes}")).unwrap());
        assert!(world.source.warnings[0].starts_with("node 0") && world.source.warnings.len() == 1);
        assert_eq!(world.objects[0].shape.bounds(), (Vec3::NEG_ONE, Vec3::new(2.0, 2.0, 0.0)));
        world.objects.iter().map(|o| o.occludes).collect::<Vec<_>>()
    };
    // Where there are no scenes, all are shown.
    assert_eq!(found(""), [false, false, true]);
    assert_eq!(found(r#","scenes":[{"nodes":[0,2]}]"#), [false, true]);
}

#[test]
fn roles_are_known_or_warned_of() {
    let with = |extras: &str| {
        triangle()
            .read(&ONE.replace(r#"{"mesh":0}"#, &format!(r#"{{"mesh":0,"name":"leaf","extras":{extras}}}"#)))
    };
    for (extras, roles) in [
        (r#"{"role":"both"}"#, (true, true)),
        (r#"{"role":"occluder"}"#, (true, false)),
        (r#"{"role":"occludee"}"#, (false, true)),
        (r#"{"roles":"occludee"}"#, (true, true)),
        ("7", (true, true)),
        ("null", (true, true)),
    ] {
        let world = with(extras).unwrap();
        let object = &world.objects[0];
        assert_eq!((object.occludes, object.tested), roles, "{extras}");
        // What is tested only is prepared as bounds only.
        let cell = world.grid.cell;
        let driver = Driver::new(&world, cell, |_| ()).unwrap();
        match driver.scene.bounds(driver.id(0)).unwrap() {
            casca::Bounds::Mesh(mesh) => assert_eq!(mesh.occludes(), roles.0, "{extras}"),
            other => panic!("{other:?} is no mesh"),
        }
    }
    for role in [r#""Occluder""#, r#""""#, "null", "1", r#"["both"]"#] {
        let world = with(&format!(r#"{{"role":{role}}}"#)).unwrap();
        assert!(world.objects[0].occludes && world.objects[0].tested, "{role}");
        let told = &world.source.warnings[0];
        assert!(told.starts_with("node 0 (\"leaf\"): has an extras.role"), "{told}");
    }
}

#[test]
fn one_scene_is_shown() {
    let nodes = r#"{"mesh":0,"name":"a"},{"children":[2]},{"mesh":0,"name":"b"},{"mesh":0,"name":"c"}"#;
    let rest = ONE.replace(r#"{"mesh":0}"#, nodes);
    let shown = |scenes: &str| {
        let world = triangle().read(&format!("{rest}{scenes}"))?;
        Ok::<_, Trouble>(world.objects.into_iter().map(|o| o.name).collect::<String>())
    };
    let scenes = r#","scenes":[{"nodes":[0]},{"nodes":[3,1]}]"#;
    assert_eq!(shown(scenes).unwrap(), "a");
    assert_eq!(shown(&format!(r#"{scenes},"scene":1"#)).unwrap(), "cb");
    assert_eq!(shown("").unwrap(), "abc");
    let refused = |scenes: &str| shown(scenes).expect_err("must be refused");
    assert!(matches!(refused(&format!(r#"{scenes},"scene":2"#)), Trouble::Format(_)));
    assert_eq!(shown(r#","scenes":[{"nodes":[2]}]"#).unwrap(), "b", "its parent moves nothing");
    let placed = rest.replace(r#"{"children":[2]}"#, r#"{"children":[2],"translation":[0,0,1]}"#);
    says(triangle().read(&format!(r#"{placed},"scenes":[{{"nodes":[2]}}]"#)), &["node 2 (\"b\") is a root"]);
    assert!(matches!(refused(r#","scenes":[{"nodes":[1,2]}]"#), Trouble::NotATree(2)));
    assert!(matches!(refused(r#","scenes":[{"nodes":[0,0]}]"#), Trouble::NotATree(0)));
    // Nodes that hold each other hang from no root.
    let ring = ONE.replace(r#"{"mesh":0}"#, r#"{"mesh":0},{"children":[2]},{"children":[1]}"#);
    assert!(matches!(triangle().read(&ring), Err(Trouble::NotATree(1))));
}

#[test]
fn matrices_place_nodes_and_are_not_animated() {
    let with = |matrix: &str| ONE.replace(r#"{"mesh":0}"#, &format!(r#"{{"mesh":0,"matrix":[{matrix}]}}"#));
    let mirror = with("-2,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1");
    // Mirrored: the corners keep their order, for meshes are seen from both sides.
    assert_eq!(
        triangles(&triangle().read(&mirror).unwrap(), 0),
        [[Vec3::X * 5.0, Vec3::X * 3.0, Vec3::new(5.0, 1.0, 0.0)]]
    );
    says(triangle().read(&with("1,0,0,0, 0,1,0,0, 0,0,1,1, 0,0,0,1")), &["node 0", "not affine"]);
    let mut parts = timed();
    parts.floats("VEC3", &[1.0; 12]);
    let animated = format!(r#"{mirror},"animations":[{}]"#, animated(0, "scale", 2, "STEP"));
    says(parts.read(&animated), &["node 0", "matrix"]);
}

/// Takes a world through the library, with a view of every tenth frame.
pub(super) fn drive(mut world: World) -> World {
    let cell = world.grid.cell;
    let mut driver = Driver::new(&world, cell, |_| {}).unwrap();
    for frame in (0..world.frames).step_by(10) {
        let moved = world.set_frame(frame);
        driver.update(&world.objects, &moved).unwrap();
        view_of(&world.camera(frame, 1.5)).unwrap();
    }
    world.set_frame(0);
    world
}

#[test]
fn walks_stay_inside_scenes_of_all_sizes() {
    for (size, around) in [
        ([10.0, 8.0, 6.0], Vec3::ZERO),
        ([10.0, 0.0, 10.0], Vec3::ZERO),
        ([10.0, 5.0, 0.0], Vec3::ZERO),
        ([0.0, 5.0, 10.0], Vec3::ZERO),
        ([1.0, 80.0, 1.0], Vec3::ZERO),
        ([0.0, 80.0, 0.0], Vec3::ZERO),
        ([1e-4, 1e-4, 1e-4], Vec3::ZERO),
        ([1.0, 1.0, 1.0], Vec3::splat(1e5)),
        ([1e-4, 0.0, 1e-4], Vec3::splat(1e5)),
        ([0.0; 3], Vec3::ONE),
        ([1e9, 1e8, 1e9], Vec3::ZERO),
    ] {
        let size = Vec3::from_array(size);
        let corners =
            [around, around + size * Vec3::new(1.0, 0.0, 1.0), around + size * Vec3::new(0.5, 1.0, 0.0)];
        let mut parts = Parts::default();
        parts.floats("VEC3", &corners.map(|c| c.to_array()).concat());
        let world = drive(parts.read(ONE).unwrap());
        let longest = size.max_element();
        let margin = (longest * 0.11).max(world.grid.cell * 2.0);
        let mut eyes = Vec::new();
        let around = around - world.source.origin.as_vec3();
        for frame in 0..world.frames {
            let eye = world.camera(frame, 1.0).eye;
            assert!(eye.cmpge(world.grid.min).all() && eye.cmple(world.grid.max).all(), "{size}: {eye}");
            assert!(
                eye.cmpge(around - margin).all() && eye.cmple(around + size + margin).all(),
                "{size}: {eye}"
            );
            eyes.push(eye);
        }
        let full = size.cmpge(Vec3::splat(longest * 0.01)).all();
        let around = around + world.source.origin.as_vec3();
        if full && longest > 1e-3 && around == Vec3::ZERO {
            assert!(eyes.iter().all(|e| e.cmpge(around).all() && e.cmple(around + size).all()), "{size}");
        }
        if around == Vec3::ZERO {
            // It is a walk, and on a floor, not in it.
            assert!(eyes[0].distance(eyes[75]) > longest * 0.005, "{size}");
            assert!(eyes[0].y > longest * 0.03, "{size}");
            // What is a tenth of the scene away is not cut off.
            let view = world.camera(0, 1.0);
            let ahead = view.view.inverse().transform_point3(Vec3::NEG_Z * longest * 0.1);
            let clip = view.view_projection() * ahead.extend(1.0);
            assert!(clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w, "{size}: {clip}");
        }
    }
    // Coordinates so large that they have no size in floats.
    let mut parts = Parts::default();
    parts.floats("VEC3", &[3e38, 0.0, 0.0, -3e38, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert!(matches!(parts.read(ONE), Err(Trouble::NotFinite(_))));
}

#[test]
fn orthographic_cameras_are_passed_over() {
    let orthographic = r#"{"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0.1,"zfar":9}}"#;
    let perspective = r#"{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}"#;
    let with = |cameras: &str, nodes: &str| {
        let nodes = ONE.replace(r#"{"mesh":0}"#, &format!(r#"{{"mesh":0}},{nodes}"#));
        triangle().read(&format!(r#"{nodes},"cameras":[{cameras}]"#)).unwrap()
    };
    let walk = triangle().read(ONE).unwrap();
    let node = r#"{"camera":0,"translation":[7,0,0]}"#;
    let world = with(orthographic, node);
    assert_eq!((world.frames, world.camera(9, 1.0).eye), (walk.frames, walk.camera(9, 1.0).eye));
    // Alone, it is named.
    let told = &world.source.warnings[0];
    assert!(told.starts_with("node 1 (\"\"): has an orthographic camera"), "{told}");
    let world = with(
        &format!("{orthographic},{perspective}"),
        &format!(r#"{node},{{"camera":1,"translation":[8,0,0]}}"#),
    );
    assert_eq!(world.camera(9, 1.0).eye, Vec3::X * 8.0);
    assert!(world.source.warnings.is_empty());
}

#[test]
fn flat_and_mirrored_nodes_can_be_driven() {
    for scale in ["0,0,0", "1,0,1", "-1,1,1", "-1,-1,-1"] {
        let node = format!(r#"{{"mesh":0,"scale":[{scale}]}},{{"mesh":0}}"#);
        drive(triangle().read(&ONE.replace(r#"{"mesh":0}"#, &node)).unwrap());
    }
}
