use std::path::Path;
use std::sync::Arc;

use glam::{Quat, Vec3};

use super::*;
use crate::drive::{Driver, view_of};
use crate::world::{FRAME_SECONDS, Mesh, Motion, Shape};

mod accessors;
mod animation;
mod draco;
mod far;
mod files;
mod instances;
mod lenient;
mod nodes;
mod packed;
mod parts;

use parts::{F32, Parts, bytes_of, glb};

/// A document with one triangle and a camera that moves from x = 0 to x = 2 in two seconds.
const SMALL: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
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
/// The floats of its buffer.
const SMALL_FLOATS: [f32; 9 + 2 + 6] =
    [0.0, 0.0, -5.0, 1.0, 0.0, -5.0, 0.0, 1.0, -5.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0];

/// A .glb of this document, or one like it.
fn small_file(json: &str) -> Vec<u8> {
    glb(json, &bytes_of(&SMALL_FLOATS))
}

/// Reads the small file with a part of its document replaced where it stands first.
fn read_small_with(old: &str, new: &str) -> Result<World, Trouble> {
    assert!(SMALL.contains(old), "{old}");
    read("small", &small_file(&SMALL.replacen(old, new, 1)), None)
}

impl Parts {
    fn read(&self, rest: &str) -> Result<World, Trouble> {
        read("made", &self.glb(rest), None)
    }

    /// The mesh of accessor 0 on a node that an animation moves.
    fn animated(&self, node: usize, path: &str, output: usize, how: &str) -> Result<World, Trouble> {
        self.read(&moved(&format!("[{}]", animated(node, path, output, how))))
    }
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

fn animated(node: usize, path: &str, output: usize, interpolation: &str) -> String {
    format!(
        r#"{{"channels":[{{"sampler":0,"target":{{"node":{node},"path":"{path}"}}}}],"samplers":[{{"input":1,"output":{output},"interpolation":"{interpolation}"}}]}}"#
    )
}
