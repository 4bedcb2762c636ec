//! Times of one thread that other programs on the machine do not change much.

use std::time::Instant;

/// Nanoseconds that this thread has run on a processor, where the system tells.
fn processor_time() -> Option<u64> {
    std::fs::read_to_string("/proc/thread-self/schedstat").ok()?.split_whitespace().next()?.parse().ok()
}

/// The seconds that some work takes on this thread, and its result: repeated until `least` seconds have passed, so that the steps of
/// the system's clock, some milliseconds, do not matter. Time in which the thread waits for a processor does not count, but
/// on systems that do not tell.
pub fn timed<T>(least: f64, mut work: impl FnMut() -> T) -> (f64, T) {
    let (start, since) = (Instant::now(), processor_time());
    let mut runs = 0.0;
    loop {
        let result = work();
        runs += 1.0;
        let seconds = match since.zip(processor_time()) {
            Some((from, to)) => to.saturating_sub(from) as f64 * 1e-9,
            None => start.elapsed().as_secs_f64(),
        };
        if seconds >= least {
            return (seconds / runs, result);
        }
    }
}
