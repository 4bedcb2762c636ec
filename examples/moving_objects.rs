//! Moving objects in a frame loop. Birds fly behind a wall, and one of them comes out at its end.
//!
//! A temporal bounding volume stands in for a hidden bird, for as long as the bird cannot have left
//! it at its greatest speed. Until then the bird needs no update: `begin_frame` lists those that
//! do.
//!
//! `cargo run --release --example moving_objects`

use std::error::Error;

use casca::glam::Vec3;
use casca::{Aabb, ObjectDesc, Query, Scene, Sphere, View};

const BIRDS: usize = 100;
const FRAMES: usize = 180;

/// Birds circle at up to 2.4 m/s; bird 0 flies out to the right at 6 m/s.
fn bird(number: usize, seconds: f32) -> Sphere {
    let home = Vec3::new(12.0 + 0.3 * number as f32, 6.0, 20.0);
    let angle = number as f32 + 1.2 * seconds;
    let offset = match number {
        0 => Vec3::X * (30.0 + 6.0 * seconds),
        _ => Vec3::new(angle.cos(), 0.0, angle.sin()) * 2.0,
    };
    Sphere::new(home + offset, 0.2)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new(1.0)?;
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 30.0), Vec3::new(48.0, 16.0, 33.0));
    scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
    let mut birds = Vec::new();
    for number in 0..BIRDS {
        let speed = if number == 0 { 6.1 } else { 2.5 };
        let desc = ObjectDesc::dynamic(bird(number, 0.0)).max_speed(speed);
        birds.push(scene.insert(desc.reported_on_expiry())?);
    }

    let view = View::omnidirectional(Vec3::new(32.0, 6.0, 55.0))?;
    let (mut query, mut reports) = (Query::new(), 0);
    for frame in 0..FRAMES {
        let seconds = frame as f32 / 60.0;
        let due = scene.begin_frame(f64::from(seconds))?;
        // Reports are for the birds that are due and for those that the last frame showed.
        for (number, &id) in birds.iter().enumerate() {
            if due.contains(&id) || query.pvs().contains(id) {
                scene.update(id, bird(number, seconds), None)?;
                reports += 1;
            }
        }
        query.run(&scene, &view);
        scene.end_frame([query.pvs()])?;
    }
    let seen: Vec<usize> = (0..BIRDS).filter(|&number| query.pvs().contains(birds[number])).collect();
    println!("{reports} reports instead of {} for {BIRDS} birds in {FRAMES} frames", BIRDS * FRAMES);
    println!("visible in the last frame: {seen:?}");
    assert!(reports < BIRDS * FRAMES / 10, "hidden birds need few reports");
    assert_eq!(seen, [0], "it flew out, and the wall hides the others");
    Ok(())
}
