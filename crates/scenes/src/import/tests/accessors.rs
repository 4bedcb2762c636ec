//! Accessors: sparse, quantized, all kinds of triangles.

use super::nodes::drive;
use super::*;

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
    let u16s = [0u16, 0, 0, 65535, 0, 0, 0, 13107, 2].map(u16::to_le_bytes).concat();
    let i16s = [0i16, 0, 0, -32768, 0, 0, 0, 32767, 2].map(i16::to_le_bytes).concat();
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
    let known =
        r#""KHR_materials_unlit","KHR_texture_transform","EXT_meshopt_compression","KHR_node_visibility""#;
    assert!(with(known).is_ok());
    let unknown = r#""KHR_materials_ior","VENDOR_floors","VENDOR_walls""#;
    let told = told(with(unknown));
    assert!(told.ends_with("VENDOR_floors, VENDOR_walls"), "{told}");
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
    // Points and lines are looked for, and hide nothing.
    assert_eq!(shown(&[(0, None)]), strip.iter().map(|&p| [p; 3]).collect::<Vec<_>>());
    assert_eq!(shown(&[(1, None)]), [[p0, p1, p1], [p2, p3, p3]]);
    assert_eq!(shown(&[(3, Some(1))]), [[p3, p2, p2], [p2, p1, p1], [p1, p0, p0]]);
    assert_eq!(shown(&[(2, None)])[3], [p3, p0, p0]);
    for lines in 0..4 {
        let world = read_as(&[(lines, None), (5, None), (lines, Some(1))]).unwrap();
        let Shape::Mesh { mesh, .. } = &world.objects[0].shape else { panic!() };
        assert_eq!(mesh.hiding().unwrap().0.len(), 2);
        let alone = drive(read_as(&[(lines, None)]).unwrap());
        assert!(!alone.objects[0].occludes && alone.objects[0].tested);
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
