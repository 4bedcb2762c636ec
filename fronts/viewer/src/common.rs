//! The options that all systems share.

use std::path::PathBuf;

use casca_stage::gpu::Gpu;
use casca_stage::window::{Start, WindowOptions, open};
use casca_tools::image::parse_size;
use clap::{Args, value_parser};

/// Width and height of pictures and of the window. Larger ones are more than some devices have room
/// for.
const SIDES: std::ops::RangeInclusive<u32> = 1..=8192;

/// Why something failed.
pub type Failed = Box<dyn std::error::Error>;

/// How something is drawn.
#[derive(Debug, Clone, Copy, Args)]
pub struct Drawing {
    /// Size of pictures and of the window, up to 8192x8192
    #[arg(long, default_value = "1280x720", value_parser = |text: &str| parse_size(text, SIDES))]
    pub size: (u32, u32),
    /// Frames to draw; a window closes after so many
    #[arg(long, value_parser = value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Draws with a software adapter
    #[arg(long)]
    pub software: bool,
}

/// The options of a system.
#[derive(Debug, Clone, Args)]
pub struct Common {
    /// The file to show
    pub file: Option<PathBuf>,
    /// Draws pictures without a window
    #[arg(long)]
    pub headless: bool,
    /// The folder for pictures [default: target/ and the name of the command]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// How it is drawn.
    #[command(flatten)]
    pub drawing: Drawing,
}

impl Drawing {
    /// Opens a window, and stays until it is closed.
    ///
    /// # Errors
    /// There is no display or no adapter, and those of what is shown.
    pub fn open(&self, start: Start) -> Result<(), Failed> {
        let Self { size, frames, software } = *self;
        open(&WindowOptions { size, software, frames }, start)
    }

    /// A device for pictures without a window.
    ///
    /// # Errors
    /// There is none, or it draws no pictures as large.
    pub fn device(&self) -> Result<Gpu, Failed> {
        let gpu = Gpu::headless(self.software)?;
        if gpu.clamp(self.size) != self.size {
            let ((w, h), (width, height)) = (gpu.clamp(self.size), self.size);
            return Err(format!("--size {width}x{height}: {} draws pictures up to {w}x{h}", gpu.name).into());
        }
        Ok(gpu)
    }
}

impl Common {
    /// The name on the command line, if there is one: a file, or something generated.
    pub fn name(&self) -> Option<String> {
        self.file.as_ref().map(|file| file.to_string_lossy().into_owned())
    }

    /// The folder for pictures; `name` is that of the command.
    pub fn folder(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("target").join(name))
    }
}

/// Options as some words give them.
///
/// # Errors
/// Says what is wrong with them.
pub fn parsed<A: Args>(words: &[&str]) -> Result<A, String> {
    let command = A::augment_args(clap::Command::new("casca-viewer").no_binary_name(true));
    let matches = command.try_get_matches_from(words).map_err(|e| e.to_string())?;
    A::from_arg_matches(&matches).map_err(|e| e.to_string())
}

/// A number with its noun: "1 line", "2 lines".
pub fn counted(number: usize, [one, more]: [&str; 2]) -> String {
    format!("{number} {}", if number == 1 { one } else { more })
}
