//! The grazing form of the attack: tiny objects closely past the outlines of occluders, as seen
//! from the outermost places and turns that a view stands for.
//!
//! Objects of the size of a point are put 1e-11 to 1e-2 past a silhouette edge, just behind the
//! occluder or far behind it. The eye is at the place of the view, on the ball of its reach, turned
//! as far as the view may turn, at a corner of the view cell; or rays are parallel. A point is seen
//! if its segment misses all occluders by more than the rounding of double precision. Each set must
//! then hold its object. Segments that come closer than that to an occluder are not judged.
//!
//! One scene has hundreds of such objects, and each query decides all of them. [`long_run`] plays
//! many of them on all cores; results do not depend on the number of threads.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc;

mod casters;
mod rims;
mod stage;
mod stream;
mod tally;
mod views;
mod walls;

#[cfg(test)]
pub(super) use rims::Start;
use stage::Stage;
pub use tally::{Lost, Tally};
use walls::Meshes;
pub use walls::SHAPES;

/// Scenes that are counted at once, so that a run does not depend on the number of threads.
const BATCH: u64 = 16;

/// How long a run is.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    /// The seed of the first scene; the next have the next seeds.
    pub seed: u64,
    /// Points that are asked for, at least.
    pub points: u64,
    /// Threads; 0 for one on each core.
    pub threads: usize,
    /// Ends after this many losses.
    pub failures: usize,
}

/// Plays the scene of a seed.
fn play(seed: u64, meshes: &Meshes) -> (Tally, Vec<Lost>) {
    let stage = |layered, moving| Stage::new(seed, meshes, layered, moving);
    let layered = seed / 16 % 4 == 3;
    let mut stage = match seed % 16 {
        0..=5 => views::play(stage(layered, false), seed.is_multiple_of(2)),
        6..=10 => stream::play(stage(layered, seed.is_multiple_of(2)), seed.is_multiple_of(3)),
        11 | 12 => views::play_parallel(stage(layered, false)),
        13 => views::play_cells(stage(layered, false)),
        _ => casters::play(stage(layered, false)),
    };
    (std::mem::take(&mut stage.tally), std::mem::take(&mut stage.lost))
}

/// Plays scene after scene on several threads, and passes the counts of all trials and losses so far
/// to `progress`.
///
/// # Panics
/// If the few meshes that all scenes use are refused.
pub fn long_run(run: Run, mut progress: impl FnMut(&Tally, &[Lost])) -> (Tally, Vec<Lost>) {
    let cores = || std::thread::available_parallelism().map_or(1, |n| n.get());
    let threads = if run.threads == 0 { cores() } else { run.threads };
    let (next, over) = (AtomicU64::new(0), AtomicBool::new(false));
    let (send, receive) = mpsc::channel();
    let (mut tally, mut lost) = (Tally::default(), Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let (send, next, over) = (send.clone(), &next, &over);
            scope.spawn(move || {
                #[expect(clippy::expect_used, reason = "these meshes are in order")]
                let meshes = Meshes::new().expect("meshes");
                while !over.load(Ordering::Relaxed) {
                    let batch = next.fetch_add(1, Ordering::Relaxed);
                    let (mut tally, mut lost) = (Tally::default(), Vec::new());
                    for seed in batch * BATCH..(batch + 1) * BATCH {
                        let (more, failed) = play(run.seed.wrapping_add(seed), &meshes);
                        tally.add(&more);
                        lost.extend(failed);
                    }
                    if send.send((batch, tally, lost)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        // Batches count in their order.
        let (mut waiting, mut counted) = (std::collections::BTreeMap::new(), 0);
        for (batch, more, failed) in receive {
            waiting.insert(batch, (more, failed));
            while let Some((more, failed)) = waiting.remove(&counted) {
                if over.load(Ordering::Relaxed) {
                    break;
                }
                tally.add(&more);
                lost.extend(failed);
                counted += 1;
                progress(&tally, &lost);
                if tally.total().tried >= run.points || lost.len() >= run.failures {
                    over.store(true, Ordering::Relaxed);
                }
            }
        }
    });
    (tally, lost)
}
