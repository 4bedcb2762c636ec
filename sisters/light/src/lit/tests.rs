use glam::{Affine3A, Vec3};

use super::*;

#[test]
fn generated_scenes_are_whole_and_found_by_name() {
    for kind in Kind::ALL {
        let scene = kind.build();
        assert_eq!((kind.name().parse(), scene.name.as_str()), (Ok(kind), kind.name()));
        let count: usize = scene.objects.iter().map(|o| o.mesh.triangles.len()).sum();
        assert_eq!(scene.triangles().len(), count, "{}", kind.name());
        for m in &scene.materials {
            assert!((m.albedo + m.specular).max_element() <= 1.0 && m.albedo.min_element() >= 0.0);
        }
        // The camera looks at something.
        let (min, max) = scene.bounds();
        let lit = scene.lights.iter().any(|l| l.incident((min + max) / 2.0).is_some());
        assert!(lit || scene.materials.iter().any(Material::emits));
        let middle = scene.camera.view_projection().project_point3((min + max) / 2.0);
        assert!(middle.x.abs() < 1.0 && middle.y.abs() < 1.0, "{}: {middle}", kind.name());
    }
    assert_eq!(Kind::Cornell.build().triangles().len(), 36);
    assert!("house".parse::<Kind>().unwrap_err().contains("cornell-point"));
}

#[test]
fn broken_triangles_are_left_out() {
    let mut scene = Kind::CornellPoint.build();
    let whole = scene.triangles().len();
    let broken = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::NAN],
        triangles: vec![[0, 1, 2], [0, 1, 9]],
        ..Mesh::default()
    };
    let mut object = scene.objects[0].clone();
    (object.mesh, object.materials) = (Arc::new(broken), vec![0, 0].into());
    scene.objects.push(object.clone());
    object.mesh = scene.objects[0].mesh.clone();
    object.materials = vec![77; 2].into();
    scene.objects.push(object);
    assert_eq!(scene.triangles().len(), whole);
    let known = scene.bounds();
    for far in [1e5, 1e30, -3e38] {
        let mut stray = scene.objects[0].clone();
        stray.transform = Affine3A::from_translation(Vec3::splat(far));
        let mut with_it = scene.clone();
        with_it.objects.push(stray);
        assert_eq!(with_it.bounds(), known, "{far}");
    }
}

#[test]
fn spots_end_at_their_edges() {
    let spot = |degrees: f32| {
        let (position, direction, intensity) = (Vec3::ZERO, Vec3::NEG_Y * 3.0, Vec3::ONE);
        let light = Light::Spot { position, direction, intensity, inner: 0.3, outer: 0.6, radius: 0.5 };
        let to = Vec3::new(degrees.to_radians().sin(), -degrees.to_radians().cos(), 0.0);
        light.incident(to).map(|light| light.irradiance.x)
    };
    assert_eq!((spot(0.0), spot(40.0)), (Some(1.0), None));
    assert!(spot(25.0).unwrap() < 1.0);
}

#[test]
fn lights_that_are_none_light_nothing() {
    let sun = |direction, irradiance| Light::Sun { direction, irradiance, half_angle: 0.0 };
    for bad in [Vec3::ZERO, Vec3::NAN, -Vec3::INFINITY] {
        let point = Light::Point { position: Vec3::X, intensity: bad, radius: 0.1 };
        for light in [point, sun(bad, Vec3::ONE), sun(Vec3::NEG_Y, bad)] {
            assert_eq!(light.incident(Vec3::ZERO), None, "{light:?}");
        }
    }
}
