//! Points of bricks, loaded by a thread into a budget of memory.

use super::BrickError;
use super::file::{BrickPoint, Bricks, Want};
use crate::PointCloud;
use crate::numeric::SQUARE_OF_SPACING;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// Loads the first points of wanted bricks, nearest first, and evicts the least recently wanted. No
/// call but [`Loader::settle`] waits for the disk: the others use the points that are loaded, and
/// the rest comes later.
#[derive(Debug)]
pub struct Loader {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    bricks: Arc<Bricks>,
    /// In points.
    budget: usize,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// The wanted bricks that fit into the budget, each once.
    wants: Vec<Want>,
    /// What bricks are cut to when there is no room, the first one last: the wants, then those that
    /// are not wanted, the least recently wanted last. Listed when room is first needed for `wants`.
    cuts: Option<Vec<Want>>,
    /// The wants before it are loaded.
    next: usize,
    /// The number of lists of wants that came so far.
    time: u64,
    loaded: BTreeMap<u32, Loaded>,
    /// The points in `loaded`.
    points: usize,
    /// Bricks that cannot be read.
    failed: BTreeSet<u32>,
    error: Option<BrickError>,
    closing: bool,
    /// The thread has ended.
    stopped: bool,
}

/// The loaded points of a brick.
#[derive(Debug, Default)]
struct Loaded {
    points: Arc<[BrickPoint]>,
    /// When the brick was last wanted.
    time: u64,
}

impl Loader {
    /// Starts the thread. `budget` is in bytes; while a brick is loaded, 12 MiB more may be in use.
    ///
    /// # Errors
    /// If there is no thread to be had.
    pub fn new(bricks: Arc<Bricks>, budget: usize) -> io::Result<Self> {
        let budget = budget / size_of::<BrickPoint>();
        let shared = Arc::new(Shared { bricks, budget, state: Mutex::default(), changed: Condvar::new() });
        let worker = shared.clone();
        let work = move || {
            let ended = panic::catch_unwind(AssertUnwindSafe(|| worker.work()));
            // Nobody waits for the thread from here on.
            let mut state = worker.lock();
            state.stopped = true;
            if ended.is_err() {
                let source = io::Error::other("the thread that loads bricks panicked");
                state.error.get_or_insert(BrickError::Io { name: worker.bricks.name.clone(), source });
            }
            worker.changed.notify_all();
        };
        let thread = thread::Builder::new().name("bricks".into()).spawn(work)?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Sets the wanted bricks, most important first. Those at the end that do not fit into the
    /// budget are not loaded. Of a brick that is in the list more than once, the largest number of
    /// points counts, at its first place. The cost is `n log n` in the length of the list.
    pub fn want(&self, wants: &[Want]) {
        let Shared { bricks, budget, .. } = &*self.shared;
        let mut state = self.shared.lock();
        state.time += 1;
        let time = state.time;
        let mut most = BTreeMap::new();
        for want in wants {
            let points = most.entry(want.brick).or_insert(0);
            *points = bricks.available(*want).max(*points);
        }
        let mut sum = 0_usize;
        state.wants.clear();
        for &Want { brick, .. } in wants {
            let Some(points) = most.remove(&brick) else { continue };
            if let Some(loaded) = state.loaded.get_mut(&brick) {
                loaded.time = time;
            }
            sum = sum.saturating_add(points as usize);
            if sum <= *budget {
                state.wants.push(Want { brick, points });
            }
        }
        (state.next, state.cuts) = (0, None);
        self.shared.changed.notify_all();
    }

    /// The number of points that are loaded, of all bricks.
    pub fn loaded(&self) -> usize {
        self.shared.lock().points
    }

    /// The loaded points of some bricks, at most as many as wanted of each, as a cloud for an operator or a
    /// picture. Radii are half the sides of squares that close most gaps, as [`crate::splat`] takes them.
    pub fn gather(&self, wants: &[Want]) -> PointCloud {
        let bricks = &self.shared.bricks;
        let parts: Vec<_> = {
            let state = self.shared.lock();
            let part = |want: &Want| Some((*want, state.loaded.get(&want.brick)?.points.clone()));
            wants.iter().filter_map(part).collect()
        };
        let mut cloud = PointCloud { origin: bricks.origin(), ..PointCloud::default() };
        for (want, points) in parts {
            let count = points.len().min(want.points as usize);
            let radius = SQUARE_OF_SPACING * bricks.spacing(want.brick, count as u32);
            let first = &points[..count];
            cloud.positions.extend(first.iter().map(|p| p.position));
            cloud.colours.extend(first.iter().map(|p| p.colour));
            cloud.radii.extend(first.iter().map(|_| radius));
        }
        cloud
    }

    /// Waits until all wanted points that fit into the budget are loaded, or the thread has ended
    /// with an error.
    pub fn settle(&self) {
        let mut state = self.shared.lock();
        while !state.stopped && state.next().is_some() {
            state = self.shared.wait(state);
        }
    }

    /// The first error since the last call. Its brick is not tried again.
    pub fn take_error(&self) -> Option<BrickError> {
        self.shared.lock().error.take()
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        self.shared.lock().closing = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self) {
        let mut state = self.lock();
        while !state.closing {
            let Some((want, have)) = state.next() else {
                self.changed.notify_all();
                state = self.wait(state);
                continue;
            };
            state.make_room(want, self.budget);
            drop(state);
            let read = self.bricks.read(want.brick, have.len() as u32..want.points);
            // Only this thread loads and drops points, so `have` still holds.
            let points = read.map(|more| have.iter().chain(&more).copied().collect::<Arc<[BrickPoint]>>());
            state = self.lock();
            match points {
                Ok(points) => {
                    state.points += points.len() - have.len();
                    let time = state.time;
                    state.loaded.insert(want.brick, Loaded { points, time });
                }
                Err(error) => {
                    state.failed.insert(want.brick);
                    state.error.get_or_insert(error);
                }
            }
        }
    }
}

impl State {
    /// The next brick of which more points are wanted than are loaded, and these.
    fn next(&mut self) -> Option<(Want, Arc<[BrickPoint]>)> {
        while let Some(&want) = self.wants.get(self.next) {
            let have = self.loaded.get(&want.brick).map(|l| l.points.clone()).unwrap_or_default();
            if have.len() < want.points as usize && !self.failed.contains(&want.brick) {
                return Some((want, have));
            }
            self.next += 1;
        }
        None
    }

    /// Drops bricks until a wanted one fits: those that are not wanted, the least recently wanted
    /// first, then what others have more than is wanted of them, the farthest first.
    fn make_room(&mut self, want: Want, budget: usize) {
        let have = self.loaded.get(&want.brick).map_or(0, |l| l.points.len());
        let limit = budget.saturating_sub((want.points as usize).saturating_sub(have));
        if self.points <= limit {
            return;
        }
        let mut cuts = self.cuts.take().unwrap_or_else(|| self.cuts());
        while self.points > limit {
            let Some(Want { brick, points }) = cuts.pop() else { break };
            let Some(loaded) = self.loaded.get_mut(&brick) else { continue };
            let left = loaded.points.len().min(points as usize);
            self.points -= loaded.points.len() - left;
            if left == 0 {
                self.loaded.remove(&brick);
            } else if left < loaded.points.len() {
                loaded.points = loaded.points[..left].into();
            }
        }
        self.cuts = Some(cuts);
    }

    fn cuts(&self) -> Vec<Want> {
        let wanted: BTreeSet<u32> = self.wants.iter().map(|want| want.brick).collect();
        let others = self.loaded.iter().filter(|(brick, _)| !wanted.contains(brick));
        let mut others: Vec<(u64, u32)> = others.map(|(&brick, l)| (l.time, brick)).collect();
        others.sort_unstable_by(|a, b| b.cmp(a));
        let others = others.into_iter().map(|(_, brick)| Want { brick, points: 0 });
        self.wants.iter().copied().chain(others).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bricks::{BuildOptions, Builder};

    #[test]
    fn nobody_waits_for_a_thread_that_panicked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("none");
        Builder::create(&path, BuildOptions::default()).unwrap().finish(|_, _| ()).unwrap();
        let loader = Loader::new(Arc::new(Bricks::open(&path).unwrap()), 1 << 20).unwrap();
        // A brick that is not in the file, past the check of `want`.
        loader.shared.lock().wants = vec![Want { brick: 7, points: 5 }];
        loader.shared.changed.notify_all();
        loader.settle();
        assert!(loader.take_error().unwrap().to_string().contains("panicked"));
    }
}
