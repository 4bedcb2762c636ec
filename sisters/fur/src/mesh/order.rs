//! The order of triangles and vertices, by meshoptimizer.

use super::types::{Coat, Mesh, Vertex};

impl Mesh {
    /// The average cache miss ratio: vertices that a first-in-first-out cache of `cache` vertices
    /// must compute, for each triangle. At least about 0.5 for large closed meshes, at most 3. The
    /// size is taken as 3 to 1024.
    pub fn acmr(&self, cache: u32) -> f32 {
        let indices = self.triangles().as_flattened();
        // No warps and no groups of primitives: a plain cache.
        meshopt::analyze_vertex_cache(indices, self.vertices().len(), cache.clamp(3, 1024), 0, 0).acmr
    }

    /// The same mesh in an order that graphics processors compute fastest: triangles for the cache
    /// of computed vertices, then vertices in the order of use. Vertices that no triangle uses are
    /// dropped. Linear in the mesh.
    pub fn ordered(&self) -> Self {
        let count = self.vertices().len();
        let order = meshopt::optimize_vertex_cache(self.triangles().as_flattened(), count);
        self.used(&order)
    }

    /// The mesh of some corners, with its vertices in the order of use.
    pub(super) fn used(&self, corners: &[u32]) -> Self {
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
        Self { vertices, coats, triangles }
    }
}

#[cfg(test)]
mod tests {
    use casca_scenes::random::generator;
    use rand::seq::SliceRandom;

    use super::*;
    use crate::samples::{ball, torus_mesh};

    /// The triangles as sorted positions, whatever their order and their first corners.
    fn faces(mesh: &Mesh) -> Vec<[[u32; 3]; 3]> {
        let face = |t: &[u32; 3]| {
            let mut f = t.map(|v| mesh.vertices()[v as usize].position.to_array().map(f32::to_bits));
            let first = (0..3).min_by_key(|&i| f[i]).unwrap();
            f.rotate_left(first);
            f
        };
        let mut faces: Vec<_> = mesh.triangles().iter().map(face).collect();
        faces.sort_unstable();
        faces
    }

    #[test]
    fn ordered_meshes_are_the_same_and_cheaper() {
        for (name, mesh) in [("torus", torus_mesh(24)), ("large torus", torus_mesh(96)), ("ball", ball(5))] {
            let mut triangles = mesh.triangles().to_vec();
            triangles.shuffle(&mut generator(1, 0));
            let random = Mesh::new(mesh.vertices().to_vec(), mesh.coats().to_vec(), triangles).unwrap();
            let ordered = random.ordered();
            let (n, v) = (mesh.triangles().len(), mesh.vertices().len());
            for cache in [16, 32] {
                let [given, before, after] = [&mesh, &random, &ordered].map(|m| m.acmr(cache));
                println!(
                    "{name}, {n} triangles, cache of {cache}: ACMR {given:.3} as made, {before:.3} shuffled, {after:.3} ordered"
                );
                // Each vertex is computed once at least, and three times a triangle at most.
                assert!(after >= v as f32 / n as f32 - 1e-4 && before <= 3.0);
                assert!(after < 0.85 && after < 0.5 * before, "{name}: {after}");
            }
            assert_eq!((faces(&ordered), ordered.open_edges()), (faces(&mesh), 0));
            assert_eq!(ordered.triangles()[0], [0, 1, 2], "vertices in the order of use");
        }
    }
}
