//! Diffuse light that cannot cross walls.
//!
//! A [`Cache`] holds the light of the surfaces of a scene in the cells of a grid. Each surface in a
//! cell sends rays through the grid **once**, and the cache stores their hits. Light is then passed
//! along the stored hits, as often as it takes. So light of all bounces costs look-ups,
//! and a light that moves costs no rays but those of its own shadows.
//!
//! ```
//! use casca_radiosity::{Cache, Grid, Light, Material, Scene, Settings, Sky, Triangle};
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), casca_radiosity::LightError> {
//! // A floor of white, under a lamp.
//! let at = |x, z| Vec3::new(x, 0.0, z);
//! let half = |corners| Triangle { corners, material: 0 };
//! let floor = vec![
//!     half([at(0.0, 0.0), at(0.0, 4.0), at(4.0, 4.0)]),
//!     half([at(0.0, 0.0), at(4.0, 4.0), at(4.0, 0.0)]),
//! ];
//! let scene = Scene {
//!     objects: vec![floor.into()],
//!     materials: vec![Material::new(Vec3::splat(0.8), Vec3::ZERO)],
//!     lights: vec![Light::Point {
//!         position: Vec3::new(2.0, 1.0, 2.0),
//!         intensity: Vec3::splat(10.0),
//!         radius: 0.0,
//!     }],
//!     sky: Sky::Even(Vec3::splat(0.5)),
//!     ..Scene::default()
//! };
//! let mut cache = Cache::new(&scene, Settings::new(Grid::around(&scene.objects, 32)))?;
//! cache.request(Vec3::new(2.0, 0.0, 2.0), Vec3::Y)?;
//! cache.gather(64)?;
//! cache.direct();
//! cache.converge(1e-4, 32);
//! let light = cache.irradiance(Vec3::new(2.0, 0.0, 2.0), Vec3::Y)?;
//! assert!((light.direct.x - 10.0).abs() < 0.1);
//! // The whole sky, of radiance 0.5.
//! assert!((light.indirect.x - 0.5 * std::f32::consts::PI).abs() < 1e-4);
//! # Ok(())
//! # }
//! ```
//!
//! # Method
//!
//! Radiosity by rays that are sent once (the "shooting" of links of Hanrahan, Salzman and Aupperle
//! 1991, here from points of surfaces into cosine-weighted hemispheres, as in Malley 1988 and Ward
//! et al. 1988), solved by Gauss and Seidel (Cohen and Greenberg 1985). Direct light of lamps is
//! taken out and found by resampled shadow rays (Talbot et al. 2005). Answers are means of the
//! states around, as irradiance caching interpolates them (Ward et al. 1988), each behind a ray of
//! its own. [`Cache::reflection`] sends rays that read states.
//!
//! A world larger than a grid has a coarse one and [`Window`]s of finer cells around the eye
//! ([`Cache::move_windows`]); all cells share one list of states and one tree of triangles.
//!
//! # Limits
//!
//! Diffuse surfaces only; the surface of a cell has one albedo, the mean of its textures. Contact shadows and folds
//! smaller than a cell blur. What lies outside of the grid is not there, and rays that leave it see
//! the sky. Results depend on neither threads, nor
//! time, nor hash order.

mod cache;
mod clip;
mod direct;
mod error;
mod filter;
mod forest;
#[cfg(feature = "gpu")]
pub mod gpu;
mod input;
mod lattice;
#[cfg(feature = "lit")]
pub mod lit;
mod mirrors;
mod moves;
mod numeric;
mod query;
mod queues;
mod spread;
mod states;
mod surfaces;
mod texture;
mod tree;
mod voxels;
mod windows;

pub use cache::{Cache, Statistics};
pub use error::LightError;
pub use input::{Grid, Light, Material, Object, Scene, Settings, Sky, Triangle, Window};
pub use mirrors::Seen;
pub use moves::Moved;
pub use query::Irradiance;
pub use surfaces::Skipped;
pub use texture::Texture;
