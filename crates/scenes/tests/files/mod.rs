//! Small valid glTF files, for tests of damaged ones and for the fuzz target `readers`.

// Each test and the fuzz target use a part of it.
#![allow(dead_code)]

/// A triangle that moves with its node, a strip of sparse positions, instances, a camera and a
/// light.
const JSON: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
    "extensionsUsed":["EXT_mesh_gpu_instancing","KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":2}]}},
    "nodes":[{"mesh":0,"name":"leaf","extras":{"role":"occludee"},"children":[2,3]},{"camera":0},
        {"mesh":1,"translation":[0,1,0],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}},
        {"extensions":{"KHR_lights_punctual":{"light":0}}}],
    "cameras":[{"type":"perspective","perspective":{"yfov":1.0,"znear":0.1}}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1],"metallicFactor":0.5,
        "baseColorTexture":{"index":0}}}],
    "textures":[{"source":0,"sampler":0}],"images":[{"bufferView":3}],"samplers":[{"wrapS":10497}],
    "skins":[{"joints":[0,2],"inverseBindMatrices":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":4,"material":0}]},
        {"primitives":[{"mode":5,"attributes":{"POSITION":3}}]}],
    "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],
        "samplers":[{"input":1,"output":2}]}],
    "accessors":[
        {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,-5],"max":[1,1,-5]},
        {"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[2]},
        {"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"},
        {"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0],"sparse":{"count":3,
            "indices":{"bufferView":3,"componentType":5121},"values":{"bufferView":0}}},
        {"bufferView":3,"componentType":5121,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},
        {"buffer":0,"byteOffset":44,"byteLength":24},{"buffer":0,"byteOffset":68,"byteLength":3}],
    "buffers":[{"byteLength":72}]}"#;

fn binary() -> Vec<u8> {
    let floats: [f32; 17] =
        [0.0, 0.0, -5.0, 1.0, 0.0, -5.0, 0.0, 1.0, -5.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0];
    let mut bytes: Vec<u8> = floats.iter().flat_map(|f| f.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0]);
    bytes
}

fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut file = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    let length = file.len() as u32;
    file[8..12].copy_from_slice(&length.to_le_bytes());
    file
}

/// Has Draco pack the first mesh.
fn packed() -> Vec<u8> {
    let stream = include_bytes!("../../../draco/tests/torus.valence.drc");
    let (length, all) = (stream.len(), 72 + stream.len());
    let view = format!(r#""byteLength":3}},{{"buffer":0,"byteOffset":72,"byteLength":{length}}}]"#);
    let parts = [
        (r#""scene":0"#, r#""extensionsRequired":["KHR_draco_mesh_compression"],"scene":0"#),
        (
            r#""indices":4"#,
            r#""indices":4,"extensions":{"KHR_draco_mesh_compression":{"bufferView":4,"attributes":{"POSITION":0}}}"#,
        ),
        (r#""byteLength":3}]"#, &view),
        (r#""byteLength":72"#, &format!(r#""byteLength":{all}"#)),
    ];
    let json = parts.iter().fold(JSON.to_owned(), |json, (old, new)| json.replacen(old, new, 1));
    glb(json.as_bytes(), &[&binary(), &stream[..]].concat())
}

/// A file with a binary chunk, one with the same bytes in its text, and one with a packed mesh.
pub fn all() -> Vec<Vec<u8>> {
    let mut json = JSON.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let base64 =
        "AAAAAAAAAAAAAKDAAACAPwAAAAAAAKDAAAAAAAAAgD8AAKDAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAABAAAAAAAAAAAAAAQI=";
    let uri = format!("\"buffers\":[{{\"byteLength\":71,\"uri\":\"data:;base64,{base64}\"}}]");
    let text = JSON.replace("\"buffers\":[{\"byteLength\":72}]", &uri);
    vec![glb(&json, &binary()), text.into_bytes(), packed()]
}

/// Sets the lengths of a file and its chunks right, wherever the text ends now.
pub fn mend(file: &mut Vec<u8>) {
    let end =
        file.windows(4).position(|w| w == b"BIN\0").filter(|&end| file.starts_with(b"glTF") && end >= 24);
    if let Some(end) = end {
        *file = glb(&file[20..end - 4], &file[end + 4..]);
    }
}
