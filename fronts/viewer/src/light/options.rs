//! The command line. All that can be checked without a device is refused here, before anything is
//! loaded.

use std::ops::RangeInclusive;

use casca_radiosity::lit::MOST_PIXELS;
use casca_tools::command_line::EXIT_CODES;
use clap::Args;
use glam::Vec3;

use crate::common::{Common, direction, number, point};
use crate::light::layer::Layer;
use crate::light::renderer::Settings;

/// Balls that may be added to a scene.
const BALLS: RangeInclusive<i64> = 0..=1000;
/// Samples of a pixel of the path tracer; 0 is no path tracer.
const SAMPLES: RangeInclusive<i64> = 0..=4096;
/// Cells along the longest axis, as the library takes them; fewer show nothing.
const RESOLUTIONS: RangeInclusive<i64> = 8..=512;
/// Rays of a state, as the library takes them.
const RAYS: RangeInclusive<i64> = 1..=4096;
/// Cells from the eye to the end of the window: 512 finer ones, as the library takes them.
const WINDOWS: RangeInclusive<i64> = 0..=64;
/// Factors of light on the screen: less or more is black or white in any scene with lights of this
/// world.
pub const EXPOSURES: RangeInclusive<f32> = 1e-4..=1e4;
/// The largest coordinate of an eye: squares of such distances are still finite.
const FARTHEST_EYE: f32 = 1e15;

/// Light with all of its bounces, by a radiosity cache: it crosses no wall
#[derive(Debug, Clone, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("file", |file| file.help("A glTF 2.0 file (.glb or .gltf), or cornell, cornell-point or emissive [default: cornell]")),
    mut_arg("frames", |frames| frames.help("With --time: times are medians of so many frames (5 if not given); else the window closes after so many"))
)]
pub struct Options {
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    /// Cells along the longest axis, 8 to 512
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(RESOLUTIONS))]
    pub resolution: u32,
    /// Rays of each surface in a cell that the picture reads, 1 to 4096; others send a quarter
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(RAYS))]
    pub rays: u32,
    /// Cells are four times finer up to so many cells from the eye, up to 64
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(WINDOWS))]
    pub window: u32,
    /// Adds so many balls that move, up to 1000
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(BALLS))]
    pub balls: u16,
    /// Light times this is shown; 1 is white; 0.0001 to 10000
    #[arg(long, default_value_t = 1.0, value_parser = |text: &str| number(text, EXPOSURES))]
    pub exposure: f32,
    /// Adds a sun that shines along x,y,z, with an irradiance of 10
    // Points may start with a minus, and are no single negative number.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub sun: Option<Vec3>,
    /// Looks from x,y,z
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_eye, requires = "to")]
    pub from: Option<Vec3>,
    /// Looks to x,y,z
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_eye, requires = "from")]
    pub to: Option<Vec3>,
    /// Prints the time of each stage: of a first picture, and of those after the balls have moved
    #[arg(long)]
    pub time: bool,
    /// Layers to draw: picture, albedo, normals, direct, indirect, mirrored, or all
    #[arg(long, value_delimiter = ',', default_value = "picture", requires = "headless")]
    pub layers: Vec<String>,
    /// Also draws the layer picture with a path tracer of so many samples a pixel, and compares the
    /// two; up to 4096
    #[arg(long, default_value_t = 0, requires = "headless", value_parser = clap::value_parser!(u32).range(SAMPLES))]
    pub truth: u32,
}

fn parse_eye(text: &str) -> Result<Vec3, String> {
    let eye = point(text)?.as_vec3();
    if eye.abs().max_element() <= FARTHEST_EYE {
        return Ok(eye);
    }
    Err(format!("{text} is too far away: numbers up to {FARTHEST_EYE:e} are possible"))
}

impl Options {
    /// The file or generated scene.
    pub fn scene(&self) -> String {
        self.common.name().unwrap_or_else(|| "cornell".to_owned())
    }

    /// How light is gathered.
    pub fn settings(&self) -> Settings {
        Settings { resolution: self.resolution, rays: self.rays, window: self.window }
    }

    /// The layers to draw. Refuses options that do not go together.
    ///
    /// # Errors
    /// Names the options, and what to do.
    pub fn check(&self) -> Result<Vec<Layer>, String> {
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from == to
        {
            return Err(
                "--from and --to are the same point: the camera looks from one to the other".to_owned()
            );
        }
        let layers = if self.layers.iter().any(|name| name == "all") {
            Layer::EVERY.to_vec()
        } else {
            self.layers.iter().map(|name| layer(name)).collect::<Result<_, _>>()?
        };
        if self.truth > 0 && !layers.contains(&Layer::Picture) {
            return Err("--truth compares the layer picture, which is not among --layers: add it".to_owned());
        }
        let (width, height) = self.common.drawing.size;
        if self.truth > 0 && width as usize * height as usize > MOST_PIXELS {
            return Err(format!(
                "--size {width}x{height} is too large for --truth: the path tracer draws up to {MOST_PIXELS} pixels"
            ));
        }
        Ok(layers)
    }
}

fn layer(name: &str) -> Result<Layer, String> {
    let found = Layer::EVERY.into_iter().find(|layer| layer.name() == name);
    let names = Layer::EVERY.map(Layer::name).join(", ");
    found.ok_or_else(|| format!("no layer is called {name:?}; there are {names} and all"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

    fn read(words: &[&str]) -> Result<(Options, Vec<Layer>), String> {
        let options = parsed::<Options>(words)?;
        options.check().map(|layers| (options, layers))
    }

    #[test]
    fn wrong_values_and_pairs_are_refused_with_what_is_possible() {
        for (words, word) in [
            ("--resolution 7", "8..=512"),
            ("--exposure inf", "from 0.0001 to 10000"),
            ("--sun 1,2", "three numbers"),
            ("--sun 0,-0,1e-30", "no direction"),
            ("--from 1,2,3", "--to"),
            ("--from 1,2,3 --to 1,2,3", "same point"),
            ("--from 1,2,3e38 --to 1,2,3", "too far away"),
            ("--headless --layers colour", "indirect"),
            ("--headless --truth 4 --layers albedo", "--layers: add it"),
            ("--headless --truth 4 --size 8192x8192", "too large for --truth"),
        ] {
            let said = read(&words.split(' ').collect::<Vec<_>>()).expect_err(words);
            assert!(said.contains(word), "{words}: {said}");
        }
        let words = "hall.glb --sun 0,-2,0 --from 1,2,3 --to -1,2,3 --headless --layers albedo,picture";
        let (options, layers) = read(&words.split(' ').collect::<Vec<_>>()).unwrap();
        assert_eq!(layers, [Layer::Albedo, Layer::Picture]);
        assert_eq!((options.sun, options.from), (Some(Vec3::NEG_Y), Some(Vec3::new(1.0, 2.0, 3.0))));
        assert_eq!(read(&["--headless", "--layers", "direct,all"]).unwrap().1, Layer::EVERY);
    }
}
