//! Prepared meshes as bytes.
//!
//! Numbers are little endian; floats are IEEE 754. A mesh is:
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `cascamsh` |
//! | 4 | version, 4 |
//! | 8 | length of the contents |
//! | | contents: the sections below, in this order |
//! | 8 | checksum of all bytes before: FNV-1a of 64 bits |
//!
//! Each section is a count of 8 bytes and as many entries:
//!
//! | section | bytes of an entry | entry |
//! |---|---|---|
//! | positions | 12 | x, y, z (f32) |
//! | triangles | 12 | three positions (u32) |
//! | flags | 3 | one entry: closed, occludes, hides from the front of triangles only (u8 each, 0 or 1) |
//! | sides | 17 | from, to: two positions (u32), slack (f32), patch beyond or 2^32 - 1 (u32), opposite (u8, 0 or 1) |
//! | patches | 76 | number of its sides (u32), number of patches inside (u32), sine of the greatest angle (f32), normal (f64 x 3), lo, hi (f64), box (f32 x 6) |
//! | open sides | 12 | side (u32), chain (u64) |
//! | parts | 6 and more | numbers of vertices, faces, edges (u16); vertices (f64 x 3), faces as outward normal and offset (f64 x 4), edges (u16 x 4) |
//!
//! Sides come in the order of their patches. A group comes before the patches inside, and has no
//! sides of its own; the first patch contains all others. Groups that are drawn in parts only have
//! the slab lo = infinity, hi = -infinity. Bounds, slacks and outlines that follow from the rest
//! are computed when a file is read. A mesh that occludes nothing has no sides, patches and open
//! sides. A mesh that is read and written again gives the same bytes.

mod contents;
mod read;
#[cfg(test)]
mod tests;
mod write;

use crate::mesh::tri_mesh::TriMesh;

impl TriMesh {
    /// A number that changes whenever [`TriMesh::prepare`] makes another mesh of the same triangles
    /// and options, or [`TriMesh::write`] other bytes of it: a part of the names by which prepared
    /// meshes are stored.
    pub const PREPARATION: u32 = 3;
}

const MAGIC: [u8; 8] = *b"cascamsh";
const VERSION: u32 = 4;

/// Bytes before the contents.
const HEADER: usize = 20;

/// Bytes after the contents.
const CHECKSUM: usize = 8;

const POSITIONS: &str = "positions";
const TRIANGLES: &str = "triangles";
const FLAGS: &str = "flags";
const SIDES: &str = "sides";
const PATCHES: &str = "patches";
const OPEN: &str = "open sides";
const PARTS: &str = "parts";

/// FNV-1a of 64 bits (Fowler, Noll and Vo 1991). No two inputs that differ in one byte have the
/// same.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}
