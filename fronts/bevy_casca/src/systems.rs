//! The order of what is done in a frame.

use bevy_ecs::prelude::*;

/// What the plugin does in `PostUpdate`, in this order. The first three are part of Bevy's
/// `VisibilitySystems::CheckVisibility`: what runs before that set changes what they find.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CascaSystems {
    /// Materials are judged: [`MaterialsPlugin`](crate::MaterialsPlugin).
    Materials,
    /// Entities that came, moved, changed or went are brought up to date in the
    /// [`CascaScene`](crate::CascaScene).
    Sync,
    /// Cameras find what they see.
    Cameras,
    /// Lights find what casts their shadows.
    Lights,
    /// The frame ends: what nobody saw is put into volumes.
    End,
}
