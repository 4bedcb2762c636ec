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
mod solids;
mod union;

pub use baker::{Baker, Progress, journal_of, write_whole};
pub use casca_baked::{Baked, Cells, Writer};
pub use error::BakeError;
pub use find::Finder;
pub use level::{Level, eyes_of};
pub use merge::{Merger, PartError, merge};
pub use places::Places;
