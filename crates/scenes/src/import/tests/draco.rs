//! Primitives that `KHR_draco_mesh_compression` packs.

use super::super::accessors::Components;
use super::super::document::parse;
use super::*;

/// A torus of 192 triangles, and a fan of 260 vertices that are integers and follow joints: the tests
/// of `casca-draco` say where.
const TORUS: &[u8] = include_bytes!("../../../../draco/tests/torus.valence.drc");
const FAN: &[u8] = include_bytes!("../../../../draco/tests/fan.drc");

/// Their primitives.
const ROUND: &str = r#"{"attributes":{"POSITION":0},"indices":1,"extensions":{
    "KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0,"NORMAL":1}}}}"#;
const FLAT: &str = r#"{"attributes":{"POSITION":0,"JOINTS_0":2},"indices":1,"extensions":{
    "KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0,"JOINTS_0":1}}}}"#;

/// A file whose accessors have no bytes, and the wrong number and box; the first view holds `stream`.
fn packed(stream: &[u8], accessors: &[(u32, &str)]) -> Parts {
    let mut parts = Parts::default();
    parts.view(stream);
    for &(component, kind) in accessors {
        parts.accessor(component, kind, 1, r#""byteOffset":0"#);
    }
    parts
}

fn torus() -> Parts {
    packed(TORUS, &[(F32, "VEC3"), (5123, "SCALAR")])
}

fn mesh(primitives: &str) -> String {
    format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{primitives}]}}]"#)
}

/// A mesh that each program must unpack.
fn required(primitives: &str) -> String {
    let names = r#""extensionsRequired":["KHR_draco_mesh_compression","KHR_mesh_quantization"]"#;
    format!("{names},{}", mesh(primitives))
}

#[test]
fn primitives_are_unpacked_once_and_bounded_by_what_is_unpacked() {
    for component in ["5121", "5123", "5125"] {
        let mut parts = torus();
        parts.accessors[1] = parts.accessors[1].replace("5123", component);
        let world = parts.read(&required(ROUND)).unwrap();
        assert_eq!(triangles(&world, 0).len(), 192);
        let (min, max) = world.objects[0].shape.bounds();
        let size = Vec3::new(2.75, 0.75, 2.75);
        assert!(min.abs_diff_eq(-size, 2e-3) && max.abs_diff_eq(size, 2e-3), "{min} {max}");
        assert!(world.grid.min.cmple(min).all() && world.grid.max.cmpge(max).all());
    }
    let parts = packed(FAN, &[(5122, "VEC3"), (5125, "SCALAR"), (5121, "VEC4")]);
    let bytes = parts.glb(&required(&format!("{FLAT},{FLAT}")));
    let world = read("fan", &bytes, None).unwrap();
    let vertex = |i: i16| Vec3::from_array([i, i % 16, i * 4 - 500].map(f32::from));
    let fans: Vec<_> = (1..259).chain(1..259).map(|i| [Vec3::ZERO, vertex(i), vertex(i + 1)]).collect();
    assert_eq!(triangles(&world, 0), fans);
    let Shape::Mesh { mesh, .. } = &world.objects[0].shape else { panic!() };
    assert_eq!(mesh.positions.len(), 260);
    assert_eq!(world.source.parts[0].primitives[..], [[0; 258], [1; 258]].concat());
    let file = parse(&bytes, None, &Default::default()).unwrap();
    let mesh = file.document.meshes().next().unwrap();
    let joints = mesh.primitives().next().unwrap().get(&gltf::Semantic::Joints(0)).unwrap();
    let joints = file.buffers.floats::<4>(&joints, "joints", Components::Integers).unwrap();
    assert_eq!(joints, (0..260).map(|i| [(i % 3) as f32, 1.0, 0.0, 0.0]).collect::<Vec<_>>());
}

#[test]
fn the_plain_form_is_read_unless_draco_is_required() {
    // What has no other form is unpacked, whatever is required.
    assert_eq!(triangles(&torus().read(&mesh(ROUND)).unwrap(), 0).len(), 192);
    let mut parts = torus();
    let (places, corners) = (parts.view(&bytes_of(&SQUARE)), parts.view(&[0, 1, 2]));
    parts.accessors = vec![
        format!(r#"{{"bufferView":{places},"componentType":5126,"type":"VEC3","count":3}}"#),
        format!(r#"{{"bufferView":{corners},"componentType":5121,"type":"SCALAR","count":3}}"#),
    ];
    let plain = parts.read(&mesh(ROUND)).unwrap();
    assert_eq!(triangles(&plain, 0), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    assert!(plain.source.warnings[0].starts_with("primitive 0 of mesh 0: is there twice, plain and packed"));
    // A form without corners is none.
    let mut cut = parts.clone();
    cut.accessors[1] = torus().accessors[1].replace(r#""count":1"#, r#""count":3"#);
    assert_eq!(triangles(&cut.read(&mesh(ROUND)).unwrap(), 0).len(), 192);
    let unpacked = parts.read(&required(ROUND)).unwrap();
    assert_eq!((triangles(&unpacked, 0).len(), unpacked.source.warnings.len()), (192, 0));
}

#[test]
fn what_cannot_be_unpacked_is_refused_with_what_to_do() {
    let (whole, mut other) = (torus(), torus());
    other.accessors[0] = other.accessors[0].replace("5126", "5122");
    let short = packed(&TORUS[..500], &[(F32, "VEC3"), (5123, "SCALAR")]);
    for (parts, old, new, why) in [
        (&short, "", "", "it is damaged"),
        (&other, "", "", "POSITION: it is not there, or of another type"),
        (&whole, r#""bufferView":0"#, r#""bufferView":1"#, "its buffer view is not there"),
        (&whole, r#""bufferView":0,"#, "", "its buffer view is not there"),
        (&whole, r#""indices":1"#, r#""indices":1,"mode":5"#, "it is not of triangles"),
        (&whole, r#""indices":1,"#, "", "it has no indices"),
        (&whole, r#"{"POSITION":0,"NORMAL":1"#, r#"{"POSITION":3,"NORMAL":1"#, "POSITION: it is not there"),
        (&whole, r#"{"POSITION":0,"NORMAL":1"#, r#"{"NORMAL":1"#, "it has no positions"),
    ] {
        assert!(ROUND.contains(old), "{old}");
        let read = parts.read(&required(&ROUND.replacen(old, new, 1)));
        says(read, &["primitive 0 of mesh 0 is packed by Draco", why, "export it anew, or without"]);
    }
    // Many views of the same bytes: each is unpacked.
    let mut many = whole;
    let named = |i: usize| many.views[0].replace(r#""buffer":0"#, &format!(r#""name":"{i}","buffer":0"#));
    many.views = (0..5000).map(named).collect();
    let all = (0..5000).map(|i| ROUND.replace(r#""bufferView":0"#, &format!(r#""bufferView":{i}"#)));
    says(many.read(&required(&all.collect::<Vec<_>>().join(","))), &["unpacks to too much; export"]);
}
