//! Levels to try a server with, and bots that run in them, peek around corners, jump and lag.

mod bot;
mod level;
mod match_;

pub use bot::{Bot, SPEED};
pub use level::{Level, LevelError, Track};
pub use match_::{DOWN, Match, Moment};
