//! Times of one thread that other programs on the machine do not change much.

use casca_scenes::measure::ThreadTime;

/// Parts of a measurement; the fastest counts.
const PARTS: u32 = 5;

/// The seconds that some work takes on this thread, and its result; it is done once if `least` is
/// 0.
///
/// It is that of [`ThreadTime`]. Other programs still slow caches and memory down, so the fastest
/// of some parts counts. Each part repeats the work for a share of `least` seconds.
pub fn timed<T>(least: f64, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut part = || {
        let start = ThreadTime::now();
        let mut runs = 0.0;
        loop {
            let result = work();
            runs += 1.0;
            let seconds = start.elapsed().as_secs_f64();
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
