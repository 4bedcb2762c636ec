//! Many frames from one result: a camera walks down a street, and another thread finds the next
//! result in time.
//!
//! `cargo run --release --example kept_results`

use std::error::Error;
use std::f32::consts::PI;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use casca::glam::{Mat4, Quat, Vec3, Vec4};
use casca::{Aabb, KeptJob, KeptOptions, KeptQuery, ObjectDesc, Scene, View};

const FRAMES: usize = 120;

/// Jobs start when the last result has served this many frames.
const EARLY: usize = 4;

/// Rows of houses on both sides of the street, with something small behind each.
fn town() -> Result<Scene, casca::Error> {
    let mut scene = Scene::new(1.0)?;
    for row in 0..16 {
        for x in [10.0, 24.0, 46.0, 60.0] {
            let corner = Vec3::new(x, 0.0, row as f32 * 10.0);
            let house = Aabb::new(corner, corner + Vec3::new(10.0, 9.0, 9.0));
            scene.insert(ObjectDesc::fixed(house).occluder(house))?;
            let bin = Aabb::new(corner + Vec3::new(10.5, 0.0, 4.0), corner + Vec3::new(11.0, 1.0, 4.5));
            scene.insert(ObjectDesc::fixed(bin))?;
        }
    }
    Ok(scene)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = town()?;
    let cart = |z: f32| Aabb::from_center(Vec3::new(40.0, 1.0, z), Vec3::new(1.0, 1.0, 1.5));
    let cart_id = scene.insert(ObjectDesc::dynamic(cart(30.0)).occluder(cart(30.0)).max_speed(5.0))?;

    let (jobs, to_do) = mpsc::channel::<KeptJob>();
    let (done, results) = mpsc::channel();
    let worker =
        thread::spawn(move || to_do.into_iter().map(KeptJob::run).all(|result| done.send(result).is_ok()));

    let mut query = KeptQuery::with_options(KeptOptions::new().reach(0.15).turn(0.1))?;
    // 60 degrees high, 16:9, with reversed depth from 0.1 m on.
    let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
    let (mut waits, mut served, mut seen) = (false, 0, 0);
    for frame in 0..FRAMES {
        let time = frame as f64 / 60.0;
        scene.begin_frame(time)?;
        let at = cart(30.0 + 3.0 * time as f32);
        scene.update(cart_id, at, Some(at.into()))?;

        // Results of jobs come when they come. Whether one holds, the query knows.
        for result in results.try_iter() {
            query.install(result, &scene);
            (waits, served) = (false, 0);
        }
        let eye = Vec3::new(38.0, 1.7, 4.0 + 1.5 * time as f32);
        // It looks along z, and turns by half a radian to both sides.
        let turn = Quat::from_rotation_y(PI + 0.5 * (time as f32).sin());
        let camera = Mat4::from_rotation_translation(turn, eye);
        let view = View::perspective(eye, projection * camera.inverse())?;
        seen += query.run(&scene, &view).len();
        served += 1;
        if !waits && served >= EARLY {
            waits = true;
            jobs.send(query.prepare(&scene, &view))?;
        }
        scene.end_frame([query.pvs()])?;
        // The rest of the frame: the other thread has time for its job.
        thread::sleep(Duration::from_millis(8));
    }
    drop(jobs);
    let ended = worker.join();
    assert!(ended.is_ok(), "jobs end");
    let objects = scene.len();
    println!(
        "{FRAMES} frames, {} of which waited for a new result; {} of {objects} objects in sight",
        query.refreshes(),
        seen / FRAMES
    );
    Ok(())
}
