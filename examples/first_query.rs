//! A first query: a wall, a ball before it and a ball behind it.
//!
//! `cargo run --release --example first_query`

use std::error::Error;

use casca::glam::{Mat4, Vec3, Vec4};
use casca::{Aabb, ObjectDesc, Query, Scene, Sphere, View};

fn main() -> Result<(), Box<dyn Error>> {
    // A grid with cells of one metre.
    let mut scene = Scene::new(1.0)?;

    // The wall is tested, and it hides other objects. The balls are only tested.
    let wall = Aabb::new(Vec3::new(8.0, 0.0, 30.0), Vec3::new(56.0, 16.0, 33.0));
    let wall = scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
    let ball = |z: f32| ObjectDesc::fixed(Sphere::new(Vec3::new(32.0, 2.0, z), 0.5));
    let before = scene.insert(ball(40.0))?;
    let behind = scene.insert(ball(20.0))?;

    // The matrix of your renderer; the eye is given beside it. This camera looks along -z: 60
    // degrees high, 16:9, with reversed depth from 0.1 m on.
    let eye = Vec3::new(32.0, 2.0, 60.0);
    let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
    let camera = projection * Mat4::from_translation(-eye);
    let mut query = Query::new();
    let pvs = query.run(&scene, &View::perspective(eye, camera)?);

    for (name, id) in [("the wall", wall), ("the ball before it", before), ("the ball behind it", behind)] {
        println!("{name} is {}", if pvs.contains(id) { "visible" } else { "hidden" });
    }
    assert!(pvs.contains(wall) && pvs.contains(before), "nothing visible is ever left out");
    assert!(!pvs.contains(behind), "the wall hides it");
    Ok(())
}
