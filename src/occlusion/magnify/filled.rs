//! Values that are filled by the first thread that asks for them.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// How often a thread looks whether another one has filled a value, before it sleeps until then.
/// Most are filled within ten microseconds; a thread that sleeps awakes a hundred later.
const LOOKS: u32 = 4096;

/// A value that is filled when it is first asked for.
#[derive(Debug)]
pub(super) struct Filled<T> {
    value: OnceLock<T>,
    /// Whether a thread fills it, or has.
    begun: AtomicBool,
}

impl<T> Default for Filled<T> {
    fn default() -> Self {
        Self { value: OnceLock::new(), begun: AtomicBool::new(false) }
    }
}

impl<T> Filled<T> {
    #[inline]
    pub(super) fn get(&self) -> Option<&T> {
        self.value.get()
    }

    pub(super) fn get_mut(&mut self) -> Option<&mut T> {
        self.value.get_mut()
    }

    /// Empties it.
    pub(super) fn take(&mut self) -> Option<T> {
        *self.begun.get_mut() = false;
        self.value.take()
    }

    /// The value, filled by this thread if no other one has begun to.
    #[inline]
    pub(super) fn get_or_fill(&self, fill: impl FnOnce() -> T) -> &T {
        if let Some(value) = self.get() {
            return value;
        }
        // The lock below orders what threads see. This only says whether to wait awake.
        if self.begun.swap(true, Ordering::Relaxed)
            && let Some(value) = self.wait()
        {
            return value;
        }
        self.value.get_or_init(fill)
    }

    /// The value, if another thread fills it soon.
    #[cold]
    fn wait(&self) -> Option<&T> {
        (0..LOOKS).find_map(|_| {
            std::hint::spin_loop();
            self.get()
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU32;

    use super::*;

    #[test]
    fn a_value_is_filled_once_by_any_number_of_threads() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let mut value = Filled::default();
        for round in 0..100 {
            let fills = AtomicU32::new(0);
            pool.broadcast(|_| {
                let filled = value.get_or_fill(|| {
                    fills.fetch_add(1, Ordering::Relaxed);
                    // In some rounds longer than the others wait awake.
                    let looks = if round % 10 == 0 { 4 * LOOKS } else { 0 };
                    (0..looks).for_each(|_| std::hint::spin_loop());
                    round
                });
                assert_eq!(*filled, round);
            });
            assert_eq!(fills.into_inner(), 1);
            assert_eq!((value.get_mut().copied(), value.take()), (Some(round), Some(round)));
            assert!(value.get().is_none() && !*value.begun.get_mut());
        }
    }
}
