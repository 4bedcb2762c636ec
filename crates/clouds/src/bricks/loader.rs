//! Points of bricks, loaded by a thread into a budget of memory.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::mem::size_of;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use super::error::BrickError;
use super::file::BrickPoint;
use super::file::{Bricks, Want};
use crate::PointCloud;
use crate::numeric::SQUARE_OF_SPACING;

/// Loads the first points of wanted bricks, nearest first, and drops those least recently wanted. No call but [`Loader::settle`] waits for
/// the disk: what is loaded is there, what is not comes later.
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
    /// The wanted bricks that fit into the budget.
    wants: Vec<Want>,
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
    idle: bool,
    closing: bool,
}

#[derive(Debug, Default)]
struct Loaded {
    points: Arc<Vec<BrickPoint>>,
    /// When the brick was last wanted.
    time: u64,
}

impl Loader {
    /// Starts the thread. `budget` is in bytes; while a brick is loaded, 8 MiB more may be in use.
    ///
    /// # Errors
    /// If there is no thread to be had.
    pub fn new(bricks: Arc<Bricks>, budget: usize) -> io::Result<Self> {
        let budget = budget / size_of::<BrickPoint>();
        let shared = Arc::new(Shared { bricks, budget, state: Mutex::default(), changed: Condvar::new() });
        let worker = shared.clone();
        let thread = thread::Builder::new().name("bricks".into()).spawn(move || worker.work())?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Says what is wanted from now on, most important first. Those at the end that do not fit into the budget are not loaded.
    pub fn want(&self, wants: &[Want]) {
        let Shared { bricks, budget, .. } = &*self.shared;
        let mut state = self.shared.lock();
        state.time += 1;
        let time = state.time;
        let mut sum = 0;
        state.wants.clear();
        for want in wants {
            if let Some(loaded) = state.loaded.get_mut(&want.brick) {
                loaded.time = time;
            }
            let points = bricks.available(*want);
            sum += points as usize;
            if sum <= *budget {
                state.wants.push(Want { brick: want.brick, points });
            }
        }
        state.next = 0;
        state.idle = false;
        self.shared.changed.notify_all();
    }

    /// The number of points that are loaded, of all bricks.
    pub fn loaded(&self) -> usize {
        self.shared.lock().points
    }

    /// The loaded points of some bricks, at most as many as wanted of each, as a cloud for an operator or a picture. Radii are half
    /// the sides of squares that close most gaps, as [`crate::splat`] takes them.
    pub fn gather(&self, wants: &[Want]) -> PointCloud {
        let bricks = &self.shared.bricks;
        let parts: Vec<_> = {
            let state = self.shared.lock();
            let part = |want: &Want| Some((*want, state.loaded.get(&want.brick)?.points.clone()));
            wants.iter().filter_map(part).collect()
        };
        let mut cloud = PointCloud { origin: bricks.origin(), ..PointCloud::default() };
        for (want, points) in parts {
            let points = &points[..points.len().min(want.points as usize)];
            let radius = SQUARE_OF_SPACING * bricks.spacing(want.brick, points.len() as u32);
            cloud.positions.extend(points.iter().map(|p| p.position));
            cloud.colours.extend(points.iter().map(|p| p.colour));
            cloud.radii.extend(points.iter().map(|_| radius));
        }
        cloud
    }

    /// Waits until all that is wanted and fits into the budget is loaded.
    pub fn settle(&self) {
        let mut state = self.shared.lock();
        while !state.idle {
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
                state.idle = true;
                self.changed.notify_all();
                state = self.wait(state);
                continue;
            };
            state.make_room(want, self.budget);
            drop(state);
            let start = have.len() as u32;
            let read = self.bricks.read(want.brick, start..want.points);
            // Only this thread changes what is loaded, so `have` still holds.
            let points = read.map(|more| Arc::new([have.as_slice(), &more].concat()));
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
    fn next(&mut self) -> Option<(Want, Arc<Vec<BrickPoint>>)> {
        while let Some(&want) = self.wants.get(self.next) {
            let have = self.loaded.get(&want.brick).map(|l| l.points.clone()).unwrap_or_default();
            if have.len() < want.points as usize && !self.failed.contains(&want.brick) {
                return Some((want, have));
            }
            self.next += 1;
        }
        None
    }

    /// Drops bricks until a wanted one fits: those that are not wanted, the least recently wanted first, then what others have more than
    /// is wanted of them, the farthest first.
    fn make_room(&mut self, want: Want, budget: usize) {
        let have = self.loaded.get(&want.brick).map_or(0, |l| l.points.len());
        let limit = budget.saturating_sub((want.points as usize).saturating_sub(have));
        if self.points <= limit {
            return;
        }
        let wanted: BTreeSet<u32> = self.wants.iter().map(|w| w.brick).collect();
        let mut others: Vec<(u64, u32)> = self
            .loaded
            .iter()
            .filter(|(brick, _)| !wanted.contains(brick))
            .map(|(&b, l)| (l.time, b))
            .collect();
        others.sort_unstable();
        for (_, brick) in others {
            if self.points <= limit {
                return;
            }
            self.points -= self.loaded.remove(&brick).map_or(0, |l| l.points.len());
        }
        for want in self.wants.iter().rev() {
            let Some(loaded) = self.loaded.get_mut(&want.brick) else { continue };
            let points = want.points as usize;
            if self.points > limit && loaded.points.len() > points {
                self.points -= loaded.points.len() - points;
                loaded.points = Arc::new(loaded.points[..points].to_vec());
            }
        }
    }
}
