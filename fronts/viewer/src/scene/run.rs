//! What the command line asks for, done.

use casca_scenes::name::SceneName;
use casca_stage::window::Start;
use casca_tools::command_line::{Outcome, make_folder, say};

use crate::common::Failed;
use crate::scene::options::Options;
use crate::scene::playback::{Method, Playback};
use crate::scene::window::First;
use crate::scene::{headless, proof, window};

/// Pictures of a scene, if no other number is given.
const FRAMES: u32 = 5;

impl Options {
    /// The window.
    ///
    /// # Errors
    /// A scene cannot be had.
    pub fn start(&self) -> Result<Start, Failed> {
        let scenes = self.scenes()?;
        scenes.iter().try_for_each(SceneName::check)?;
        let first = match (self.at, &self.common.file) {
            (Some(frame), _) => First::Still(frame as usize),
            (None, None) => First::Above,
            (None, Some(_)) => First::Path,
        };
        Ok(window::start(scenes, &self.made(), self.method, first))
    }

    /// Opens a window, draws pictures or proves that they are right; whether all that was to be
    /// proved holds.
    ///
    /// # Errors
    /// What is drawn cannot be had or written.
    pub fn run(&self) -> Result<Outcome, Failed> {
        let drawing = &self.common.drawing;
        if !(self.common.headless || self.proof) {
            return drawing.open(self.start()?).map(|()| Outcome::Well);
        }
        let scenes = self.scenes()?;
        // A proof takes minutes: what cannot be read or written is said before it.
        scenes.iter().try_for_each(SceneName::check)?;
        let out = self.common.folder("viewer");
        make_folder(&out)?;
        let gpu = drawing.device()?;
        say(format_args!("drawing on {}", gpu.name));
        let mut holds = true;
        let frames = drawing.frames.unwrap_or(FRAMES) as usize;
        let at = self.at.map(|frame| frame as usize);
        for scene in &scenes {
            let mut playback = Playback::new(scene.open(&self.made())?)?;
            if self.proof {
                let methods = [Method::Point, Method::Cell];
                let plan = (drawing.size, frames);
                let rows = proof::prove(&gpu, &mut playback, plan, &methods, Some(&out))?;
                holds &= proof::report(&playback.world.name, playback.world.objects.len(), &rows);
            } else {
                let plan = headless::Plan {
                    method: self.method,
                    frames: if at.is_some() { 1 } else { frames },
                    at,
                    out: &out,
                    size: drawing.size,
                    birds_eye: self.birds_eye,
                    animation: self.animation,
                    layers: &self.layers,
                    bare: self.bare,
                };
                holds &= headless::pictures(&gpu, &mut playback, &plan)? == 0;
            }
        }
        if !holds {
            eprintln!("visible objects were lost");
            return Ok(Outcome::Lost);
        }
        Ok(Outcome::Well)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

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
