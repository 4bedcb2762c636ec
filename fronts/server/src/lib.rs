//! Which entities may each client of a game be told of? Those that it could see before the next
//! answer reaches it, and no others: a cheater who draws all that he is told of sees no enemy
//! through a wall. **What can be seen is never told late.**
//!
//! ```
//! use casca::glam::Vec3;
//! use casca::{Aabb, ObjectDesc, Scene};
//! use casca_server::{ClientDesc, EntityDesc, ServerOptions, VisibilityServer};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A level: a wall across a field.
//! let field = Aabb::new(Vec3::new(0.0, -2.0, 0.0), Vec3::new(64.0, 8.0, 64.0));
//! let mut level = Scene::new(1.0)?;
//! let ground = Aabb::new(field.min, Vec3::new(64.0, 0.0, 64.0));
//! let wall = Aabb::new(Vec3::new(0.0, 0.0, 40.0), Vec3::new(64.0, 8.0, 41.0));
//! for solid in [ground, wall] {
//!     level.insert(ObjectDesc::fixed(solid).occluder(solid))?;
//! }
//!
//! let mut server = VisibilityServer::new(level, ServerOptions::new())?;
//! // An eye that runs at 5 m/s, of a client with 100 ms latency.
//! let client = server.add_client(ClientDesc::new(Vec3::new(32.0, 1.7, 20.0), 5.0, 0.1), 0.0)?;
//! let person = |x, z| Aabb::from_center(Vec3::new(x, 0.9, z), Vec3::new(0.4, 0.9, 0.4));
//! let friend = server.add_entity(EntityDesc::new(person(30.0, 30.0), 5.0), 0.0)?;
//! let enemy = server.add_entity(EntityDesc::new(person(30.0, 60.0), 5.0), 0.0)?;
//!
//! server.tick(0.0)?;
//! assert_eq!(server.answer(client)?.told, [friend], "the enemy is behind the wall");
//! server.move_entity(enemy, person(30.0, 35.0), 0.03)?;
//! server.tick(0.033)?;
//! assert_eq!(server.answer(client)?.new, [enemy]);
//! # Ok(())
//! # }
//! ```
//!
//! # What is promised
//!
//! Let a client's latency be at least the way of a report to the server and of an answer back,
//! with the time between two reports and that by which the client draws entities late. Let eyes
//! and entities keep to their speeds, and ticks follow each other by [`ServerOptions::tick`] at
//! most. Then, from when an answer arrives until the next one does, it names all entities that the
//! client's true eye can see: also where they moved since, also when reports were lost meanwhile
//! (up to [`ServerOptions::most_age`]).
//!
//! # How it is found
//!
//! An answer names an entity unless one wall of the level hides the box of all places where it may
//! be by then from all eyes within `speed * (latency + tick + age of the report)` of where the eye
//! was reported: see [`casca_walls`]. Answers err by telling too much. Sets from cell to cell that
//! were found ahead of time, if there are some, decide many pairs before: see
//! [`VisibilityServer::set_baked`].
//!
//! # Limits
//!
//! - Walls are rectangles across an axis. Occluders that are round, turned or slanted hide nothing.
//! - Who reports nothing is told of more, as if the eye went on for [`ServerOptions::most_age`].
//! - Entities hide nothing. A door that is closed is an object of the level: see
//!   [`VisibilityServer::level_mut`].
//! - Boxes of entities must hold all that can be seen of them, weapons and effects included.
//!
//! # Features
//!
//! - `rayon`, on by default: clients are answered by several threads.
//! - `bots`: the module `bots`, with levels from test scenes and files, and bots that run in them.
//! - `wire`: the modules `wire` and `session`, with the protocol of `PROTOCOL.md`.
//! - `net`: the modules `net` and `program`, the command `casca serve`: WebSockets, metrics, a map.
#![deny(missing_docs)]

mod baked;
#[cfg(feature = "bots")]
pub mod bots;
mod describe;
mod error;
mod id;
#[cfg(feature = "net")]
pub mod net;
mod numeric;
mod options;
#[cfg(feature = "net")]
pub mod program;
mod server;
#[cfg(feature = "wire")]
pub mod session;
mod space;
#[cfg(feature = "wire")]
pub mod wire;

pub use casca;
pub use describe::{ClientDesc, EntityDesc, Team};
pub use error::ServerError;
pub use id::{ClientId, EntityId};
pub use numeric::{FARTHEST, FASTEST, LONGEST};
pub use options::ServerOptions;
pub use server::{Answer, VisibilityServer};
