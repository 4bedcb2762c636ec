//! A walk through a world, frame by frame, with the library's scene kept up to date.

use casca::{Error, Method, Query};

use super::{ASPECT, FrameInput};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::world::{Camera, FRAME_SECONDS, Object, World};
use casca_truth::oracle::ItemBuffer;

/// A world on its walk, in as many grids as are asked for.
pub(super) struct Walker {
    pub(super) world: World,
    grids: Vec<(Driver, Query)>,
    frustum: Query,
}

/// One frame of the walk.
pub(super) struct Snapshot {
    pub(super) camera: Camera,
    /// The objects in the frustum, ascending.
    pub(super) in_frustum: Vec<usize>,
}

impl Walker {
    /// Inserts the world as it is at its first frame, into the grid that it asks for.
    ///
    /// # Errors
    /// As [`Driver::new`].
    pub(super) fn new(mut world: World) -> Result<Self, Error> {
        world.set_frame(0);
        let mut walker = Self { world, grids: Vec::new(), frustum: Query::with_method(Method::Frustum)? };
        walker.add(walker.world.grid.cell)?;
        Ok(walker)
    }

    /// Inserts the world into another grid, too, before it walks.
    ///
    /// # Errors
    /// As [`Driver::new`].
    pub(super) fn add(&mut self, cell: f32) -> Result<(), Error> {
        self.add_driver(Driver::new(&self.world, cell, |_| ())?);
        Ok(())
    }

    /// Takes the world as inserted elsewhere, with more objects, along on its walk.
    pub(super) fn add_driver(&mut self, driver: Driver) {
        self.grids.push((driver, Query::new()));
    }

    /// The scene in one of the grids.
    pub(super) fn driver(&self, grid: usize) -> &Driver {
        &self.grids[grid].0
    }

    /// Walks all frames; of them, `count` are looked at, evenly spread. Returns how many were.
    ///
    /// # Errors
    /// As the library's, and those of `look`.
    pub(super) fn walk<E: From<Error>>(
        &mut self,
        count: usize,
        mut look: impl FnMut(&Self, usize, &Snapshot) -> Result<(), E>,
    ) -> Result<usize, E> {
        let step = (self.world.frames / count.max(1)).max(1);
        let mut seen = 0;
        for number in 0..self.world.frames {
            let moved = self.world.set_frame(number);
            for (driver, _) in &mut self.grids {
                driver.scene.begin_frame(number as f64 * FRAME_SECONDS)?;
                driver.update(&self.world.objects, &moved)?;
            }
            let camera = self.world.camera(number, ASPECT);
            let view = view_of(&camera)?;
            if number % step == step / 2 && seen < count {
                let driver = &self.grids[0].0;
                let pvs = self.frustum.run(&driver.scene, &view);
                let in_frustum = driver.found(pvs);
                look(self, number, &Snapshot { camera, in_frustum })?;
                seen += 1;
            }
            for (driver, query) in &mut self.grids {
                query.run(&driver.scene, &view);
                driver.scene.end_frame([query.pvs()])?;
            }
        }
        Ok(seen)
    }

    /// What contenders get of a frame in one of the grids.
    pub(super) fn input<'a>(&'a self, frame: &'a Snapshot, grid: usize) -> FrameInput<'a> {
        FrameInput {
            driver: self.driver(grid),
            objects: &self.world.objects,
            in_frustum: &frame.in_frustum,
            camera: &frame.camera,
        }
    }

    /// The tested objects that an item buffer shows in this frame, ascending.
    pub(super) fn visible(&self, frame: &Snapshot, exact: &mut ItemBuffer) -> Vec<usize> {
        visible_in(exact, &self.world.objects, &frame.camera)
    }
}

/// The tested objects of which an item buffer shows a pixel, ascending.
pub(super) fn visible_in(exact: &mut ItemBuffer, objects: &[Object], camera: &Camera) -> Vec<usize> {
    exact.render(objects, camera);
    let seen = exact.visible().iter().zip(objects).enumerate();
    seen.filter(|(_, (pixels, object))| **pixels > 0 && object.tested).map(|(i, _)| i).collect()
}

/// An item buffer with this many pixels in a row.
pub(super) fn item_buffer(width: usize) -> ItemBuffer {
    ItemBuffer::new(width, (width as f32 / ASPECT).round() as usize)
}
