//! Commands for clouds larger than memory: `generate`, `bricks`, `walk`.

mod bricks;
mod generate;
mod picture;
mod progress;
mod town;
mod walk;

pub use bricks::Cut;
pub use generate::Generate;
pub use walk::Walk;
