//! Arguments that commands share. What they default to, and what a command says of them, it sets
//! with [`default_to`] and [`about`].

#[cfg(feature = "experiments")]
mod measured;

use std::path::PathBuf;

use clap::{Arg, Args};

#[cfg(feature = "experiments")]
pub use measured::{PageArguments, Repeats, SizedPage, WalkArguments, Width, scenes_or};

/// The default of an argument.
pub fn default_to(value: &'static str) -> impl FnOnce(Arg) -> Arg {
    move |argument| argument.required(false).default_value(value)
}

/// The default of an argument, and what `--help` says about it.
pub fn about(value: &'static str, help: &'static str) -> impl FnOnce(Arg) -> Arg {
    move |argument| default_to(value)(argument).help(help)
}

/// Arguments of all commands with something random and a progress bar.
#[derive(Debug, Clone, Args)]
pub struct Common {
    /// Seed of all that is random
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// No progress bar
    #[arg(long)]
    pub quiet: bool,
}

/// Where results go.
#[derive(Debug, Clone, Args)]
pub struct Out {
    /// Where the results go
    #[arg(long)]
    pub out: PathBuf,
}
