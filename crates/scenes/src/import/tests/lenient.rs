//! What other programs write, and what no file may cost.

use super::*;

/// The triangle on one node, with another part in the document, and what is said about it.
fn with(rest: &str) -> Vec<String> {
    let world = triangle().read(rest).unwrap_or_else(|why| panic!("{rest}: {why}"));
    assert_eq!(triangles(&world, 0).len(), 1, "{rest}");
    world.source.warnings
}

#[test]
fn valid_files_of_other_programs_are_read() {
    let textured = r#","extensionsRequired":["KHR_texture_basisu"],"images":[{"uri":"a.ktx2"}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"extensions":
        {"KHR_texture_basisu":{"source":0}}},{"extensions":{"MSFT_texture_dds":{"source":9}}},{}]"#;
    for more in [
        r#","scenes":[{"nodes":[0]},{"name":"lights only"}]"#,
        r#","animations":[{"channels":[{"sampler":0,"target":{"path":"translation"}}],"samplers":[{"input":0,"output":0}]}]"#,
        r#","animations":[{"channels":[]},{"samplers":[]}],"skins":[{"joints":[0],"skeleton":7}]"#,
        r#","animations":[{"channels":[{"sampler":0,"target":{"path":"pointer","extensions":
            {"KHR_animation_pointer":{"pointer":"/materials/0/alphaCutoff"}}}}]}]"#,
        r#","extras":7,"cameras":null,"materials":[],"extensionsUsed":[]"#,
        r#","samplers":[{"magFilter":1,"wrapS":2}],"images":[{"bufferView":0},{}],"textures":[{"source":0,"sampler":0}]"#,
        textured,
    ] {
        assert!(with(&format!("{ONE}{more}")).is_empty(), "{more}");
    }
    for (old, new) in [
        (r#"{"mesh":0}"#, r#"{"mesh":0.0,"name":7,"extras":null,"translation":null}"#),
        (r#""POSITION":0"#, r#""POSITION":0,"NORMAL":99,"UV":0,"COLOR_x":0,"TEXCOORD_0":99"#),
        (r#""POSITION":0}"#, r#""POSITION":0},"targets":[{"TANGENT":99}]"#),
    ] {
        assert!(with(&ONE.replace(old, new)).is_empty(), "{new}");
    }
    // Accessors without boxes, or of other forms; views with a target and a stride that say
    // nothing.
    let mut parts = triangle();
    parts.accessors[0] = r#"{"bufferView":0,"componentType":5126.0,"count":3,"type":"VEC3"}"#.into();
    parts.accessors.push(r#"{"componentType":5130,"count":1,"type":"VEC9"}"#.into());
    parts.views[0] = parts.views[0].replace("{", r#"{"target":7,"byteStride":0,"#);
    let world = parts.read(ONE).unwrap();
    assert_eq!(world.source.warnings, ["accessor 1: is broken and left out"]);
    // One without any bytes is all zeros.
    parts.accessors[0] = r#"{"componentType":5126,"count":3,"type":"VEC3"}"#.into();
    assert_eq!(triangles(&parts.read(ONE).unwrap(), 0), [[Vec3::ZERO; 3]]);
    says(
        parts.read(&ONE.replace(r#""POSITION":0"#, r#""POSITION":1"#)),
        &["not a valid", "accessors[1].componentType"],
    );
}

#[test]
fn broken_details_are_left_out_with_a_warning() {
    for (more, told) in [
        (r#","cameras":[{"type":"fisheye"}]"#, "camera 0: is broken and left out"),
        (r#","cameras":[{"type":"perspective","orthographic":{}}]"#, "camera 0: is broken and left out"),
        (
            r#","materials":[{"alphaMode":"GLASS"}]"#,
            "material 0 (\"\"): is broken, and is taken as transparent",
        ),
        (
            r#","extensions":{"KHR_lights_punctual":{"lights":[{"type":"sun"}]}}"#,
            "light 0: is broken and left out",
        ),
    ] {
        assert_eq!(with(&format!("{ONE}{more}")), [told], "{more}");
    }
}

#[test]
fn containers_are_read_as_others_write_them() {
    let (json, bin) = (SMALL, &bytes_of(&SMALL_FLOATS));
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat();
    let made = |chunks: &[Vec<u8>]| {
        let body = chunks.concat();
        let length = (12 + body.len() as u32).to_le_bytes();
        [&b"glTF\x02\0\0\0"[..], &length, &body].concat()
    };
    let marked = format!("\u{feff}{json}");
    let even = format!("{}{}", json, " ".repeat((4 - json.len() % 4) % 4));
    let odd = format!("{}{}", json, " ".repeat(1 + (4 - json.len() % 4) % 4));
    for (name, file) in [
        ("unpadded", made(&[chunk(b"JSON", odd.as_bytes()), chunk(b"BIN\0", bin)])),
        ("padding that is not counted", {
            let fill = vec![0; 4 - odd.len() % 4];
            made(&[chunk(b"JSON", odd.as_bytes()), fill, chunk(b"BIN\0", bin)])
        }),
        (
            "filled by zeros",
            made(&[chunk(b"JSON", format!("{json}\0\0\0").as_bytes()), chunk(b"BIN\0", bin)]),
        ),
        ("byte-order mark", made(&[chunk(b"JSON", marked.as_bytes()), chunk(b"BIN\0", bin)])),
        (
            "other chunks",
            made(&[chunk(b"JSON", even.as_bytes()), chunk(b"XMP\0", b"1234"), chunk(b"BIN\0", bin)]),
        ),
        ("more behind", [small_file(SMALL), b"more".to_vec()].concat()),
        ("some bytes behind", made(&[chunk(b"JSON", odd.as_bytes()), chunk(b"BIN\0", bin), vec![0; 5]])),
    ] {
        let read = read("made", &file, None);
        assert_eq!(read.map(|world| world.objects.len()).map_err(|why| why.to_string()), Ok(1), "{name}");
    }
    let parts = triangle();
    let uri = r#","uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA""#;
    let marked = format!("\u{feff}{}", parts.json(ONE, uri));
    assert!(read("marked", marked.as_bytes(), None).is_ok());
}

#[test]
fn other_versions_and_other_files_are_named() {
    let with = |asset: &str| {
        let json = triangle().json(ONE, "").replace(r#""asset":{"version":"2.0"}"#, asset);
        read("made", &glb(&json, &triangle().bin), None)
    };
    for good in ["\"2.1\",\"minVersion\":\"2.0\"", "2.0", "\"2.0\",\"copyright\":7"] {
        assert!(with(&format!(r#""asset":{{"version":{good}}}"#)).is_ok(), "{good}");
    }
    says(with(r#""asset":{"version":"1.0"}"#), &["version 1.0 is not read; export it as glTF 2.0"]);
    says(with(r#""asset":{"version":"2.5","minVersion":"2.5"}"#), &["version 2.5 is not read"]);
    says(with(r#""extras":{}"#), &["not a valid glTF", "no asset"]);
    says(read("first", br#"{"nodes":{"node":{}},"meshes":{}}"#, None), &["version 1.0 is not read"]);
    says(read("first", b"glTF\x01\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0", None), &["version 1.0 is not read"]);
    says(read("text", b"v 1 2 3\nf 1 2 3", None), &["not a valid glTF 2.0 file: its JSON", "line 1"]);
    says(read("wide", b"\xff\xfe{\0}\0", None), &["UTF-16"]);
    // The place of a fault is named, and never all of many.
    says(
        triangle().read(&ONE.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"translation":[1,2]}"#)),
        &["nodes[0]", "length 2"],
    );
    let many = vec![r#"{"mesh":7}"#; 1000].join(",");
    let told = told(triangle().read(&ONE.replace(r#"{"mesh":0}"#, &many)));
    assert!(told.contains("nodes[0].mesh") && told.contains("and 997 more") && told.len() < 300, "{told}");
}

/// Reads a file in which node 0 moves for this many seconds, with what hangs from it, and the last
/// node has the camera. Accessor 3 has `count` places without any bytes.
fn moving(count: usize, seconds: f32, nodes: &str) -> World {
    let mut parts = triangle();
    parts.floats("SCALAR", &[0.0, seconds]);
    parts.floats("VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    parts.accessor(F32, "VEC3", count, r#""byteOffset":0"#);
    let clip = animated(0, "translation", 2, "LINEAR");
    let camera = r#""cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}]"#;
    parts.read(&format!(r#"{},"animations":[{clip}],{camera}"#, ONE.replace(r#"{"mesh":0}"#, nodes))).unwrap()
}

#[test]
fn what_moves_for_long_costs_no_more_than_its_file_may() {
    let placed = r#""extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":3}}}"#;
    let nodes = format!(r#"{{"mesh":0,"children":[1],{placed}}},{{"camera":0}}"#);
    let (few, many) = (moving(10, 300.0, &nodes), moving(10_000, 300.0, &nodes));
    assert!(few.frames == 9001 && many.frames == 9001 && many.source.warnings.is_empty());
    // Bounded together, none is bounded less: all go the same way.
    for (world, object) in [(&few, 9), (&many, 9_999)] {
        let Motion::Dynamic { max_speed } = world.objects[object].motion else { panic!("it moves") };
        assert!((0.0133..0.0140).contains(&max_speed), "{max_speed}");
        assert!(world.grid.max.x >= 5.0 && world.grid.max.x < 5.1, "{}", world.grid.max);
    }
    // A camera at the end of a chain of nodes that all move: fewer frames, which is said.
    let chain: Vec<String> = (1..1500).map(|i| format!(r#"{{"mesh":0,"children":[{i}]}}"#)).collect();
    let deep = moving(1, 3300.0, &format!(r#"{},{{"camera":0}}"#, chain.join(",")));
    assert!((100..99_001).contains(&deep.frames), "{}", deep.frames);
    let told = format!("99001 frames: are too many for what moves; the path has {} instead", deep.frames);
    assert_eq!(deep.source.warnings, [told]);
}
