//! Times of one thread that other programs on the machine do not change much.

use std::time::Instant;

/// Nanoseconds that this thread has run on a processor, where the system tells.
fn processor_time() -> Option<u64> {
    std::fs::read_to_string("/proc/thread-self/schedstat").ok()?.split_whitespace().next()?.parse().ok()
}

/// Parts of a measurement; the fastest counts.
const PARTS: u32 = 5;

/// The seconds that some work takes on this thread, and its result; it is done once if `least` is 0.
///
/// Time in which the thread waits for a processor does not count, but on systems that do not tell. Other programs still slow
/// caches and memory down, so the fastest of some parts counts. Each part repeats the work for a share of `least` seconds, so
/// that the steps of the system's clock, some milliseconds, do not matter.
pub fn timed<T>(least: f64, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut part = || {
        let (start, since) = (Instant::now(), processor_time());
        let mut runs = 0.0;
        loop {
            let result = work();
            runs += 1.0;
            let seconds = match since.zip(processor_time()) {
                Some((from, to)) => to.saturating_sub(from) as f64 * 1e-9,
                None => start.elapsed().as_secs_f64(),
            };
            if seconds >= least / f64::from(PARTS) {
                return (seconds / runs, result);
            }
        }
    };
    let mut best = part();
    for _ in 1..if least > 0.0 { PARTS } else { 1 } {
        let next = part();
        if next.0 < best.0 {
            best = next;
        }
    }
    best
}
