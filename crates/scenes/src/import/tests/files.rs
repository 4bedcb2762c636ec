//! Files as a whole: what is read, and what is refused.

use super::*;

#[test]
fn reads_meshes_roles_and_the_camera_path() {
    let world = read_small_with("", "").unwrap();
    assert_eq!((world.objects.len(), world.frames), (1, 61));
    let leaf = &world.objects[0];
    assert!(leaf.name == "leaf" && leaf.tested && !leaf.occludes && leaf.motion == Motion::Static);
    let eye = world.camera(30, 1.5).eye;
    assert!((eye - Vec3::X).length() < 1e-5, "{eye}");
}

#[test]
fn broken_files_are_refused_whole() {
    let file = small_file(SMALL);
    for length in 0..file.len() {
        assert!(read("cut", &file[..length], None).is_err(), "cut at {length}");
    }
    let missing = load(Path::new("/no/such/file.glb")).err().expect("no such file");
    assert!(matches!(missing.why, Trouble::Read(_)));
}

#[test]
fn what_the_parser_takes_for_granted_is_checked() {
    for (old, new) in [
        (r#""path":"translation""#, r#""path":"colour""#),
        (r#""target":{"node":1"#, r#""target":{"node":9"#),
        (r#""count":3"#, r#""count":0"#),
        (r#""count":2"#, r#""count":0"#),
        (r#""count":3"#, r#""count":18446744073709551615"#),
        (r#""sampler":0"#, r#""sampler":1"#),
        (r#""POSITION":0"#, r#""POSITION":7"#),
        (r#"{"camera":0}"#, r#"{"camera":0,"children":[1]}"#),
    ] {
        assert!(read_small_with(old, new).is_err(), "{new} was taken");
    }
    let mut short = small_file(SMALL);
    short[8..12].copy_from_slice(&11u32.to_le_bytes());
    assert!(matches!(read("short", &short, None), Err(Trouble::Format(_))));
}

#[test]
fn buffers_come_from_data_uris() {
    use base64::Engine;
    let parts = triangle();
    let data = base64::engine::general_purpose::STANDARD.encode(&parts.bin);
    let with = |uri: &str| read("data", parts.json(ONE, &format!(r#","uri":"{uri}""#)).as_bytes(), None);
    let expected = triangles(&parts.read(ONE).unwrap(), 0);
    for kind in ["application/octet-stream;base64", "application/gltf-buffer;base64", ";BASE64"] {
        assert_eq!(triangles(&with(&format!("data:{kind},{data}")).unwrap(), 0), expected);
    }
    assert_eq!(triangles(&with(&format!("DATA:;base64,{data}")).unwrap(), 0), expected);
    let escaped = data.replace('+', "%2B").replace('/', "%2F").replace('=', "%3D");
    assert_eq!(triangles(&with(&format!("data:;base64,{escaped}")).unwrap(), 0), expected);
    says(with(&format!("data:application/octet-stream,{data}")), &["buffer 0", "not in base64"]);
    says(with("data:;base64"), &["no comma"]);
    says(with(&format!("data:;base64,{}", &data[1..])), &["base64"]);
    says(with(&format!("data:;base64,!{}", &data[1..])), &["base64"]);
    says(with(&format!("data:;base64,{}", &data[4..])), &["buffer 0 has 33 bytes"]);
    says(read("bin", parts.json(ONE, "").as_bytes(), None), &["no binary chunk"]);
    let two = parts.json(ONE, "").replace("}],\"nodes\"", "},{\"byteLength\":4}],\"nodes\"");
    says(read("two", &glb(&two, &parts.bin), None), &["buffer 1", "no URI"]);
}

#[test]
fn buffers_come_from_files_by_relative_uris_only() {
    let parts = triangle();
    let folder = std::env::temp_dir().join(format!("casca-import-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("sub")).unwrap();
    // More than is needed is not read.
    std::fs::write(folder.join("a b.bin"), [&parts.bin[..], &[7; 100]].concat()).unwrap();
    std::fs::write(folder.join("short.bin"), &parts.bin[..35]).unwrap();
    let json = |uri: &str| parts.json(ONE, &format!(r#","uri":"{uri}""#));
    let with = |uri: &str| read("files", json(uri).as_bytes(), Some(&folder));
    let expected = triangles(&parts.read(ONE).unwrap(), 0);
    std::fs::write(folder.join("c%20#1.bin"), &parts.bin).unwrap();
    // As they should be, and as others write them: unescaped, and with backslashes.
    for uri in [
        "a%20b.bin",
        "a b.bin",
        "./a%20b.bin",
        "sub/../a%20b.bin",
        r"sub\\..\\a%20b.bin",
        "c%20#1.bin",
        "c%2520%231.bin",
    ] {
        assert_eq!(triangles(&with(uri).unwrap(), 0), expected, "{uri}");
    }
    let file = folder.join("sub/scene.gltf");
    std::fs::write(&file, json("../a%20b.bin")).unwrap();
    assert_eq!(load(&file).unwrap().name, "scene");
    let absolute = folder.join("a%20b.bin").to_str().unwrap().to_owned();
    for (uri, why) in [
        (format!("file://{absolute}"), "relative"),
        ("http://example.org/a.bin".to_owned(), "relative"),
        ("C:a.bin".to_owned(), "relative"),
        (absolute.clone(), "relative"),
        (absolute.replacen('/', "%2F", 1), "relative"),
        ("a%20b.bin?x".to_owned(), "query"),
        ("a%20b.bin#x".to_owned(), "fragment"),
        ("%ff.bin".to_owned(), "UTF-8"),
        ("sub".to_owned(), "is no file"),
        (String::new(), "is no file"),
        ("gone.bin".to_owned(), "gone.bin"),
    ] {
        says(with(&uri), &["buffer 0", &uri, why]);
    }
    says(with("short.bin"), &["has 35 bytes, but 36 are needed"]);
    says(read("nowhere", json("a%20b.bin").as_bytes(), None), &["no folder"]);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn deep_trees_of_objects_cost_no_more_than_their_nodes() {
    // Every node shows the triangle and hangs from the one before; all of them move.
    let depth = 20_000;
    let mut nodes = String::from(r#"{"camera":0}"#);
    for i in 2..depth {
        nodes += &format!(r#",{{"mesh":0,"translation":[0,0,0.001],"children":[{}]}}"#, i + 1);
    }
    nodes += r#",{"mesh":0}"#;
    let json = SMALL
        .replace(r#"{"camera":0}"#, &nodes)
        .replace(r#""nodes":[0,1]"#, r#""nodes":[0,1,2]"#)
        .replace(r#""node":1"#, r#""node":2"#);
    let world = read("deep", &small_file(&json), None).unwrap();
    assert_eq!(world.objects.len(), depth);
    // The last hangs from all others, which move it by two in all at the end.
    let mut last = Vec3::ZERO;
    world.animation.shapes(0, &mut |i, shape| {
        if let (true, Shape::Mesh { transform, .. }) = (i + 1 == depth, shape) {
            last = transform.translation.into();
        }
    });
    assert!((last.z - 0.001 * (depth - 3) as f32).abs() < 0.05, "{last}");
}

#[test]
fn what_unfolds_to_more_than_the_file_is_refused() {
    // A thousand accessors of a mebi of zeros each, which take no bytes.
    let zeros = r#"{"componentType":5126,"count":1048576,"type":"VEC3","min":[0,0,0],"max":[0,0,0],"sparse":{"count":1,
        "indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":0}}},"#;
    let primitives: Vec<String> =
        (0..1000).map(|i| format!(r#"{{"attributes":{{"POSITION":{}}}}}"#, i + 3)).collect();
    let last = r#"{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}"#;
    let few = r#"{"attributes":{"POSITION":0}}"#;
    let with_zeros = SMALL
        .replace(last, &format!("{last},{}", zeros.repeat(1000).trim_end_matches(',')))
        .replace(few, &primitives.join(","));
    says(read("made", &small_file(&with_zeros), None), &["unfolds to too much"]);
    // The same positions in very many primitives, of which each may have them.
    assert!(read_small_with(few, &[few; 1000].join(",")).is_ok());
    says(read_small_with(few, &vec![few; 400_000].join(",")), &["unfolds to too much"]);
    // Instances with a long name.
    let name = "leaf".repeat(50_000);
    let instanced =
        format!(r#"{name}","extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":0}}}}}}"#);
    let many = format!(r#""nodes":[{{"mesh":0,"name":"{instanced}}},{{"camera":0}}"#);
    let one = r#""nodes":[{"mesh":0,"name":"leaf","extras":{"role":"occludee"}},{"camera":0}"#;
    assert!(read_small_with(one, &many).is_ok());
    let zeros = zeros.trim_end_matches(',').replace("1048576", "524288");
    let json = SMALL
        .replace(one, &many.replace(r#""TRANSLATION":0"#, r#""TRANSLATION":3"#))
        .replace(last, &format!("{last},{zeros}"));
    says(read("made", &small_file(&json), None), &["too many instances for its name"]);
}
