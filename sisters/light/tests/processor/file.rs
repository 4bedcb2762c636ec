//! Materials and lights of glTF files.

use self::parts::Parts;
use casca_radiosity::lit::{LitScene, Material, read_lit};
use casca_scenes::random::generator;
use casca_scenes::world::Sides;
use glam::Vec3;
use rand::RngExt;

#[path = "../../../../crates/scenes/src/import/tests/parts.rs"]
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
    assert_eq!(sides(r#"{"alphaMode":"MASK"}"#), (Sides::Neither, 0));
    let transmission = |name: &str, factor: &str| {
        sides(&format!(r#"{{"extensions":{{"KHR_materials_{name}":{{"{factor}":0.1}}}}}}"#)).0
    };
    assert_eq!(transmission("transmission", "transmissionFactor"), Sides::Neither);
    assert_eq!(transmission("diffuse_transmission", "diffuseTransmissionFactor"), Sides::Neither);
    assert_eq!(transmission("sheen", "sheenRoughnessFactor"), Sides::Front);
}
