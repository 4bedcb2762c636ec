//! Light that bounces, in a window or into pictures.
//!
//! `cargo run --release -p casca-light -- FILE.glb` opens a window; `-- --help` lists the options.

mod headless;
mod scene;
mod window;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use casca_lab::command_line::{EXIT_CODES, Outcome, finish, make_folder, say};
use casca_light::cones::ConeCount;
use casca_light::picture::Layer;
use casca_light::renderer::Settings;
use casca_stage::gpu::Gpu;
use clap::Parser;
use glam::Vec3;

use crate::scene::Start;

/// Width and height of pictures and of the window.
const SIDES: std::ops::RangeInclusive<u32> = 1..=8192;
/// Balls that may be added to a scene.
const MOST_BALLS: i64 = 1000;

#[derive(Debug, Parser)]
#[command(
    about = "Light that bounces between surfaces, by cones through voxels: in a window, or into pictures",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
struct Options {
    /// A glTF 2.0 file (.glb or .gltf), or cornell, cornell-point, furnace, light-box, plane or emissive
    #[arg(default_value = "cornell")]
    scene: String,
    /// Cells along the longest axis, 16 to 512
    #[arg(long, default_value_t = 128)]
    resolution: u32,
    /// Length of steps along cones in texels, 0.1 to 5; light leaks above 1
    #[arg(long, default_value_t = 1.0)]
    step: f32,
    /// How far cones gather light, as a share of the longest edge of the grid, 0.01 to 2
    #[arg(long, default_value_t = 1.0)]
    reach: f32,
    /// Half the angle of the narrowest reflection, in degrees, 0.1 to 45
    #[arg(long, default_value_t = 1.0)]
    aperture: f32,
    /// Gathers diffuse light with 16 cones instead of 6
    #[arg(long)]
    fine: bool,
    /// Leaves out the second bounce
    #[arg(long)]
    no_bounce: bool,
    /// Brings light up to date only where the picture can read it
    #[arg(long)]
    cull: bool,
    /// Adds so many balls that move
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MOST_BALLS))]
    balls: u16,
    /// Light times this is shown; 1 is white
    #[arg(long, default_value_t = 1.0)]
    exposure: f32,
    /// Adds a sun that shines along x,y,z, with an irradiance of 10
    #[arg(long, value_parser = parse_point)]
    sun: Option<Vec3>,
    /// Looks from x,y,z
    #[arg(long, value_parser = parse_point, requires = "to")]
    from: Option<Vec3>,
    /// Looks to x,y,z
    #[arg(long, value_parser = parse_point, requires = "from")]
    to: Option<Vec3>,
    /// Draws pictures without a window
    #[arg(long)]
    headless: bool,
    /// Prints the time of each stage at 64, 128 and 256 cells, beside the thesis' ratios
    #[arg(long)]
    time: bool,
    /// Cells along the longest axis at which stages are timed
    #[arg(long, value_delimiter = ',', default_value = "64,128,256", requires = "time")]
    times: Vec<u32>,
    /// Layers to draw: picture, albedo, normals, direct, indirect, occlusion, voxels, or all
    #[arg(long, value_delimiter = ',', default_value = "picture")]
    layers: Vec<String>,
    /// Also draws each picture with a path tracer of so many samples a pixel, and compares the two
    #[arg(long, default_value_t = 0, requires = "headless", value_parser = clap::value_parser!(u32).range(0..=4096))]
    truth: u32,
    /// Where pictures go
    #[arg(long, default_value = "target/light")]
    out: PathBuf,
    /// Size of pictures and of the window, up to 8192x8192
    #[arg(long, default_value = "1024x768", value_parser = parse_size)]
    size: (u32, u32),
    /// Draws with a software adapter
    #[arg(long)]
    software: bool,
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
    fn settings(&self) -> Settings {
        Settings {
            resolution: self.resolution,
            step: self.step,
            reach: self.reach,
            cones: if self.fine { ConeCount::Sixteen } else { ConeCount::Six },
            aperture: self.aperture.to_radians().tan(),
            bounce: !self.no_bounce,
        }
    }

    fn layers(&self) -> Result<Vec<Layer>, String> {
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

    fn start(&self) -> Result<Start, Box<dyn Error>> {
        let mut start = Start::open(&self.scene, self.balls)?;
        start.change(self.sun, self.from.zip(self.to));
        Ok(start)
    }
}

fn run(options: &Options) -> Result<Outcome, Box<dyn Error>> {
    let layers = options.layers()?;
    let start = options.start()?;
    if !(options.headless || options.time) {
        window::open(start, options)?;
        return Ok(Outcome::Well);
    }
    if options.headless {
        make_folder(&options.out)?;
    }
    let gpu = Gpu::headless(options.software)?;
    say(format_args!("drawing on {}", gpu.name));
    if options.headless {
        headless::pictures(&gpu, &start, options, &layers)?;
    }
    if options.time {
        headless::time(&gpu, &start, options)?;
    }
    Ok(Outcome::Well)
}

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(words: &[&str]) -> String {
        let options = Options::try_parse_from(std::iter::once(&"light").chain(words));
        let failed = |e: Box<dyn Error>| e.to_string();
        options.map_err(|e| e.to_string()).and_then(|o| run(&o).map_err(failed)).expect_err(words[0])
    }

    #[test]
    fn what_is_wrong_is_named_before_anything_is_drawn() {
        let broken = std::env::temp_dir().join(format!("casca-light-{}.glb", std::process::id()));
        std::fs::write(&broken, "glTF, but no more").unwrap();
        let broken_name = broken.to_str().unwrap();
        for (words, word) in [
            (vec!["--headless", "no/such.glb"], "no/such.glb"),
            (vec!["--headless", broken_name], broken_name),
            (vec!["--headless", "house"], "cornell-point"),
            (vec!["--headless", "--layers", "colour"], "occlusion"),
            (vec!["--size", "0x720"], "from 1 to 8192"),
            (vec!["--size", "NaNx1"], "from 1 to 8192"),
            (vec!["--balls", "70000"], "--balls"),
            (vec!["--sun", "1,2"], "three numbers"),
            (vec!["--from", "1,2,3"], "--to"),
        ] {
            let said = said(&words);
            assert!(said.contains(word), "{words:?}: {said}");
        }
        std::fs::remove_file(&broken).unwrap();
    }

    #[test]
    fn absurd_settings_are_refused_with_what_is_possible() {
        if Gpu::headless(false).is_err() {
            return println!("skipped: no adapter");
        }
        let out = std::env::temp_dir();
        for (option, value, word) in [
            ("--resolution", "0", "from 16 to 512"),
            ("--resolution", "4294967295", "from 16 to 512"),
            ("--step", "NaN", "from 0.1 to 5"),
            ("--reach", "inf", "from 0.01 to 2"),
            ("--aperture", "90", "from 0.001 to 1"),
        ] {
            let said = said(&["--headless", "--out", out.to_str().unwrap(), option, value]);
            assert!(said.contains(word), "{option} {value}: {said}");
        }
    }
}
