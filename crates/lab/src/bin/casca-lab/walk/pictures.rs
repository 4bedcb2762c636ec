//! The pictures of the frame in the middle of a walk.

use casca::internals::QueryInternals;
use casca::{Method, Query, Scene, View};
use casca_lab::pictures::{FramePicture, PictureError, TopView, buffers, frame, top_view};
use casca_scenes::world::{Camera, World};
use casca_truth::oracle::ItemBuffer;
use glam::Vec3;

use super::options::{ASPECT, MethodName, Options};
use crate::Failure;

/// The files that a walk writes.
pub const PICTURES: [&str; 4] = ["walk.svg", "frame.png", "buffers.png", "top_view.svg"];

/// The height of a picture.
pub fn height_of(width: usize) -> usize {
    (width as f32 / ASPECT).round() as usize
}

/// A frame that is drawn.
pub struct Shot<'a> {
    pub options: &'a Options,
    pub world: &'a World,
    pub scene: &'a Scene,
    pub query: &'a Query,
    pub number: usize,
    pub camera: Camera,
    /// Objects in the frustum.
    pub in_frustum: &'a [usize],
    /// Whether the method finds an object visible.
    pub sees: &'a dyn Fn(usize) -> bool,
    /// The eye in each frame.
    pub path: &'a [Vec3],
}

impl Shot<'_> {
    /// Draws all pictures; `view` is that of the camera.
    pub fn draw(&self, view: &View) -> Result<(), Failure> {
        self.top_view(view)?;
        self.frame()?;
        if self.options.method == MethodName::Point {
            let title = self.title("the occlusion buffers");
            buffers(&self.options.out.out.join("buffers.png"), &title, &self.query.occlusion_images())?;
        }
        Ok(())
    }

    fn title(&self, subject: &str) -> String {
        format!("{}, frame {}: {subject}", self.world.name, self.number)
    }

    /// The grid from above, with the cells that the method `Cell` visits.
    fn top_view(&self, view: &View) -> Result<(), Failure> {
        let mut recorder = Query::with_method(Method::Cell(self.options.cell_options()))?;
        recorder.record_cells(true);
        recorder.run(self.scene, view);
        let (Some(visited), Some(hidden)) = (recorder.visited_cells(), recorder.hidden_cells()) else {
            return Ok(());
        };
        let height = f64::from(self.camera.eye.y);
        let volumes: Vec<_> = self.scene.ids().filter_map(|id| self.scene.tbv(id).ok().flatten()).collect();
        let volumes: Vec<_> =
            volumes.into_iter().filter(|(lo, hi)| lo.y <= height && height <= hi.y).collect();
        let (scene, camera, path) = (self.scene, self.camera, self.path);
        let picture = TopView { scene, visited, hidden, volumes: &volumes, camera, path };
        Ok(top_view(
            &self.options.out.out.join("top_view.svg"),
            &self.title("the grid from above"),
            &picture,
        )?)
    }

    fn frame(&self) -> Result<(), PictureError> {
        let mut exact = ItemBuffer::new(1280, height_of(1280));
        exact.render(&self.world.objects, &self.camera);
        let picture = FramePicture {
            exact: &exact,
            objects: &self.world.objects,
            camera: self.camera,
            in_frustum: self.in_frustum,
            sees: self.sees,
        };
        let title = self.title(&format!("what {} shows and hides", self.options.method.name()));
        frame(&self.options.out.out.join("frame.png"), &title, &picture)
    }
}
