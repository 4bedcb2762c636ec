//! A procedural scene as a level in a file.

use std::path::PathBuf;

use casca_lab::arguments::{FRAMES, Failure};
use casca_scenes::export;
use casca_scenes::generated::{self, SceneKind, SceneOptions};
use casca_tools::command_line::{EXIT_CODES, Outcome, say, try_writing};
use clap::{Parser, value_parser};

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Writes a procedural scene as a glTF 2.0 file (.glb), which `walk --scene` opens",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// A procedural scene, as `walk` takes it
    #[arg(long, default_value = "rooms")]
    scene: SceneKind,
    /// Frames of the camera's path, 1 to 100000
    #[arg(long, default_value_t = 150, value_parser = value_parser!(u32).range(FRAMES))]
    frames: u32,
    /// Seed of the scene
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The file
    #[arg(long, default_value = "target/level/level.glb")]
    out: PathBuf,
}

/// Writes the file.
pub fn run(options: &Options) -> Result<Outcome, Failure> {
    try_writing(&options.out)?;
    let scene_options =
        SceneOptions { seed: options.seed, frames: options.frames as usize, ..SceneOptions::default() };
    let mut world = generated::build(options.scene, &scene_options);
    export::save(&mut world, &options.out)?;
    say(format_args!(
        "{}: {} objects and {} frames in {}",
        world.name,
        world.objects.len(),
        world.frames,
        options.out.display()
    ));
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_is_named_before_anything_is_built() {
        let folder = std::env::temp_dir().join(format!("casca-level-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let name = folder.to_str().unwrap();
        let options = Options::try_parse_from(["level", "--out", name]).unwrap();
        assert!(run(&options).unwrap_err().to_string().contains(name));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
