//! The options of the command `walk`.

use std::path::PathBuf;

use casca::{CellOptions, MAX_CELLS_PER_AXIS, Method, PointOptions, Query};
use casca_scenes::name::SceneName;
use casca_tools::command_line::EXIT_CODES;
use clap::{Parser, ValueEnum, value_parser};
use glam::UVec3;

use crate::arguments::{Cached, Common, Out, about};
use crate::arguments::{FRAMES, MOST_SAMPLES, WIDTHS};

/// Width over height of all pictures.
pub(super) const ASPECT: f32 = 16.0 / 9.0;

/// Cells of a grid. So many take half a minute to fill and 2 GB.
const MOST_CELLS: u64 = 1 << 30;

/// How visibility is decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Objects in the frustum
    Frustum,
    /// What the viewer's cell can see
    Cell,
    /// What the eye can see, at pixel precision
    Point,
    /// For comparison: a rasterised depth buffer, which loses objects
    Hzb,
    /// For comparison: a ray-cast depth buffer, which loses objects
    Rays,
}

impl MethodName {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frustum => "frustum",
            Self::Cell => "cell",
            Self::Point => "point",
            Self::Hzb => "hzb",
            Self::Rays => "rays",
        }
    }
}

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Walks through a scene, finds the visible objects of each frame, and proves that none is missing",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/walk", "Where the pictures go"))
)]
pub struct Options {
    /// spheres, city, rooms, forest, crowd, terrain, town, rocks, spheres-meshes, city-meshes,
    /// spheres-16, city-10, valley, harbour, storeys or a glTF 2.0 file (.glb), of which only what
    /// is drawn opaque hides, from the side from which it is drawn
    #[arg(long, default_value = "spheres")]
    pub scene: SceneName,
    /// How visibility is decided
    #[arg(long, value_enum, default_value = "point")]
    pub method: MethodName,
    /// Cells along x, y and z, such as 100x60x100, or fit: as many as suit the number of objects
    /// [default: as the scene asks]
    #[arg(long, value_parser = parse_grid)]
    pub grid: Option<GridChoice>,
    /// Frames to walk, 1 to 100000 [default: the scene's path, 150 for procedural scenes]
    #[arg(long, value_parser = value_parser!(u32).range(FRAMES))]
    pub frames: Option<u32>,
    /// Pixels along each side of the direction masks: a power of two from 64 to 4096
    #[arg(long, default_value_t = CellOptions::default().mask_resolution, value_parser = parse_mask)]
    pub mask: u32,
    /// Width of a pixel of the occlusion buffers in degrees, 0.03 to 11.25
    #[arg(long, default_value_t = PointOptions::default().pixel_degrees, value_parser = parse_pixel)]
    pub pixel: f32,
    /// Squares examined again for one undecided object, at most
    #[arg(long, default_value_t = PointOptions::default().refine_squares)]
    pub refine: u32,
    /// Patches of triangles drawn again in undecided pixels, in one query, at most
    #[arg(long, default_value_t = PointOptions::default().refine_patches)]
    pub patches: u32,
    /// Rays to each object that the PVS leaves out, in every frame, up to 10000
    #[arg(long, default_value_t = 16, value_parser = value_parser!(u32).range(..=MOST_SAMPLES))]
    pub samples: u32,
    /// Left-out objects that get rays, in every frame
    #[arg(long, default_value_t = 20_000)]
    pub candidates: u32,
    /// Width of the exact item buffer in pixels, 16 to 16384; 0 for none
    #[arg(long, default_value_t = 1920, value_parser = parse_width)]
    pub width: u32,
    /// Writes all results to this file
    #[arg(long)]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    pub cached: Cached,
    #[command(flatten)]
    pub out: Out,
    #[command(flatten)]
    pub common: Common,
}

/// The grid that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridChoice {
    /// Cells along each axis.
    Dims(UVec3),
    /// As many as suit the number of objects.
    Fit,
}

fn parse_grid(text: &str) -> Result<GridChoice, String> {
    if text == "fit" {
        return Ok(GridChoice::Fit);
    }
    let parts: Result<Vec<u32>, _> = text.split('x').map(str::parse).collect();
    let range = 1..=MAX_CELLS_PER_AXIS;
    match parts.as_deref() {
        Ok(&[x, y, z]) if [x, y, z].iter().all(|n| range.contains(n)) => {
            let cells = [x, y, z].map(u64::from).iter().product::<u64>();
            let dims = GridChoice::Dims(UVec3::new(x, y, z));
            (cells <= MOST_CELLS)
                .then_some(dims)
                .ok_or_else(|| format!("{cells} cells are more than {MOST_CELLS}"))
        }
        _ => Err(format!("expected three numbers from 1 to {MAX_CELLS_PER_AXIS} such as 100x60x100, or fit")),
    }
}

/// The number in a text, if the library accepts the method that `with` makes of it.
fn option<T: Copy + std::str::FromStr>(text: &str, with: fn(T) -> Method) -> Result<T, String>
where
    T::Err: ToString,
{
    let value = text.parse::<T>().map_err(|e| e.to_string())?;
    Query::with_method(with(value)).map(|_| value).map_err(|e| e.to_string())
}

fn parse_mask(text: &str) -> Result<u32, String> {
    option(text, |n| Method::Cell(CellOptions::default().mask_resolution(n)))
}

fn parse_pixel(text: &str) -> Result<f32, String> {
    option(text, |degrees| Method::Point(PointOptions::default().pixel_degrees(degrees)))
}

fn parse_width(text: &str) -> Result<u32, String> {
    let found = text.parse::<u32>().ok().filter(|n| *n == 0 || WIDTHS.contains(&i64::from(*n)));
    found.ok_or_else(|| format!("expected 0 or a number from {} to {}", WIDTHS.start(), WIDTHS.end()))
}

impl Options {
    /// Says why the options make no sense together, if they do not.
    pub fn check(&self) -> Result<(), String> {
        if self.width == 0 && (self.samples == 0 || self.candidates == 0) {
            let why = "without an item buffer (--width 0) only rays can find what is lost";
            return Err(format!("nothing would be checked: {why}, and --samples or --candidates is 0"));
        }
        Ok(())
    }

    /// Options of the cell method.
    pub fn cell_options(&self) -> CellOptions {
        CellOptions::default().mask_resolution(self.mask)
    }

    /// The method of the query, with its options.
    pub fn query_method(&self) -> Method {
        match self.method {
            MethodName::Frustum => Method::Frustum,
            MethodName::Cell => Method::Cell(self.cell_options()),
            _ => {
                let options = PointOptions::default().pixel_degrees(self.pixel);
                Method::Point(options.refine_squares(self.refine).refine_patches(self.patches))
            }
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
            ("--width 99999999999999999999", "16384"),
            ("--frames 0", "1..=100000"),
            ("--frames 99999999999", "1..=100000"),
            ("--frames NaN", "--frames"),
            ("--seed -1", "--seed"),
            ("--seed NaN", "--seed"),
            ("--grid 0x0x0", "from 1 to 8192"),
            ("--grid 9999x1x1", "from 1 to 8192"),
            ("--grid 8192x8192x8192", "549755813888 cells"),
            ("--grid 1x1", "three numbers"),
            ("--grid NaNx1x1", "three numbers"),
            ("--grid=-1x1x1", "three numbers"),
            ("--mask 0", "power of two"),
            ("--mask 100", "power of two"),
            ("--mask 8192", "4096"),
            ("--pixel NaN", "11.25"),
            ("--pixel inf", "11.25"),
            ("--pixel 0", "11.25"),
            ("--pixel=-1", "11.25"),
            ("--refine -1", "--refine"),
            ("--samples 99999999999", "10000"),
            ("--samples 10001", "10000"),
            ("--candidates -1", "--candidates"),
            ("--scene house", "spheres, city"),
            ("--width 0 --samples 0", "nothing would be checked"),
            ("--width 0 --candidates 0", "nothing would be checked"),
        ] {
            let said = options(line).expect_err(line);
            assert!(said.contains(word), "{line}: {said}");
        }
    }

    #[test]
    fn the_ends_of_each_range_are_taken_and_every_setting_is_one_of_the_librarys() {
        for line in [
            "",
            "--width 0",
            "--width 16 --samples 0",
            "--width 16384 --candidates 0",
            "--frames 1",
            "--frames 100000 --samples 10000",
            "--mask 64 --pixel 0.03",
            "--mask 4096 --pixel 11.25 --refine 0 --patches 4294967295",
            "--grid 1x1x8192 --seed 18446744073709551615",
        ] {
            let options = options(line).expect(line);
            assert!(Query::with_method(options.query_method()).is_ok(), "{line}");
        }
        assert_eq!(options("--grid fit").unwrap().grid, Some(GridChoice::Fit));
        assert_eq!(options("--grid 3x2x1").unwrap().grid, Some(GridChoice::Dims(UVec3::new(3, 2, 1))));
        assert_eq!(options("").unwrap().query_method(), Method::default());
    }

    #[test]
    fn help_tells_the_exit_codes_and_the_options_are_sound() {
        Options::command().debug_assert();
        assert!(Options::command().render_help().to_string().contains("4  nothing was checked"));
    }
}
