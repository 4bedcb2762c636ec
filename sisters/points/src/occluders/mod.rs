//! Occluders estimated from the points themselves, so that a scan hides its own rooms.
//!
//! **They are estimates, not conservative.** Nobody knows the surface between points. An opening
//! narrower than three cells of [`Occluders::resolution`] is taken for a gap between samples and
//! closed, glass that was scanned hides like a wall, and what a scanner did not see stays open. A
//! brick that such an occluder hides may hold points that an eye would see. Where walls are known,
//! insert these instead.
//!
//! Points are sorted into voxels of about eight cells. Planes near many of their points are found
//! by random samples (Fischler & Bolles 1981), and alike ones of neighbours grow into patches. The
//! points of a patch are drawn into an image of the plane, one pixel a cell; single empty pixels
//! are closed, where the pixels around are as full as points at random fill them, and a pixel is
//! taken away at each rim, except where other surface goes on, as at the corner of a room. What is
//! left is covered by few, large rectangles.
//!
//! ```no_run
//! use casca_points::bricks::Bricks;
//! use casca_points::occluders::{OccluderOptions, Occluders};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let bricks = Bricks::open("scan.bricks".as_ref())?;
//! let found = Occluders::estimate(&bricks, &OccluderOptions::default())?;
//! let objects = bricks.len() + found.boxes.len();
//! let mut scene = casca::Scene::new(&casca::GridSpec::fit(bricks.bounds(), objects)?)?;
//! // Larger by the margin, so that no wall hides its own points.
//! bricks.insert_grown(&mut scene, found.margin)?;
//! found.insert_into(&mut scene)?;
//! # Ok(())
//! # }
//! ```

mod axes;
mod facets;
mod image;
mod patches;
mod plane;
mod rectangles;
mod resolution;
#[cfg(test)]
mod tests;
mod voxels;

use casca::{Obb, ObjectDesc, ObjectId, Scene};

use crate::bricks::{BrickError, Bricks};
use image::{HALF_THICKNESS, Images, NEAR};
use voxels::Voxels;

/// How occluders are estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OccluderOptions {
    /// The side of a cell in the units of the points: openings of three cells and more stay open.
    /// `None`, and numbers that are not positive, take 1.25 times the spacing that three quarters
    /// of the points keep in bricks, or up to 1.6 times as much where those on flat parts leave
    /// more cells empty.
    pub resolution: Option<f32>,
    /// The shorter side of the smallest rectangles, in cells; at least 1.
    pub least_side: u32,
    /// The most rectangles; the largest are kept.
    pub most: usize,
}

impl Default for OccluderOptions {
    fn default() -> Self {
        Self { resolution: None, least_side: 8, most: 1 << 13 }
    }
}

/// Occluders estimated from points: see [the module](self) for what they may hide wrongly.
#[derive(Debug, Clone, PartialEq)]
pub struct Occluders {
    /// Thin boxes along walls, floors and other flat parts, the largest first, relative to the
    /// origin of the bricks.
    pub boxes: Vec<Obb>,
    /// How much larger bricks are to be inserted, in the units of the points. Points lie on both
    /// sides of the plane through them, and a brick of a wall must not hide behind that wall.
    pub margin: f32,
    /// The side of a cell, in the units of the points; 0 if there are no points.
    pub resolution: f32,
}

impl Occluders {
    /// Estimates the occluders of a cloud. Reads each point twice, brick by brick, and those of
    /// 256 bricks up to five times more. Beside one brick, memory holds some hundred bytes for
    /// each voxel that has points, and two bits for each cell of a patch. The result does not
    /// depend on the number of threads.
    ///
    /// # Errors
    /// Those of reading bricks.
    pub fn estimate(bricks: &Bricks, options: &OccluderOptions) -> Result<Self, BrickError> {
        let resolution = resolution::resolution(bricks, options.resolution)?;
        let mut found = Self { boxes: Vec::new(), margin: 0.0, resolution };
        if resolution == 0.0 {
            return Ok(found);
        }
        found.margin = (NEAR + HALF_THICKNESS) * resolution;
        let voxels = Voxels::of(bricks, resolution)?;
        let patches = patches::grow(&voxels);
        let images = Images::draw(bricks, &voxels, &patches)?;
        found.boxes = images.boxes(&patches, resolution, options.least_side.max(1) as usize);
        let area = |b: &Obb| b.half.x * b.half.y;
        found.boxes.sort_by(|a, b| area(b).total_cmp(&area(a)));
        found.boxes.truncate(options.most);
        Ok(found)
    }

    /// Inserts each box as a fixed object that hides what is behind it. Its user data is
    /// [`u64::MAX`], which is no number of a brick. The ids are in the order of the boxes.
    ///
    /// # Errors
    /// Those of [`Scene::insert`]; the boxes before the error are inserted.
    pub fn insert_into(&self, scene: &mut Scene) -> Result<Vec<ObjectId>, casca::Error> {
        scene.reserve(self.boxes.len());
        let object = |b: &Obb| ObjectDesc::fixed(*b).occluder(*b).user_data(u64::MAX);
        self.boxes.iter().map(|b| scene.insert(object(b))).collect()
    }
}
