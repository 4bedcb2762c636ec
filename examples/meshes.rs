//! Meshes need no hand-made occluders: a wall with a doorway, and a door that opens.
//!
//! `TriMesh` prepares any triangles. An `Instance` is a mesh under a transform, for objects that
//! move.
//!
//! `cargo run --release --example meshes`

use std::error::Error;
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

use casca::glam::{Affine3A, Vec3};
use casca::{Instance, ObjectDesc, Query, Scene, Sphere, TriMesh, View};

/// A rectangle from `min` to `max` in the plane z = 0.
fn rectangle(min: (f32, f32), max: (f32, f32)) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corners = [(min.0, min.1), (max.0, min.1), (max.0, max.1), (min.0, max.1)];
    (corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new(0.5)?;

    // Three rectangles around a doorway, 1 m wide and 2 m high. The same mesh is tested and hides.
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    for (min, max) in [((0.0, 0.0), (9.5, 5.0)), ((10.5, 0.0), (20.0, 5.0)), ((9.5, 2.0), (10.5, 5.0))] {
        let (more_corners, more_triangles) = rectangle(min, max);
        let first = corners.len() as u32;
        corners.extend(more_corners.into_iter().map(|corner| corner + Vec3::Z * 10.0));
        triangles.extend(more_triangles.into_iter().map(|triangle| triangle.map(|corner| corner + first)));
    }
    let wall = Arc::new(TriMesh::new(corners, triangles)?);
    scene.insert(ObjectDesc::fixed(wall.clone()).occluder(wall))?;

    // The door is a little larger than the doorway. It turns around its left edge.
    let (corners, triangles) = rectangle((0.0, 0.0), (1.1, 2.05));
    let leaf = Arc::new(TriMesh::new(corners, triangles)?);
    let hinge = Affine3A::from_translation(Vec3::new(9.45, 0.0, 10.02));
    let door = |angle: f32| Instance::new(leaf.clone(), hinge * Affine3A::from_rotation_y(-angle));
    let shut = door(0.0)?;
    let id = scene.insert(ObjectDesc::dynamic(shut.clone()).occluder(shut))?;
    let lamp = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(10.0, 1.5, 5.0), 0.1)))?;

    let view = View::omnidirectional(Vec3::new(10.0, 1.6, 15.0))?;
    let mut query = Query::new();
    let mut seen = Vec::new();
    for frame in 0..3u8 {
        scene.begin_frame(f64::from(frame))?;
        let angle = f32::from(frame) * 0.5 * FRAC_PI_2;
        scene.update(id, door(angle)?, Some(door(angle)?.into()))?;
        let sees = query.run(&scene, &view).contains(lamp);
        println!("door at {:2.0} degrees: the lamp is visible: {sees}", angle.to_degrees());
        seen.push(sees);
        scene.end_frame([query.pvs()])?;
    }
    assert_eq!((seen[0], seen[2]), (false, true), "the open door shows the lamp");
    Ok(())
}
