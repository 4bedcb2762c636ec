//! Views that `EXT_meshopt_compression` packs.

use super::super::packed::MESHOPT;
use super::*;

/// Corners of triangles on a ramp.
fn ramp() -> Vec<[u16; 4]> {
    (0..300).map(|i| [i % 20 * 97, i / 20 * 41, i % 23, 7]).collect()
}

/// The corners that a file says. They are packed in its first buffer; of the second, in which they
/// belong, `own` says more. The first of two words about their view is replaced by the other.
fn read_packed(name: &str, own: &str, [old, new]: [&str; 2]) -> Result<World, Trouble> {
    // By `encode_vertex_buffer_level(&ramp(), 2, Some(1))` of the crate meshopt 0.7.
    let bin = include_bytes!("ramp.meshopt").to_vec();
    let view = format!(
        r#"{{"buffer":1,"byteLength":2400,"byteStride":8,"extensions":{{"{name}":{{"buffer":0,
        "byteLength":{},"byteStride":8,"count":300,"mode":"ATTRIBUTES"}}}}}}"#,
        bin.len()
    );
    assert!(view.contains(old), "{old}");
    let accessor = r#"{"bufferView":0,"componentType":5123,"type":"VEC3","count":300}"#;
    let parts = Parts { accessors: vec![accessor.into()], views: vec![view.replacen(old, new, 1)], bin };
    let required = format!(r#""extensionsRequired":["{name}","KHR_mesh_quantization"],{ONE}"#);
    let json = parts.json(&required, &format!(r#"}},{{"byteLength":2400{own}"#));
    read("packed", &glb(&json, &parts.bin), None)
}

#[test]
fn packed_views_are_read_where_their_bytes_are_not_there() {
    let place = |v: [u16; 4]| Vec3::from_array([0, 1, 2].map(|axis| f32::from(v[axis])));
    let expected: Vec<Vec3> = ramp().into_iter().map(place).collect();
    let corners = |read: Result<World, Trouble>| triangles(&read.unwrap(), 0).concat();
    for name in MESHOPT {
        let marked = format!(r#","extensions":{{"{name}":{{"fallback":true}}}}"#);
        for own in ["", &marked, r#","uri":"gone.bin""#] {
            assert_eq!(corners(read_packed(name, own, ["", ""])), expected, "{name} {own}");
        }
    }
    // Bytes that are there are taken, whatever is packed.
    let zeros = format!(r#","uri":"data:;base64,{}""#, "AAAA".repeat(800));
    let found = corners(read_packed(MESHOPT[0], &zeros, ["ATTRIBUTES", "NOTHING"]));
    assert_eq!(found, [Vec3::ZERO; 300]);
    let damaged = "what buffer view 0 packs is damaged";
    for (old, new, why) in [
        ("ATTRIBUTES", "TRIANGLES", damaged),
        (r#""mode""#, r#""filter":"MEDIAN","mode""#, damaged),
        (r#""count":300"#, r#""count":200"#, damaged),
        (r#""count":300"#, r#""count":4000000000"#, "unpacks to too much"),
        (r#""count":300"#, r#""count":18446744073709551615"#, "unpacks to too much"),
        (r#""buffer":0"#, r#""buffer":7"#, damaged),
        (r#""buffer":0"#, r#""buffer":1"#, damaged),
        (r#""byteLength":2400"#, r#""byteLength":2392"#, damaged),
    ] {
        says(read_packed(MESHOPT[0], "", [old, new]), &["buffer 1", why]);
    }
}
