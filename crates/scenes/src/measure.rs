//! What measurements share: the clock of a thread, the time of a call, and settled scenes.

use std::time::Duration;

use casca::{Error, Method, Query, View};

use crate::drive::{Driver, view_of};
use crate::world::World;

/// A moment on the clock of a thread: the processor time that the thread has used. Waiting for a
/// processor, for other threads or for files is not part of it, so that other programs disturb a
/// measurement less.
///
/// Reading it costs a call of the system, some hundred nanoseconds. Where a system tells no such
/// time, it is the time that passes.
#[derive(Debug, Clone, Copy)]
pub struct ThreadTime(Duration);

impl ThreadTime {
    /// This moment on the clock of this thread.
    pub fn now() -> Self {
        Self(thread_clock())
    }

    /// The processor time that this thread has used since; on another thread it means nothing.
    pub fn elapsed(&self) -> Duration {
        thread_clock().saturating_sub(self.0)
    }
}

#[cfg(any(target_os = "linux", target_os = "macos"))]
fn thread_clock() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap_or(0))
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn thread_clock() -> Duration {
    static START: std::sync::LazyLock<web_time::Instant> = std::sync::LazyLock::new(web_time::Instant::now);
    START.elapsed()
}

/// What a call gives, and the processor time that this thread spends on it. For calls that stay on
/// this thread.
pub fn timed<T>(call: impl FnOnce() -> T) -> (T, Duration) {
    let start = ThreadTime::now();
    let value = call();
    (value, start.elapsed())
}

/// A scene whose hidden objects have settled in their volumes after a walk of all frames, as
/// the world stands now.
pub struct Settled {
    /// The scene.
    pub driver: Driver,
    /// The views of the walk.
    pub views: Vec<View>,
}

impl Settled {
    /// Inserts a world and walks through it once.
    ///
    /// # Errors
    /// As [`Driver::new`], [`view_of`] and [`Query::with_method`].
    pub fn new(world: &World, method: Method) -> Result<Self, Error> {
        let mut driver = Driver::new(world, world.grid.cell, |_| ())?;
        let views: Result<Vec<View>, Error> =
            (0..world.frames).map(|f| view_of(&world.camera(f, 16.0 / 9.0))).collect();
        let (mut query, views) = (Query::with_method(method)?, views?);
        driver.scene.begin_frame(0.0)?;
        for view in &views {
            query.run(&driver.scene, view);
            driver.scene.end_frame([query.pvs()])?;
        }
        Ok(Self { driver, views })
    }

    /// Runs the queries of the whole walk and returns how many objects they found.
    pub fn walk(&self, query: &mut Query) -> usize {
        self.views.iter().map(|view| query.run(&self.driver.scene, view).len()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(any(target_os = "linux", target_os = "macos"))]
    #[test]
    fn the_clock_of_a_thread_counts_its_work_and_not_its_sleep() {
        let long = Duration::from_millis(50);
        let ((), slept) = timed(|| std::thread::sleep(long));
        assert!(slept < long / 2, "{slept:?}");
        // Work goes on until the clock has gone on: it would never end if it stood still.
        let start = ThreadTime::now();
        let mut sum = 0u64;
        while start.elapsed() < Duration::from_millis(2) {
            sum = std::hint::black_box(sum + 1);
        }
        assert!(sum > 0);
    }
}
