//! How layers are chosen.

use bevy_ecs::prelude::*;

/// How many layers coats get. The defaults are for a graphics processor of today.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct FurSettings {
    /// Without it all coats keep the layers that they have.
    pub enabled: bool,
    /// The most layers of a coat, at most 256; 0 for no fur at all. 24 by default.
    pub most_layers: u32,
    /// The greatest sum of the weights of all visible furry entities: for the skin and for each
    /// layer its vertices and its pixels ([`casca_fur::visibility::plan_sights`]). Infinite by
    /// default. A budget that is negative or NaN counts as none, with a warning.
    pub budget: f64,
    /// The weight of a pixel, where a vertex weighs 1. Finite and at least 0.
    pub pixel_weight: f64,
}

impl Default for FurSettings {
    fn default() -> Self {
        Self { enabled: true, most_layers: 24, budget: f64::INFINITY, pixel_weight: 1.0 }
    }
}
