//! Experiments, charts and pictures for casca, and the program `casca-lab`. Nothing here is part of
//! the library's API.
//!
//! - `experiments` (the feature `experiments`): the experiments of the report.
//! - `pictures` (a feature): charts, and pictures of the objects that a frame shows and hides.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

#[cfg(feature = "experiments")]
pub mod experiments;
#[cfg(feature = "pictures")]
pub mod pictures;
