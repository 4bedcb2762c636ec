//! The command `casca light bake`.

use std::path::{Path, PathBuf};

use casca_radiosity::Light;
use casca_radiosity::lit::LitScene;
use casca_tools::command_line::{EXIT_CODES, Outcome, PathError, direction, say, try_writing};
use clap::{Args, value_parser};
use glam::Vec3;

use crate::{Level, Settings, beside, light};

/// Irradiance of the sun that is added.
const SUN: Vec3 = Vec3::new(10.5, 10.0, 9.0);
/// Samples of the path tracer for each texel that is compared.
const SAMPLES: u32 = 1024;

/// How a scene is lit, for all programs that light one.
#[derive(Debug, Clone, Args)]
pub struct Lighting {
    /// Cells along the longest axis, 8 to 512
    // Fewer show nothing, and the library takes no more.
    #[arg(long, default_value_t = 64, value_parser = value_parser!(u32).range(8..=512))]
    pub resolution: u32,
    /// Adds a sun that shines along x,y,z, with an irradiance of 10
    // Points may start with a minus, and are no single negative number.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub sun: Option<Vec3>,
}

impl Lighting {
    /// Adds the sun to a scene.
    pub fn add(&self, scene: &mut LitScene) {
        let sun = |direction| Light::Sun { direction, irradiance: SUN, half_angle: 0.0 };
        scene.lights.extend(self.sun.map(sun));
    }
}

/// Bakes lightmaps and a grid of probes for a level, which Bevy reads as Lightmap and IrradianceVolume
#[derive(Debug, Clone, Args)]
#[command(after_help = EXIT_CODES)]
pub struct Options {
    /// The level: a glTF 2.0 file (.glb or .gltf)
    level: PathBuf,
    /// The lit level to write (.glb); its images are written beside it
    #[arg(long)]
    out: PathBuf,
    /// Texels a metre
    #[arg(long, default_value_t = 8.0)]
    texels: f32,
    /// Texels along the longest side of a lightmap; there are more where one is too small
    #[arg(long, default_value_t = 4096)]
    side: u32,
    /// Metres between probes
    #[arg(long, default_value_t = 1.0)]
    probes: f32,
    /// Leaves the lights of the file to the engine: lightmaps have what comes from them by bounces
    #[arg(long)]
    live: bool,
    /// Compares so many texels with a path tracer, which takes long
    #[arg(long, default_value_t = 0)]
    check: usize,
    #[command(flatten)]
    lighting: Lighting,
}

/// Does what the options say.
///
/// # Errors
/// The level cannot be read or lit, or files cannot be written.
pub fn run(options: &Options) -> Result<Outcome, Box<dyn std::error::Error>> {
    try_writing(&options.out)?;
    let named = |why: &dyn std::fmt::Display| format!("{}: {why}", options.level.display());
    let bytes = std::fs::read(&options.level).map_err(|why| named(&why))?;
    let name = options.out.file_stem().unwrap_or_default().to_string_lossy();
    let mut level = Level::read(&name, &bytes, options.level.parent()).map_err(|why| named(&why))?;
    level.warnings.iter().for_each(|line| eprintln!("warning: {}", named(line)));
    options.lighting.add(&mut level.scene);
    let settings = Settings {
        texels: options.texels,
        side: options.side,
        spacing: options.probes,
        cells: options.lighting.resolution,
        live: options.live,
        ..Settings::default()
    };
    let mut told = (String::new(), 0);
    let found = light(&level.scene, &level.placed, &settings, &mut |what, done, all| {
        let tenth = 10 * done / all.max(1);
        if (what, tenth) != (told.0.as_str(), told.1) {
            eprintln!("{what}: {done} of {all}");
            told = (what.to_owned(), tenth);
        }
    })
    .map_err(|why| named(&why))?;
    for (name, bytes) in level.lit(&name, &found, &settings).map_err(|why| named(&why))? {
        let path = options.out.parent().unwrap_or(Path::new("")).join(name);
        // The level gets the name that was asked for, whatever its ending is.
        let path = if path.extension().is_some_and(|e| e == "glb") { &options.out } else { &path };
        std::fs::write(path, &bytes).map_err(PathError::write(path))?;
        say(format_args!("{}: {} bytes", path.display(), bytes.len()));
    }
    let (atlas, n, lit, bytes) = (&found.atlas, found.probes.counts, found.lit, found.statistics.bytes);
    let (pages, width, height, megabytes) = (atlas.page_count, atlas.width, atlas.height, bytes as f64 / 1e6);
    say(format_args!(
        "{lit} lit texels on {pages} pages of {width} x {height}, {} probes, {megabytes:.1} MB of cache",
        n.to_array().map(|n| n.to_string()).join(" x ")
    ));
    if options.check > 0 {
        let b = beside(&level.scene, &level.placed, &found, options.check, SAMPLES);
        let (texels, light, [error, noise]) =
            (b.texels, 1.0 + b.difference, [b.error, b.noise].map(|x| 100.0 * x));
        say(format_args!(
            "beside a path tracer at {texels} texels: mean light {light:.3}, mean error {error:.1}%, \
             its own noise {noise:.1}%"
        ));
    }
    Ok(Outcome::Well)
}
