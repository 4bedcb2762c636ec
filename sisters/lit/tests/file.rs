//! Materials, textures and lights of glTF files.

use std::io::Cursor;

use self::parts::Parts;
use casca_lit::read_lit;
use casca_radiosity::lit::{LitScene, Material};
use casca_scenes::random::generator;
use casca_scenes::world::Sides;
use glam::{DVec2, Vec2, Vec3};
use rand::RngExt;

#[path = "../../../crates/scenes/src/import/tests/parts.rs"]
mod parts;

/// One node with the mesh whose positions are accessor 0.
const ONE: &str = r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;

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

/// A triangle as accessor 0.
fn triangle() -> Parts {
    let mut parts = Parts::default();
    parts.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    parts
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
        let _ = read_lit("flipped", &broken, None);
    }
}

#[test]
fn lights_are_moved_with_a_scene_far_away() {
    let lit = LIT
        .replace(r#"{"mesh":0}"#, r#"{"mesh":0,"translation":[500000,0,0]}"#)
        .replace(r#""translation":[0,2,0]"#, r#""translation":[500000,2,0]"#);
    let near = read_lit("near", &triangle().glb(LIT), None).unwrap();
    let far = read_lit("far", &triangle().glb(&lit), None).unwrap();
    let corner = |scene: &LitScene| scene.triangles()[0].corners[0];
    let below = |scene: &LitScene| scene.lights[0].incident(corner(scene)).unwrap().irradiance;
    assert!(corner(&far).length() < 8.0 && below(&near).abs_diff_eq(below(&far), 1e-6));
}

#[test]
fn materials_and_lights_are_read() {
    let file = triangle().glb(LIT);
    let scene = read_lit("lit", &file, None).unwrap();
    let triangles = scene.triangles();
    assert_eq!(triangles.iter().map(|t| t.material).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(scene.materials[0], Material { sides: Sides::Front, ..Material::matt(Vec3::ONE) });
    let red = scene.materials[1];
    assert_eq!((red.emission, red.gloss), (Vec3::new(3.0, 3.0, 0.0), 0.75));
    assert!((red.specular - Vec3::new(0.52, 0.02, 0.02)).length() < 1e-6, "{red:?}");
    assert!((red.albedo - Vec3::new(0.48, 0.0, 0.0)).length() < 1e-6, "{red:?}");
    let below = scene.lights[0].incident(Vec3::ZERO).unwrap();
    assert!((below.irradiance - Vec3::new(1.0, 0.5, 0.0)).length() < 1e-6, "{below:?}");
    assert_eq!(scene.lights[0].incident(Vec3::new(3.0, 0.0, 0.0)), None);
    assert_eq!(scene.sky, Vec3::ZERO);
    flip(&file, 5_000);
    // Without lights there is a sun of irradiance 3; a sky beside other suns is as bright as they are.
    let plain = read_lit("plain", &triangle().glb(ONE), None).unwrap();
    assert!(plain.lights.len() == 1 && plain.sky != Vec3::ZERO && plain.triangles().len() == 1);
    let sunny =
        read_lit("sunny", &triangle().glb(&LIT.replace("\"spot\",", "\"directional\",")), None).unwrap();
    assert!((sunny.sky - plain.sky * 4.0 / 3.0).length() < 1e-6 && sunny.lights.len() == 1, "{}", sunny.sky);
}

#[test]
fn the_sides_from_which_materials_stop_light_are_read() {
    let sides = |material: &str| {
        let rest = ONE.replace(r#""POSITION":0}"#, r#""POSITION":0},"material":0"#);
        let file = triangle().glb(&format!(r#"{rest},"materials":[{material}]"#));
        let scene = read_lit("lit", &file, None).unwrap();
        (scene.materials[1].sides, scene.triangles().len())
    };
    assert_eq!(sides("{}"), (Sides::Front, 1));
    assert_eq!(sides(r#"{"doubleSided":true}"#), (Sides::Both, 1));
    // Without a texture a mask is all there or not.
    let masked = |alpha: f32, mode: &str| {
        sides(&format!(
            r#"{{"alphaMode":"{mode}","pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,{alpha}]}}}}"#
        ))
    };
    assert_eq!(masked(0.4, "MASK"), (Sides::Neither, 0));
    assert_eq!((masked(0.6, "MASK"), masked(0.4, "OPAQUE")), ((Sides::Front, 1), (Sides::Front, 1)));
    assert_eq!((masked(0.4, "BLEND").1, masked(0.6, "BLEND").1), (0, 1));
    let transmission = |name: &str, factor: &str| {
        sides(&format!(r#"{{"extensions":{{"KHR_materials_{name}":{{"{factor}":0.1}}}}}}"#)).0
    };
    assert_eq!(transmission("transmission", "transmissionFactor"), Sides::Neither);
    assert_eq!(transmission("diffuse_transmission", "diffuseTransmissionFactor"), Sides::Neither);
    assert_eq!(transmission("sheen", "sheenRoughnessFactor"), Sides::Front);
}

/// A PNG of 2 x 2 texels.
fn png(texels: [[u8; 4]; 4]) -> Vec<u8> {
    let image = image::RgbaImage::from_raw(2, 2, texels.concat()).unwrap();
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A sheet of two triangles with a texture, which a sampler and a material use.
fn painted(texels: [[u8; 4]; 4], sampler: &str, material: &str) -> Vec<u8> {
    let mut parts = Parts::default();
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0_f32]];
    parts.floats("VEC3", &corners.map(|[x, y]| [x, y, 0.0]).concat());
    let view = parts.view(&parts::bytes_of(&corners.concat()));
    parts.accessor(parts::F32, "VEC2", 6, &format!(r#""bufferView":{view}"#));
    let image = parts.view(&png(texels));
    parts.glb(&format!(
        r#""extensionsUsed":["KHR_texture_transform"],"images":[{{"bufferView":{image},"mimeType":"image/png"}}],
        "samplers":[{{{sampler}}}],"textures":[{{"source":0,"sampler":0}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],
        "materials":[{{{material}}}]"#
    ))
}

/// White, black; a grey of half of the light, and red that is hardly there.
const TEXELS: [[u8; 4]; 4] = [[255; 4], [0, 0, 0, 255], [188, 188, 188, 128], [255, 0, 0, 100]];

#[test]
fn base_colours_have_their_textures_and_masks_their_holes() {
    let file = painted(
        TEXELS,
        r#""wrapS":33648,"wrapT":10497"#,
        r#""alphaMode":"MASK","doubleSided":true,"pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":
        {"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.5,0],"scale":[2,1]}}}}"#,
    );
    let scene = read_lit("painted", &file, None).unwrap();
    let material = scene.materials[1];
    assert_eq!((material.texture, material.sides, scene.textures.len()), (Some(0), Sides::Both, 1));
    // Mirrored along u: there are two of it.
    let texture = &scene.textures[0];
    assert_eq!(texture.size(), (4, 2));
    let at = |u: f64, v: f64| texture.at(DVec2::new(u / 4.0, v / 2.0));
    assert_eq!((at(0.5, 0.5), at(1.5, 0.5), at(2.5, 0.5), at(3.5, 0.5)), {
        let (white, black) = (Some(Vec3::ONE), Some(Vec3::ZERO));
        (white, black, black, white)
    });
    assert!((at(0.5, 1.5).unwrap() - 0.5).abs().max_element() < 0.01, "{:?}", at(0.5, 1.5));
    assert_eq!((at(1.5, 1.5), texture.has_holes()), (None, true));
    let uv = |u: f32, v: f32| Vec2::new((2.0 * u + 0.5) / 2.0, v);
    assert_eq!(scene.triangles()[1].uv, [uv(0.0, 0.0), uv(1.0, 1.0), uv(0.0, 1.0)]);
    // Metals mirror the mean of it.
    let mean = (1.0 + 0.5 + 1.0) / 4.0;
    let metal = r#""pbrMetallicRoughness":{"roughnessFactor":0.5,"baseColorTexture":{"index":0}}"#;
    let scene = read_lit("metal", &painted(TEXELS, "", metal), None).unwrap();
    assert!((scene.materials[1].specular.x - mean).abs() < 0.01, "{:?}", scene.materials[1]);
    // All of it is there where it is opaque, and at the edge goes on as it ends.
    assert!(!scene.textures[0].has_holes());
    let clamped = painted(TEXELS, r#""wrapS":33071"#, metal);
    assert_eq!(read_lit("clamped", &clamped, None).unwrap().triangles()[0].uv[1], Vec2::new(0.75, 0.0));
    flip(&file, 2_000);
}

#[test]
fn light_is_the_mean_of_its_texture_over_each_triangle() {
    let glow = r#""emissiveFactor":[3,1,0],"emissiveTexture":{"index":0}"#;
    let texels = [[255; 4], [0, 0, 0, 255], [255; 4], [0, 0, 0, 255]];
    let scene = read_lit("glow", &painted(texels, "", glow), None).unwrap();
    let light = |i: usize| scene.materials[scene.triangles()[i].material as usize].emission;
    // Of the triangle below the diagonal a quarter is in the white half.
    for (i, share) in [(0, 0.25), (1, 0.75)] {
        let wanted = Vec3::new(3.0, 1.0, 0.0) * share;
        assert!((light(i) - wanted).abs().max_element() < 0.1, "{i}: {} for {wanted}", light(i));
    }
    let dark = read_lit("dark", &painted([[0, 0, 0, 255]; 4], "", glow), None).unwrap();
    assert!(dark.triangles().iter().all(|t| dark.materials[t.material as usize].emission == Vec3::ZERO));
    assert_eq!(dark.lights.len(), 1, "a sun shines where nothing glows");
}

#[test]
fn images_that_cannot_be_read_are_refused_by_number() {
    let mut file = painted(TEXELS, "", r#""emissiveFactor":[1,1,1],"emissiveTexture":{"index":0}"#);
    let at = file.windows(4).position(|w| w == b"IDAT").unwrap();
    file[at + 6] ^= 255;
    assert!(read_lit("broken", &file, None).unwrap_err().to_string().starts_with("image 0 "));
}
