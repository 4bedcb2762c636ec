//! What a game adds.

use crate::client::ClientDesc;
use crate::id::{ClientId, EntityId};
use crate::roster::Entity;

/// Tells a client of more entities than it may see: of those that it hears, for example.
///
/// Closures are hooks; `&()` adds nothing. Answers must not depend on the order of questions: they
/// come from several threads.
pub trait Hook: Sync {
    /// Whether a client is told of an entity that it cannot see.
    fn tells(&self, client: (ClientId, &ClientDesc), entity: (EntityId, &Entity)) -> bool;
}

impl Hook for () {
    fn tells(&self, _: (ClientId, &ClientDesc), _: (EntityId, &Entity)) -> bool {
        false
    }
}

impl<F: Fn((ClientId, &ClientDesc), (EntityId, &Entity)) -> bool + Sync> Hook for F {
    fn tells(&self, client: (ClientId, &ClientDesc), entity: (EntityId, &Entity)) -> bool {
        self(client, entity)
    }
}
