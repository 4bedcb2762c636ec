//! Writing a prepared mesh.

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use crate::geometry::plane::HalfSpace;
use crate::mesh::file::{HEADER, MAGIC, VERSION, checksum};
use crate::mesh::tri_mesh::TriMesh;
use crate::shape::convex::Convex;

impl TriMesh {
    /// Writes the mesh as prepared, so that [`TriMesh::read`] gets it back in a fraction of the
    /// time that preparing took. Several meshes may follow each other in a stream.
    ///
    /// The layout, described at the top of `src/mesh/file/mod.rs`, has a version. Files of other
    /// versions are refused, so keep the sources of your meshes.
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
        out.push(u8::from(self.surface.front));
        let surface = &self.surface;
        count(out, surface.sides.len());
        for (_, _, side) in surface.leaf_sides() {
            out.extend(side.ends.iter().flat_map(|v| v.to_le_bytes()));
            out.extend(side.slack.to_le_bytes());
            out.extend(side.twin().get().to_le_bytes());
            out.push(u8::from(side.opposite()));
        }
        count(out, surface.patch_count());
        for (at, patch) in surface.indexed() {
            let inside = at.after().up_to(patch.next);
            let sides = if inside == 0 { patch.last - patch.first } else { 0 };
            out.extend(sides.to_le_bytes());
            out.extend(inside.to_le_bytes());
            out.extend(patch.sine.to_le_bytes());
            let DVec3 { x, y, z } = patch.normal;
            out.extend([x, y, z, patch.lo, patch.hi].iter().flat_map(|v| v.to_le_bytes()));
            put3(out, patch.min);
            put3(out, patch.max);
        }
        // In the file sides are numbered as they come.
        let open = || (0u32..).zip(surface.leaf_sides()).filter(|(_, (_, _, side))| side.is_open());
        count(out, open().count());
        let mut chain = surface.chain();
        for (place, (_, number, _)) in open() {
            out.extend(place.to_le_bytes());
            out.extend(chain(number).to_le_bytes());
        }
        count(out, self.parts.len());
        for Convex { vertices, faces, edges, .. } in &self.parts {
            let counts = [vertices.len(), faces.len(), edges.len()];
            out.extend(counts.iter().flat_map(|&n| (n as u16).to_le_bytes()));
            out.extend(vertices.iter().flat_map(|v| v.to_array()).flat_map(f64::to_le_bytes));
            // The file has outward normals.
            let outward = |face: &HalfSpace| [-face.normal.x, -face.normal.y, -face.normal.z, face.offset];
            let planes = faces.iter().flat_map(outward);
            out.extend(planes.flat_map(f64::to_le_bytes));
            out.extend(edges.iter().flatten().flat_map(|i| i.to_le_bytes()));
        }
    }
}

fn put3(out: &mut Vec<u8>, v: Vec3) {
    out.extend(v.to_array().iter().flat_map(|c| c.to_le_bytes()));
}
