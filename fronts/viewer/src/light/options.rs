//! The command line, and what it asks for, done. All that can be checked without a device is refused
//! before anything is loaded.

use std::ops::RangeInclusive;

use casca_lightmap::program::{self, Lighting};
use casca_tools::command_line::{EXIT_CODES, point};
use clap::{Args, Subcommand};
use glam::DVec3;

use crate::common::{Common, Failed, number, one_of};
use crate::light::picture::{LAYERS, Layer};
use crate::light::renderer::Settings;
use crate::light::scene::Room;

/// Balls that may be added to a scene.
const BALLS: RangeInclusive<i64> = 0..=1000;
/// Cells from the eye to the end of the window: 512 finer ones, as the library takes them.
const WINDOWS: RangeInclusive<i64> = 0..=64;
/// Factors of light on the screen: less or more is black or white in any scene with lights of this
/// world.
pub const EXPOSURES: RangeInclusive<f32> = 1e-4..=1e4;

/// Light with all of its bounces, by a radiosity cache: it crosses no wall
#[derive(Debug, Clone, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true, args_conflicts_with_subcommands = true,
    mut_arg("file", |file| file.help("A glTF 2.0 file (.glb or .gltf), cornell or cornell-point [default: cornell]"))
)]
pub struct Options {
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    /// How the scene is lit.
    #[command(flatten)]
    pub lighting: Lighting,
    /// What is done instead of showing it.
    #[command(subcommand)]
    pub instead: Option<Instead>,
    /// Rays of each surface in a cell that the picture reads, others send a quarter; a slider.
    #[arg(skip = 64_u32)]
    pub rays: u32,
    /// Cells are four times finer up to so many cells from the eye, up to 64
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(WINDOWS))]
    pub window: u32,
    /// Adds so many balls that move, up to 1000
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(BALLS))]
    pub balls: u16,
    /// Light times this is shown; 1 is white; 0.0001 to 10000 [default: by the picture's own light]
    #[arg(long, value_parser = |text: &str| number(text, EXPOSURES))]
    pub exposure: Option<f32>,
    /// Looks from x,y,z
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point, requires = "to")]
    pub from: Option<DVec3>,
    /// Looks to x,y,z
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point, requires = "from")]
    pub to: Option<DVec3>,
    /// Layers to draw: picture, albedo, normals, direct, indirect, mirrored, or all
    #[arg(long, value_delimiter = ',', default_value = "picture", requires = "headless",
        value_parser = |text: &str| if text == "all" { Ok(None) } else { one_of(text, &LAYERS).map(Some) })]
    pub layers: Vec<Option<Layer>>,
}

/// What a scene is lit for besides being shown.
#[derive(Debug, Clone, Subcommand)]
pub enum Instead {
    /// Bakes lightmaps and probes into files.
    Bake(program::Options),
}

impl Options {
    pub(super) fn open(&self) -> Result<Room, Failed> {
        let name = self.common.name().unwrap_or_else(|| "cornell".to_owned());
        let mut start = Room::open(&name, self.balls)?;
        self.lighting.add(&mut start.scene);
        start.look(self.from.zip(self.to).map(|(from, to)| (from.as_vec3(), to.as_vec3())));
        Ok(start)
    }

    /// How light is gathered.
    pub fn settings(&self) -> Settings {
        Settings { resolution: self.lighting.resolution, rays: self.rays, window: self.window }
    }

    /// The layers to draw. Refuses options that do not go together.
    ///
    /// # Errors
    /// Names the options, and what to do.
    pub fn check(&self) -> Result<Vec<Layer>, String> {
        if self.from.is_some() && self.from == self.to {
            return Err(
                "--from and --to are the same point: the camera looks from one to the other".to_owned()
            );
        }
        let some = self.layers.iter().copied().collect::<Option<Vec<Layer>>>();
        Ok(some.unwrap_or_else(|| LAYERS.map(|(_, layer)| layer).to_vec()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{Shows, parsed};
    use glam::Vec3;

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
            ("--from 1,2,3e38 --to 1,2,3", "numbers up to 1e15"),
            ("--headless --layers colour", "indirect"),
            ("bake hall.glb", "--out"),
            ("bake hall.glb --out lit.glb --resolution 7", "8..=512"),
            ("hall.glb --headless bake hall.glb --out lit.glb", "cannot be used"),
        ] {
            let said = read(&words.split(' ').collect::<Vec<_>>()).expect_err(words);
            assert!(said.contains(word), "{words}: {said}");
        }
        let words = "hall.glb --sun 0,-2,0 --from 1,2,3 --to -1,2,3 --headless --layers albedo,picture";
        let (options, layers) = read(&words.split(' ').collect::<Vec<_>>()).unwrap();
        assert_eq!(layers, [Layer::Albedo, Layer::Picture]);
        let wanted = (Some(Vec3::NEG_Y), Some(DVec3::new(1.0, 2.0, 3.0)));
        assert_eq!((options.lighting.sun, options.from), wanted);
        assert_eq!(
            read(&["--headless", "--layers", "direct,all"]).unwrap().1,
            LAYERS.map(|(_, layer)| layer)
        );
    }

    fn said(words: &[&str]) -> String {
        parsed::<Options>(words).and_then(|o| o.run().map_err(|e| e.to_string())).expect_err(words[1])
    }

    #[test]
    fn scenes_that_cannot_be_had_are_named_before_anything_is_drawn() {
        let folder = std::env::temp_dir().join(format!("casca-lit-files-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = |name: &str, bytes: &[u8]| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).unwrap();
            path.to_str().unwrap().to_owned()
        };
        let empty = br#"{"asset": {"version": "2.0"}}"#;
        let lit = folder.join("lit.glb");
        let bake = parsed::<Options>(&["bake", "no/such.glb", "--out", lit.to_str().unwrap()]).unwrap();
        assert!(bake.run().unwrap_err().to_string().contains("no/such.glb: ") && !lit.exists());
        for (scene, word) in [
            ("no/such.glb".to_owned(), "no/such.glb: cannot be read"),
            (file("broken.glb", b"glTF, but no more"), "broken.glb: is not a valid"),
            (file("empty.gltf", empty), "empty.gltf: holds no triangles"),
            (file("house.obj", b"v 0 0 0"), "no .glb or .gltf file"),
            (folder.to_str().unwrap().to_owned(), "no .glb or .gltf file"),
            ("house".to_owned(), "cornell-point"),
            (String::new(), "[FILE]"),
        ] {
            let said = said(&["--headless", &scene]);
            assert!(said.contains(word), "{scene}: {said}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
