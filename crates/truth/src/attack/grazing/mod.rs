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

use rayon::prelude::*;

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
pub use tally::Tally;
use walls::Meshes;
pub use walls::SHAPES;

/// Scenes that are counted at once.
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
fn play(seed: u64, meshes: &Meshes) -> (Tally, Vec<String>) {
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
/// If the few meshes that all scenes use are refused, or there are no threads.
#[expect(clippy::expect_used, reason = "these meshes are in order")]
pub fn long_run(run: Run, mut progress: impl FnMut(&Tally, &[String])) -> (Tally, Vec<String>) {
    let meshes = Meshes::new().expect("meshes");
    let threads = rayon::ThreadPoolBuilder::new().num_threads(run.threads).build().expect("threads");
    let batch = |number: u64| {
        let (mut tally, mut lost) = (Tally::default(), Vec::new());
        for seed in number * BATCH..(number + 1) * BATCH {
            let (more, failed) = play(run.seed.wrapping_add(seed), &meshes);
            tally.add(&more);
            lost.extend(failed);
        }
        (tally, lost)
    };
    let (mut tally, mut lost, mut next) = (Tally::default(), Vec::new(), 0);
    loop {
        let end = next + threads.current_num_threads() as u64;
        let found: Vec<_> = threads.install(|| (next..end).into_par_iter().map(batch).collect());
        next = end;
        // Batches count in their order, so that a run does not depend on the number of threads.
        for (more, failed) in found {
            tally.add(&more);
            lost.extend(failed);
            progress(&tally, &lost);
            if tally.total().tried >= run.points || lost.len() >= run.failures {
                return (tally, lost);
            }
        }
    }
}
