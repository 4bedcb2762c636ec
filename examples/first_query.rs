//! A first query: a wall, a ball before it and a ball behind it.
//!
//! `cargo run --release --example first_query`

use std::error::Error;

use casca::{Aabb, GridSpec, ObjectDesc, Query, Scene, Sphere, View};
use glam::Vec3;
use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};

fn main() -> Result<(), Box<dyn Error>> {
    // A grid with cells of one metre over the level.
    let level = Aabb::new(Vec3::ZERO, Vec3::new(64.0, 16.0, 64.0));
    let mut scene = Scene::new(&GridSpec::covering(level, 1.0)?)?;

    // The wall is tested, and it hides other objects. The balls are only tested.
    let wall = Aabb::new(Vec3::new(8.0, 0.0, 30.0), Vec3::new(56.0, 16.0, 33.0));
    let wall = scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
    let ball = |z: f32| ObjectDesc::fixed(Sphere::new(Vec3::new(32.0, 2.0, z), 0.5));
    let before = scene.insert(ball(40.0))?;
    let behind = scene.insert(ball(20.0))?;

    // Any glam view-projection will do; the eye is given beside it.
    let eye = Vec3::new(32.0, 2.0, 60.0);
    let camera = perspective(1.0, 16.0 / 9.0, 0.1, 500.0) * look_at_mat4(eye, eye - Vec3::Z, Vec3::Y);
    let mut query = Query::new();
    let pvs = query.run(&scene, &View::perspective(eye, camera)?);

    for (name, id) in [("the wall", wall), ("the ball before it", before), ("the ball behind it", behind)] {
        println!("{name} is {}", if pvs.contains(id) { "visible" } else { "hidden" });
    }
    assert!(pvs.contains(wall) && pvs.contains(before), "nothing visible is ever left out");
    assert!(!pvs.contains(behind), "the wall hides it");
    Ok(())
}
