//! The command line, and what it asks for, done.

use casca_maps::{Drawing, HARBOUR};
use casca_tools::command_line::EXIT_CODES;
use clap::Args;

use crate::common::{Common, Failed};
use crate::plane::level::Level;

/// The longest side of a map, in tiles: larger ones are no picture.
const LONGEST: u32 = 512;
/// Seconds that a picture shows the level after its start, if no frames are given.
pub(super) const FRAMES: u32 = 90;

/// Shows what an eye sees on a map, and which guards it can see
///
/// In the window: W A S D walk (Shift: faster), the mouse moves the eye, Space pauses, N makes
/// another floor plan.
#[derive(Debug, Clone, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("file", |file| file.help("A map of Tiled (.tmx, .tmj), or one drawn with letters: # wall, + door, g guard, @ start [default: a harbour]"))
)]
pub struct Options {
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    /// A floor plan of rooms with this seed instead of a file
    #[arg(long, conflicts_with = "file")]
    pub rooms: Option<u64>,
}

impl Options {
    pub(super) fn level(&self) -> Result<Level, Failed> {
        if let Some(seed) = self.rooms {
            return Level::floor_plan(seed);
        }
        let Some(path) = &self.common.file else {
            return Level::new("harbour", Drawing::read(HARBOUR), 1);
        };
        if cfg!(target_arch = "wasm32") {
            // The reader is no part of pages then.
            return Err("pages open no maps".into());
        }
        let map = Drawing::open(path)?;
        map.warnings.iter().for_each(|warning| eprintln!("warning: {}: {warning}", path.display()));
        let (width, height) = (map.walls.width(), map.walls.height());
        if width.max(height) > LONGEST {
            let why = format!("{}: {width} by {height} tiles, more than {LONGEST} a side", path.display());
            return Err(why.into());
        }
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Level::new(&name, map, 1).map_err(|why| format!("{}: {why}", path.display()).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{Shows, parsed};

    #[test]
    fn maps_that_cannot_be_taken_are_refused_by_name() {
        let place = std::env::temp_dir().join(format!("casca-plane-{}.txt", std::process::id()));
        let wide = "#".repeat(LONGEST as usize + 1);
        for (text, word) in [("", "no free tile"), ("###\n###", "no free tile"), (&*wide, "more than 512")] {
            std::fs::write(&place, text).unwrap();
            let options = parsed::<Options>(&[place.to_str().unwrap()]).unwrap();
            let said = options.start().err().unwrap().to_string();
            assert!(said.contains(word) && said.contains("casca-plane"), "{said}");
        }
        // A map of Tiled, whatever its name.
        let tiles = "1,0,0,0,0,1";
        let map = format!(
            "<map orientation=\"orthogonal\" width=\"3\" height=\"2\" tilewidth=\"16\" tileheight=\"16\"><tileset firstgid=\"1\"/>\
             <layer name=\"Walls\" width=\"3\" height=\"2\"><data encoding=\"csv\">{tiles}</data></layer></map>"
        );
        std::fs::write(&place, map).unwrap();
        let level = parsed::<Options>(&[place.to_str().unwrap()]).unwrap().level().unwrap();
        assert_eq!((level.size(), level.layer.opaque().bits().count()), ((3, 2), 2));
        std::fs::remove_file(&place).unwrap();
        let gone = parsed::<Options>(&[place.to_str().unwrap()]).unwrap().start().err().unwrap().to_string();
        assert!(gone.contains("casca-plane"), "{gone}");
        assert!(parsed::<Options>(&["--rooms", "3", "a.txt"]).is_err());
    }
}
