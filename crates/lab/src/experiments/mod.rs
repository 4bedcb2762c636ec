//! The laboratory: experiments whose results make up the report, `docs/report.md`.
//!
//! Each experiment is a function from a [`Lab`] to a [`Section`]: text, tables and charts.
//! [`write()`] puts sections together. What is compared goes through a `Contender`, so that
//! the library and the methods of today's engines are measured by the same code.

mod against;
mod aggressive;
mod coherence;
mod contender;
mod context;
mod report;
mod scaling;
mod shadows;
mod stability;
mod stage;
mod thesis;
mod upkeep;
mod walker;
mod worth;

pub use against::against;
pub use aggressive::aggressive;
pub(crate) use contender::{BUFFER, Contender, FrameInput};
pub(crate) use context::{ASPECT, Place, grouped, median, p99, places};
pub use context::{Lab, LabError};
pub use report::{Block, ReportError, Section, Table, write};
pub use scaling::scaling;
pub use shadows::shadows;
pub use stability::stability;
pub use thesis::thesis;
pub use upkeep::upkeep;
pub use worth::{finding, lines_of, worth};

/// An experiment: a section of the report.
pub type Experiment = fn(&Lab) -> Result<Section, LabError>;

/// All experiments by name, in the order of the report.
pub const EXPERIMENTS: &[(&str, Experiment)] = &[
    ("worth", worth),
    ("against", against),
    ("stability", stability),
    ("thesis", thesis),
    ("upkeep", upkeep),
    ("scaling", scaling),
    ("coherence", coherence::coherence),
    ("shadows", shadows),
    ("aggressive", aggressive),
];
