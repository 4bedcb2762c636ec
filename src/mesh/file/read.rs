//! Reading a prepared mesh: every number is checked before it is used.

use std::io::Read;

use glam::{DVec3, Vec3};

use crate::error::FileError;
use crate::geometry::Aabb;
use crate::geometry::plane::HalfSpace;
use crate::mesh::file::contents::Contents;
use crate::mesh::file::{
    CHECKSUM, FLAGS, HEADER, MAGIC, OPEN, PARTS, PATCHES, POSITIONS, SIDES, TRIANGLES, VERSION, checksum,
};
use crate::mesh::surface::{
    Beyond, EDGE, Patch, PatchIndex, PatchSide, Surface, Topology, first_of_equals, slack,
};
use crate::mesh::tri_mesh::TriMesh;
use crate::numeric::mesh::FILE_ROUNDING;
use crate::shape::convex::Convex;

/// Corners, faces or edges of a part, at most: twice what a box with 20 planes cut off can have.
const MOST_OF_PART: usize = 144;

/// Groups are nested no deeper: far deeper than those of prepared meshes, and shallow enough for
/// reading to cost the file's length.
const DEEPEST: usize = 64;

impl TriMesh {
    /// Reads a mesh that [`TriMesh::write`] wrote, and not a byte more. Memory is only taken for
    /// bytes that are there.
    ///
    /// It checks the checksum, and that a prepared mesh can have every number in the file: no file
    /// makes the library panic. It also checks that the mesh is closed if the file says so.
    ///
    /// It trusts that the patches and parts are those of the triangles. The checksum finds
    /// accidents, but not intent: a file that was made by hand can hide objects that its triangles
    /// do not hide, or be hidden where its triangles are seen. Prepare meshes of unknown origin
    /// yourself.
    ///
    /// # Errors
    /// Refuses bytes that are no such mesh; the stream is then left somewhere in them. At
    /// the end of the stream the error is [`FileError::Truncated`] after 0 bytes.
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
}

impl Contents<'_> {
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
        let first = first_of_equals(&positions);
        let flags = self.section(FLAGS, 3, |c, i| {
            c.check(i, i == 0, "is one too many")?;
            let (closed, occludes, front) = (c.flag(i)?, c.flag(i)?, c.flag(i)?);
            c.check(i, occludes || !front, "hides from its front, though the mesh occludes nothing")?;
            // Only a mesh that is closed can have opaque cells.
            let topology = match closed {
                true => Topology::of(&positions, &triangles, &first),
                false => Topology { closed: false, alike: false },
            };
            c.check(i, topology.closed == closed, "says that the mesh is closed, which it is not")?;
            Ok((topology, occludes, front))
        })?;
        let &[(topology, occludes, front)] = flags.as_slice() else {
            return Err(self.broken(0, "is missing"));
        };
        let surface = self.surface(&positions, bounds, front)?;
        let empty = occludes || surface.sides.is_empty();
        self.section = SIDES;
        self.check(0, empty, "is one too many: the mesh occludes nothing")?;
        let parts = self.parts(bounds)?;
        let flags = (topology, occludes);
        Ok(TriMesh::from_prepared(positions, triangles, &first, bounds, flags, surface, parts))
    }

    fn surface(&mut self, positions: &[Vec3], bounds: Aabb, front: bool) -> Result<Surface, FileError> {
        let mut sides = self.section(SIDES, 17, |c, i| {
            let ends = [c.u32()?, c.u32()?];
            let there = ends.iter().all(|&v| (v as usize) < positions.len());
            c.check(i, there, "names a position that is not there")?;
            let slack = c.f32()?;
            c.check(i, slack >= 0.0, "has a slack that is negative or no number")?;
            let (twin, opposite) = (PatchIndex::new(c.u32()?), c.flag(i)?);
            let alone = twin == PatchIndex::NONE;
            c.check(i, !(alone && opposite), "is opposite to no patch")?;
            c.check(i, alone || twin < PatchSide::MOST, "names a patch that is not there")?;
            Ok(PatchSide::new(ends, slack, if alone { Beyond::More } else { Beyond::Patch(twin, opposite) }))
        })?;
        let patches = self.patches(positions, bounds, &sides)?;
        let beyond = |s: &PatchSide| {
            let patch = patches.get(s.twin().index());
            s.twin() != PatchIndex::NONE && patch.is_none_or(|p: &Patch| p.next != s.twin().after())
        };
        if let Some(entry) = sides.iter().position(beyond) {
            return Err(FileError::Entry { section: SIDES, entry, why: "names a patch that is not there" });
        }
        let mut next = 0;
        let mut chains = self.section(OPEN, 12, |c, i| {
            let (side, chain) = (c.u32()?, c.u64()?);
            let alone = sides.get_mut(side as usize).filter(|s| s.twin() == PatchIndex::NONE);
            let Some(alone) = alone else {
                return Err(c.broken(i, "names a side that is not there, or has a patch beyond"));
            };
            *alone = alone.opened();
            c.check(i, side as usize >= next, "names a side that comes before that of the last entry")?;
            next = side as usize + 1;
            Ok((side, chain))
        })?;
        chains.retain(|chain| chain.1 != EDGE);
        let positions = positions.into();
        let mut surface = Surface { positions, sides, patches, front, chains, ..Surface::default() };
        surface.find_group_outlines();
        self.section = PATCHES;
        for (i, patch) in surface.indexed().filter(|(i, p)| p.next > i.after()) {
            let along = |p: Vec3| patch.normal.dot(p.as_dvec3());
            let inside = |p: Vec3| patch.lo <= along(p) && along(p) <= patch.hi;
            let all = surface.outline(i).all(|(_, side)| surface.ends(&side).into_iter().all(inside));
            self.check(i.index(), all, "has parts that leave its slab")?;
        }
        surface.shrink();
        Ok(surface)
    }

    fn patches(
        &mut self,
        positions: &[Vec3],
        bounds: Aabb,
        sides: &[PatchSide],
    ) -> Result<Vec<Patch>, FileError> {
        let largest = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        let room = FILE_ROUNDING * largest;
        let mut first = 0u32;
        // The groups that the next patch is in: their boxes, and where they end.
        let mut groups: Vec<(Aabb, u32)> = Vec::new();
        let patches = self.section(PATCHES, 76, |c, i| {
            let (count, inside) = (c.u32()?, c.u32()?);
            let number = i as u32;
            while groups.pop_if(|g| g.1 == number).is_some() {}
            let next = number.checked_add(inside).and_then(|n| n.checked_add(1));
            let outer = groups.last().map(|g| g.1);
            let Some(next) =
                next.filter(|&n| outer.is_none_or(|end| n <= end) && (outer.is_some() || i == 0))
            else {
                return Err(c.broken(i, "is outside of the first, or leaves its group"));
            };
            let group = inside > 0;
            let own = first.checked_add(count).and_then(|last| sides.get(first as usize..last as usize));
            let Some(own) = own.filter(|_| !group || count == 0) else {
                return Err(c.broken(i, "has sides though it is a group, or more than there are"));
            };
            let last = first + count;
            let sine = c.f32()?;
            c.check(i, (0.0..=1.0).contains(&sine), "has a sine that is not in [0, 1]")?;
            let (normal, lo, hi) = (c.dvec3()?, c.f64()?, c.f64()?);
            let (min, max) = (c.vec3()?, c.vec3()?);
            c.check(
                i,
                (normal.length() - 1.0).abs() <= FILE_ROUNDING,
                "has a normal that is not of length 1",
            )?;
            let (around, _) = groups.last().map_or((bounds, 0), |g: &(Aabb, u32)| *g);
            let within = min.cmpge(around.min).all() && max.cmple(around.max).all() && min.cmple(max).all();
            c.check(i, within, "has a box that is inverted, or leaves the mesh or its group")?;
            let (a, b) = (normal * min.as_dvec3(), normal * max.as_dvec3());
            let (least, most) = (a.min(b).element_sum() - room, a.max(b).element_sum() + room);
            let bundle = group && (lo, hi) == (f64::INFINITY, f64::NEG_INFINITY);
            let slab = least <= lo && lo <= hi && hi <= most;
            c.check(i, slab || bundle, "has a slab that is inverted or leaves its box")?;
            for side in own {
                for p in side.ends.map(|v| positions[v as usize]) {
                    let along = normal.dot(p.as_dvec3());
                    let held = min.cmple(p).all() && max.cmpge(p).all() && lo <= along && along <= hi;
                    c.check(i, held, "has a side that leaves its box or slab")?;
                }
                c.check(i, side.twin() != PatchIndex::new(number), "has a side with itself beyond")?;
            }
            if group {
                c.check(i, groups.len() < DEEPEST, "is inside of too many groups")?;
                groups.push((Aabb { min, max }, next));
            }
            let next = PatchIndex::new(next);
            let patch = Patch { first, last, next, sine, normal, lo, hi, min, max, slack: slack(own) };
            first = last;
            Ok(patch)
        })?;
        let whole = patches.first().is_none_or(|p| p.next.index() == patches.len());
        self.check(0, whole, "does not contain all others")?;
        if first as usize != sides.len() {
            return Err(self.broken(patches.len(), "is missing: there are sides without a patch"));
        }
        Ok(patches)
    }

    fn parts(&mut self, bounds: Aabb) -> Result<Vec<Convex>, FileError> {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let size = (high - low).length();
        let largest = low.abs().max(high.abs()).max_element();
        let room = FILE_ROUNDING * (largest + size) + 2.0 * f64::MIN_POSITIVE;
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
                let unit = (n.length() - 1.0).abs() <= FILE_ROUNDING;
                c.check(i, unit, "has a face whose normal is not of length 1")?;
                let most = vertices.iter().map(|v| n.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
                c.check(i, (h - most).abs() <= room, "has a face that does not touch its corners")?;
                Ok(HalfSpace { normal: -n, offset: h })
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
