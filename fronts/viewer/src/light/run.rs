//! What the command line asks for, done.

use casca_stage::window;
use casca_tools::command_line::{Outcome, say};

use crate::common::Failed;
use crate::light::options::Options;
use crate::light::scene::Start;
use crate::light::{headless, window as shown};

impl Options {
    fn open(&self) -> Result<Start, Failed> {
        let mut start = Start::open(&self.scene(), self.balls)?;
        start.change(self.sun, self.from.zip(self.to));
        Ok(start)
    }

    /// The window.
    ///
    /// # Errors
    /// The scene cannot be had.
    pub fn start(&self) -> Result<window::Start, Failed> {
        self.check()?;
        Ok(shown::start(self.open()?, self))
    }

    /// Opens a window, draws pictures or prints times.
    ///
    /// # Errors
    /// The scene cannot be had, lit or written.
    pub fn run(&self) -> Result<Outcome, Failed> {
        let drawing = &self.common.drawing;
        if !(self.common.headless || self.time) {
            return drawing.open(self.start()?).map(|()| Outcome::Well);
        }
        let layers = self.check()?;
        let start = self.open()?;
        let gpu = drawing.device()?;
        say(format_args!("drawing on {}", gpu.name));
        if self.common.headless {
            headless::pictures(&gpu, &start, self, &layers)?;
        }
        if self.time {
            headless::time(&gpu, &start, self)?;
        }
        Ok(Outcome::Well)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

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
        for (scene, word) in [
            ("no/such.glb".to_owned(), "no/such.glb: cannot be read"),
            (file("broken.glb", b"glTF, but no more"), "broken.glb: is not a valid"),
            (file("empty.gltf", empty), "empty.gltf: holds no triangles"),
            (file("house.obj", b"v 0 0 0"), "neither a .glb or .gltf file nor"),
            (folder.to_str().unwrap().to_owned(), "neither a .glb or .gltf file nor"),
            ("house".to_owned(), "cornell-point"),
            (String::new(), "[FILE]"),
        ] {
            let said = said(&["--headless", &scene]);
            assert!(said.contains(word), "{scene}: {said}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
