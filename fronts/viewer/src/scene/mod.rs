//! Scenes: draws exactly the objects that casca finds visible, in a window or into pictures, and
//! proves pixel by pixel that none is missing.
//!
//! How casca is wired into a render loop is in `frame_loop`.

mod birds_eye;
mod camera_fit;
pub mod draw;
mod frame_loop;
mod geometry;
mod headless;
mod legend;
mod options;
mod overlays;
mod panel;
pub mod playback;
pub mod proof;
pub mod renderer;
pub mod window;

use casca_scenes::name::SceneName;
use casca_stage::window::Start;
use casca_tools::command_line::Outcome;

use crate::common::{Common, Failed, Shows};
use crate::scene::options::FRAMES;
use crate::scene::playback::{Method, Playback};
use crate::scene::window::First;

pub(crate) use options::Options;

/// Tries whether files can be read, before work that comes first. Costs loading them.
fn check(scenes: &[SceneName]) -> Result<(), Failed> {
    let files = scenes.iter().filter(|scene| !matches!(scene, SceneName::Built(_)));
    files.map(|file| file.open(&Default::default())).try_for_each(|world| world.map(drop))?;
    Ok(())
}

impl Shows for Options {
    fn common(&self) -> &Common {
        &self.common
    }

    fn start(&self) -> Result<Start, Failed> {
        let scenes = self.scenes()?;
        check(&scenes)?;
        let first = match (self.at, &self.common.file) {
            (Some(frame), _) => First::Still(frame as usize),
            (None, None) => First::Above,
            (None, Some(_)) => First::Path,
        };
        Ok(window::start(scenes, &self.made(), self.method, first))
    }

    fn is_windowless(&self) -> bool {
        self.common.headless || self.proof
    }

    fn work(&self) -> Result<Outcome, Failed> {
        let scenes = self.scenes()?;
        // A proof takes minutes: what cannot be read or written is said before it.
        check(&scenes)?;
        let (gpu, folder) = self.common.studio("view")?;
        let mut holds = true;
        for scene in &scenes {
            let mut playback = Playback::new(scene.open(&self.made())?)?;
            holds &= if self.proof {
                let plan = (self.common.size, self.common.frames.unwrap_or(FRAMES) as usize);
                let methods = [Method::Point, Method::Cell];
                let rows = proof::prove(&gpu, &mut playback, plan, &methods, Some(&folder))?;
                proof::report(&playback.world.name, playback.world.objects.len(), &rows)
            } else {
                headless::pictures(&gpu, &mut playback, self, &folder)? == 0
            };
        }
        if !holds {
            eprintln!("visible objects were lost");
            return Ok(Outcome::Lost);
        }
        Ok(Outcome::Well)
    }
}
