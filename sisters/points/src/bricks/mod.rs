//! Clouds larger than memory, cut into bricks that a [`casca::Scene`] culls as objects, between
//! walls that the application inserts.
//!
//! A file of bricks is built out of core by a [`Builder`]. [`Bricks`] opens it: the index is in
//! memory, 64 bytes for each brick; the points, 16 bytes each, stay in the file. The points of a
//! brick are in an order of which every beginning is a coarser level of detail. A [`Loader`] reads
//! as much of each wanted brick as a picture needs, in a thread of its own, into a budget of memory.
//!
//! ```no_run
//! use casca_points::bricks::{Bricks, Loader};
//! use std::sync::Arc;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let camera = casca_points::Camera::look_at(glam::Vec3::Z, glam::Vec3::ZERO, glam::Vec3::Y, 0.8, (640, 480), 0.1, 1e3)?;
//! let bricks = Arc::new(Bricks::open("town.bricks".as_ref())?);
//! let mut scene = casca::Scene::new(casca::cell_for(bricks.bounds(), bricks.len())?)?;
//! bricks.insert_into(&mut scene)?;
//! // Insert walls, floors and other occluders, too, with user data that is no number of a brick.
//! # let wall = casca::Aabb::new(glam::Vec3::ZERO, glam::Vec3::ONE);
//! scene.insert(casca::ObjectDesc::fixed(wall).occluder(wall).user_data(u64::MAX))?;
//! let loader = Loader::new(bricks.clone(), 512 << 20)?;
//! let mut query = casca::Query::new();
//!
//! // In every frame:
//! let view = casca::View::perspective(camera.eye(), camera.view_projection())?;
//! let visible = query.run(&scene, &view).iter().filter_map(|id| u32::try_from(scene.user_data(id).ok()?).ok());
//! let wants = bricks.wants(visible, &camera, 1.0);
//! loader.want(&wants);
//! let points = loader.gather(&wants);
//! # Ok(())
//! # }
//! ```

mod build;
mod file;
mod loader;
mod order;
#[cfg(test)]
mod tests;

pub use build::{BuildOptions, Builder};
pub use file::{Bricks, Want};
pub use loader::Loader;

/// Why there are no bricks.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BrickError {
    /// The operating system says why.
    #[error("{name}: {source}")]
    Io {
        /// The file.
        name: String,
        /// The reason.
        source: std::io::Error,
    },
    /// A file of something else, of another version, cut short or damaged.
    #[error("{name} is not a valid brick file: {cause}")]
    Broken {
        /// The file.
        name: String,
        /// What is wrong.
        cause: String,
    },
    /// A point to build bricks from is infinite, not a number, or too far from the first ones for
    /// single precision.
    #[error("the position of point {index} is not finite")]
    NotFinite {
        /// Its number among all points.
        index: u64,
    },
    /// Points to build bricks from have colours only for some.
    #[error(transparent)]
    Length(#[from] crate::LengthError),
}
