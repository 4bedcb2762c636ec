//! The order of triangles and vertices, and coarser meshes, by meshoptimizer.

use meshopt::{SimplifyOptions, VertexDataAdapter};

use super::types::{Coat, Mesh, Vertex};
use crate::error::{Error, range};
use crate::numeric::MAX_COORDINATE;

impl Mesh {
    /// The average cache miss ratio: vertices that a first-in-first-out cache of `cache` vertices must compute, for each triangle. At least
    /// about 0.5 for large closed meshes, at most 3. The size is taken as 3 to 1024.
    pub fn acmr(&self, cache: u32) -> f32 {
        let indices = self.triangles().as_flattened();
        // No warps and no groups of primitives: a plain cache.
        meshopt::analyze_vertex_cache(indices, self.vertices().len(), cache.clamp(3, 1024), 0, 0).acmr
    }

    /// The same mesh in an order that graphics processors compute fastest: triangles for the cache of computed vertices, then vertices in
    /// the order of use. Vertices that no triangle uses are dropped. Linear in the mesh.
    pub fn ordered(&self) -> Self {
        let count = self.vertices().len();
        let order = meshopt::optimize_vertex_cache(self.triangles().as_flattened(), count);
        self.used(&order)
    }

    /// A coarser mesh of about `triangles` triangles, whose vertices are vertices of this one (edge collapse by quadrics, Garland &
    /// Heckbert 1997). More are left where the shape cannot become simpler. The result is [ordered](Mesh::ordered), and comes with the
    /// greatest distance to this mesh that the quadrics estimate, in units.
    ///
    /// Vertices at one position must share normal and coat, else seams keep apart what they part.
    ///
    /// # Errors
    /// Refuses 0 triangles. If nothing is left, it says that the mesh is empty.
    pub fn simplified(&self, triangles: usize) -> Result<(Self, f32), Error> {
        range("the number of triangles to leave", triangles as f64, 1.0, self.triangles().len() as f64)?;
        let positions: Vec<[f32; 3]> = self.vertices().iter().map(|v| v.position.to_array()).collect();
        let bytes: Vec<u8> = positions.as_flattened().iter().flat_map(|c| c.to_ne_bytes()).collect();
        let Ok(adapter) = VertexDataAdapter::new(&bytes, 12, 0) else { return Err(Error::Empty) };
        let mut error = 0.0;
        // Errors as distances; regular triangles, since layers of thin ones would show their edges.
        let options = SimplifyOptions::ErrorAbsolute | SimplifyOptions::RegularizeLight;
        let left = meshopt::simplify(
            self.triangles().as_flattened(),
            &adapter,
            3 * triangles,
            MAX_COORDINATE,
            options,
            Some(&mut error),
        );
        if left.is_empty() {
            return Err(Error::Empty);
        }
        let order = meshopt::optimize_vertex_cache(&left, self.vertices().len());
        Ok((self.used(&order), error))
    }

    /// The mesh of some corners, with its vertices in the order of use.
    fn used(&self, corners: &[u32]) -> Self {
        let mut number = vec![u32::MAX; self.vertices().len()];
        let mut vertices: Vec<Vertex> = Vec::new();
        let mut coats: Vec<Coat> = Vec::new();
        let mut renumber = |v: u32| {
            let slot = &mut number[v as usize];
            if *slot == u32::MAX {
                *slot = vertices.len() as u32;
                vertices.push(self.vertices()[v as usize]);
                coats.push(self.coats()[v as usize]);
            }
            *slot
        };
        let triangles = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(&mut renumber)).collect();
        Self::from_checked(vertices, coats, triangles)
    }
}
