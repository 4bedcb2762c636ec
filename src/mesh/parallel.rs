//! Work that several threads share, with the feature `rayon`. Results do not depend on the number
//! of threads.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// Appends the results for the numbers below `count`, in order.
#[cfg(feature = "rayon")]
pub(super) fn extend<T: Send>(all: &mut Vec<T>, count: usize, result: impl Fn(usize) -> T + Send + Sync) {
    all.par_extend((0..count).into_par_iter().map(result));
}

/// Appends the results for the numbers below `count`, in order.
#[cfg(not(feature = "rayon"))]
pub(super) fn extend<T>(all: &mut Vec<T>, count: usize, result: impl Fn(usize) -> T) {
    all.extend((0..count).map(result));
}

/// Sorts entries of which no two are equal.
#[cfg(feature = "rayon")]
pub(super) fn sort<T: Ord + Send>(entries: &mut [T]) {
    entries.par_sort_unstable();
}

/// Sorts entries of which no two are equal.
#[cfg(not(feature = "rayon"))]
pub(super) fn sort<T: Ord>(entries: &mut [T]) {
    entries.sort_unstable();
}

/// The results of two tasks. The second one runs on this thread.
#[cfg(feature = "rayon")]
pub(super) fn both<A: Send, B>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B) -> (A, B) {
    let mut done = None;
    let second = rayon::in_place_scope(|scope| {
        scope.spawn(|_| done = Some(first()));
        second()
    });
    (done.expect("the scope ends when all its tasks have ended"), second)
}

/// The results of two tasks. The second one runs on this thread.
#[cfg(not(feature = "rayon"))]
pub(super) fn both<A, B>(first: impl FnOnce() -> A, second: impl FnOnce() -> B) -> (A, B) {
    let second = second();
    (first(), second)
}
