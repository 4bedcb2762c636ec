//! Materials and lights.

use super::*;

#[test]
fn materials_and_lights_are_read() {
    let file = triangle().glb(LIT);
    let scene = read_lit("lit", &file, None).unwrap();
    let triangles = scene.triangles();
    assert_eq!(triangles.iter().map(|t| t.material).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(scene.materials[0], Material::matt(Vec3::ONE));
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
