//! Plays scenes, one by one or on all cores.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc;

use super::stage::Stage;
use super::tally::{Lost, Tally};
use super::walls::Meshes;
use super::{casters, cells, parallel, stream, views};

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
pub fn play(seed: u64, meshes: &Meshes) -> (Tally, Vec<Lost>) {
    let stage = |layered, moving| Stage::new(seed, meshes, layered, moving);
    let layered = seed / 16 % 4 == 3;
    let mut stage = match seed % 16 {
        0..=5 => views::play(stage(layered, false), seed.is_multiple_of(2)),
        6..=10 => stream::play(stage(layered, seed.is_multiple_of(2)), seed.is_multiple_of(3)),
        11 | 12 => parallel::play(stage(layered, false)),
        13 => cells::play(stage(layered, false)),
        _ => casters::play(stage(layered, false)),
    };
    (std::mem::take(&mut stage.tally), std::mem::take(&mut stage.lost))
}

/// Plays scene after scene on several threads; `progress` is told what was tried and lost so far.
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
