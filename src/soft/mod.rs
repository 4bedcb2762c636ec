//! Soft visibility: estimates of how much of something can be seen, on the cells of a grid.
//!
//! A [`crate::Query`] says whether something can be seen and never errs by hiding it. The functions
//! here say how much of it, and **may err both ways**: shapes count as the cells that they touch.
//! ([`VisibleFraction`] also has a bound by the cells that they fill.) Use them for levels of
//! detail, for the order of streaming, and for light. They must not decide what is drawn.
//!
//! [`SoftGrid`] holds the occupied cells in two layers, for fixed and for moving shapes, and a
//! pyramid of opacities above them. It is asked by [`SoftGrid::first_hit`] (an exact walk through
//! the cells), [`SoftGrid::cone`], [`SoftGrid::visible_fraction`] and
//! [`SoftGrid::ambient_occlusion`]; a [`VisibilityVolume`] keeps what a light reaches.
//!
//! Sources: J. G. Villegas, *Trazado de conos para el cálculo de iluminación global empleando
//! sombreado de vóxeles* (UCV 2016), and Crassin et al., *Interactive Indirect Illumination Using
//! Voxel Cone Tracing* (2011). Opacities have no running averages, so that results do not depend on
//! the order of shapes.
//!
//! ```
//! use casca::soft::{Cone, Layer, March, SoftGrid};
//! use casca::{Aabb, GridSpec, Sphere};
//! use glam::{UVec3, Vec3};
//!
//! # fn main() -> Result<(), casca::Error> {
//! let mut soft = SoftGrid::new(&GridSpec { min: Vec3::ZERO, cell: 0.25, dims: UVec3::splat(64) })?;
//! // A wall that hides the left half of what is behind it.
//! let wall = Aabb::new(Vec3::new(0.0, 0.0, 8.0), Vec3::new(8.0, 16.0, 8.5));
//! let id = soft.insert(wall, Layer::Fixed)?;
//! soft.rebuild();
//! let (eye, ball) = (Vec3::new(8.0, 8.0, 2.0), Sphere::new(Vec3::new(8.0, 8.0, 14.0), 1.0));
//! let seen = soft.visible_fraction(eye, ball, 64)?;
//! assert!(seen.least > 0.4 && seen.most < 0.6);
//! let cone = Cone { apex: eye, direction: Vec3::Z, tan: 0.1, reach: 12.0 };
//! assert!((0.3..0.7).contains(&soft.cone(&cone, &March::Slabs)?.transmittance));
//! soft.remove(id)?;
//! soft.rebuild();
//! assert_eq!(soft.visible_fraction(eye, ball, 64)?.least, 1.0);
//! # Ok(())
//! # }
//! ```

mod cone;
mod estimate;
mod grid;
mod pyramid;
mod rays;
mod volume;
mod walk;

pub use cone::{Cone, ConeAnswer, March};
pub use estimate::VisibleFraction;
pub use grid::{Layer, SoftGrid, SoftId};
pub use pyramid::Pyramid;
pub use volume::VisibilityVolume;
pub use walk::CellHit;
