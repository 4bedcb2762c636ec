//! Several cameras on one scene: two players on both sides of a wall, and a runner behind it.
//!
//! Each camera has a query of its own. `end_frame` takes the results of all of them, because an
//! object is hidden only if no camera sees it. With the feature `rayon`, `Query::run_all` runs the
//! queries in parallel.
//!
//! `cargo run --release --example several_cameras`

use std::error::Error;

use casca::glam::Vec3;
use casca::{Aabb, ObjectDesc, Query, Scene, Sphere, View};

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new(1.0)?;
    // From side to side, so that nobody looks around it.
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 30.0), Vec3::new(64.0, 16.0, 34.0));
    scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
    let runner = |seconds: f32| Sphere::new(Vec3::new(20.0 + 5.0 * seconds, 1.0, 14.0), 0.4);
    let id = scene.insert(ObjectDesc::dynamic(runner(0.0)).max_speed(5.1))?;

    let eyes = [Vec3::new(32.0, 2.0, 56.0), Vec3::new(32.0, 2.0, 8.0)];
    let views = [View::omnidirectional(eyes[0])?, View::omnidirectional(eyes[1])?];
    let mut queries = [Query::new(), Query::new()];
    let mut waited = 0;
    // The second player leaves half way.
    for frame in 0..60u8 {
        let seconds = f32::from(frame) / 30.0;
        let players = if frame < 30 { 2 } else { 1 };
        scene.begin_frame(f64::from(seconds))?;
        scene.update(id, runner(seconds), None)?;
        for (query, view) in queries.iter_mut().zip(&views).take(players) {
            query.run(&scene, view);
        }
        let seen: Vec<bool> = queries[..players].iter().map(|query| query.pvs().contains(id)).collect();
        if frame % 15 == 0 {
            println!("frame {frame:2}: the players see the runner: {seen:?}");
        }
        assert!(!seen[0], "the wall is between them");
        assert!(seen.get(1).is_none_or(|sees| *sees), "nothing is between them");
        scene.end_frame(queries[..players].iter().map(Query::pvs))?;
        // A runner whom nobody sees waits in a temporal bounding volume, at no cost to any query,
        // as long as he does not leave it too soon.
        assert!(scene.tbv(id)?.is_none() || players == 1, "somebody sees him");
        waited += u32::from(scene.tbv(id)?.is_some());
    }
    println!(
        "after the second player left, the runner was in a temporal bounding volume for {waited} frames"
    );
    assert!(waited > 0);
    Ok(())
}
