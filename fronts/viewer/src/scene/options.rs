//! The command line, and what it asks for, done.

use casca_scenes::generated::{SceneKind, SceneOptions};
use casca_scenes::name::SceneName;
use casca_tools::command_line::EXIT_CODES;
use clap::Args;

use crate::common::{Common, Failed, one_of};
use crate::scene::overlays::{LAYERS, Layer};
use crate::scene::playback::{METHODS, Method};

/// Pictures of a scene, if no other number is given.
pub const FRAMES: u32 = 5;

/// Draws exactly the objects that casca finds visible
///
/// Without a file the window shows a city from above: the objects that a camera in its streets
/// sees, and those that are culled.
#[derive(Debug, Clone, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("file", |file| file.help("glTF 2.0 files (.glb), or spheres, city, rooms, forest, crowd, ...; comma-separated [default: the city from above; without a window the scenes of solids]"))
)]
pub struct Options {
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    /// How what is drawn is decided: all, frustum, point or cell
    #[arg(long, default_value = "point", value_parser = |text: &str| one_of(text, &METHODS))]
    pub method: Method,
    /// Compares pictures of everything with pictures of what point and cell leave; exits with 1 if
    /// they lose a pixel
    #[arg(long)]
    pub proof: bool,
    /// Pictures show the whole scene from above, with the camera, its frustum and the culled
    /// objects
    #[arg(long, requires = "headless")]
    pub birds_eye: bool,
    /// Also writes the pictures as one animated PNG
    #[arg(long, requires = "headless")]
    pub animation: bool,
    /// Layers over the pictures, comma-separated: hidden, volumes, frustum
    #[arg(long, value_delimiter = ',', value_parser = |text: &str| one_of(text, &LAYERS))]
    pub layers: Vec<Layer>,
    /// Shows this frame of the path only, standing still
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=100_000), conflicts_with_all = ["animation", "proof"])]
    pub at: Option<u32>,
    /// Pictures without numbers
    #[arg(long, requires = "headless", conflicts_with = "birds_eye")]
    pub bare: bool,
    /// Seed of procedural scenes
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

impl Options {
    /// The scenes that are asked for; those of solids if none is, the city first.
    ///
    /// # Errors
    /// Names the one that is none, and what there is.
    pub fn scenes(&self) -> Result<Vec<SceneName>, Failed> {
        let Some(names) = self.common.name() else {
            let mut solids = SceneKind::SOLIDS;
            solids.sort_by_key(|kind| *kind != SceneKind::City);
            return Ok(solids.map(SceneName::Built).to_vec());
        };
        let scene = |name: &str| name.parse().map_err(|why: String| format!("{name:?} is {why}").into());
        names.split(',').map(scene).collect()
    }

    /// What procedural scenes are made of.
    pub fn made(&self) -> SceneOptions {
        SceneOptions { seed: self.seed, ..SceneOptions::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{Shows, parsed};

    #[test]
    fn absurd_values_are_refused_with_what_is_expected() {
        for (words, word) in [
            (["--size", "0x720"], "from 1 to 8192"),
            (["--frames", "0"], "1..=100000"),
            (["--layers", "hidden,all"], "frustum"),
            (["--method", "best"], "point"),
            (["--seed", "-1"], "--seed"),
        ] {
            let said = parsed::<Options>(&words).expect_err(words[1]);
            assert!(said.contains(word), "{words:?}: {said}");
        }
        assert_eq!(parsed::<Options>(&["--size", "8192x1"]).unwrap().common.size, (8192, 1));
        assert!(parsed::<Options>(&["--animation"]).unwrap_err().contains("--headless"));
    }

    #[test]
    fn scenes_are_names_and_files() {
        let scenes = |words: &[&str]| parsed::<Options>(words).unwrap().scenes();
        let said = scenes(&["city,house"]).unwrap_err().to_string();
        assert!(said.contains("\"house\"") && said.contains("spheres, city"), "{said}");
        let named = scenes(&["rooms,a.glb"]).unwrap();
        assert_eq!(named, [SceneName::Built(SceneKind::Rooms), SceneName::File("a.glb".into())]);
        let all = scenes(&[]).unwrap();
        assert_eq!((all.len(), &all[0]), (SceneKind::SOLIDS.len(), &SceneName::Built(SceneKind::City)));
    }

    #[test]
    fn a_missing_scene_or_a_folder_that_is_none_is_named_before_anything_is_drawn() {
        let place = std::env::temp_dir().join(format!("casca-viewer-{}", std::process::id()));
        std::fs::write(&place, "no folder").unwrap();
        let failure = |words: &[&str]| parsed::<Options>(words).unwrap().run().unwrap_err().to_string();
        let name = place.to_str().unwrap();
        assert!(failure(&["--headless", "--out", name]).contains(name));
        assert!(failure(&["--proof", "--out", name]).contains(name));
        assert!(failure(&["--headless", "city,no/such.glb"]).contains("no/such.glb"));
        std::fs::remove_file(&place).unwrap();
    }
}
