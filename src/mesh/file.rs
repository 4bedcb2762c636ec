//! Prepared meshes as bytes.
//!
//! Numbers are little endian; floats are IEEE 754. A mesh is:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `cascamsh` |
//! | 4 | version, 2 |
//! | 8 | length of the contents |
//! | | contents: the sections below, in this order |
//! | 8 | checksum of all before: FNV-1a of 64 bits |
//!
//! Each section is a count of 8 bytes and as many entries:
//!
//! | section | bytes of an entry | entry |
//! |---|---|---|
//! | positions | 12 | x, y, z (f32) |
//! | triangles | 12 | three positions (u32) |
//! | flags | 10 | one entry: closed (u8, 0 or 1); occludes (u8, 0 or 1); sine of the greatest angle in a patch if triangles hide from their front, else -1 (f64) |
//! | sides | 33 | from, to (f32 x 3), slack (f32), patch beyond or 2^32 - 1 (u32), opposite (u8, 0 or 1) |
//! | patches | 68 | number of its sides (u32), normal (f64 x 3), lo, hi (f64), box (f32 x 6) |
//! | clusters | 4 | number of its patches (u32) |
//! | open sides | 12 | side (u32), chain (u64) |
//! | parts | 6 and more | numbers of vertices, faces, edges (u16); vertices (f64 x 3), faces (f64 x 4), edges (u16 x 4) |
//!
//! Sides lie in the order of their patches, patches in that of their clusters. What follows from the
//! rest is computed when read: the bounds, and slack and boxes of patches and clusters. A mesh that occludes nothing has
//! no sides, patches, clusters and open sides.
//! What is read and written again gives the same bytes.

use std::io::{self, Read, Write};

use glam::{DVec3, Vec3};

use crate::error::FileError;
use crate::geometry::Aabb;
use crate::mesh::surface::{Cluster, NONE, Patch, Side, Surface, slack};
use crate::mesh::tri_mesh::{TriMesh, is_closed};
use crate::shape::convex::Convex;

const MAGIC: [u8; 8] = *b"cascamsh";
const VERSION: u32 = 2;
/// Bytes before the contents.
const HEADER: usize = 20;
/// Bytes after the contents.
const CHECKSUM: usize = 8;

const POSITIONS: &str = "positions";
const TRIANGLES: &str = "triangles";
const FLAGS: &str = "flags";
const SIDES: &str = "sides";
const PATCHES: &str = "patches";
const CLUSTERS: &str = "clusters";
const OPEN: &str = "open sides";
const PARTS: &str = "parts";

/// Corners, faces or edges of a part, at most: twice what a box with 20 planes cut off can have.
const MOST_OF_PART: usize = 144;

/// Share of the coordinates by which entries may miss what they should touch: far above all roundings.
const ROUNDING: f64 = 1e-6;

impl TriMesh {
    /// Writes the mesh as prepared, so that [`TriMesh::read`] gets it back in a fraction of the time that
    /// preparing took. Several meshes may follow each other in a stream.
    ///
    /// The layout, described at the top of `src/shape/file.rs`, has a version: files of others are
    /// refused, so keep what meshes are made of.
    ///
    /// ```
    /// use casca::TriMesh;
    /// use glam::Vec3;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// let mesh = TriMesh::new(corners, faces)?;
    /// let mut file = Vec::new();
    /// mesh.write(&mut file)?;
    ///
    /// let loaded = TriMesh::read(&mut file.as_slice())?;
    /// assert_eq!(loaded.triangles(), mesh.triangles());
    /// assert!(loaded.is_closed());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Those of the stream.
    pub fn write(&self, out: &mut (impl Write + ?Sized)) -> io::Result<()> {
        let mut bytes = Vec::new();
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend([0; 8]);
        self.contents(&mut bytes);
        let length = (bytes.len() - HEADER) as u64;
        bytes[HEADER - 8..HEADER].copy_from_slice(&length.to_le_bytes());
        bytes.extend(checksum(&bytes).to_le_bytes());
        out.write_all(&bytes)
    }

    /// Reads a mesh that [`TriMesh::write`] wrote, and not a byte more. Memory is only taken for bytes
    /// that are there.
    ///
    /// Checked are the checksum, and that every number is one that a prepared mesh can hold: no file
    /// makes the library panic. That the mesh is closed if the file says so is checked too.
    ///
    /// Trusted is that the patches and parts are those of the triangles. The checksum finds
    /// accidents, but not intent: who makes a file by hand can have it hide what its triangles do not
    /// hide, or be hidden where its triangles are seen. Prepare meshes of unknown origin yourself.
    ///
    /// # Errors
    /// Says what is wrong with bytes that are no such mesh; the stream is then left somewhere in them. At
    /// the end of the stream that is [`FileError::Truncated`] after 0 bytes.
    pub fn read(input: &mut (impl Read + ?Sized)) -> Result<Self, FileError> {
        let mut bytes = Vec::new();
        let mut fetch = |more: u64, bytes: &mut Vec<u8>| -> Result<(), FileError> {
            let needed = more.saturating_add(bytes.len() as u64);
            // It takes memory bit by bit, as bytes arrive.
            (&mut *input).take(more).read_to_end(bytes)?;
            if !bytes.starts_with(&MAGIC[..MAGIC.len().min(bytes.len())]) {
                let mut found = [0; 8];
                found.iter_mut().zip(bytes.iter()).for_each(|(to, from)| *to = *from);
                return Err(FileError::Magic { found });
            }
            let held = bytes.len() as u64;
            if held < needed { Err(FileError::Truncated { held, needed }) } else { Ok(()) }
        };
        fetch(HEADER as u64, &mut bytes)?;
        let mut header = Contents { rest: &bytes[MAGIC.len()..], section: "numbers of the header" };
        let (found, length) = (header.u32()?, header.u64()?);
        if found != VERSION {
            return Err(FileError::Version { found, known: VERSION });
        }
        fetch(length.saturating_add(CHECKSUM as u64), &mut bytes)?;
        let (all, last) = bytes.split_at(bytes.len() - CHECKSUM);
        let stored = Contents { rest: last, section: "checksum" }.u64()?;
        let computed = checksum(all);
        if stored != computed {
            return Err(FileError::Checksum { stored, computed });
        }
        let mut contents = Contents { rest: &all[HEADER..], section: POSITIONS };
        let mesh = contents.mesh()?;
        match contents.rest.len() {
            0 => Ok(mesh),
            n => Err(FileError::Trailing(n as u64)),
        }
    }

    /// Appends all sections.
    fn contents(&self, out: &mut Vec<u8>) {
        let count = |out: &mut Vec<u8>, n: usize| out.extend((n as u64).to_le_bytes());
        count(out, self.positions.len());
        self.positions.iter().for_each(|&p| put3(out, p));
        count(out, self.triangles.len());
        out.extend(self.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()));
        count(out, 1);
        out.push(u8::from(self.closed));
        out.push(u8::from(self.occludes));
        out.extend(self.surface.front.unwrap_or(-1.0).to_le_bytes());
        let Surface { sides, patches, clusters, open, .. } = &self.surface;
        count(out, sides.len());
        for side in sides {
            put3(out, side.from);
            put3(out, side.to);
            out.extend(side.slack.to_le_bytes());
            out.extend(side.twin.to_le_bytes());
            out.push(u8::from(side.opposite));
        }
        count(out, patches.len());
        for patch in patches {
            out.extend((patch.last - patch.first).to_le_bytes());
            let DVec3 { x, y, z } = patch.normal;
            out.extend([x, y, z, patch.lo, patch.hi].iter().flat_map(|v| v.to_le_bytes()));
            put3(out, patch.min);
            put3(out, patch.max);
        }
        count(out, clusters.len());
        out.extend(clusters.iter().flat_map(|c| (c.last - c.first).to_le_bytes()));
        count(out, open.len());
        for (side, chain) in open {
            out.extend(side.to_le_bytes());
            out.extend(chain.to_le_bytes());
        }
        count(out, self.parts.len());
        for Convex { vertices, faces, edges, .. } in &self.parts {
            let counts = [vertices.len(), faces.len(), edges.len()];
            out.extend(counts.iter().flat_map(|&n| (n as u16).to_le_bytes()));
            out.extend(vertices.iter().flat_map(|v| v.to_array()).flat_map(f64::to_le_bytes));
            let planes = faces.iter().flat_map(|&(n, h)| [n.x, n.y, n.z, h]);
            out.extend(planes.flat_map(f64::to_le_bytes));
            out.extend(edges.iter().flatten().flat_map(|i| i.to_le_bytes()));
        }
    }
}

fn put3(out: &mut Vec<u8>, v: Vec3) {
    out.extend(v.to_array().iter().flat_map(|c| c.to_le_bytes()));
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo 1991). No two inputs that differ in one byte have the same.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}

/// What is left of the contents, and the section that is read.
struct Contents<'a> {
    rest: &'a [u8],
    section: &'static str,
}

impl Contents<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], FileError> {
        let Some((head, rest)) = self.rest.split_first_chunk() else { return Err(self.short(N as u64)) };
        self.rest = rest;
        Ok(*head)
    }

    fn short(&self, needed: u64) -> FileError {
        FileError::Section { section: self.section, needed, held: self.rest.len() as u64 }
    }

    fn flag(&mut self, entry: usize) -> Result<bool, FileError> {
        match self.take()? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(self.broken(entry, "has a flag that is neither 0 nor 1")),
        }
    }

    fn u16(&mut self) -> Result<u16, FileError> {
        self.take().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Result<u32, FileError> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, FileError> {
        self.take().map(u64::from_le_bytes)
    }

    fn f32(&mut self) -> Result<f32, FileError> {
        self.take().map(f32::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64, FileError> {
        self.take().map(f64::from_le_bytes)
    }

    fn vec3(&mut self) -> Result<Vec3, FileError> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    fn dvec3(&mut self) -> Result<DVec3, FileError> {
        Ok(DVec3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    fn broken(&self, entry: usize, why: &'static str) -> FileError {
        FileError::Entry { section: self.section, entry, why }
    }

    /// Refuses an entry of the section unless a condition holds.
    fn check(&self, entry: usize, holds: bool, why: &'static str) -> Result<(), FileError> {
        if holds { Ok(()) } else { Err(self.broken(entry, why)) }
    }

    /// Entries of at least `size` bytes each.
    fn list<T>(
        &mut self,
        count: u64,
        size: u64,
        mut entry: impl FnMut(&mut Self, usize) -> Result<T, FileError>,
    ) -> Result<Vec<T>, FileError> {
        let needed = count.saturating_mul(size);
        if needed > self.rest.len() as u64 {
            return Err(self.short(needed));
        }
        let mut entries = Vec::with_capacity(count as usize);
        for i in 0..count as usize {
            entries.push(entry(self, i)?);
        }
        Ok(entries)
    }

    /// A section of entries of at least `size` bytes each.
    fn section<T>(
        &mut self,
        name: &'static str,
        size: u64,
        entry: impl FnMut(&mut Self, usize) -> Result<T, FileError>,
    ) -> Result<Vec<T>, FileError> {
        self.section = name;
        let count = self.u64()?;
        self.list(count, size, entry)
    }

    fn mesh(&mut self) -> Result<TriMesh, FileError> {
        let positions = self.section(POSITIONS, 12, |c, i| {
            let p = c.vec3()?;
            c.check(i, p.is_finite(), "is not finite")?;
            Ok(p)
        })?;
        let triangles = self.section(TRIANGLES, 12, |c, i| {
            let t = [c.u32()?, c.u32()?, c.u32()?];
            let there = t.iter().all(|&v| (v as usize) < positions.len());
            c.check(i, there, "names a position that is not there")?;
            Ok(t)
        })?;
        let corners = triangles.iter().flatten().map(|&v: &u32| positions[v as usize]);
        let Some(bounds) = Aabb::from_points(corners) else {
            return Err(self.broken(0, "is missing: a mesh has at least one"));
        };
        let flags = self.section(FLAGS, 10, |c, i| {
            c.check(i, i == 0, "is one too many")?;
            let (closed, occludes, front) = (c.flag(i)?, c.flag(i)?, c.f64()?);
            let sine = front == -1.0 || (0.0..=1.0).contains(&front);
            c.check(i, sine, "has a sine that is neither -1 nor in [0, 1]")?;
            let two_sided = occludes || front == -1.0;
            c.check(i, two_sided, "has a sine, though the mesh occludes nothing")?;
            // Only a mesh that is closed can have opaque cells.
            let holds = !closed || is_closed(&positions, &triangles);
            c.check(i, holds, "says that the mesh is closed, which it is not")?;
            Ok((closed, occludes, (front != -1.0).then_some(front)))
        })?;
        let &[(closed, occludes, front)] = flags.as_slice() else {
            return Err(self.broken(0, "is missing"));
        };
        let surface = self.surface(bounds, front)?;
        let empty = occludes || surface.sides.is_empty();
        self.section = SIDES;
        self.check(0, empty, "is one too many: the mesh occludes nothing")?;
        let parts = self.parts(bounds)?;
        Ok(TriMesh::from_prepared(positions, triangles, bounds, (closed, occludes), surface, parts))
    }

    fn surface(&mut self, bounds: Aabb, front: Option<f64>) -> Result<Surface, FileError> {
        let sides = self.section(SIDES, 33, |c, i| {
            let side = Side {
                from: c.vec3()?,
                to: c.vec3()?,
                slack: c.f32()?,
                twin: c.u32()?,
                opposite: c.flag(i)?,
            };
            c.check(i, side.slack >= 0.0, "has a slack that is negative or no number")?;
            let alone = side.twin == NONE && side.opposite;
            c.check(i, !alone, "is opposite to no patch")?;
            Ok(side)
        })?;
        let mut first = 0u32;
        let largest = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        let room = ROUNDING * largest;
        let patches = self.section(PATCHES, 68, |c, i| {
            let last = c.u32()?.checked_add(first).filter(|&last| first < last);
            let Some(own) = last.and_then(|last| sides.get(first as usize..last as usize)) else {
                return Err(c.broken(i, "has no sides, or more than there are"));
            };
            let last = first + own.len() as u32;
            let (normal, lo, hi) = (c.dvec3()?, c.f64()?, c.f64()?);
            let (min, max) = (c.vec3()?, c.vec3()?);
            c.check(i, (normal.length() - 1.0).abs() <= ROUNDING, "has a normal that is not of length 1")?;
            let inside = min.cmpge(bounds.min).all() && max.cmple(bounds.max).all() && min.cmple(max).all();
            c.check(i, inside, "has a box that is inverted or leaves the mesh")?;
            let (a, b) = (normal * min.as_dvec3(), normal * max.as_dvec3());
            let (least, most) = (a.min(b).element_sum() - room, a.max(b).element_sum() + room);
            c.check(
                i,
                least <= lo && lo <= hi && hi <= most,
                "has a slab that is inverted or leaves its box",
            )?;
            for side in own {
                for p in [side.from, side.to] {
                    let along = normal.dot(p.as_dvec3());
                    let held = min.cmple(p).all() && max.cmpge(p).all() && lo <= along && along <= hi;
                    c.check(i, held, "has a side that leaves its box or slab")?;
                }
                c.check(i, side.twin != i as u32, "has a side with itself beyond")?;
            }
            let patch = Patch { first, last, normal, lo, hi, min, max, slack: slack(own) };
            first = last;
            Ok(patch)
        })?;
        if first as usize != sides.len() {
            return Err(self.broken(patches.len(), "is missing: there are sides without a patch"));
        }
        let beyond = |s: &Side| s.twin != NONE && s.twin as usize >= patches.len();
        if let Some(entry) = sides.iter().position(beyond) {
            return Err(FileError::Entry { section: SIDES, entry, why: "names a patch that is not there" });
        }
        let mut first = 0u32;
        let clusters = self.section(CLUSTERS, 4, |c, i| {
            let last = c.u32()?.checked_add(first);
            match last.filter(|&last| first < last && last as usize <= patches.len()) {
                Some(last) => Ok(Cluster::new(std::mem::replace(&mut first, last), last, &patches)),
                None => Err(c.broken(i, "has no patches, or more than there are")),
            }
        })?;
        if first as usize != patches.len() {
            return Err(self.broken(clusters.len(), "is missing: there are patches without a cluster"));
        }
        let mut next = 0;
        let open = self.section(OPEN, 12, |c, i| {
            let (side, chain) = (c.u32()?, c.u64()?);
            let alone = sides.get(side as usize).is_some_and(|s| s.twin == NONE);
            c.check(i, alone, "names a side that is not there, or has a patch beyond")?;
            c.check(i, side as usize >= next, "names a side that comes before that of the last entry")?;
            next = side as usize + 1;
            Ok((side, chain))
        })?;
        Ok(Surface { sides, patches, clusters, front, open })
    }

    fn parts(&mut self, bounds: Aabb) -> Result<Vec<Convex>, FileError> {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let size = (high - low).length();
        let largest = low.abs().max(high.abs()).max_element();
        let room = ROUNDING * (largest + size) + 2.0 * f64::MIN_POSITIVE;
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let parts = self.section(PARTS, 6, |c, i| {
            let counts = [c.u16()?, c.u16()?, c.u16()?];
            let solid = counts.iter().zip([4, 4, 6]).all(|(&n, least)| n >= least);
            c.check(i, solid, "has too few corners, faces or edges for a solid")?;
            let few = counts.iter().all(|&n| usize::from(n) <= MOST_OF_PART);
            c.check(i, few, "has too many corners, faces or edges")?;
            let [corners, planes, _] = counts;
            let vertices = c.list(corners.into(), 24, |c, _| {
                let v = c.dvec3()?;
                // Turned boxes reach out of the mesh, but not farther than their diagonals.
                let near = v.cmpge(low - size - room).all() && v.cmple(high + size + room).all();
                c.check(i, near, "has a corner that is far from the mesh")?;
                (min, max) = (min.min(v), max.max(v));
                Ok(v)
            })?;
            let faces = c.list(planes.into(), 32, |c, _| {
                let (n, h) = (c.dvec3()?, c.f64()?);
                let unit = (n.length() - 1.0).abs() <= ROUNDING;
                c.check(i, unit, "has a face whose normal is not of length 1")?;
                let most = vertices.iter().map(|v| n.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
                c.check(i, (h - most).abs() <= room, "has a face that does not touch its corners")?;
                Ok((n, h))
            })?;
            let edges = c.list(counts[2].into(), 8, |c, _| {
                let edge = [c.u16()?, c.u16()?, c.u16()?, c.u16()?];
                let [a, b, f, g] = edge;
                let apart = a != b && f != g;
                let there = a.max(b) < corners && f.max(g) < planes;
                c.check(i, apart && there, "has an edge without two of its corners and two of its faces")?;
                Ok(edge)
            })?;
            Ok(Convex { vertices, faces, edges, lost: 0.0 })
        })?;
        let holds = min.cmple(low).all() && max.cmpge(high).all();
        self.check(parts.len(), holds, "is missing: all parts together do not reach around the mesh")?;
        Ok(parts)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Affine3A, UVec3};

    use super::*;
    use crate::geometry::Sphere;
    use crate::grid::GridSpec;
    use crate::mesh::instance::Instance;
    use crate::mesh::tri_mesh::{Facing, Preparation};
    use crate::object::ObjectDesc;
    use crate::query::Query;
    use crate::scene::Scene;
    use crate::view::View;

    /// A floor and a wall that share an edge: two patches, with a seam and open sides.
    fn corner() -> TriMesh {
        let positions = vec![
            Vec3::new(1.0, 1.0, 1.0),
            Vec3::new(5.0, 1.0, 1.0),
            Vec3::new(5.0, 1.0, 5.0),
            Vec3::new(1.0, 1.0, 5.0),
            Vec3::new(1.0, 6.0, 1.0),
            Vec3::new(5.0, 6.0, 1.0),
        ];
        TriMesh::new(positions, vec![[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4]]).unwrap()
    }

    /// A ball, so coarse that outlines leave the edges of triangles; closed unless rings are left out.
    fn ball(center: Vec3, rings: std::ops::Range<u32>, how: &Preparation) -> TriMesh {
        let point = |ring: u32, step: u32| {
            let (tilt, angle) = (ring as f32 * 0.196_349_55, (step % 24) as f32 * 0.261_799_4);
            let flat = if ring.is_multiple_of(16) { 0.0 } else { tilt.sin() };
            center + Vec3::new(flat * angle.cos(), tilt.cos(), flat * angle.sin()) * 2.0
        };
        let positions = (0..=16).flat_map(|r| (0..24).map(move |s| point(r, s))).collect();
        let at = |r: u32, s: u32| r * 24 + s % 24;
        let quad = |(r, s)| {
            let (a, b, c, d) = (at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s));
            [[a, b, c], [a, c, d]]
        };
        let triangles = rings.flat_map(|r| (0..24).map(move |s| (r, s))).flat_map(quad).collect();
        TriMesh::prepare(positions, triangles, how, &mut |_| ()).unwrap()
    }

    fn meshes() -> Vec<TriMesh> {
        let front = Preparation { facing: Facing::Front, tolerance: Some(0.1), ..Preparation::default() };
        let scaled = |s: f32| {
            let positions = corner().positions.iter().map(|&p| (p - 3.5) * s).collect();
            TriMesh::new(positions, corner().triangles).unwrap()
        };
        vec![
            corner(),
            ball(Vec3::splat(8.0), 0..16, &Preparation::default()),
            ball(Vec3::new(3.0, 8.0, 8.0), 0..11, &front),
            // Nothing to hide with, the zeros of both signs, and the largest and least numbers.
            TriMesh::new(vec![Vec3::ONE; 3], vec![[0, 1, 2]]).unwrap(),
            TriMesh::new(vec![Vec3::ZERO, -Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 2, 3], [1, 3, 2]])
                .unwrap(),
            scaled(f32::MAX / 4.0),
            scaled(1e-45),
        ]
    }

    fn bytes(mesh: &TriMesh) -> Vec<u8> {
        let mut bytes = Vec::new();
        mesh.write(&mut bytes).unwrap();
        bytes
    }

    fn read(mut bytes: &[u8]) -> Result<TriMesh, FileError> {
        TriMesh::read(&mut bytes)
    }

    /// Makes length and checksum those of changed contents.
    fn mend(bytes: &mut Vec<u8>) {
        bytes.truncate(bytes.len() - CHECKSUM);
        let length = (bytes.len() - HEADER) as u64;
        bytes[HEADER - 8..HEADER].copy_from_slice(&length.to_le_bytes());
        bytes.extend(checksum(bytes).to_le_bytes());
    }

    /// Where the count of each section is.
    fn places(bytes: &[u8]) -> [usize; 8] {
        let mut at = HEADER;
        [12, 12, 10, 33, 68, 4, 12, 0].map(|size| {
            let here = at;
            at += 8 + size * u64::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize;
            here
        })
    }

    /// What can be seen of some objects around a mesh that is placed twice.
    fn seen(mesh: TriMesh) -> Vec<Vec<usize>> {
        let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(16) };
        let mut scene = Scene::new(&spec).unwrap();
        let mesh = Arc::new(mesh);
        let fixed = ObjectDesc::fixed(mesh.clone()).occluder(mesh.clone());
        let mut ids = vec![scene.insert(fixed).unwrap()];
        if let Ok(moved) = Instance::new(mesh, Affine3A::from_rotation_x(0.3)) {
            let desc = ObjectDesc::dynamic(moved.clone()).occluder(moved);
            ids.push(scene.insert(desc).unwrap());
            scene.translate(ids[1], Vec3::new(7.0, 1.0, 6.0)).ok();
        }
        for i in 0..216 {
            let center = Vec3::new((i % 6) as f32, (i / 6 % 6) as f32, (i / 36) as f32) * 2.5 + 1.5;
            ids.push(scene.insert(ObjectDesc::fixed(Sphere::new(center, 0.2))).unwrap());
        }
        let mut query = Query::new();
        let eyes = [Vec3::new(3.0, 3.0, 7.5), Vec3::new(3.1, 3.2, 0.4), Vec3::new(15.0, 12.0, 13.0)];
        let look = |eye| {
            let pvs = query.run(&scene, &View::from_planes(eye, &[]).unwrap());
            (0..ids.len()).filter(|&i| pvs.contains(ids[i])).collect()
        };
        eyes.into_iter().map(look).collect()
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        let all = meshes();
        assert!(all.iter().any(|m| m.surface.sides.iter().any(|s| s.slack > 0.0)));
        assert!(all.iter().any(|m| m.surface.sides.iter().any(|s| s.opposite)));
        assert!(all.iter().any(|m| m.surface.clusters.len() > 1 && m.closed));
        assert!(all.iter().any(|m| !m.surface.open.is_empty() && m.surface.front.is_some()));
        // One after the other, and nothing of the next is taken.
        let mut stream: Vec<u8> = all.iter().flat_map(bytes).collect();
        stream.extend(b"more");
        let mut rest = stream.as_slice();
        for mesh in &all {
            let loaded = TriMesh::read(&mut rest).unwrap();
            assert_eq!(loaded.positions, mesh.positions);
            assert_eq!(loaded.triangles, mesh.triangles);
            assert_eq!((loaded.bounds, loaded.closed), (mesh.bounds, mesh.closed));
            assert_eq!(loaded.surface, mesh.surface);
            assert_eq!(loaded.parts, mesh.parts);
            assert_eq!(bytes(&loaded), bytes(mesh));
        }
        assert_eq!(rest, b"more");
        assert!(matches!(read(&[]), Err(FileError::Truncated { held: 0, .. })));
    }

    #[test]
    fn a_loaded_mesh_hides_what_the_prepared_one_hides() {
        let mut hidden = 0;
        for mesh in meshes() {
            let before = seen(mesh.clone());
            assert_eq!(seen(read(&bytes(&mesh)).unwrap()), before);
            hidden += before.iter().map(|seen| 218 - seen.len()).sum::<usize>();
        }
        assert!(hidden > 100, "{hidden}");
    }

    #[test]
    fn bounds_only_stay_bounds_only() {
        let whole = ball(Vec3::splat(8.0), 0..16, &Preparation::default());
        let mesh = TriMesh::bounds_only(whole.positions.clone(), whole.triangles.clone()).unwrap();
        let loaded = read(&bytes(&mesh)).unwrap();
        assert!(!loaded.occludes() && loaded.is_closed() && !loaded.solid);
        assert_eq!((loaded.sides(), loaded.parts.len()), (0, mesh.parts.len()));
        assert_eq!(bytes(&loaded), bytes(&mesh));
        assert!(bytes(&mesh).len() < bytes(&whole).len());
        // What hides nothing has no front, and nothing to hide with.
        let flags = places(&bytes(&mesh))[2];
        let mut front = bytes(&mesh);
        front[flags + 10..flags + 18].copy_from_slice(&0.5f64.to_le_bytes());
        mend(&mut front);
        let refused = read(&front).unwrap_err().to_string();
        assert!(refused.contains("has a sine, though the mesh occludes nothing"), "{refused}");
    }

    #[test]
    fn refuses_every_damaged_byte() {
        let whole = bytes(&corner());
        for at in 0..whole.len() {
            for flip in [1, 0x10, 0x80, 0xff] {
                let mut damaged = whole.clone();
                damaged[at] ^= flip;
                let refused = read(&damaged).unwrap_err();
                let named = match at {
                    0..8 => matches!(refused, FileError::Magic { .. }),
                    8..12 => {
                        matches!(refused, FileError::Version { found, known: VERSION } if found != VERSION)
                    }
                    12..20 => {
                        matches!(refused, FileError::Truncated { .. } | FileError::Checksum { .. })
                    }
                    _ => matches!(refused, FileError::Checksum { .. }),
                };
                assert!(named, "byte {at}: {refused}");
            }
        }
    }

    #[test]
    fn refuses_every_shortened_file() {
        let whole = bytes(&corner());
        for length in 0..whole.len() {
            match read(&whole[..length]).unwrap_err() {
                FileError::Truncated { held, needed } => {
                    assert_eq!(held, length as u64);
                    let known = if length < HEADER { HEADER } else { whole.len() };
                    assert_eq!(needed, known as u64);
                }
                other => panic!("{length} bytes: {other}"),
            }
            // The same with a checksum that is right.
            if length > HEADER + CHECKSUM {
                let mut short = whole[..length].to_vec();
                mend(&mut short);
                let refused = read(&short).unwrap_err();
                assert!(matches!(refused, FileError::Section { .. }), "{length} bytes: {refused}");
            }
        }
        assert!(matches!(
            read(b"glTF"),
            Err(FileError::Magic { found: [b'g', b'l', b'T', b'F', 0, 0, 0, 0] })
        ));
    }

    #[test]
    fn refuses_what_follows_the_last_section() {
        let mut long = bytes(&corner());
        long.splice(long.len() - CHECKSUM..long.len() - CHECKSUM, [0; 3]);
        mend(&mut long);
        assert!(matches!(read(&long), Err(FileError::Trailing(3))));
    }

    #[test]
    fn other_versions_are_refused() {
        for found in [0, 1, 3, u32::MAX] {
            let mut other = bytes(&corner());
            other[8..12].copy_from_slice(&found.to_le_bytes());
            mend(&mut other);
            let refused = read(&other).unwrap_err();
            assert!(matches!(refused, FileError::Version { found: f, known: VERSION } if f == found));
        }
    }

    /// A stream that never holds more than asked for, and says how much that was.
    struct Endless(u64);

    impl Read for Endless {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.0 += buffer.len() as u64;
            // Far above what doubling takes, far below what is claimed.
            if self.0 > 1 << 20 { Err(io::Error::other("asked for too much")) } else { Ok(0) }
        }
    }

    #[test]
    fn claims_take_no_memory() {
        let whole = bytes(&corner());
        // More than any machine has: taking it fails at once.
        for claim in [1u64 << 36, 1 << 44, 1 << 60, u64::MAX / 12 + 2, u64::MAX] {
            let mut header = whole[..HEADER].to_vec();
            header[12..20].copy_from_slice(&claim.to_le_bytes());
            let mut stream = header.as_slice().chain(Endless(0));
            let refused = TriMesh::read(&mut stream).unwrap_err();
            assert!(matches!(refused, FileError::Truncated { held: 20, .. }), "{refused}");
            for at in places(&whole) {
                let mut claiming = whole.clone();
                claiming[at..at + 8].copy_from_slice(&claim.to_le_bytes());
                mend(&mut claiming);
                let refused = read(&claiming).unwrap_err();
                assert!(matches!(refused, FileError::Section { .. }), "{claim} at {at}: {refused}");
            }
        }
    }

    #[test]
    fn refuses_nonsense_with_a_right_checksum() {
        let whole = bytes(&corner());
        let [positions, triangles, flags, sides, patches, clusters, open, parts] = places(&whole);
        let (nan, inf) = (f32::NAN.to_le_bytes(), f32::INFINITY.to_le_bytes());
        let (nan64, two) = (f64::NAN.to_le_bytes(), 2f64.to_le_bytes());
        let none = NONE.to_le_bytes();
        let (counts, first) = (parts + 8, parts + 14);
        let vertices = usize::from(whole[counts]);
        let faces = first + 24 * vertices;
        let edges = faces + 32 * usize::from(whole[counts + 2]);
        // The first open side, and one with a patch beyond.
        let alone = u32::from_le_bytes(*whole[open + 8..].first_chunk().unwrap()) as usize;
        let mesh = corner();
        let beyond = mesh.surface.sides.iter().position(|s| s.twin != NONE).unwrap();
        let twin = |side: usize| sides + 8 + 33 * side + 28;
        let own = u32::from(mesh.surface.patches[0].last as usize <= beyond).to_le_bytes();
        let cases: &[(usize, &[u8], &str, &str)] = &[
            (positions + 8, &nan, POSITIONS, "not finite"),
            (positions + 20, &inf, POSITIONS, "not finite"),
            (triangles + 8, &6u32.to_le_bytes(), TRIANGLES, "not there"),
            (triangles + 8, &none, TRIANGLES, "not there"),
            (flags + 8, &[1], FLAGS, "which it is not"),
            (flags + 8, &[2], FLAGS, "neither 0 nor 1"),
            (flags + 9, &[3], FLAGS, "neither 0 nor 1"),
            (flags + 9, &[0], SIDES, "occludes nothing"),
            (flags + 10, &two, FLAGS, "sine"),
            (flags + 10, &nan64, FLAGS, "sine"),
            (sides + 8, &nan, PATCHES, "leaves its box"),
            (sides + 20, &100f32.to_le_bytes(), PATCHES, "leaves its box"),
            (sides + 32, &nan, SIDES, "slack"),
            (sides + 32, &(-1f32).to_le_bytes(), SIDES, "slack"),
            (twin(beyond), &2u32.to_le_bytes(), SIDES, "not there"),
            (twin(beyond), &own, PATCHES, "itself beyond"),
            (twin(beyond), &none, SIDES, "opposite to no patch"),
            (twin(alone), &1u32.to_le_bytes(), OPEN, "patch beyond"),
            (twin(alone) + 4, &[7], SIDES, "neither 0 nor 1"),
            (patches + 8, &0u32.to_le_bytes(), PATCHES, "no sides"),
            (patches + 8, &none, PATCHES, "more than there are"),
            (patches + 76, &3u32.to_le_bytes(), PATCHES, "sides without a patch"),
            (patches + 12, &nan64, PATCHES, "length 1"),
            (patches + 12, &two, PATCHES, "length 1"),
            (patches + 36, &nan64, PATCHES, "slab"),
            (patches + 36, &(-1e9f64).to_le_bytes(), PATCHES, "slab"),
            (patches + 36, &1e9f64.to_le_bytes(), PATCHES, "slab"),
            (patches + 44, &1e9f64.to_le_bytes(), PATCHES, "slab"),
            (patches + 52, &nan, PATCHES, "leaves the mesh"),
            (patches + 52, &0f32.to_le_bytes(), PATCHES, "leaves the mesh"),
            (patches + 64, &7f32.to_le_bytes(), PATCHES, "leaves the mesh"),
            (clusters + 8, &0u32.to_le_bytes(), CLUSTERS, "no patches"),
            (clusters + 8, &1u32.to_le_bytes(), CLUSTERS, "without a cluster"),
            (clusters + 8, &none, CLUSTERS, "more than there are"),
            (open + 8, &none, OPEN, "not there"),
            (open + 8, &(beyond as u32).to_le_bytes(), OPEN, "patch beyond"),
            (open + 20, &(alone as u32).to_le_bytes(), OPEN, "comes before"),
            (counts, &3u16.to_le_bytes(), PARTS, "too few"),
            (counts + 2, &3u16.to_le_bytes(), PARTS, "too few"),
            (counts + 4, &0u16.to_le_bytes(), PARTS, "too few"),
            (counts + 4, &300u16.to_le_bytes(), PARTS, "too many"),
            (first, &nan64, PARTS, "far from"),
            (first, &1e30f64.to_le_bytes(), PARTS, "far from"),
            (faces, &two, PARTS, "length 1"),
            (faces + 24, &nan64, PARTS, "touch"),
            (faces + 24, &9f64.to_le_bytes(), PARTS, "touch"),
            (edges, &(vertices as u16).to_le_bytes(), PARTS, "without two"),
            (edges + 4, &100u16.to_le_bytes(), PARTS, "without two"),
            (edges, &whole[edges + 2..edges + 4], PARTS, "without two"),
        ];
        for &(at, new, named, reason) in cases {
            let mut made = whole.clone();
            made[at..at + new.len()].copy_from_slice(new);
            assert_ne!(made, whole, "{named}: {reason}");
            mend(&mut made);
            match read(&made).unwrap_err() {
                FileError::Entry { section, why, .. } if section == named => {
                    assert!(why.contains(reason), "{named} {why}, where {reason} was expected");
                }
                other => panic!("{named} {reason}: {other}"),
            }
        }
        // Sections without entries.
        let cut = |from: usize, size: usize, count: u64| {
            let mut made = whole.clone();
            made.drain(from + 8..from + 8 + size);
            made[from..from + 8].copy_from_slice(&count.to_le_bytes());
            mend(&mut made);
            read(&made).unwrap_err().to_string()
        };
        assert!(cut(triangles, 48, 0).contains("triangles of the mesh is missing"));
        assert!(cut(flags, 10, 0).contains("flags of the mesh is missing"));
        assert!(cut(clusters, 4, 0).contains("without a cluster"));
        assert!(cut(parts, whole.len() - CHECKSUM - parts - 8, 0).contains("around the mesh"));
        let mut twice = whole.clone();
        twice[flags..flags + 8].copy_from_slice(&2u64.to_le_bytes());
        mend(&mut twice);
        assert!(read(&twice).unwrap_err().to_string().contains("one too many"));
    }

    #[test]
    fn what_passes_all_checks_does_no_harm() {
        let whole = bytes(&corner());
        let mut taken = 0;
        for at in HEADER..whole.len() - CHECKSUM {
            for flip in [1, 0x80] {
                let mut made = whole.clone();
                made[at] ^= flip;
                mend(&mut made);
                if let Ok(mesh) = read(&made) {
                    assert_eq!(bytes(&mesh), made);
                    seen(mesh);
                    taken += 1;
                }
            }
        }
        assert!(taken > 50, "{taken}");
    }

    #[test]
    fn checksums_are_those_of_fnv_1a() {
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn writing_says_what_the_stream_says() {
        let mut small = [0; 100];
        assert_eq!(corner().write(&mut small.as_mut_slice()).unwrap_err().kind(), io::ErrorKind::WriteZero);
    }
}
