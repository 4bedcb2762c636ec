//! Animals that move: skeletons, the weights of vertices, clips, and the bounds of poses.
//!
//! A furry mesh is skinned as a volume: a point of a layer, extruded from the mesh **at rest**,
//! goes where the blended matrix of its vertex takes it (linear blend skinning). So strands keep
//! their roots, stand as the skin under them turns, and the whole fur of a vertex follows one
//! matrix, whose inverse takes an eye back to the mesh at rest, where strands are looked up.
//!
//! - [`Skeleton`] and [`Joint`]: what hangs from what.
//! - [`Weights`]: which joints a vertex follows.
//! - [`Track`], [`Clip`]: keyed motion. [`Pose`]: all joints at a time.
//! - [`SkinBounds`]: a box that holds all layers in a pose, whatever the weights are.
//!
//! ```
//! use casca_fur::mesh::prepare;
//! use casca_fur::skin::*;
//! use casca_fur::strands::Fur;
//! use glam::{Affine3A, Quat, Vec3};
//!
//! # fn main() -> Result<(), casca_fur::Error> {
//! let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
//! let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let (mesh, placing) = prepare(&corners, &[], &faces)?;
//! // One joint in the middle, one at the tip that turns by half a turn in a second.
//! let tip = Joint::at(Some(0), Vec3::Z * 0.5);
//! let skeleton = Skeleton::new(vec![Joint::at(None, Vec3::ZERO), tip])?;
//! let weights = Weights::new(&vec![[0, 1, 0, 0]; 4], &vec![[0.7, 0.3, 0.0, 0.0]; 4], &skeleton)?;
//! let turns = vec![Quat::IDENTITY, Quat::from_rotation_x(3.0)];
//! let turn = Track::new(vec![0.0, 1.0], turns, Interpolation::Linear)?;
//! let clip = Clip::new(vec![(1, Channel::Rotation(turn))], &skeleton)?;
//! let mut pose = Pose::rest(&skeleton);
//! pose.set(&skeleton, &clip, 0.25);
//! let fur = Fur::for_radius(placing.aabb_radius, 0.1, 0.2)?;
//! let bounds = SkinBounds::new(&mesh, &weights)?.posed(&pose, &fur);
//! let there = weights.blend(2, &pose).transform_point3(mesh.vertices()[2].position);
//! assert!(bounds.contains(there));
//! # Ok(())
//! # }
//! ```

mod bounds;
mod pose;
mod skeleton;
mod track;
mod weights;

pub use bounds::SkinBounds;
pub use pose::Pose;
pub use skeleton::{Joint, Local, Skeleton};
pub use track::{Channel, Clip, Interpolation, Keyed, Track};
pub use weights::{PER_VERTEX, Weights};
