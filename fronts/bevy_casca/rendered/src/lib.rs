//! Scenes for `bevy_casca`, and an app that renders them by Bevy, with or without the plugin.

/// Without a window; not in pages.
#[cfg(not(target_family = "wasm"))]
pub mod fur;
#[cfg(not(target_family = "wasm"))]
pub mod herd;
#[cfg(not(target_family = "wasm"))]
pub mod rendered;
#[cfg(not(target_family = "wasm"))]
pub mod scenes;
pub mod town;
