//! The command line, and what it asks for, done.

use casca_plane::maps::{Drawing, HARBOUR};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::COLOUR;
use casca_stage::panel::Panel;
use casca_stage::window::Start;
use casca_tools::command_line::{EXIT_CODES, Outcome, make_folder, say};
use casca_tools::image::write_png;
use clap::{Args, value_parser};

use crate::common::{Common, Failed};
use crate::plane::level::Level;
use crate::plane::{draw, window};

/// The longest side of a map, in tiles: larger ones are no picture.
const LONGEST: u32 = 512;
/// Guards on maps that place none.
const GUARDS: u32 = 14;
/// Seconds that a picture shows the level after its start, if no frames are given.
const FRAMES: u32 = 90;

/// Shows what an eye sees on a map, and which guards it can see
///
/// In the window: W A S D walk (Shift: faster), the mouse moves the eye, Space pauses, N makes
/// another floor plan.
#[derive(Debug, Clone, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("file", |file| file.help("A map of Tiled (.tmx), or one drawn with letters: # wall, + door, g guard, @ start [default: a harbour]"))
)]
pub struct Options {
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    /// A floor plan of rooms with this seed instead of a file
    #[arg(long, conflicts_with = "file")]
    pub rooms: Option<u64>,
    /// Guards on maps that place none
    #[arg(long, default_value_t = GUARDS, value_parser = value_parser!(u32).range(0..=1000))]
    pub guards: u32,
}

impl Options {
    /// The window.
    ///
    /// # Errors
    /// The map cannot be had.
    pub fn start(&self) -> Result<Start, Failed> {
        Ok(window::start(self.guards, self.level()?))
    }

    /// Opens a window or draws a picture.
    ///
    /// # Errors
    /// The map cannot be had, or nothing can be drawn.
    pub fn run(&self) -> Result<Outcome, Failed> {
        let drawing = &self.common.drawing;
        if !self.common.headless {
            return drawing.open(self.start()?).map(|()| Outcome::Well);
        }
        let mut level = self.level()?;
        let gpu = drawing.device()?;
        let canvas = Canvas::new(&gpu, drawing.size);
        for _ in 0..drawing.frames.unwrap_or(FRAMES) {
            level.step(level.eye())?;
        }
        let folder = self.common.folder("plane");
        make_folder(&folder)?;
        let mut panel = Panel::new(&gpu, COLOUR);
        draw::picture(&mut panel, (&gpu, &canvas.picture(), 1.0), &level);
        let path = folder.join(format!("plane-{}.png", level.name));
        write_png(&path, canvas.size(), &canvas.read_picture(&gpu)?)?;
        level.lines().iter().for_each(say);
        say(format_args!("{}, drawn on {}", path.display(), gpu.name));
        Ok(Outcome::Well)
    }

    fn level(&self) -> Result<Level, Failed> {
        if let Some(seed) = self.rooms {
            return Level::floor_plan(seed, self.guards);
        }
        let Some(path) = &self.common.file else {
            return Level::new("harbour", Drawing::read(HARBOUR), (1, self.guards));
        };
        let map = Drawing::open(path)?;
        map.warnings.iter().for_each(|warning| eprintln!("warning: {}: {warning}", path.display()));
        let (width, height) = (map.walls.width(), map.walls.height());
        if width.max(height) > LONGEST {
            let why = format!("{}: {width} by {height} tiles, more than {LONGEST} a side", path.display());
            return Err(why.into());
        }
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Level::new(&name, map, (1, self.guards)).map_err(|why| format!("{}: {why}", path.display()).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

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
        for (text, word) in [
            ("<?xml version=\"1.0\"?><svg/>", "no element map"),
            ("{\"type\": \"map\", \"tilewidth\": 9}", "saved as .tmx"),
            ("\u{1}\u{2}", "no map"),
        ] {
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
        assert!(parsed::<Options>(&["--guards", "1001"]).is_err());
    }
}
