//! Temporal bounding volumes over time: how many hidden objects are drawn into cells in a frame,
//! and how their validity adapts.

use casca_plane::maps::MapKind;
use casca_plane::{Disc, Method, ObjectDesc, ObjectId, Query, View};
use glam::Vec2;
use rand::RngExt;

use crate::setup::{Failure, Level, SIDE};

const FRAMES: u32 = 1200;
const OBJECTS: u32 = 2000;
/// World units per second.
const SPEED: f32 = 2.0;

/// A moving object and where it goes.
struct Walker {
    id: ObjectId,
    place: Vec2,
    direction: Vec2,
}

/// The table, for objects that report each move or only those that are due.
pub fn print() -> Result<(), Failure> {
    println!(
        "Volumes: rooms, {SIDE}x{SIDE} cells, {OBJECTS} objects at {SPEED} cells a second, {FRAMES} frames at 60 Hz, a walking viewer."
    );
    println!("Means of 120 frames each.\n");
    println!(
        "| reports | frames | hidden objects | volumes drawn | volumes seen | reports due | calls of update | validity, s |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for silent in [false, true] {
        run(silent)?;
    }
    println!();
    Ok(())
}

fn run(silent: bool) -> Result<(), Failure> {
    let mut level = Level::new(MapKind::Rooms, 0)?;
    let mut walkers = Vec::new();
    for _ in 0..OBJECTS {
        let place = level.place();
        let desc = ObjectDesc::dynamic(Disc::new(place, 0.3)).max_speed(SPEED * 1.001);
        let id = level.scene.insert(if silent { desc.reported_on_expiry() } else { desc })?;
        walkers.push(Walker { id, place, direction: Vec2::from_angle(level.random.random_range(0.0..6.2)) });
    }
    let mut eye = Walker { id: walkers[0].id, place: level.place(), direction: Vec2::X };
    let mut query = Query::with_method(Method::Cell)?;
    let mut sums = [0.0; 6];
    for frame in 1..=FRAMES {
        let due = level.scene.begin_frame(f64::from(frame) / 60.0)?;
        let mut is_due = vec![false; OBJECTS as usize + level.scene.len()];
        due.iter().for_each(|id| is_due[id.index()] = true);
        step(&mut level, &mut eye);
        let mut calls = 0;
        for walker in &mut walkers {
            step(&mut level, walker);
            if !silent || is_due[walker.id.index()] || query.pvs().contains(walker.id) {
                level.scene.update(walker.id, Disc::new(walker.place, 0.3), None)?;
                calls += 1;
            }
        }
        query.run(&level.scene, &View::all_round(eye.place)?);
        let report = level.scene.end_frame([query.pvs()])?;
        let hidden = walkers.iter().filter(|walker| !query.pvs().contains(walker.id)).count();
        let validity = walkers.iter().filter_map(|walker| level.scene.validity(walker.id).ok()?).sum::<f64>();
        let numbers =
            [hidden as f64, report.drawn as f64, report.revealed as f64, due.len() as f64, calls as f64];
        sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
        sums[5] += validity / f64::from(OBJECTS);
        if frame % 120 == 0 {
            let [hidden, drawn, seen, due, calls, validity] = sums.map(|sum| sum / 120.0);
            let name = if silent { "on expiry" } else { "when moved" };
            let frames = format!("{} to {frame}", frame - 119);
            println!(
                "| {name} | {frames} | {hidden:.0} | {drawn:.1} | {seen:.1} | {due:.1} | {calls:.0} | {validity:.2} |"
            );
            sums = [0.0; 6];
        }
    }
    Ok(())
}

/// Walks straight on, and turns before walls.
fn step(level: &mut Level, walker: &mut Walker) {
    for _ in 0..8 {
        let next = walker.place + walker.direction * SPEED / 60.0;
        let front = next + walker.direction * 0.32;
        if !level.map.get(front.x.max(0.0) as u32, front.y.max(0.0) as u32) {
            walker.place = next;
            return;
        }
        walker.direction = Vec2::from_angle(level.random.random_range(0.0..6.2));
    }
}
