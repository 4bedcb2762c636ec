//! The command `view`: a window, or a picture without one.

use std::error::Error;
use std::io::{self, Write};
use std::path::PathBuf;

use casca_stage::canvas::{Canvas, Target};
use casca_stage::fly::{Fly, way};
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::image::write_png;
use casca_stage::window::{self, Demo, Screen, WindowOptions};
use casca_stage::winit::keyboard::KeyCode;
use clap::Args;
use glam::Vec3;

use crate::Done;
use crate::operators::{Look, Looked, parse_size};
use crate::panes::{Content, Panes};

/// The share of the cloud's length that the camera flies in a second.
const SPEED: f32 = 0.15;

/// Shows all points of a cloud beside those that each operator finds visible, and its surface
///
/// In the window: W A S D Q E fly (Shift: faster), the right mouse button looks around, Escape quits, Space finds the visible points from
/// here. Until then the last result stays, so you can fly around it and see what was hidden from the old viewpoint.
#[derive(Debug, Args)]
pub struct View {
    #[command(flatten)]
    look: Look,
    /// The panes, comma-separated
    #[arg(long, value_enum, value_delimiter = ',', default_value = "points,hpr,clusters,splat,surface")]
    panes: Vec<Content>,
    /// Size of the picture or window
    #[arg(long, default_value = "1500x800", value_parser = parse_size)]
    size: (u32, u32),
    /// Draws a picture without a window
    #[arg(long)]
    headless: bool,
    /// Folder for the picture, which is called points-NAME.png [default: target/points]
    #[arg(long, requires = "headless")]
    out: Option<PathBuf>,
    /// Draws with a software adapter
    #[arg(long)]
    software: bool,
}

impl View {
    pub fn run(&self) -> Done {
        if self.headless {
            return self.picture();
        }
        let looked = self.look.open()?;
        let title = format!("{} - casca-points", looked.name);
        let options = WindowOptions { title, size: self.size, software: self.software, frames: None };
        window::open(&options, |screen| Viewer::new(screen, looked, &self.panes))
    }

    fn picture(&self) -> Done {
        let gpu = Gpu::headless(self.software)?;
        let looked = self.look.open()?;
        let canvas = Canvas::new(&gpu, self.size);
        let mut panes = Panes::new(&gpu, COLOUR, &self.panes);
        let camera = looked.camera(looked.eye, looked.target, panes.size(canvas.size()))?;
        let titles = panes.find(&gpu, &looked, &camera)?;
        panes.draw(&gpu, &canvas.picture(), &camera, 1.0);
        let folder = self.out.clone().unwrap_or_else(|| "target/points".into());
        let path = folder.join(format!("points-{}.png", looked.name));
        std::fs::create_dir_all(&folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
        write_png(&path, canvas.size(), &canvas.read_picture(&gpu)?)?;
        for line in titles.into_iter().chain([format!("{}, drawn on {}", path.display(), gpu.name)]) {
            // That nobody reads it is no reason to fail.
            let _ = writeln!(io::stdout(), "{line}");
        }
        Ok(())
    }
}

struct Viewer {
    looked: Looked,
    panes: Panes,
    fly: Fly,
    /// Whether the visible points are those of another eye.
    is_old: bool,
}

impl Viewer {
    fn new(screen: &Screen, looked: Looked, panes: &[Content]) -> Result<Self, Box<dyn Error>> {
        let fly = Fly::new(looked.eye, looked.target - looked.eye);
        let panes = Panes::new(&screen.gpu, screen.format(), panes);
        Ok(Self { looked, panes, fly, is_old: true })
    }
}

impl Demo for Viewer {
    fn press(&mut self, key: KeyCode, _: &Screen) -> Done {
        self.is_old |= key == KeyCode::Space;
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, _: &Screen) {
        self.fly.turn(x, y);
    }

    fn resize(&mut self, _: &Screen) {}

    fn step(&mut self, seconds: f64, screen: &Screen) {
        let way = way(&screen.keys) * (SPEED * self.looked.length * seconds.min(0.1) as f32);
        if way != Vec3::ZERO {
            self.fly.go(way);
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let size = self.panes.size(screen.size());
        let camera = self.looked.camera(self.fly.eye, self.fly.eye + self.fly.forward(), size)?;
        if std::mem::take(&mut self.is_old) {
            self.panes.find(&screen.gpu, &self.looked, &camera)?;
        }
        self.panes.draw(&screen.gpu, target, &camera, screen.scale());
        Ok(())
    }
}
