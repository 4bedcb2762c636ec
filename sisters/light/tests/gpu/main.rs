//! The graphics processor beside the processor.

#[path = "../common/mod.rs"]
mod common;
mod device;
mod direct;
mod gaps;
mod lobes;
mod mirrors;
mod pictures;
mod windows;
