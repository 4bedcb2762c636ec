//! Materials and lights.

use super::*;

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
    // Without lights there is a sun.
    let plain = read_lit("plain", &triangle().glb(ONE), None).unwrap();
    assert!(plain.lights.len() == 1 && plain.sky != Vec3::ZERO && plain.triangles().len() == 1);
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
