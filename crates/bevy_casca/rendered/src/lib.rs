//! Scenes for `bevy_casca`, and an app that renders them by Bevy, with or without the plugin.

pub mod level;
pub mod rendered;
pub mod scenes;
pub mod town;
