//! What all systems share: options, pictures without a window, and how they are started.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use casca_stage::canvas::Canvas;
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::timing::Clock;
use casca_stage::window::{Start, open};
use casca_tools::command_line::{Outcome, make_folder, say};
use casca_tools::image::{halved, parse_size, write_png};
use clap::{Args, value_parser};

/// Width and height of pictures and of the window. Larger ones are more than some devices have room
/// for.
const SIDES: RangeInclusive<u32> = 1..=8192;

/// Why something failed.
pub type Failed = Box<dyn std::error::Error>;

/// The options that all systems take.
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

impl Common {
    /// A device for pictures without a window, and the folder for them, which is made; `name` is that
    /// of the command.
    ///
    /// # Errors
    /// There is no device, it draws no pictures as large, or the folder cannot be made.
    pub fn studio(&self, name: &str) -> Result<(Gpu, PathBuf), Failed> {
        let folder = self.out.clone().unwrap_or_else(|| PathBuf::from("target").join(name));
        make_folder(&folder)?;
        let gpu = Gpu::headless(self.software)?;
        if gpu.clamp(self.size) != self.size {
            let ((w, h), (width, height)) = (gpu.clamp(self.size), self.size);
            return Err(format!("--size {width}x{height}: {} draws pictures up to {w}x{h}", gpu.name).into());
        }
        say(format_args!("drawing on {}", gpu.name));
        Ok((gpu, folder))
    }

    /// The name on the command line, if there is one: a file, or something generated.
    pub fn name(&self) -> Option<String> {
        self.file.as_ref().map(|file| file.to_string_lossy().into_owned())
    }
}

/// A canvas for pictures without a window.
pub struct Film {
    /// What is drawn to.
    pub canvas: Canvas,
    /// Whether it is twice as wide and as high as its pictures, for smooth edges.
    is_twice: bool,
}

impl Film {
    /// A canvas for pictures of this size; if it is to be twice as large, as far as the device draws
    /// such pictures.
    pub fn new(gpu: &Gpu, (width, height): (u32, u32), is_twice: bool) -> Self {
        let large = (2 * width, 2 * height);
        let is_twice = is_twice && gpu.clamp(large) == large;
        Self { canvas: Canvas::new(gpu, if is_twice { large } else { (width, height) }), is_twice }
    }

    /// Width and height of the pictures.
    pub fn size(&self) -> (u32, u32) {
        let (width, height) = self.canvas.size();
        if self.is_twice { (width / 2, height / 2) } else { (width, height) }
    }

    /// The picture as it was drawn: red, green, blue, opacity, row by row.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        let pixels = self.canvas.read_picture(gpu)?;
        Ok(if self.is_twice { halved(&pixels, self.canvas.size()) } else { pixels })
    }

    /// Writes the picture as it was drawn into a file, and prints its name.
    pub fn save(&self, gpu: &Gpu, path: &Path) -> Result<(), Failed> {
        write_png(path, self.size(), &self.read(gpu)?)?;
        say(path.display());
        Ok(())
    }
}

/// The options of a system, which shows what they say.
pub trait Shows: Args {
    /// Those that all systems take.
    fn common(&self) -> &Common;

    /// The window.
    fn start(&self) -> Result<Start, Failed>;

    /// Whether it draws pictures or prints numbers, and opens no window.
    fn is_windowless(&self) -> bool {
        self.common().headless
    }

    /// Does its work without a window; whether all that was to be proved holds.
    fn work(&self) -> Result<Outcome, Failed>;

    /// Opens a window, or works without one.
    fn run(&self) -> Result<Outcome, Failed> {
        if self.is_windowless() {
            return self.work();
        }
        let Common { size, software, frames, .. } = *self.common();
        open(size, software, frames, self.start()?).map(|()| Outcome::Well)
    }
}

/// Options as some words give them.
pub fn parsed<A: Args>(words: &[&str]) -> Result<A, String> {
    let command = A::augment_args(clap::Command::new("casca").no_binary_name(true));
    let matches = command.try_get_matches_from(words).map_err(|e| e.to_string())?;
    A::from_arg_matches(&matches).map_err(|e| e.to_string())
}

/// A number of a command line, within a range.
pub fn number<T>(text: &str, range: RangeInclusive<T>) -> Result<T, String>
where
    T: FromStr + PartialOrd + Display,
{
    let found = text.trim().parse().ok().filter(|number| range.contains(number));
    found.ok_or_else(|| format!("expected a number from {} to {}", range.start(), range.end()))
}

/// One of several of a command line, by its name.
///
/// # Errors
/// None has this name; says those that there are.
pub fn one_of<T: Copy>(text: &str, all: &[(&str, T)]) -> Result<T, String> {
    let found = all.iter().find(|(name, _)| *name == text).map(|(_, one)| *one);
    found.ok_or_else(|| format!("expected {}", all.iter().map(|one| one.0).collect::<Vec<_>>().join(", ")))
}

/// Prints the stages of a frame with their times; one that ran twice has the sum.
pub fn say_stages(clock: &Clock) {
    let mut sums: Vec<(&str, Duration)> = Vec::new();
    for &(name, time) in clock.stages() {
        match sums.iter_mut().find(|sum| sum.0 == name) {
            Some(sum) => sum.1 += time,
            None => sums.push((name, time)),
        }
    }
    let all: Duration = sums.iter().map(|sum| sum.1).sum();
    let stage = |(name, time): &(&str, Duration)| format!("{name} {:.2}", time.as_secs_f64() * 1e3);
    let stages: Vec<String> = sums.iter().map(stage).chain([stage(&("all", all))]).collect();
    say(format_args!("ms: {}", stages.join(", ")));
}

/// A number with its noun: "1 line", "2 lines".
pub fn counted(number: usize, [one, more]: [&str; 2]) -> String {
    format!("{number} {}", if number == 1 { one } else { more })
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_tools::command_line::{direction, point};
    use glam::{DVec3, Vec3};

    #[test]
    fn numbers_points_and_directions_are_finite_and_within_their_range() {
        assert_eq!(number("0.5", 0.0..=1.0), Ok(0.5));
        for text in ["2", "-1", "NaN", "inf", "x", ""] {
            assert_eq!(number(text, 0.0..=1.0).unwrap_err(), "expected a number from 0 to 1");
        }
        assert_eq!(point("1, 2,-3"), Ok(DVec3::new(1.0, 2.0, -3.0)));
        for text in ["1,2", "1,2,NaN", "1,2,3e38", "1,x,3", "1,2,3,4", ",,", ""] {
            assert!(point(text).unwrap_err().contains("three numbers"), "{text}");
        }
        assert_eq!(direction("0,-2,0"), Ok(Vec3::NEG_Y));
        assert!(direction("0,0,0").unwrap_err().contains("no direction"));
    }
}
