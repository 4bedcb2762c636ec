//! The frame loop: the clock and the results of a frame's queries.

use crate::error::Error;
use crate::pvs::Pvs;
use crate::scene::Scene;

impl Scene {
    /// Sets the clock, in seconds.
    ///
    /// # Errors
    /// Refuses a time that is not finite; then nothing changes.
    pub fn begin_frame(&mut self, now: f64) -> Result<(), Error> {
        if !now.is_finite() {
            return Err(Error::NotFinite { what: "the time", value: now });
        }
        self.now = now;
        Ok(())
    }

    /// Takes the results of a frame's queries. Those of queries that never ran are passed over.
    ///
    /// # Errors
    /// Refuses a result of another scene; then nothing changes.
    pub fn end_frame<'a>(&mut self, views: impl IntoIterator<Item = &'a Pvs>) -> Result<(), Error> {
        if views.into_iter().filter(|pvs| pvs.has_run()).any(|pvs| pvs.scene != self.tag()) {
            return Err(Error::ForeignPvs);
        }
        Ok(())
    }
}
