//! Lit levels in files: what is written is read back.

use casca_lightmap::{Level, Probes, Settings, light, unpacked};
use casca_scenes::random::generator;
use glam::{UVec3, Vec3};
use gltf::Gltf;
use parts::{Parts, bytes_of};
use rand::RngExt;
use serde_json::Value;

#[path = "../../../crates/scenes/src/import/tests/parts.rs"]
mod parts;

const FAST: Settings = Settings { texels: 4.0, side: 256, spacing: 1.0, cells: 16, rays: 16, live: false };

/// A floor that stands twice, the second time mirrored and larger; the same one on a lift; and a line in
/// its mesh. Its corners have one more attribute, of three bytes.
fn level(texture: &str) -> Vec<u8> {
    let mut parts = Parts::default();
    let corners = [0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 0.0, 2.0, 2.0, 0.0, 0.0];
    parts.floats("VEC3", &corners);
    let indices: Vec<u8> = [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect();
    parts.dense(5123, "SCALAR", &indices, "");
    let view = parts.view(&(0..12).collect::<Vec<u8>>());
    let third = format!(r#""bufferView":{view},"normalized":true"#);
    parts.accessor(5121, "VEC3", 4, &third);
    parts.floats("SCALAR", &[0.0, 1.0]);
    let view = parts.view(&bytes_of(&[0.0, 0.0, 0.0, 0.0, 3.0, 0.0]));
    parts.accessor(5126, "VEC3", 2, &format!(r#""bufferView":{view}"#));
    parts.floats("VEC3", &[[0.0, 1.0, 0.0]; 4].concat());
    parts.glb(&format!(
        r#""scene":0,"scenes":[{{"nodes":[0,1,2,3],"extras":{{"kept":1}}}}],
        "nodes":[{{"mesh":0,"name":"floor","extras":{{"role":"both"}}}},
        {{"mesh":0,"scale":[-2,1,2],"translation":[-1,0,0]}},{{"mesh":0,"name":"lift"}},
        {{"translation":[1,2,1],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":2,"NORMAL":5}},"indices":1,
        "material":0}},
        {{"attributes":{{"POSITION":0}},"mode":1}}]}}],"materials":[{{"name":"grey"{texture}}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":2,"path":"translation"}}}}],
        "samplers":[{{"input":3,"output":4}}]}}],"extensionsUsed":["KHR_lights_punctual"],
        "textures":[{{"source":0}}],"images":[{{"uri":"none.png"}}],"extensions":
        {{"KHR_lights_punctual":{{"lights":[{{"type":"point","intensity":9}}]}}}}"#
    ))
}

type Image = ([u32; 3], Vec<Vec3>);

/// A file that is lit, read back: its document, its bytes, its text, and its images as the library for
/// KTX 2 reads them, with their sizes.
fn lit(bytes: &[u8]) -> (Gltf, Vec<u8>, Value, Vec<Image>, Probes) {
    let level = Level::read("level", bytes, None).unwrap();
    let found = light(&level.scene, &level.placed, &FAST, &mut |_, _, _| {}).unwrap();
    let files = level.lit("lit", &found, &FAST).unwrap();
    assert_eq!(files[0].0, "lit.glb");
    let read = Gltf::from_slice(&files[0].1).unwrap();
    let glb = gltf::Glb::from_slice(&files[0].1).unwrap();
    let text: Value = serde_json::from_slice(&glb.json).unwrap();
    let extra = &text["scenes"][0]["extras"]["casca_light"];
    assert_eq!(extra["lightmaps"], serde_json::json!(["lit.lightmap0.ktx2"]));
    assert_eq!((&extra["probes"]["image"], files.len()), (&"lit.probes.ktx2".into(), 3));
    let image = |(_, bytes): &(String, Vec<u8>)| {
        let file = ktx2::Reader::new(&bytes[..]).unwrap();
        let head = file.header();
        assert_eq!(head.format, Some(ktx2::Format::E5B9G9R9_UFLOAT_PACK32));
        let texels = file.levels().next().unwrap().data.as_chunks().0.iter();
        let texels: Vec<Vec3> = texels.map(|t: &[u8; 4]| unpacked(u32::from_le_bytes(*t))).collect();
        let size = [head.pixel_width, head.pixel_height, head.pixel_depth];
        assert_eq!(texels.len() as u32, size[0] * size[1] * size[2].max(1));
        (size, texels)
    };
    (read, glb.bin.unwrap().into_owned(), text, files[1..].iter().map(image).collect(), found.probes)
}

#[test]
fn a_lit_level_is_the_level_with_coordinates_and_images_that_are_read_back() {
    let bytes = level("");
    let (read, bin, text, images, probes) = lit(&bytes);
    let before: Value = serde_json::from_slice(&gltf::Glb::from_slice(&bytes).unwrap().json).unwrap();
    for same in ["materials", "animations", "extensions", "extensionsUsed", "asset"] {
        assert_eq!(text[same], before[same], "{same}");
    }
    let mut nodes = text["nodes"].clone();
    for node in nodes.as_array_mut().unwrap() {
        if let Some(extras) = node.get_mut("extras").and_then(Value::as_object_mut) {
            extras.remove("casca_light");
        }
    }
    nodes[1].as_object_mut().unwrap().remove("extras");
    assert_eq!((&nodes, &text["scenes"][0]["extras"]["kept"]), (&before["nodes"], &1.into()));
    // What moves has no place in the lightmap.
    let rects: Vec<[f64; 4]> = (0..2)
        .map(|i| &text["nodes"][i]["extras"]["casca_light"])
        .map(|e| serde_json::from_value(e["uv_rect"].clone()).unwrap())
        .collect();
    assert!(text["nodes"][2].get("extras").is_none());

    let mesh = read.meshes().next().unwrap();
    let primitives: Vec<gltf::Primitive> = mesh.primitives().collect();
    let reader = primitives[0].reader(|_| Some(&bin));
    let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let uv: Vec<[f32; 2]> = reader.read_tex_coords(1).unwrap().into_f32().collect();
    // Sets of coordinates start with the first.
    assert!(reader.read_tex_coords(0).unwrap().into_f32().eq(uv.iter().copied()));
    let colors: Vec<[u8; 3]> = reader.read_colors(0).unwrap().into_rgb_u8().collect();
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!((positions.len(), uv.len(), indices.len()), (4, 4, 6));
    assert!(reader.read_normals().unwrap().eq([[0.0, 1.0, 0.0]; 4]));
    // Attributes stay with their corners: corner k of the old file had the bytes 3k, 3k + 1, 3k + 2.
    let old = [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, 0.0_f32]];
    for (position, color) in positions.iter().zip(&colors) {
        let corner = old.iter().position(|p| p == position).unwrap() as u8;
        assert_eq!(color, &[3 * corner, 3 * corner + 1, 3 * corner + 2]);
    }
    assert_eq!(primitives[0].bounding_box(), gltf::mesh::Bounds { min: [0.0; 3], max: [2.0, 0.0, 2.0] });
    let line = primitives[1].reader(|_| Some(&bin));
    assert!(line.read_tex_coords(1).is_none() && line.read_positions().unwrap().count() == 4);

    // Texels say what a point light of intensity 9 gives, an e which is nowhere but below it: each floor
    // below (1, 2, 1) by its own rectangle. The sheets face upwards, also the mirrored one.
    let (size, texels) = &images[0];
    for (rect, place) in rects.iter().zip([[1.0, 1.0, 0.0], [-2.0, 2.0, -1.0]]) {
        for (p, at) in positions.iter().zip(&uv) {
            // From the corner a little towards the middle.
            let inwards = |corner: f64, middle: f64| corner + 0.2 * (middle - corner);
            let at = [0, 1].map(|i| inwards(f64::from(at[i]), 0.5));
            let x = (rect[0] + at[0] * (rect[2] - rect[0])) * f64::from(size[0]);
            let y = (rect[1] + at[1] * (rect[3] - rect[1])) * f64::from(size[1]);
            let found = texels[y as usize * size[0] as usize + x as usize].x;
            let way = Vec3::new(
                inwards(f64::from(p[0]), 1.0) as f32 * place[0] + place[2] - 1.0,
                2.0,
                inwards(f64::from(p[2]), 1.0) as f32 * place[1] - 1.0,
            );
            let truth = 9.0 * 2.0 / way.length().powi(3) / std::f32::consts::PI;
            assert!((found / truth - 1.0).abs() < 0.2, "{found}, not {truth} at {way}");
        }
    }
    let (size, texels) = &images[1];
    assert_eq!(UVec3::from_array(*size), probes.counts * UVec3::new(1, 2, 3));
    let written = probes.texture().1;
    let most = written.iter().map(|c| c.max_element()).fold(0.0, f32::max);
    assert!(written.iter().zip(texels).all(|(a, b)| (*a - *b).abs().max_element() <= most / 512.0));
}

#[test]
fn damaged_files_and_levels_without_anything_still_are_errors() {
    let bytes = level("");
    let mut random = generator(5, 0);
    for _ in 0..300 {
        let mut broken = bytes.clone();
        for _ in 0..1 + random.random_range(0..3) {
            let at = random.random_range(0..broken.len());
            broken[at] ^= 1 << random.random_range(0..8);
        }
        if random.random_range(0..4) == 0 {
            broken.truncate(random.random_range(0..bytes.len()));
        }
        // Either is fine; it must not panic, and what is written must be read.
        let Ok(level) = Level::read("broken", &broken, None) else { continue };
        let coarse = Settings { texels: 0.5, cells: 4, rays: 1, ..FAST };
        let Ok(found) = light(&level.scene, &level.placed, &coarse, &mut |_, _, _| {}) else { continue };
        if let Ok(files) = level.lit("lit", &found, &Settings { live: true, ..coarse }) {
            assert!(Level::read("again", &files[0].1, None).is_ok());
        }
    }
    let said = |bytes: &[u8]| Level::read("level", bytes, None).map(|_| ()).unwrap_err().to_string();
    assert!(said(b"glTF").contains("header"), "{}", said(b"glTF"));
    // The texture needs the second set, which lightmaps would take.
    let second = level(r#","occlusionTexture":{"index":0,"texCoord":1}"#);
    assert!(said(&second).contains("nothing can have a lightmap"), "{}", said(&second));
}
