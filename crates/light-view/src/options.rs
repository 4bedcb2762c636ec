//! The command line.

use std::error::Error;
use std::path::PathBuf;

use casca_lab::command_line::EXIT_CODES;
use casca_light::cones::ConeCount;
use casca_light::picture::Layer;
use casca_light::renderer::Settings;
use clap::Parser;
use glam::Vec3;

use crate::scene::Start;

/// Width and height of pictures and of the window.
const SIDES: std::ops::RangeInclusive<u32> = 1..=8192;
/// Balls that may be added to a scene.
const MOST_BALLS: i64 = 1000;

/// What the command line says.
#[derive(Debug, Parser)]
#[command(
    about = "Light that bounces between surfaces, by cones through voxels: in a window, or into pictures",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// A glTF 2.0 file (.glb or .gltf), or cornell, cornell-point, furnace, light-box, plane or emissive
    #[arg(default_value = "cornell")]
    pub scene: String,
    /// Cells along the longest axis, 16 to 512
    #[arg(long, default_value_t = 128)]
    pub resolution: u32,
    /// Length of steps along cones in texels, 0.1 to 5; light leaks above 1
    #[arg(long, default_value_t = 1.0)]
    pub step: f32,
    /// How far cones gather light, as a share of the longest edge of the grid, 0.01 to 2
    #[arg(long, default_value_t = 1.0)]
    pub reach: f32,
    /// Half the angle of the narrowest reflection, in degrees, 0.1 to 45
    #[arg(long, default_value_t = 1.0)]
    pub aperture: f32,
    /// Gathers diffuse light with 16 cones instead of 6
    #[arg(long)]
    pub fine: bool,
    /// Leaves out the second bounce
    #[arg(long)]
    pub no_bounce: bool,
    /// Brings light up to date only where the picture can read it
    #[arg(long)]
    pub cull: bool,
    /// Adds so many balls that move
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MOST_BALLS))]
    pub balls: u16,
    /// Light times this is shown; 1 is white
    #[arg(long, default_value_t = 1.0)]
    pub exposure: f32,
    /// Adds a sun that shines along x,y,z, with an irradiance of 10
    #[arg(long, value_parser = parse_point)]
    pub sun: Option<Vec3>,
    /// Looks from x,y,z
    #[arg(long, value_parser = parse_point, requires = "to")]
    pub from: Option<Vec3>,
    /// Looks to x,y,z
    #[arg(long, value_parser = parse_point, requires = "from")]
    pub to: Option<Vec3>,
    /// Draws pictures without a window
    #[arg(long)]
    pub headless: bool,
    /// Prints the time of each stage at 64, 128 and 256 cells, beside the thesis' ratios
    #[arg(long)]
    pub time: bool,
    /// Cells along the longest axis at which stages are timed
    #[arg(long, value_delimiter = ',', default_value = "64,128,256", requires = "time")]
    pub times: Vec<u32>,
    /// Layers to draw: picture, albedo, normals, direct, indirect, occlusion, voxels, or all
    #[arg(long, value_delimiter = ',', default_value = "picture")]
    pub layers: Vec<String>,
    /// Also draws each picture with a path tracer of so many samples a pixel, and compares the two
    #[arg(long, default_value_t = 0, requires = "headless", value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub truth: u32,
    /// Where pictures go
    #[arg(long, default_value = "target/light")]
    pub out: PathBuf,
    /// Size of pictures and of the window, up to 8192x8192
    #[arg(long, default_value = "1024x768", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Draws with a software adapter
    #[arg(long)]
    pub software: bool,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    casca_stage::canvas::parse_size(text, SIDES)
}

fn parse_point(text: &str) -> Result<Vec3, String> {
    let numbers: Vec<f32> =
        text.split(',').filter_map(|n| n.parse().ok()).filter(|n: &f32| n.is_finite()).collect();
    let point = <[f32; 3]>::try_from(numbers).map(Vec3::from_array);
    point.map_err(|_| "expected three numbers such as 0.2,-1,0".to_owned())
}

impl Options {
    /// How light is gathered.
    pub fn settings(&self) -> Settings {
        Settings {
            resolution: self.resolution,
            step: self.step,
            reach: self.reach,
            cones: if self.fine { ConeCount::Sixteen } else { ConeCount::Six },
            aperture: self.aperture.to_radians().tan(),
            bounce: !self.no_bounce,
        }
    }

    /// The layers to draw.
    pub fn layers(&self) -> Result<Vec<Layer>, String> {
        if self.layers.iter().any(|name| name == "all") {
            return Ok(Layer::EVERY.to_vec());
        }
        let find = |name: &String| {
            let found = Layer::EVERY.into_iter().find(|layer| layer.name() == name);
            let names = Layer::EVERY.map(Layer::name).join(", ");
            found.ok_or_else(|| format!("no layer is called {name:?}; there are {names} and all"))
        };
        self.layers.iter().map(find).collect()
    }

    /// The scene.
    pub fn start(&self) -> Result<Start, Box<dyn Error>> {
        let mut start = Start::open(&self.scene, self.balls)?;
        start.change(self.sun, self.from.zip(self.to));
        Ok(start)
    }
}
