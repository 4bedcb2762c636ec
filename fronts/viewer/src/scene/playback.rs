//! A scene, all methods that may cull it, and its clock.

use std::error::Error;
use std::fmt;
use std::time::Duration;

use casca::{Query, Scene};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::world::{Camera, FRAME_SECONDS, Object, World};
use casca_stage::window::Done;
use glam::DVec3;

use crate::scene::frame_loop;
use crate::scene::geometry::Geometry;

/// How it is decided what is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Method {
    /// Everything is drawn.
    All,
    /// What may be in the frustum.
    Frustum,
    /// casca: what the eye can see.
    Point,
    /// casca: what the eye's cell can see.
    Cell,
}

/// The methods by their names, in their order above.
pub const METHODS: [(&str, Method); 4] =
    [("all", Method::All), ("frustum", Method::Frustum), ("point", Method::Point), ("cell", Method::Cell)];

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(METHODS[*self as usize].0)
    }
}

/// A scene and its clock.
pub struct Playback {
    /// The objects as they are now.
    pub world: World,
    /// The library's scene.
    pub driver: Driver,
    /// What is drawn.
    pub geometry: Geometry,
    /// Frames since the start.
    pub ticks: usize,
    point: Query,
    cell: Query,
    frustum: Query,
}

/// What there is to draw in a frame.
pub struct Frame<'a> {
    /// All objects as they are now.
    pub objects: &'a [Object],
    /// What is drawn of them.
    pub geometry: &'a Geometry,
    /// The library's scene.
    pub scene: &'a Scene,
    /// Corners of the box of the level.
    pub level: (DVec3, DVec3),
    /// The camera that was culled for.
    pub camera: Camera,
    /// The objects to draw, ascending.
    pub visible: Vec<usize>,
    /// Time that culling took.
    pub time: Duration,
}

impl Playback {
    /// A scene with all objects where they are at first.
    ///
    /// # Errors
    /// As [`Driver::new`].
    pub fn new(mut world: World) -> Result<Self, Box<dyn Error>> {
        world.source.tell();
        world.set_frame(0);
        let driver = Driver::new(&world, world.grid.cell, |_| ())?;
        Ok(Self {
            geometry: Geometry::new(&world.objects),
            driver,
            ticks: 0,
            point: Query::with_method(casca::Method::point())?,
            cell: Query::with_method(casca::Method::cell())?,
            frustum: Query::with_method(casca::Method::Frustum)?,
            world,
        })
    }

    /// The frame of the path that `tick` shows: there and back again, so that nothing ever jumps.
    pub fn path_frame(&self, tick: usize) -> usize {
        match self.world.frames {
            0 | 1 => 0,
            n => n - 1 - (tick % (2 * n - 2)).abs_diff(n - 1),
        }
    }

    /// The path's camera now.
    pub fn path_camera(&self, aspect: f32) -> Camera {
        self.world.camera(self.path_frame(self.ticks), aspect)
    }

    /// Runs the frame loop once: culls for `camera` by `method` and has `draw` draw it.
    ///
    /// # Errors
    /// As `frame_loop::frame`.
    pub fn frame(
        &mut self,
        method: Method,
        camera: &Camera,
        draw: &mut dyn FnMut(Frame<'_>) -> Done,
    ) -> Done {
        let (number, seconds) = (self.path_frame(self.ticks), self.ticks as f64 * FRAME_SECONDS);
        let moved = self.world.set_frame(number);
        let query = match method {
            Method::Point => &mut self.point,
            Method::Cell => &mut self.cell,
            _ => &mut self.frustum,
        };
        let (objects, geometry, grid) = (&self.world.objects, &self.geometry, &self.world.grid);
        let level = (grid.min.as_dvec3(), grid.max.as_dvec3());
        frame_loop::frame(
            &mut self.driver,
            query,
            seconds,
            (objects, &moved),
            camera,
            &mut |scene, query, time| {
                let (visible, time) = match method {
                    Method::All => ((0..objects.len()).collect(), Duration::ZERO),
                    Method::Frustum | Method::Point | Method::Cell => (found(query), time),
                };
                draw(Frame { objects, geometry, scene, level, camera: *camera, visible, time })
            },
        )
    }

    /// What each of `methods` would draw for the camera of this frame, ascending; the scene stays
    /// as it is.
    ///
    /// # Errors
    /// As [`view_of`].
    pub fn compare(
        &mut self,
        methods: &[Method],
        camera: &Camera,
    ) -> Result<Vec<Vec<usize>>, Box<dyn Error>> {
        let view = view_of(camera)?;
        let sets = methods.iter().map(|method| {
            let query = match method {
                Method::All => return (0..self.world.objects.len()).collect(),
                Method::Frustum => &mut self.frustum,
                Method::Point => &mut self.point,
                Method::Cell => &mut self.cell,
            };
            query.run(&self.driver.scene, &view);
            found(query)
        });
        Ok(sets.collect())
    }
}

/// The objects of a result, ascending. They were inserted in order, and none was removed.
fn found(query: &Query) -> Vec<usize> {
    let mut found: Vec<usize> = query.pvs().visible().iter().map(|id| id.index()).collect();
    found.sort_unstable();
    found
}
