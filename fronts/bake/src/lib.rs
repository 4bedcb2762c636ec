#![doc = include_str!("../README.md")]
#![deny(missing_docs)]

mod baker;
mod error;
mod find;
mod journal;
mod level;
mod merge;
mod part;
mod places;
#[cfg(feature = "cli")]
pub mod program;
mod solids;

pub use baker::{Baker, Progress, journal_of, write_whole};
pub use casca_baked::{Baked, Cells, ReadError, Writer};
pub use error::BakeError;
pub use find::Finder;
pub use level::{Level, bounds_of, eyes_of};
pub use merge::{Merger, merge};
pub use places::Places;
