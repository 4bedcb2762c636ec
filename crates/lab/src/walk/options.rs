//! The options of the command `walk`.

use std::path::PathBuf;

use casca::Method;
use casca_scenes::name::SceneName;
use casca_tools::command_line::EXIT_CODES;
use clap::{Parser, ValueEnum, value_parser};

use crate::arguments::{Cached, Common, FRAMES, MOST_SAMPLES, WIDTHS};

/// Width over height of all pictures.
pub(super) const ASPECT: f32 = 16.0 / 9.0;

/// How visibility is decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Objects in the frustum
    Frustum,
    /// What the viewer's cell can see
    Cell,
    /// What the eye can see, at pixel precision
    Point,
}

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Walks through a scene, finds the visible objects of each frame, and proves that none is missing",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// spheres, city, rooms, forest, crowd, town, rocks, harbour, voxels, leaves or a
    /// glTF 2.0 file (.glb): in one, surfaces hide that are drawn opaque, from the side
    /// that is drawn
    #[arg(long, default_value = "spheres")]
    pub scene: SceneName,
    /// How visibility is decided
    #[arg(long, value_enum, default_value = "point")]
    pub method: MethodName,
    /// Frames to walk, 1 to 100000 [default: the scene's path, 150 for procedural scenes]
    #[arg(long, value_parser = value_parser!(u32).range(FRAMES))]
    pub frames: Option<u32>,
    /// Rays to each object that the PVS leaves out, in every frame, up to 10000
    #[arg(long, default_value_t = 16, value_parser = value_parser!(u32).range(..=MOST_SAMPLES))]
    pub samples: u32,
    /// Width of the exact item buffer in pixels, 16 to 16384; 0 for none
    #[arg(long, default_value_t = 1920, value_parser = parse_width)]
    pub width: u32,
    /// Where prepared meshes are kept.
    #[command(flatten)]
    pub cached: Cached,
    /// Where the pictures go
    #[arg(long, default_value = "target/walk")]
    pub out: PathBuf,
    /// What is random, and the progress bar.
    #[command(flatten)]
    pub common: Common,
}

fn parse_width(text: &str) -> Result<u32, String> {
    let found = text.parse::<u32>().ok().filter(|n| *n == 0 || WIDTHS.contains(&i64::from(*n)));
    found.ok_or_else(|| format!("expected 0 or a number from {} to {}", WIDTHS.start(), WIDTHS.end()))
}

impl Options {
    /// Says why the options make no sense together, if they do not.
    pub fn check(&self) -> Result<(), String> {
        if self.width == 0 && self.samples == 0 {
            let why = "without an item buffer (--width 0) only rays can find what is lost";
            return Err(format!("nothing would be checked: {why}, and --samples is 0"));
        }
        Ok(())
    }

    /// The method of the library's query.
    pub fn query_method(&self) -> Method {
        match self.method {
            MethodName::Frustum => Method::Frustum,
            MethodName::Cell => Method::cell(),
            MethodName::Point => Method::point(),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    /// The options of a command line, or why it makes no sense.
    fn options(line: &str) -> Result<Options, String> {
        let words = std::iter::once("walk").chain(line.split_whitespace());
        let options = Options::try_parse_from(words).map_err(|e| e.to_string())?;
        options.check().map(|()| options)
    }

    #[test]
    fn absurd_values_are_refused_with_what_is_expected() {
        for (line, word) in [
            ("--width 100000", "16384"),
            ("--width 15", "from 16"),
            ("--width -1", "--width"),
            ("--frames 0", "1..=100000"),
            ("--seed -1", "--seed"),
            ("--samples 10001", "10000"),
            ("--scene house", "spheres, city"),
            ("--width 0 --samples 0", "nothing would be checked"),
        ] {
            let said = options(line).expect_err(line);
            assert!(said.contains(word), "{line}: {said}");
        }
    }

    #[test]
    fn the_ends_of_each_range_are_taken_and_the_options_are_sound() {
        for line in [
            "",
            "--width 0",
            "--width 16 --samples 0",
            "--width 16384",
            "--frames 1 --seed 18446744073709551615",
            "--frames 100000 --samples 10000",
        ] {
            options(line).expect(line);
        }
        assert_eq!(options("").unwrap().query_method(), Method::default());
        Options::command().debug_assert();
    }
}
