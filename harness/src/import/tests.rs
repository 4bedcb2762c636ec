use super::*;

/// A .glb with one triangle and a camera that moves from x = 0 to x = 2 in two seconds.
fn small_file() -> Vec<u8> {
    small_file_with("", "")
}

/// The same with a part of its JSON replaced.
fn small_file_with(old: &str, new: &str) -> Vec<u8> {
    let floats: [f32; 9 + 2 + 6] =
        [0.0, 0.0, -5.0, 1.0, 0.0, -5.0, 0.0, 1.0, -5.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0];
    let bin: Vec<u8> = floats.iter().flat_map(|f| f.to_le_bytes()).collect();
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
        "nodes":[{"mesh":0,"name":"leaf","extras":{"role":"occludee"}},{"camera":0}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1.0,"znear":0.1}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
            "samplers":[{"input":1,"output":2}]}],
        "accessors":[
            {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,-5],"max":[1,1,-5]},
            {"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[2]},
            {"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},
            {"buffer":0,"byteOffset":44,"byteLength":24}],
        "buffers":[{"byteLength":68}]}"#;
    assert!(json.contains(old), "{old}");
    let mut json = json.replacen(old, new, 1).into_bytes();
    while !json.len().is_multiple_of(4) {
        json.push(b' ');
    }
    let mut file = Vec::new();
    let total = 12 + 8 + json.len() + 8 + bin.len();
    for word in [0x4654_6c67, 2, total as u32, json.len() as u32, 0x4e4f_534a] {
        file.extend(word.to_le_bytes());
    }
    file.extend(&json);
    for word in [bin.len() as u32, 0x004e_4942] {
        file.extend(word.to_le_bytes());
    }
    file.extend(&bin);
    file
}

#[test]
fn reads_meshes_roles_and_the_camera_path() {
    let world = read("small", &small_file(), None).unwrap();
    assert_eq!((world.objects.len(), world.frames), (1, 61));
    let leaf = &world.objects[0];
    assert!(leaf.name == "leaf" && leaf.tested && !leaf.occludes && leaf.motion == Motion::Static);
    let eye = world.camera(30, 1.5).eye;
    assert!((eye - Vec3::X).length() < 1e-5, "{eye}");
}

#[test]
fn broken_files_are_refused_whole() {
    let file = small_file();
    for length in 0..file.len() {
        assert!(read("cut", &file[..length], None).is_err(), "cut at {length}");
    }
    let mut state = 3u32;
    let mut next = |n: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % n
    };
    for _ in 0..20_000 {
        let mut broken = file.clone();
        for _ in 0..1 + next(3) {
            let at = next(broken.len());
            broken[at] ^= 1 << next(8);
        }
        // Either way is fine; it must not panic.
        let _ = read("flipped", &broken, None);
    }
    assert!(matches!(
        load(Path::new("/no/such/file.glb")).err().expect("no such file").why,
        Trouble::Read(_)
    ));
}

#[test]
fn what_the_parser_takes_for_granted_is_checked() {
    for (old, new) in [
        (r#""path":"translation""#, r#""path":"colour""#),
        (r#""target":{"node":1"#, r#""target":{"node":9"#),
        (r#""type":"perspective""#, r#""type":"orthographic""#),
        (r#""count":3"#, r#""count":0"#),
        (r#""count":2"#, r#""count":0"#),
        (r#""count":3"#, r#""count":18446744073709551615"#),
        (r#""POSITION":0"#, r#""POSITION":7"#),
        (r#"{"camera":0}"#, r#"{"camera":0,"children":[1]}"#),
    ] {
        let refused = read("bad", &small_file_with(old, new), None);
        println!("{new}: {}", refused.err().unwrap_or_else(|| panic!("{new} was taken")));
    }
    let mut short = small_file();
    short[8..12].copy_from_slice(&11u32.to_le_bytes());
    assert!(matches!(read("short", &short, None), Err(Trouble::Format(gltf::Error::Binary(_)))));
}

#[test]
fn deep_trees_need_no_deep_stack() {
    // A chain of nodes, with the camera at its end.
    let depth = 30_000;
    let mut nodes = String::from(r#"{"camera":0,"children":[2]}"#);
    for i in 3..depth {
        nodes += &format!(r#",{{"children":[{i}]}}"#);
    }
    nodes += r#",{"mesh":0}"#;
    let world = read("deep", &small_file_with(r#"{"camera":0}"#, &nodes), None).unwrap();
    assert!(world.objects[1].motion != Motion::Static);
}

#[test]
fn reads_the_real_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    for (file, objects, triangles) in [
        ("sponza.glb", 339, 262_267),
        ("sponza-parts.glb", 1444, 262_267),
        ("kitchen-parts.glb", 757, 56_939),
        ("cornell.glb", 8, 36),
    ] {
        let path = folder.join(file);
        if !path.exists() {
            println!("skipped: {file} is not here");
            continue;
        }
        let world = load(&path).unwrap();
        let found: usize = world
            .objects
            .iter()
            .map(|o| match &o.shape {
                Shape::Mesh { mesh, .. } => mesh.triangles.len(),
                _ => 0,
            })
            .sum();
        assert_eq!((world.objects.len(), found, world.frames), (objects, triangles, 300), "{file}");
    }
}
