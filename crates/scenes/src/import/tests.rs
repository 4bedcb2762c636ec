use std::path::Path;
use std::sync::Arc;

use glam::{Quat, Vec3};
use rand::RngExt;

use super::*;
use crate::drive::{Driver, grid_for, view_of};
use crate::lit::Material;
use crate::random::generator;
use crate::world::{FRAME_SECONDS, Mesh, Motion, Shape};

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
    glb(&json.replacen(old, new, 1), &bin)
}

fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
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
    file.extend(bin);
    file
}

/// A file in the making: what its accessors read.
#[derive(Default, Clone)]
struct Parts {
    accessors: Vec<String>,
    views: Vec<String>,
    bin: Vec<u8>,
}

const F32: u32 = 5126;

impl Parts {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(format!(
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
            self.bin.len(),
            bytes.len()
        ));
        self.bin.extend(bytes);
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        self.views.len() - 1
    }

    /// An accessor; `more` follows its type and count.
    fn accessor(&mut self, component: u32, kind: &str, count: usize, more: &str) -> usize {
        self.accessors.push(format!(
            r#"{{"componentType":{component},"type":"{kind}","count":{count},"min":[0,0,0],"max":[0,0,0],{more}}}"#
        ));
        self.accessors.len() - 1
    }

    fn dense(&mut self, component: u32, kind: &str, bytes: &[u8], more: &str) -> usize {
        let width = match component {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let size = width
            * match kind {
                "SCALAR" => 1,
                "VEC3" => 3,
                _ => 4,
            };
        let view = self.view(bytes);
        self.accessor(component, kind, bytes.len() / size, &format!(r#""bufferView":{view}{more}"#))
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        self.dense(F32, kind, &bytes_of(values), "")
    }

    fn json(&self, rest: &str, uri: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}{uri}}}],{rest}}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.bin.len()
        )
    }

    fn glb(&self, rest: &str) -> Vec<u8> {
        glb(&self.json(rest, ""), &self.bin)
    }

    fn read(&self, rest: &str) -> Result<World, Trouble> {
        read("made", &self.glb(rest), None)
    }
}

fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|f| f.to_le_bytes()).collect()
}

/// Corners of a triangle, and one more for a square.
const SQUARE: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
/// One node with the mesh whose positions are accessor 0.
const ONE: &str = r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;

/// A triangle as accessor 0.
fn triangle() -> Parts {
    let mut parts = Parts::default();
    parts.floats("VEC3", &SQUARE[..9]);
    parts
}

/// The triangles of an object, in world space.
fn triangles(world: &World, object: usize) -> Vec<[Vec3; 3]> {
    let Shape::Mesh { mesh, transform } = &world.objects[object].shape else { return Vec::new() };
    let at = |v: u32| transform.transform_point3(mesh.positions[v as usize]);
    mesh.triangles.iter().map(|t| t.map(at)).collect()
}

fn told(refused: Result<World, Trouble>) -> String {
    refused.err().expect("must be refused").to_string()
}

/// Whether an error says all of `parts`.
fn says(refused: Result<World, Trouble>, parts: &[&str]) {
    let told = told(refused);
    assert!(parts.iter().all(|part| told.contains(part)), "{told:?} lacks one of {parts:?}");
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

/// Reads a file with random bits flipped. Either way is fine; it must not panic.
fn flip(file: &[u8], times: usize) {
    let mut random = generator(3, 0);
    let mut next = |n: usize| random.random_range(0..n);
    for _ in 0..times {
        let mut broken = file.to_vec();
        for _ in 0..1 + next(3) {
            let at = next(broken.len());
            broken[at] ^= 1 << next(8);
        }
        // Reads all that `read` does, and more.
        let _ = read_lit("flipped", &broken, None);
    }
}

#[test]
fn broken_files_are_refused_whole() {
    let file = small_file();
    for length in 0..file.len() {
        assert!(read("cut", &file[..length], None).is_err(), "cut at {length}");
    }
    flip(&file, 20_000);
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
        (r#""sampler":0"#, r#""sampler":1"#),
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
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
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
    says(with(&format!("data:application/octet-stream,{data}")), &["buffer 0", "not in base64"]);
    says(with("data:;base64"), &["no comma"]);
    says(with(&format!("data:;base64,{}", &data[1..])), &["base64"]);
    says(with(&format!("data:;base64,!{}", &data[1..])), &["base64"]);
    assert!(matches!(
        with(&format!("data:;base64,{}", &data[4..])),
        Err(Trouble::ShortBuffer { held: 33, .. })
    ));
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
    for uri in ["a%20b.bin", "a b.bin", "./a%20b.bin", "sub/../a%20b.bin"] {
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
    assert!(matches!(with("short.bin"), Err(Trouble::ShortBuffer { held: 35, needed: 36, .. })));
    says(read("nowhere", json("a%20b.bin").as_bytes(), None), &["no folder"]);
    std::fs::remove_dir_all(&folder).unwrap();
}

/// A triangle of sparse positions: two of them new at `places`, over the square or over nothing.
fn sparse_positions(places: [u16; 2], base: bool) -> Parts {
    let mut parts = Parts::default();
    let base =
        if base { format!(r#""bufferView":{},"#, parts.view(&bytes_of(&SQUARE))) } else { String::new() };
    let at = parts.view(&places.map(u16::to_le_bytes).concat());
    let new = parts.view(&bytes_of(&[5.0, 0.0, 0.0, 0.0, 6.0, 7.0]));
    parts.accessor(
        F32,
        "VEC3",
        4,
        &format!(
            r#"{base}"sparse":{{"count":2,"indices":{{"bufferView":{at},"componentType":5123}},"values":{{"bufferView":{new}}}}}"#
        ),
    );
    let corners = parts.dense(5121, "SCALAR", &[0, 1, 2, 2, 1, 3], "");
    assert_eq!(corners, 1);
    parts
}

const INDEXED: &str =
    r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]"#;

#[test]
fn sparse_accessors_are_laid_over_their_base() {
    let (a, b) = (Vec3::new(5.0, 0.0, 0.0), Vec3::new(0.0, 6.0, 7.0));
    let world = sparse_positions([1, 3], true).read(INDEXED).unwrap();
    assert_eq!(triangles(&world, 0), [[Vec3::ZERO, a, Vec3::Y], [Vec3::Y, a, b]]);
    let world = sparse_positions([1, 3], false).read(INDEXED).unwrap();
    assert_eq!(triangles(&world, 0), [[Vec3::ZERO, a, Vec3::ZERO], [Vec3::ZERO, a, b]]);

    // Indices of primitives as well: 0 0 0 becomes 0 1 2.
    let mut parts = triangle();
    let (at, new) = (parts.view(&[1, 2]), parts.view(&[1, 0, 2, 0]));
    let sparse = format!(
        r#""sparse":{{"count":2,"indices":{{"bufferView":{at},"componentType":5121}},"values":{{"bufferView":{new}}}}}"#
    );
    parts.accessor(5123, "SCALAR", 3, &sparse);
    assert_eq!(triangles(&parts.read(INDEXED).unwrap(), 0), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
}

#[test]
fn broken_sparse_accessors_are_refused() {
    for places in [[3, 1], [1, 1]] {
        says(sparse_positions(places, true).read(INDEXED), &["accessor 0 (positions)", "ascend"]);
    }
    says(sparse_positions([1, 4], false).read(INDEXED), &["accessor 0 (positions)", "beyond its end"]);
    let with = |old: &str, new: &str| {
        let mut parts = sparse_positions([1, 3], false);
        let all = [parts.accessors.join("|"), parts.views.join("|")].join("@");
        assert!(all.contains(old), "{all} lacks {old}");
        let all = all.replacen(old, new, 1);
        let (accessors, views) = all.split_once('@').unwrap();
        parts.accessors = accessors.split('|').map(str::to_owned).collect();
        parts.views = views.split('|').map(str::to_owned).collect();
        parts.read(INDEXED)
    };
    assert!(with("", "").is_ok());
    says(with(r#""sparse":{"count":2"#, r#""sparse":{"count":0"#), &["no elements"]);
    says(with(r#""sparse":{"count":2"#, r#""sparse":{"count":5"#), &["more than it has"]);
    says(with(r#""sparse":{"count":2"#, r#""sparse":{"count":3"#), &["buffer view holds"]);
    says(with(r#""componentType":5123"#, r#""componentType":5125"#), &["buffer view holds"]);
    says(with(r#""componentType":5123"#, r#""componentType":5122"#), &["not a valid"]);
    says(
        with(r#""values":{"bufferView":1"#, r#""values":{"byteOffset":4,"bufferView":1"#),
        &["buffer view holds"],
    );
    says(with(r#""values":{"bufferView":1"#, r#""values":{"bufferView":0"#), &["buffer view holds"]);
    says(with(r#""values":{"bufferView":1"#, r#""values":{"bufferView":9"#), &["not a valid"]);
    says(with(r#""byteLength":24"#, r#""byteLength":24,"byteStride":12"#), &["stride"]);
    says(with(r#""byteLength":24"#, r#""byteLength":4000"#), &["buffer 0 has", "needed"]);
    says(with(r#""type":"VEC3","count":4"#, r#""type":"VEC3","count":99999999999"#), &["too long"]);
}

#[test]
fn quantized_positions_need_their_extension() {
    let named = |list: &str| format!(r#""{list}":["KHR_mesh_quantization"],{ONE}"#);
    let i8s = [0u8, 0, 0, 127, 0, 0, 0, 129, 128].to_vec();
    let u16s: Vec<u8> = [0u16, 0, 0, 65535, 0, 0, 0, 13107, 2].iter().flat_map(|v| v.to_le_bytes()).collect();
    let i16s: Vec<u8> =
        [0i16, 0, 0, -32768, 0, 0, 0, 32767, 2].iter().flat_map(|v| v.to_le_bytes()).collect();
    for (component, bytes, normalized, b, c) in [
        (5120, &i8s, true, Vec3::X, Vec3::new(0.0, -1.0, -1.0)),
        (5120, &i8s, false, Vec3::X * 127.0, Vec3::new(0.0, -127.0, -128.0)),
        (5121, &i8s, true, Vec3::X * (127.0 / 255.0), Vec3::new(0.0, 129.0 / 255.0, 128.0 / 255.0)),
        (5121, &i8s, false, Vec3::X * 127.0, Vec3::new(0.0, 129.0, 128.0)),
        (5122, &i16s, true, Vec3::NEG_X, Vec3::new(0.0, 1.0, 2.0 / 32767.0)),
        (5122, &i16s, false, Vec3::X * -32768.0, Vec3::new(0.0, 32767.0, 2.0)),
        (5123, &u16s, true, Vec3::X, Vec3::new(0.0, 0.2, 2.0 / 65535.0)),
        (5123, &u16s, false, Vec3::X * 65535.0, Vec3::new(0.0, 13107.0, 2.0)),
    ] {
        let mut parts = Parts::default();
        parts.dense(component, "VEC3", bytes, &format!(r#","normalized":{normalized}"#));
        for list in ["extensionsUsed", "extensionsRequired"] {
            let world = parts.read(&named(list)).unwrap();
            assert_eq!(triangles(&world, 0), [[Vec3::ZERO, b, c]], "{component} {normalized}");
        }
        says(parts.read(ONE), &["accessor 0 (positions)", "type"]);
    }
    let mut parts = Parts::default();
    parts.dense(5125, "VEC3", &[0; 36], "");
    says(parts.read(&named("extensionsUsed")), &["accessor 0 (positions)", "type"]);
}

#[test]
fn required_extensions_are_understood_or_named() {
    let with = |names: &str| triangle().read(&format!(r#""extensionsRequired":[{names}],{ONE}"#));
    let known = r#""KHR_materials_unlit","KHR_texture_transform","EXT_mesh_gpu_instancing""#;
    assert!(with(known).is_ok());
    let unknown = r#""KHR_materials_ior","KHR_draco_mesh_compression","EXT_meshopt_compression""#;
    let told = told(with(unknown));
    assert!(told.ends_with("KHR_draco_mesh_compression, EXT_meshopt_compression"), "{told}");
}

#[test]
fn all_kinds_of_triangles_are_read_and_no_others() {
    let strip = SQUARE.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    let [p0, p1, p2, p3] = strip[..] else { panic!() };
    let mut parts = Parts::default();
    parts.floats("VEC3", &SQUARE);
    parts.dense(5123, "SCALAR", &[3, 0, 2, 0, 1, 0, 0, 0], "");
    parts.dense(5121, "SCALAR", &[0, 1, 2, 2, 2, 1, 3], "");
    let read_as = |modes: &[(u32, Option<u32>)]| {
        let primitive = |&(mode, indices): &(u32, Option<u32>)| {
            let indices = indices.map_or(String::new(), |i| format!(r#","indices":{i}"#));
            format!(r#"{{"attributes":{{"POSITION":0}},"mode":{mode}{indices}}}"#)
        };
        let primitives: Vec<String> = modes.iter().map(primitive).collect();
        parts.read(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{}]}}]"#,
            primitives.join(",")
        ))
    };
    let shown = |modes: &[(u32, Option<u32>)]| triangles(&read_as(modes).unwrap(), 0);
    // All of a strip that lies flat show the same side.
    assert_eq!(shown(&[(5, None)]), [[p0, p1, p2], [p1, p3, p2]]);
    assert_eq!(shown(&[(5, Some(1))]), [[p3, p2, p1], [p2, p0, p1]]);
    assert_eq!(shown(&[(6, None)]), [[p0, p1, p2], [p0, p2, p3]]);
    assert_eq!(shown(&[(6, Some(1))]), [[p3, p2, p1], [p3, p1, p0]]);
    // Two equal corners only lead on.
    assert_eq!(shown(&[(5, Some(2))]), [[p0, p1, p2], [p2, p1, p3]]);
    for lines in 0..4 {
        assert_eq!(shown(&[(lines, None), (5, None), (lines, Some(1))]).len(), 2);
        assert!(matches!(read_as(&[(lines, None)]), Err(Trouble::NoTriangles)));
    }
    // Parts of a mesh share its vertices.
    let world = read_as(&[(5, None), (6, Some(1))]).unwrap();
    let Shape::Mesh { mesh, .. } = &world.objects[0].shape else { panic!() };
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 4));

    says(read_as(&[(5, None), (4, None)]), &["primitive 1 of mesh 0 has 4 corners"]);
    let mut two = Parts::default();
    two.floats("VEC3", &SQUARE[..6]);
    for mode in [4, 5, 6] {
        let mesh =
            format!(r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":{mode}}}]}}]"#);
        says(two.read(&format!(r#""nodes":[{{"mesh":0}}],{mesh}"#)), &["2 corners"]);
    }
    let mut restart = triangle();
    restart.dense(5121, "SCALAR", &[0, 1, 255], "");
    says(restart.read(INDEXED), &["accessor 1 (indices)", "greatest index"]);
    let mut beyond = triangle();
    beyond.dense(5121, "SCALAR", &[0, 1, 3], "");
    says(beyond.read(INDEXED), &["mesh 0 names vertex 3 of 3"]);
}

#[test]
fn nodes_share_meshes() {
    let world = triangle().read(&ONE.replace(r#"{"mesh":0}"#, r#"{"mesh":0},{"mesh":0}"#)).unwrap();
    let meshes: Vec<_> = world.objects.iter().map(|o| shared(&o.shape)).collect();
    assert!(meshes.len() == 2 && Arc::ptr_eq(&meshes[0], &meshes[1]));
}

fn shared(shape: &Shape) -> Arc<Mesh> {
    let Shape::Mesh { mesh, .. } = shape else { panic!("no mesh") };
    mesh.clone()
}

/// A triangle on a node at x = 10 that is turned half about y, with what can place three instances
/// of it.
fn instanced(attributes: &str) -> (Parts, String) {
    let mut parts = triangle();
    parts.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 3.0, 0.0, 0.0]);
    parts.dense(
        5122,
        "VEC4",
        &rotation_bytes(&[[0, 0, 0, 32767], [0, 0, 23170, 23170], [0, 0, 32767, 0]]),
        r#","normalized":true"#,
    );
    parts.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, -1.0]);
    parts.floats("SCALAR", &[1.0, 2.0]);
    let node = format!(
        r#"{{"mesh":0,"name":"tree","translation":[10,0,0],"rotation":[0,1,0,0],"extras":{{"role":"occluder"}},"extensions":{{"EXT_mesh_gpu_instancing":{attributes}}}}}"#
    );
    let rest = ONE.replace(r#"{"mesh":0}"#, &node);
    (parts, rest)
}

fn rotation_bytes(values: &[[i16; 4]]) -> Vec<u8> {
    values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect()
}

const PLACED: &str = r#"{"attributes":{"TRANSLATION":1,"ROTATION":2,"SCALE":3}}"#;

#[test]
fn instances_become_objects() {
    let (parts, rest) = instanced(PLACED);
    let world = parts.read(&rest).unwrap();
    let names: Vec<&str> = world.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["tree#0", "tree#1", "tree#2"]);
    assert!(world.objects.iter().all(|o| o.occludes && !o.tested && o.motion == Motion::Static));
    let meshes: Vec<_> = world.objects.iter().map(|o| shared(&o.shape)).collect();
    assert!(Arc::ptr_eq(&meshes[0], &meshes[2]));
    for (object, corners) in [
        (0, [[10.0, 0.0, 0.0], [9.0, 0.0, 0.0], [10.0, 1.0, 0.0]]),
        (1, [[10.0, 2.0, 0.0], [10.0, 4.0, 0.0], [12.0, 2.0, 0.0]]),
        (2, [[7.0, 0.0, 0.0], [8.0, 0.0, 0.0], [7.0, -1.0, 0.0]]),
    ] {
        for (found, corner) in triangles(&world, object)[0].iter().zip(corners) {
            assert!(found.distance(Vec3::from_array(corner)) < 1e-3, "{object}: {found} is not {corner:?}");
        }
    }
    // What is not about places still counts instances.
    let (parts, rest) = instanced(r#"{"attributes":{"_AGE":4}}"#);
    assert_eq!(parts.read(&rest).unwrap().objects.len(), 2);
}

#[test]
fn broken_instances_are_refused() {
    for (attributes, why) in [
        ("7", "without attributes"),
        ("{}", "without attributes"),
        (r#"{"attributes":{}}"#, "without attributes"),
        (r#"{"attributes":{"TRANSLATION":"1"}}"#, "TRANSLATION is no accessor"),
        (r#"{"attributes":{"SCALE":-1}}"#, "SCALE is no accessor"),
        (r#"{"attributes":{"SCALE":5}}"#, "SCALE is no accessor"),
        (r#"{"attributes":{"TRANSLATION":1,"_AGE":4}}"#, "different lengths"),
    ] {
        let (parts, rest) = instanced(attributes);
        says(parts.read(&rest), &["node 0 (\"tree\")", why]);
    }
    for attribute in [r#"{"attributes":{"ROTATION":1}}"#, r#"{"attributes":{"TRANSLATION":2}}"#] {
        let (parts, rest) = instanced(attribute);
        says(parts.read(&rest), &["(instances)", "type"]);
    }
    let (mut parts, rest) = instanced(r#"{"attributes":{"ROTATION":5}}"#);
    parts.floats("VEC4", &[0.0; 4]);
    says(parts.read(&rest), &["accessor 5 (instances)", "rotation"]);
}

/// A triangle, and as accessor 1 the times of four keys.
fn timed() -> Parts {
    let mut parts = triangle();
    parts.floats("SCALAR", &[0.0, 0.5, 1.0, 2.0]);
    parts
}

/// A node with the mesh, at x = 3 on an empty node, and animations.
fn moved(animations: &str) -> String {
    let nodes = r#"{"children":[1]},{"mesh":0,"name":"leaf","translation":[3,0,0]}"#;
    format!(r#"{},"animations":{animations}"#, ONE.replace(r#"{"mesh":0}"#, nodes))
}

fn animation(node: usize, path: &str, output: usize, interpolation: &str) -> String {
    format!(
        r#"{{"channels":[{{"sampler":0,"target":{{"node":{node},"path":"{path}"}}}}],"samplers":[{{"input":1,"output":{output},"interpolation":"{interpolation}"}}]}}"#
    )
}

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
        let mut world =
            parts.read(&moved(&format!("[{}]", animation(0, "translation", values, interpolation)))).unwrap();
        for (frame, x) in expected {
            let found = origin(&mut world, frame).x - 3.0;
            assert!((found - x).abs() < 1e-4, "{interpolation} {frame}: {found}");
        }
    }
    // A spline with tangents of 0: halfway between two keys the mean, a quarter on 5/32 of the way.
    let key = |x: f32| [0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, 0.0, 0.0];
    let spline = parts.floats("VEC3", &[key(0.0), key(0.0), key(0.0), key(32.0)].concat());
    let mut world =
        parts.read(&moved(&format!("[{}]", animation(0, "translation", spline, "CUBICSPLINE")))).unwrap();
    assert!((origin(&mut world, 45).x - 19.0).abs() < 1e-3);
    let quarter = origin(&mut world, 37).x - 3.0;
    let t = 7.0f32 / 30.0;
    assert!((quarter - 32.0 * (3.0 * t * t - 2.0 * t * t * t)).abs() < 1e-3, "{quarter}");
    says(
        parts.read(&moved(&format!("[{}]", animation(0, "translation", values, "CUBICSPLINE")))),
        &["accessor 2 (animation values)", "not as long"],
    );
    let mut parts = timed();
    parts.accessors[1] = parts.accessors[1].replace(r#""count":4"#, r#""count":1"#);
    parts.floats("VEC3", &[f32::NAN, 0.0, 0.0]);
    says(
        parts.read(&moved(&format!("[{}]", animation(0, "scale", 2, "STEP")))),
        &["accessor 2", "not finite"],
    );
    let mut parts = triangle();
    parts.floats("SCALAR", &[1.0, 0.5]);
    parts.floats("VEC3", &[0.0; 6]);
    says(
        parts.read(&moved(&format!("[{}]", animation(0, "scale", 2, "STEP")))),
        &["(animation times)", "order"],
    );
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
        let mut world =
            parts.read(&moved(&format!("[{}]", animation(0, "rotation", output, "LINEAR")))).unwrap();
        for (frame, angle) in [(0, 0.0f32), (15, 90.0), (20, 120.0), (30, 180.0), (45, 225.0)] {
            let expected = Quat::from_rotation_z(angle.to_radians()) * (Vec3::X * 3.0);
            let found = origin(&mut world, frame);
            assert!(found.distance(expected) < within, "{frame}: {found} is not {expected}");
        }
    }
    says(
        parts.read(&moved(&format!("[{}]", animation(0, "rotation", raw, "LINEAR")))),
        &["(animation values)", "type"],
    );
    says(
        parts.read(&moved(&format!("[{}]", animation(0, "translation", shorts, "LINEAR")))),
        &["(animation values)", "type"],
    );
    let none = parts.floats("VEC4", &[0.0; 16]);
    says(parts.read(&moved(&format!("[{}]", animation(0, "rotation", none, "STEP")))), &["rotation of no"]);
}

#[test]
fn of_two_animations_the_first_is_used() {
    let mut parts = timed();
    let ones = parts.floats("VEC3", &[1.0; 12]);
    let twos = parts.floats("VEC3", &[2.0; 12]);
    let (first, second) =
        (animation(1, "translation", ones, "STEP"), animation(1, "translation", twos, "STEP"));
    for (animations, x) in [(format!("[{first},{second}]"), 1.0), (format!("[{second},{first}]"), 2.0)] {
        assert_eq!(origin(&mut parts.read(&moved(&animations)).unwrap(), 1).x, x);
    }
    // Different properties go together.
    let scale = animation(1, "scale", twos, "STEP");
    let mut world = parts.read(&moved(&format!("[{first},{scale}]"))).unwrap();
    world.set_frame(1);
    assert_eq!(triangles(&world, 0)[0][1], Vec3::new(3.0, 1.0, 1.0));
    // What is not used is checked all the same.
    let short = parts.floats("VEC3", &[2.0; 3]);
    let broken = animation(1, "translation", short, "STEP");
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
        vec![animation(0, "translation", way, "CUBICSPLINE")],
        vec![animation(0, "rotation", turns, "LINEAR")],
        vec![animation(0, "rotation", turn, "CUBICSPLINE")],
        vec![animation(0, "rotation", turns, "STEP"), animation(1, "scale", sizes, "LINEAR")],
        vec![
            animation(1, "rotation", turn, "CUBICSPLINE"),
            animation(0, "scale", sizes, "STEP"),
            animation(0, "translation", way, "CUBICSPLINE"),
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
    let world = parts.read(&moved(&format!("[{}]", animation(0, "translation", still, "LINEAR")))).unwrap();
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
    let moved = moved(&format!("[{}]", animation(1, "rotation", turns, "STEP")));
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
    let animation = animation(0, "translation", way, "LINEAR").replace(r#""input":1"#, r#""input":5"#);
    let mut world = parts.read(&format!(r#"{rest},"animations":[{animation}]"#)).unwrap();
    assert_eq!(world.set_frame(15), [0, 1, 2]);
    for object in 0..3 {
        let Motion::Dynamic { max_speed } = world.objects[object].motion else { panic!("it moves") };
        assert!((6.0..6.2).contains(&max_speed), "{max_speed}");
        assert!((triangles(&world, object)[0][0].z - 3.0).abs() < 1e-4);
    }
}

#[test]
fn deformed_meshes_are_refused() {
    let mut parts = timed();
    parts.floats("SCALAR", &[0.0, 1.0, 0.0, 1.0]);
    let targets = r#""POSITION":0},"targets":[{"POSITION":0}]}"#;
    let morphed = |rest: &str| rest.replace(r#""POSITION":0}}"#, targets);
    // Targets that are not used change nothing.
    assert!(parts.read(&morphed(ONE)).is_ok());
    assert!(parts.read(&morphed(&ONE.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"weights":[0]}"#))).is_ok());
    let at_node = morphed(&ONE.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"name":"face","weights":[0.5]}"#));
    says(parts.read(&at_node), &["node 0 (\"face\")", "morph targets"]);
    let at_mesh = morphed(ONE).replace(r#""primitives""#, r#""weights":[0.5],"primitives""#);
    says(parts.read(&at_mesh), &["node 0", "morph targets"]);
    // The weights of a node count before those of its mesh.
    assert!(parts.read(&at_mesh.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"weights":[0]}"#)).is_ok());
    let animated = moved(&format!("[{}]", animation(1, "weights", 2, "LINEAR")));
    assert!(parts.read(&animated).is_ok());
    says(parts.read(&morphed(&animated)), &["node 1 (\"leaf\")", "morph targets"]);
    let skinned = ONE.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"name":"body","skin":0}"#);
    says(parts.read(&format!(r#"{skinned},"skins":[{{"joints":[0]}}]"#)), &["node 0 (\"body\")", "skin"]);
}

#[test]
fn roles_are_known_or_refused() {
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
        let grid = grid_for(&world.grid, None).unwrap();
        let driver = Driver::new(&world, &grid, |_| ()).unwrap();
        match driver.scene.bounds(driver.id(0)).unwrap() {
            casca::Bounds::Mesh(mesh) => assert_eq!(mesh.occludes(), roles.0, "{extras}"),
            other => panic!("{other:?} is no mesh"),
        }
    }
    for role in [r#""Occluder""#, r#""""#, "null", "1", r#"["both"]"#] {
        says(with(&format!(r#"{{"role":{role}}}"#)), &["node 0 (\"leaf\")", role]);
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
    assert!(refused(r#","scenes":[{"nodes":[2]}]"#).to_string().contains("node 2 (\"b\") is a root"));
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
    let animated = format!(r#"{mirror},"animations":[{}]"#, animation(0, "scale", 2, "STEP"));
    says(parts.read(&animated), &["node 0", "matrix"]);
}

/// Takes a world through the library, with a view of every tenth frame.
fn drive(mut world: World) -> World {
    let grid = grid_for(&world.grid, None).unwrap();
    let mut driver = Driver::new(&world, &grid, |_| {}).unwrap();
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
    let world = with(
        &format!("{orthographic},{perspective}"),
        &format!(r#"{node},{{"camera":1,"translation":[8,0,0]}}"#),
    );
    assert_eq!(world.camera(9, 1.0).eye, Vec3::X * 8.0);
}

#[test]
fn flat_and_mirrored_nodes_can_be_driven() {
    for scale in ["0,0,0", "1,0,1", "-1,1,1", "-1,-1,-1"] {
        let node = format!(r#"{{"mesh":0,"scale":[{scale}]}},{{"mesh":0}}"#);
        drive(triangle().read(&ONE.replace(r#"{"mesh":0}"#, &node)).unwrap());
    }
}

#[test]
fn flipped_bits_never_panic() {
    use base64::Engine;
    let strip = |rest: &str| rest.replace(r#""POSITION":0}"#, r#""POSITION":0},"mode":5"#);
    let (parts, rest) = instanced(PLACED);
    let data = base64::engine::general_purpose::STANDARD.encode(&parts.bin);
    let mut turning = timed();
    let turns = rotation_bytes(&[[0, 0, 0, 32767]; 4]);
    let turns = turning.dense(5122, "VEC4", &turns, r#","normalized":true"#);
    let spline = turning.floats("VEC3", &[0.5; 36]);
    let animations =
        [animation(0, "rotation", turns, "LINEAR"), animation(1, "translation", spline, "CUBICSPLINE")]
            .join(",");
    for file in [
        sparse_positions([1, 3], true).glb(INDEXED),
        sparse_positions([1, 3], false).glb(&strip(INDEXED)),
        parts.glb(&rest),
        parts.json(&rest, &format!(r#","uri":"data:;base64,{data}""#)).into_bytes(),
        turning.glb(&moved(&format!("[{animations}]"))),
    ] {
        assert!(read("whole", &file, None).is_ok());
        flip(&file, 4_000);
        for length in 0..file.len() {
            assert!(read("cut", &file[..length], None).is_err(), "cut at {length}");
        }
    }
}

/// Two primitives, a white one and a shiny red one that emits, and a lamp that hangs at (0, 2, 0)
/// and points down.
const LIT: &str = r#""extensionsUsed":["KHR_lights_punctual","KHR_materials_emissive_strength"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","color":[1,0.5,0],"intensity":4,
        "spot":{"innerConeAngle":0.2,"outerConeAngle":0.5}}]}},
    "nodes":[{"mesh":0},{"translation":[0,2,0],"rotation":[-0.70710678,0,0,0.70710678],
        "extensions":{"KHR_lights_punctual":{"light":0}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}},{"attributes":{"POSITION":0},"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"metallicFactor":0.5,"roughnessFactor":0.25},
        "emissiveFactor":[1,1,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":3}}}]"#;

#[test]
fn materials_and_lights_are_read() {
    let file = triangle().glb(LIT);
    let scene = read_lit("lit", &file, None).unwrap();
    let triangles = scene.triangles();
    assert_eq!(triangles.iter().map(|t| t.material).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(scene.materials[0], Material::matt(Vec3::ONE));
    let red = scene.materials[1];
    assert_eq!((red.emission, red.gloss), (Vec3::new(3.0, 3.0, 0.0), 0.75));
    assert!((red.specular - Vec3::new(0.52, 0.02, 0.02)).length() < 1e-6, "{red:?}");
    assert!((red.albedo - Vec3::new(0.48, 0.0, 0.0)).length() < 1e-6, "{red:?}");
    let below = scene.lights[0].incident(Vec3::ZERO).unwrap();
    assert!((below.irradiance - Vec3::new(1.0, 0.5, 0.0)).length() < 1e-6, "{below:?}");
    assert_eq!(scene.lights[0].incident(Vec3::new(3.0, 0.0, 0.0)), None);
    assert_eq!(scene.sky, Vec3::ZERO);
    flip(&file, 5_000);
    // Without lights there is a sun.
    let plain = read_lit("plain", &triangle().glb(ONE), None).unwrap();
    assert!(plain.lights.len() == 1 && plain.sky != Vec3::ZERO && plain.triangles().len() == 1);
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
    let file = small_file_with(r#"{"camera":0}"#, &nodes);
    let text = String::from_utf8_lossy(&file).into_owned();
    let json = &text[text.find('{').unwrap()..text.rfind('}').unwrap() + 1];
    let moved = json.replace(r#""nodes":[0,1]"#, r#""nodes":[0,1,2]"#).replace(r#""node":1"#, r#""node":2"#);
    let world = read("deep", &glb(&moved, &file[file.len() - 68..]), None).unwrap();
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
    let small = small_file();
    let text = String::from_utf8_lossy(&small).into_owned();
    let json = &text[text.find('{').unwrap()..text.rfind('}').unwrap() + 1];
    let with = |old: &str, new: &str| {
        assert!(json.contains(old), "{old}");
        read("made", &glb(&json.replace(old, new), &small[small.len() - 68..]), None)
    };
    // A thousand accessors of a mebi of zeros each, which take no bytes.
    let zeros = r#"{"componentType":5126,"count":1048576,"type":"VEC3","min":[0,0,0],"max":[0,0,0],"sparse":{"count":1,
        "indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":0}}},"#;
    let primitives: Vec<String> =
        (0..1000).map(|i| format!(r#"{{"attributes":{{"POSITION":{}}}}}"#, i + 3)).collect();
    let with_zeros = json
        .replace(
            r#"{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}]"#,
            &format!(
                r#"{{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}},{}]"#,
                zeros.repeat(1000).trim_end_matches(',')
            ),
        )
        .replace(r#"{"attributes":{"POSITION":0}}"#, &primitives.join(","));
    says(read("made", &glb(&with_zeros, &small[small.len() - 68..]), None), &["unfolds to too much"]);
    // The same positions in very many primitives, of which each may have them.
    let few = r#"{"attributes":{"POSITION":0}}"#;
    assert!(with(few, &[few; 1000].join(",")).is_ok());
    says(with(few, &vec![few; 400_000].join(",")), &["unfolds to too much"]);
    // Instances with a long name.
    let name = "leaf".repeat(50_000);
    let instanced =
        format!(r#"{name}","extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":0}}}}}}"#);
    let many = format!(r#""nodes":[{{"mesh":0,"name":"{instanced}}},{{"camera":0}}"#);
    let one = r#""nodes":[{"mesh":0,"name":"leaf","extras":{"role":"occludee"}},{"camera":0}"#;
    assert!(with(one, &many).is_ok());
    let zeros = zeros.trim_end_matches(',').replace("1048576", "524288");
    let json = json.replace(one, &many.replace(r#""TRANSLATION":0"#, r#""TRANSLATION":3"#)).replace(
        r#"{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}]"#,
        &format!(r#"{{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}},{zeros}]"#),
    );
    says(read("made", &glb(&json, &small[small.len() - 68..]), None), &["too many instances for its name"]);
}
