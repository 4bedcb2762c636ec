//! Lists of objects drawn to a canvas, and sets of objects checked against an item buffer.

use std::cell::Cell;

use casca_scenes::world::{Camera, Object};
use casca_stage::canvas::{Canvas, items_of};
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::gpu::{Reading, waited_for};

use crate::scene::geometry::{DrawList, Geometry, colour_of};
use crate::scene::renderer::{Marks, NO_ITEM, Output, Renderer};

/// What an item buffer says about a set of objects.
#[derive(Debug, Clone, Default)]
pub struct Check {
    /// Tested objects that some pixel shows, ascending.
    pub shown: Vec<usize>,
    /// Those of them that are not in the set.
    pub lost: Vec<usize>,
}

/// A picture and its item buffer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shot {
    /// Red, green, blue, opacity, row by row.
    pub pixels: Vec<u8>,
    /// The number of the object in each pixel, or [`NO_ITEM`].
    pub items: Vec<u32>,
}

impl Shot {
    /// The pixels whose colour or object is another in `other`, a shot of the same size.
    pub fn differing(&self, other: &Self) -> Vec<usize> {
        let colours = self.pixels.chunks(4).zip(other.pixels.chunks(4));
        let both = colours.zip(self.items.iter().zip(&other.items)).enumerate();
        both.filter(|(_, ((a, b), (i, j)))| a != b || i != j).map(|(pixel, _)| pixel).collect()
    }
}

/// A canvas, and what draws to it.
pub struct Painter<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The textures.
    pub canvas: &'a Canvas,
    /// The passes.
    pub renderer: &'a mut Renderer,
}

impl Painter<'_> {
    /// Draws the picture.
    pub fn picture(&mut self, camera: &Camera, list: &DrawList, marks: &Marks) {
        self.renderer.draw(self.gpu, Output::Picture, &self.canvas.picture(), camera, list, marks);
    }

    /// Draws the picture and the item buffer and reads both.
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub fn shot(&mut self, camera: &Camera, list: &DrawList) -> Result<Shot, GpuError> {
        let marks = Marks::default();
        self.picture(camera, list, &marks);
        let pixels = self.canvas.read_picture(self.gpu)?;
        self.renderer.draw(self.gpu, Output::Items, &self.canvas.items(), camera, list, &marks);
        Ok(Shot { pixels, items: self.canvas.read_items(self.gpu)? })
    }

    /// Compares a set, ascending, with what an item buffer of all objects shows.
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub fn check(
        &mut self,
        camera: &Camera,
        objects: (&Geometry, &[Object]),
        set: &[usize],
    ) -> Result<Check, GpuError> {
        let begun = self.begin_check(camera, objects, set)?;
        self.gpu.wait()?;
        waited_for(begun.end())
    }

    /// Draws what [`Self::check`] compares with, and does not wait for it. One looks through
    /// objects that hide nothing: for those, all that hides is drawn once more without them.
    ///
    /// # Errors
    /// The device is out of memory.
    pub fn begin_check(
        &mut self,
        camera: &Camera,
        (geometry, objects): (&Geometry, &[Object]),
        set: &[usize],
    ) -> Result<Begun, GpuError> {
        let mut buffers = Vec::new();
        let all = objects.iter().all(|o| o.occludes);
        for occluders in [false, true] {
            if occluders && all {
                break;
            }
            let drawn = (0..objects.len()).filter(|&i| !occluders || objects[i].occludes);
            let list = geometry.list(objects, drawn, &|_| [0; 4]);
            let marks = Marks::default();
            self.renderer.draw(self.gpu, Output::Items, &self.canvas.items(), camera, &list, &marks);
            buffers.push(self.canvas.read_items_later(self.gpu)?);
        }
        let tested = objects.iter().map(|o| o.tested).collect();
        Ok(Begun { buffers, read: Cell::default(), tested, set: set.to_vec() })
    }
}

/// A check whose item buffers are on their way.
pub struct Begun {
    buffers: Vec<Reading>,
    /// Whether each object is shown by those that are there, and how many of them are.
    read: Cell<(Vec<bool>, usize)>,
    tested: Vec<bool>,
    set: Vec<usize>,
}

impl Begun {
    /// Its end; `None` if the item buffers are not there yet.
    pub fn end(&self) -> Option<Result<Check, GpuError>> {
        let (mut seen, mut read) = self.read.take();
        seen.resize(self.tested.len(), false);
        while let Some(bytes) = self.buffers.get(read).and_then(Reading::take) {
            match bytes {
                Ok(bytes) => items_of(&bytes).filter(|&i| i != NO_ITEM).for_each(|i| seen[i as usize] = true),
                Err(why) => return Some(Err(why)),
            }
            read += 1;
        }
        if read < self.buffers.len() {
            self.read.set((seen, read));
            return None;
        }
        let shown: Vec<usize> = (0..seen.len()).filter(|&i| seen[i] && self.tested[i]).collect();
        let lost = shown.iter().copied().filter(|i| self.set.binary_search(i).is_err()).collect();
        Some(Ok(Check { shown, lost }))
    }
}

/// The list that draws some objects in their own colours.
pub fn coloured(geometry: &Geometry, objects: &[Object], visible: &[usize]) -> DrawList {
    geometry.list(objects, visible.iter().copied(), &|i| colour_of(i, &objects[i]))
}
