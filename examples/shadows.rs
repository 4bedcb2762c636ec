//! Shadow casters: the objects that may cast a shadow of the sun onto anything visible.
//!
//! A tower stands behind the camera, and its shadow falls before it. A ball stands in the shadow of a hill, and
//! another one lies so that its shadow falls out of sight: neither needs to be drawn into the shadow map.
//!
//! `cargo run --release --example shadows`

use std::error::Error;

use casca::{Aabb, GridSpec, Light, ObjectDesc, Query, Scene, Sphere, View};
use glam::Vec3;
use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};

fn main() -> Result<(), Box<dyn Error>> {
    let level = Aabb::new(Vec3::ZERO, Vec3::new(128.0, 48.0, 128.0));
    let mut scene = Scene::new(&GridSpec::covering(level, 1.0)?)?;
    let mut solid = |min: [f32; 3], max: [f32; 3]| {
        let shape = Aabb::new(Vec3::from(min), Vec3::from(max));
        scene.insert(ObjectDesc::fixed(shape).occluder(shape))
    };
    let ground = solid([0.0, 0.0, 0.0], [128.0, 1.0, 128.0])?;
    let tower = solid([60.0, 1.0, 100.0], [66.0, 40.0, 106.0])?;
    let hill = solid([20.0, 1.0, 40.0], [40.0, 30.0, 60.0])?;
    let mut ball = |x: f32, z: f32| {
        let shape = Sphere::new(Vec3::new(x, 3.0, z), 1.0);
        scene.insert(ObjectDesc::fixed(shape).occluder(shape))
    };
    let in_shadow = ball(30.0, 36.0)?;
    let far_behind = ball(20.0, 124.0)?;

    // The eye looks along -z, and the sun shines the same way, downwards.
    let eye = Vec3::new(64.0, 5.0, 90.0);
    let matrix = perspective(1.0, 16.0 / 9.0, 0.1, 500.0) * look_at_mat4(eye, eye - Vec3::Z, Vec3::Y);
    let (mut camera, mut sun) = (Query::new(), Query::new());
    camera.run(&scene, &View::perspective(eye, matrix)?);
    let pvs = camera.pvs();
    let mut casters = Vec::new();
    let sunlight = Light::Directional(Vec3::new(0.0, -1.0, -1.0));
    sun.shadow_casters(&scene, &camera, &sunlight, &mut casters)?;

    let objects = [
        ("ground", ground),
        ("tower", tower),
        ("hill", hill),
        ("ball in shadow", in_shadow),
        ("ball far behind", far_behind),
    ];
    for (name, id) in objects {
        println!("{name:<16} visible: {:<6} casts a shadow: {}", pvs.contains(id), casters.contains(&id));
    }
    assert!(
        !pvs.contains(tower) && casters.contains(&tower),
        "its shadow comes into sight from behind the eye"
    );
    assert!(casters.contains(&hill) && !casters.contains(&in_shadow), "the hill's shadow covers the ball");
    assert!(!casters.contains(&far_behind), "its shadow stays behind the eye");
    Ok(())
}
