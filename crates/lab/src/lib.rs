//! Experiments, charts and pictures for casca, and the program `casca-lab`. Nothing here is part of
//! the library's API.
//!
//! - `experiments` (the feature `experiments`): the experiments of the report.
//! - `pictures` (a feature): charts, and pictures of the objects that a frame shows and hides.
//! - `walk` and `arguments` (the feature `cli`): the main job, for `casca-lab` and for `casca`.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

#[cfg(feature = "cli")]
pub mod arguments;
#[cfg(feature = "experiments")]
pub mod experiments;
#[cfg(feature = "pictures")]
pub mod pictures;
#[cfg(feature = "cli")]
pub mod walk;
