//! Shadow casters: the objects that may cast a shadow of the sun or of a lamp onto anything
//! visible.
//!
//! A tower stands behind the camera, and its shadow falls before it. A ball stands in the shadow of
//! a hill, a second one lies so that its shadow falls out of sight, and a third one behind a wall,
//! where the camera does not see the ground: none of them needs to be drawn into the shadow map. A
//! lamp shines on the side of the third one that no camera sees.
//!
//! `cargo run --release --example shadows`

use std::error::Error;

use casca::glam::{Mat4, Vec3, Vec4};
use casca::{Aabb, Light, ObjectDesc, ObjectId, Query, Scene, Sphere, View};

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new(1.0)?;
    let mut solid = |min: [f32; 3], max: [f32; 3]| {
        let shape = Aabb::new(Vec3::from(min), Vec3::from(max));
        scene.insert(ObjectDesc::fixed(shape).occluder(shape))
    };
    let ground = solid([0.0, 0.0, 0.0], [128.0, 1.0, 128.0])?;
    let tower = solid([60.0, 1.0, 100.0], [66.0, 40.0, 106.0])?;
    let hill = solid([20.0, 1.0, 40.0], [40.0, 30.0, 60.0])?;
    let wall = solid([70.0, 1.0, 50.0], [90.0, 14.0, 52.0])?;
    let mut ball = |x: f32, z: f32| {
        let shape = Sphere::new(Vec3::new(x, 3.0, z), 1.0);
        scene.insert(ObjectDesc::fixed(shape).occluder(shape))
    };
    let in_shadow = ball(30.0, 36.0)?;
    let far_behind = ball(20.0, 124.0)?;
    let behind_wall = ball(80.0, 40.0)?;

    // The eye looks along -z, and the sun shines the same way, downwards.
    let eye = Vec3::new(64.0, 5.0, 90.0);
    // 60 degrees high, 16:9, with reversed depth from 0.1 m on.
    let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
    let matrix = projection * Mat4::from_translation(-eye);
    let (mut camera, mut light) = (Query::new(), Query::new());
    camera.run(&scene, &View::perspective(eye, matrix)?);
    let (mut sunlit, mut lamplit) = (Vec::new(), Vec::new());
    let sun = Light::directional(Vec3::new(0.0, -1.0, -1.0));
    light.shadow_casters(&scene, &camera, &sun, &mut sunlit)?;
    // Between the camera and the wall: the wall casts a shadow, but not into sight.
    let lamp = Light::point(Vec3::new(78.0, 8.0, 60.0), 30.0);
    light.shadow_casters(&scene, &camera, &lamp, &mut lamplit)?;

    let objects = [
        ("ground", ground),
        ("tower", tower),
        ("hill", hill),
        ("wall", wall),
        ("ball in shadow", in_shadow),
        ("ball far behind", far_behind),
        ("ball behind wall", behind_wall),
    ];
    let casts = |casters: &[ObjectId], id| if casters.contains(&id) { "casts a shadow" } else { "-" };
    println!("{:<16} {:<8} {:<14} lamp", "", "visible", "sun");
    for (name, id) in objects {
        let visible = if camera.pvs().contains(id) { "yes" } else { "-" };
        println!("{name:<16} {visible:<8} {:<14} {}", casts(&sunlit, id), casts(&lamplit, id));
    }
    assert!(
        !camera.pvs().contains(tower) && sunlit.contains(&tower),
        "its shadow comes into sight from behind the eye"
    );
    assert!(sunlit.contains(&hill) && !sunlit.contains(&in_shadow), "the hill's shadow covers the ball");
    assert!(!sunlit.contains(&far_behind), "its shadow stays behind the eye");
    assert!(!sunlit.contains(&behind_wall), "its shadow falls on ground behind the wall");
    assert!(lamplit.contains(&ground) && !lamplit.contains(&tower), "the lamp does not reach the tower");
    Ok(())
}
