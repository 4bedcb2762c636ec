//! The main job: an observer walks through a dynamic scene, and the library finds the visible
//! objects of each frame, which are checked against exact visibility.

mod options;
mod session;
mod summary;

use casca_scenes::generated::SceneOptions;
use casca_scenes::world::World;
use casca_tools::command_line::{Outcome, try_writing_into};
use glam::DVec3;
use indicatif::ProgressBar;

use crate::arguments::{Failure, bar};
use crate::pictures::chart;
pub use options::{MethodName, Options};
use session::{Frame, Session};
use summary::Summary;

/// Losses that are printed one by one.
const LOSSES_SHOWN: usize = 10;

/// Walks, prints the results, and writes the pictures.
pub fn run(options: &Options) -> Result<Outcome, Failure> {
    // A walk takes minutes: what cannot be written is said before it.
    try_writing_into(&options.out, &["walk.svg", "frame.png"])?;
    let mut session = Session::new(options, open(options)?)?;
    let frames = walk(options, &mut session)?;

    let counts: Vec<_> = frames.iter().map(|frame| frame.counts).collect();
    let title = format!("{}: what the observer can see", session.world.name);
    chart(&options.out.join("walk.svg"), &title, &counts)?;
    let summary = Summary { options, session: &session, frames: &frames };
    summary.print();
    Ok(summary.outcome())
}

fn open(options: &Options) -> Result<World, Failure> {
    let frames = options.frames.map(|n| n as usize);
    let mut scene_options = SceneOptions { seed: options.common.seed, ..SceneOptions::default() };
    scene_options.frames = frames.unwrap_or(scene_options.frames);
    let mut world = options.scene.open(&scene_options)?;
    world.source.tell();
    world.frames = world.frames.min(frames.unwrap_or(usize::MAX));
    Ok(world)
}

fn walk(options: &Options, session: &mut Session<'_>) -> Result<Vec<Frame>, Failure> {
    let count = session.world.frames;
    let bar = bar(options.common.quiet, count, &session.world.name, "frame");
    let mut frames: Vec<Frame> = Vec::with_capacity(count);
    let mut shown = 0;
    for number in 0..count {
        let frame = session.frame(number)?;
        show_losses(&bar, &session.world, number, &frame, &mut shown);
        frames.push(frame);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(frames)
}

/// Prints the first losses of a walk; `shown` counts them.
fn show_losses(bar: &ProgressBar, world: &World, number: usize, frame: &Frame, shown: &mut usize) {
    for lost in frame.verdict.false_negatives.iter().take(LOSSES_SHOWN - *shown) {
        bar.suspend(|| {
            if *shown == 0 {
                eprintln!("visible objects are missing from the PVS; the first ones:");
            }
            let name = &world.objects[lost.object].name;
            let in_file = |place: DVec3| place + world.source.origin;
            eprintln!(
                "  frame {number}: object {} {name:?} is seen ({:?}) along the ray from {} to {}",
                lost.object,
                lost.found_by,
                in_file(lost.origin),
                in_file(lost.target)
            );
        });
        *shown += 1;
    }
}
