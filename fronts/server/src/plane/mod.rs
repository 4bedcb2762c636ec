//! The same promise on maps of tiles: who may be told of whom in strategy games, roguelikes and
//! games seen from above.
//!
//! A [`PlaneServer`] has a map of opaque tiles, clients and entities. An answer names an entity if
//! any eye that the client may have by then could see a tile that the entity may be in by then:
//! wherever the eye gets to within `speed * (latency + tick + age of the report)`, and likewise the
//! entity. What one eye sees is [`casca_plane::FieldOfView`]'s matter; here, all eyes of a tile are
//! asked for at once ([`casca_plane::FieldOfView::run_from_tile`]) and kept by tile.
//!
//! An entity is in all tiles that its square touches. Those that are opaque do not count, unless
//! all of them are: who hugs a wall is not seen from behind it.
//!
//! Lengths are tiles, times seconds: tile `(x, y)` is the square from `(x, y)` to `(x + 1, y + 1)`.

mod client;
mod entity;
mod ground;
mod options;
mod server;
mod sights;

pub use client::PlaneClient;
pub use entity::PlaneEntity;
pub use options::PlaneOptions;
pub use server::PlaneServer;
