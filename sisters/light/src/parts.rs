//! Work in parts, so that a frame takes a bounded time. All of it done, the light is the same.

use crate::cache::Cache;
use crate::error::LightError;
use crate::queues::Wish;

impl Cache {
    /// As [`Cache::gather_ring`], but for so many of the states that wait; returns how many wait
    /// now. States that questions asked for come first and send `rays.0` each. When there are none,
    /// and each fourth time, those that were hit come, oldest first, and send `rays.1`.
    ///
    /// A state sends the same rays whenever its turn comes.
    ///
    /// # Errors
    /// If no state has so many rays, or too many rays would be stored; then all of them wait on.
    pub fn gather_part(&mut self, rays: (u32, u32), states: usize) -> Result<usize, LightError> {
        let most = states.min(self.waiting.count());
        self.check_room(rays.0, most)?;
        self.check_room(rays.1, most)?;
        let (wish, mut part) = self.waiting.take(most);
        part.sort_unstable();
        self.gather_states(&part, if wish == Wish::Asked { rays.0 } else { rays.1 });
        Ok(self.waiting.count())
    }

    /// As [`Cache::direct`], but for so many states; returns how many have none or an old light
    /// now. Those that have none come first, and then those whose light is the oldest. It is old
    /// after [`Cache::set_lights`] or [`Cache::set_object`].
    pub fn direct_part(&mut self, states: usize) -> usize {
        let part = self.unlit.take(states);
        self.light(&part);
        self.unlit.count()
    }

    /// How many states wait for rays: see [`Cache::gather_part`].
    pub fn waiting(&self) -> usize {
        self.waiting.count()
    }
}
