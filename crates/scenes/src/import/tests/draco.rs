//! Primitives that `KHR_draco_mesh_compression` packs. The streams are by the reference encoder
//! (`draco3dgltf` 1.5.7), of what `torus` and `fan` say.

use std::f64::consts::TAU;

use rand::RngExt;

use super::super::accessors::Components;
use super::super::document::{File, parse};
use super::*;
use crate::random::generator;

/// Tori: by Edgebreaker at speeds 0 and 7, and in sequence.
const TORI: [&[u8]; 3] = [
    include_bytes!("torus.valence.drc"),
    include_bytes!("torus.standard.drc"),
    include_bytes!("torus.sequential.drc"),
];
/// A fan of 260 vertices that are integers, which follow joints.
const FAN: &[u8] = include_bytes!("fan.drc");
/// Cells of the torus around its hole, and around its tube.
const CELLS: [u32; 2] = [12, 8];
/// Half a step of 11 bits over the width of the torus, which is 5.5, and of 10 bits over 1; and what
/// floats round.
const STEPS: [f32; 2] = [5.5 / 2047.0 * 0.501, 1.0 / 1023.0 * 0.501];

/// The vertices of the torus by rows, with its seams twice, and where they lie in its texture.
fn torus() -> Vec<(Vec3, [f32; 2])> {
    let [n, m] = CELLS;
    let vertex = |i: u32, j: u32| {
        let [a, b] = [(i % n, n), (j % m, m)].map(|(k, of)| TAU * f64::from(k) / f64::from(of));
        let ring = 2.0 + 0.75 * b.cos();
        let place = [ring * a.cos(), 0.75 * b.sin(), ring * a.sin()].map(|x| x as f32);
        (Vec3::from_array(place), [i as f32 / n as f32, j as f32 / m as f32])
    };
    (0..=n).flat_map(|i| (0..=m).map(move |j| vertex(i, j))).collect()
}

/// Its triangles, from their least corner on, in order.
fn triangles_of_torus() -> Vec<[usize; 3]> {
    let [n, m] = CELLS.map(|cells| cells as usize);
    let cell = |i: usize, j: usize| {
        let (p, q) = (i * (m + 1) + j, (i + 1) * (m + 1) + j);
        [[p, p + 1, q], [q, p + 1, q + 1]]
    };
    sorted((0..n).flat_map(|i| (0..m).flat_map(move |j| cell(i, j))).collect())
}

fn sorted(mut triangles: Vec<[usize; 3]>) -> Vec<[usize; 3]> {
    for t in &mut triangles {
        let least = (0..3).min_by_key(|&corner| t[corner]).unwrap();
        t.rotate_left(least);
    }
    triangles.sort_unstable();
    triangles
}

/// A file whose accessors have no bytes; the first view holds `stream`.
fn packed(stream: &[u8], accessors: &[(u32, &str)]) -> Parts {
    let mut parts = Parts::default();
    parts.view(stream);
    for &(component, kind) in accessors {
        // Its box and its number are wrong: they say nothing of what is unpacked.
        parts.accessor(component, kind, 1, r#""byteOffset":0"#);
    }
    parts
}

fn packed_torus(stream: &[u8]) -> Parts {
    packed(stream, &[(F32, "VEC3"), (5123, "SCALAR"), (F32, "VEC2")])
}

fn packed_fan(stream: &[u8]) -> Parts {
    packed(stream, &[(5122, "VEC3"), (5125, "SCALAR"), (5121, "VEC4")])
}

const TORUS: &str = r#"{"attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"extensions":{
    "KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}}}"#;
const FANNED: &str = r#"{"attributes":{"POSITION":0,"JOINTS_0":2},"indices":1,"extensions":{
    "KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0,"JOINTS_0":1}}}}"#;

/// A node with a mesh of primitives that Draco must unpack.
fn required(primitives: &str) -> String {
    let names = r#""extensionsRequired":["KHR_draco_mesh_compression","KHR_mesh_quantization"]"#;
    format!("{names},{}", mesh(primitives))
}

fn mesh(primitives: &str) -> String {
    format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{primitives}]}}]"#)
}

/// What the first primitive of a file has.
fn read_of<const N: usize>(file: &File, semantic: gltf::Semantic) -> Vec<[f32; N]> {
    let mesh = file.document.meshes().next().unwrap();
    let accessor = mesh.primitives().next().unwrap().get(&semantic).unwrap();
    file.buffers.floats(&accessor, "attributes", Components::Integers).unwrap()
}

#[test]
fn all_triangles_and_texture_coordinates_are_read_within_their_step() {
    let expected = torus();
    for (stream, component) in TORI.into_iter().zip(["5121", "5123", "5125"]) {
        let mut parts = packed_torus(stream);
        parts.accessors[1] = parts.accessors[1].replace("5123", component);
        let bytes = parts.glb(&required(TORUS));
        let file = parse(&bytes, None, &Default::default()).unwrap();
        let coordinates = read_of::<2>(&file, gltf::Semantic::TexCoords(0));
        let places = read_of::<3>(&file, gltf::Semantic::Positions);
        let vertex = |corner: u32| {
            let (place, [u, v]) = (Vec3::from_array(places[corner as usize]), coordinates[corner as usize]);
            let is_it = |(p, [s, t]): &(Vec3, [f32; 2])| {
                (*p - place).abs().max_element() <= STEPS[0] && (s - u).abs().max((t - v).abs()) <= STEPS[1]
            };
            expected.iter().position(is_it).unwrap_or_else(|| panic!("{place} {u} {v}"))
        };
        let primitive = file.document.meshes().next().unwrap().primitives().next().unwrap();
        let corners = file.buffers.indices(&primitive.indices().unwrap()).unwrap();
        let found = corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(vertex)).collect();
        assert_eq!(sorted(found), triangles_of_torus(), "{component}");

        let world = read("torus", &bytes, None).unwrap();
        assert_eq!(triangles(&world, 0).len(), 192);
        assert!(world.grid.min.cmplt(Vec3::new(-2.7, -0.7, -2.7)).all(), "{}", world.grid.min);
    }
}

#[test]
fn integers_are_read_as_they_are_and_primitives_share_what_they_unpack() {
    let bytes = packed_fan(FAN).glb(&required(&format!("{FANNED},{FANNED}")));
    let world = read("fan", &bytes, None).unwrap();
    let vertex = |i: i16| Vec3::from_array([i, i % 16, i * 4 - 500].map(f32::from));
    let fans: Vec<_> = (1..259).chain(1..259).map(|i| [Vec3::ZERO, vertex(i), vertex(i + 1)]).collect();
    assert_eq!(triangles(&world, 0), fans);
    let Shape::Mesh { mesh, .. } = &world.objects[0].shape else { panic!() };
    assert_eq!(mesh.positions.len(), 260);
    assert_eq!(world.source.parts[0].primitives[..], [[0; 258], [1; 258]].concat());
    let file = parse(&bytes, None, &Default::default()).unwrap();
    let joints: Vec<[f32; 4]> = (0..260).map(|i| [(i % 3) as f32, 1.0, 0.0, 0.0]).collect();
    assert_eq!(read_of(&file, gltf::Semantic::Joints(0)), joints);
}

#[test]
fn the_plain_form_is_read_unless_draco_is_required() {
    let mut parts = packed_torus(TORI[0]);
    let view = parts.view(&bytes_of(&SQUARE));
    parts.accessors[0] = format!(r#"{{"bufferView":{view},"componentType":5126,"type":"VEC3","count":3}}"#);
    let places = parts.view(&[0, 1, 2]);
    parts.accessors[1] =
        format!(r#"{{"bufferView":{places},"componentType":5121,"type":"SCALAR","count":3}}"#);
    let plain = parts.read(&mesh(TORUS)).unwrap();
    assert_eq!(triangles(&plain, 0), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    assert!(plain.source.warnings[0].starts_with("primitive 0 of mesh 0: is there twice, plain and packed"));
    let unpacked = parts.read(&required(TORUS)).unwrap();
    assert_eq!((triangles(&unpacked, 0).len(), unpacked.source.warnings.len()), (192, 0));
    // What has no other form is unpacked, whatever is required.
    assert_eq!(triangles(&packed_torus(TORI[0]).read(&mesh(TORUS)).unwrap(), 0).len(), 192);
}

#[test]
fn what_cannot_be_unpacked_is_refused_with_what_to_do() {
    let whole = packed_torus(TORI[0]);
    let mut other = whole.clone();
    other.accessors[0] = other.accessors[0].replace("5126", "5122");
    for (parts, old, new, why) in [
        (&packed_torus(&TORI[0][..500]), "", "", "be had"),
        (&other, "", "", "its POSITION is of another type than its accessor"),
        (&whole, r#""bufferView":0"#, r#""bufferView":1"#, "its buffer view is not there"),
        (&whole, r#""bufferView":0,"#, "", "its buffer view is not there"),
        (&whole, r#""indices":1"#, r#""indices":1,"mode":5"#, "it is not of triangles"),
        (&whole, r#""indices":1,"#, "", "it has no indices"),
        (&whole, r#"{"POSITION":0,"NORMAL":1"#, r#"{"POSITION":3,"NORMAL":1"#, "its POSITION is not there"),
        (&whole, r#"{"POSITION":0,"NORMAL":1"#, r#"{"NORMAL":1"#, "it has no positions"),
    ] {
        assert!(TORUS.contains(old), "{old}");
        let read = parts.read(&required(&TORUS.replacen(old, new, 1)));
        says(read, &["primitive 0 of mesh 0 is packed by Draco", why, "export it anew, or without"]);
    }
    // Many views of the same bytes: each is unpacked.
    let mut many = whole;
    let named = |i: usize| many.views[0].replace(r#""buffer":0"#, &format!(r#""name":"{i}","buffer":0"#));
    many.views = (0..4000).map(named).collect();
    let all = (0..4000).map(|i| TORUS.replace(r#""bufferView":0"#, &format!(r#""bufferView":{i}"#)));
    says(many.read(&required(&all.collect::<Vec<_>>().join(","))), &["unpacks to too much; export"]);
}

#[test]
fn damaged_streams_are_read_or_refused() {
    let mut dice = generator(1, 0);
    let (mut read, mut refused) = (0, 0);
    for case in 0..12_000 {
        let (mut stream, fan) = ([TORI[0], TORI[1], TORI[2], FAN][case % 4].to_vec(), case % 4 == 3);
        for _ in 0..dice.random_range(1..4) {
            // Half of the damages are near the head, where all else is decided.
            let end = if dice.random() { stream.len().min(64) } else { stream.len() };
            let at = dice.random_range(0..end);
            stream[at] = dice.random();
        }
        if dice.random_ratio(1, 8) {
            stream.truncate(dice.random_range(0..stream.len()));
        }
        let (parts, primitive) =
            if fan { (packed_fan(&stream), FANNED) } else { (packed_torus(&stream), TORUS) };
        match parts.read(&required(primitive)) {
            Ok(_) => read += 1,
            Err(_) => refused += 1,
        }
    }
    assert!(read > 1000 && refused > 1000, "{read} {refused}");
}
