//! What a client is told in a tick.

use crate::id::{ClientId, EntityId};

/// What one client is told in a tick. Lists are in the order of ids.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Answer {
    /// The client.
    pub client: ClientId,
    /// All entities that it is told of.
    pub told: Vec<EntityId>,
    /// Those that it was not told of in the tick before.
    pub new: Vec<EntityId>,
    /// Those that it was told of in the tick before, and must forget: also those that were removed.
    pub forgotten: Vec<EntityId>,
    /// How far its eye may be from where it was reported, in metres.
    pub reach: f64,
    /// Whether it is the first answer, or the eye jumped farther than its speed allows: whatever it
    /// knew may be wrong, so tell it all of [`Answer::told`].
    pub is_fresh: bool,
    /// Whether its last report is older than [`ServerOptions::most_age`], so that entities may be
    /// told late: drop the client, or stop its eye.
    ///
    /// [`ServerOptions::most_age`]: crate::ServerOptions::most_age
    pub is_stale: bool,
}

impl Answer {
    pub(crate) fn new(client: ClientId) -> Self {
        let (told, new, forgotten) = (Vec::new(), Vec::new(), Vec::new());
        Self { client, told, new, forgotten, reach: 0.0, is_fresh: true, is_stale: false }
    }

    /// Finds what changed since an earlier list.
    pub(crate) fn compare(&mut self, before: &[EntityId]) {
        let lacks = |list: &[EntityId], id: &EntityId| list.binary_search(id).is_err();
        self.new.clear();
        self.new.extend(self.told.iter().filter(|id| lacks(before, id)));
        self.forgotten.clear();
        self.forgotten.extend(before.iter().filter(|id| lacks(&self.told, id)));
    }
}
