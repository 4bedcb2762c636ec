//! Centring and welding: a triangle list becomes an indexed mesh.

use std::collections::HashMap;

use glam::Vec3;

use super::normals::continuous_normals;
use super::types::{Coat, Mesh, Vertex, check_count, check_vertices};
use crate::error::Error;

/// Makes one vertex of all corners with the same position, normal and coat (thesis, algorithm 3),
/// in the order of their first corner. Coats may be left out: white fur of full length. Costs a hash
/// table of the vertices.
///
/// # Errors
/// Refuses lists whose length is no multiple of 3, and what [`Mesh::new`] refuses.
pub fn weld(soup: &[Vertex], coats: &[Coat]) -> Result<Mesh, Error> {
    if !soup.len().is_multiple_of(3) {
        return Err(Error::Corners { vertices: soup.len() });
    }
    check_count(soup.len() / 3)?;
    if !coats.is_empty() && coats.len() != soup.len() {
        return Err(Error::Count { what: "coats", found: coats.len(), expected: soup.len() });
    }
    let mut numbers: HashMap<[u32; 10], u32> = HashMap::new();
    let (mut vertices, mut kept) = (Vec::new(), Vec::new());
    let mut corners = Vec::with_capacity(soup.len());
    for (i, vertex) in soup.iter().enumerate() {
        let coat = coats.get(i).copied().unwrap_or_default();
        let mut key = [0; 10];
        let values = [vertex.position.to_array(), vertex.normal.to_array(), coat.color.to_array()];
        // Adding 0 makes -0 the same as 0.
        for (slot, value) in key.iter_mut().zip(values.into_iter().flatten().chain([coat.length])) {
            *slot = (value + 0.0).to_bits();
        }
        corners.push(*numbers.entry(key).or_insert_with(|| {
            vertices.push(*vertex);
            kept.push(coat);
            vertices.len() as u32 - 1
        }));
    }
    let triangles = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    Mesh::new(vertices, kept, triangles)
}

/// Where a mesh was, and how large it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placing {
    /// The centre of the box around the vertices, before centring: add it to get the old positions.
    pub center: Vec3,
    /// Half the diagonal of that box. The thesis calls it the radius of the smallest enclosing
    /// sphere, which it is for a box only.
    pub aabb_radius: f32,
}

/// Moves the middle of the box around all vertices to the origin (thesis, algorithm 1), and
/// measures the mesh. Costs two passes.
///
/// # Errors
/// Refuses no vertices, and coordinates that are not finite or above 1e9.
pub fn center(vertices: &mut [Vertex]) -> Result<Placing, Error> {
    check_vertices(vertices)?;
    let all = vertices.iter().map(|v| v.position.as_dvec3());
    let Some((lo, hi)) = all.map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
        return Err(Error::Empty);
    };
    let middle = ((lo + hi) * 0.5).as_vec3();
    for v in &mut *vertices {
        v.position -= middle;
    }
    Ok(Placing { center: middle, aabb_radius: ((hi - lo).length() * 0.5) as f32 })
}

/// Prepares an indexed mesh, of a file for example: [`center`], [`continuous_normals`], [`weld`]
/// and [`Mesh::ordered`]. Coats are one for each position, or none for white fur of full length.
/// Vertices at one position become one if their coats are equal.
///
/// # Errors
/// What these steps refuse, and indices without a position.
pub fn prepare(positions: &[Vec3], coats: &[Coat], triangles: &[[u32; 3]]) -> Result<(Mesh, Placing), Error> {
    let given = positions.iter().map(|&p| Vertex::at(p)).collect();
    let mesh = Mesh::new(given, coats.to_vec(), triangles.to_vec())?;
    let corners = || triangles.as_flattened().iter().map(|&v| v as usize);
    let mut soup: Vec<Vertex> = corners().map(|v| mesh.vertices()[v]).collect();
    let coats: Vec<Coat> = corners().map(|v| mesh.coats()[v]).collect();
    let placing = center(&mut soup)?;
    continuous_normals(&mut soup)?;
    Ok((weld(&soup, &coats)?.ordered(), placing))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{cube, torus};

    #[test]
    fn the_cube_and_the_torus_of_the_thesis() {
        for (mut soup, size) in [(cube(10.0), (12, 8, 264)), (torus(3.0, 1.0, 24, 8), (384, 192, 6912))] {
            continuous_normals(&mut soup).unwrap();
            let mesh = weld(&soup, &[]).unwrap();
            assert_eq!((mesh.triangles().len(), mesh.vertices().len(), mesh.bytes()), size);
            assert_eq!(mesh.open_edges(), 0);
        }
        // With flat normals nothing is shared but within the sides of the cube.
        assert_eq!(weld(&cube(10.0), &[]).unwrap().vertices().len(), 24);
    }

    #[test]
    fn coats_part_vertices_and_signs_of_zero_do_not() {
        let soup = [Vec3::ZERO, Vec3::X, Vec3::Y, -Vec3::ZERO, Vec3::Y, Vec3::X].map(Vertex::at);
        assert_eq!(weld(&soup, &[]).unwrap().vertices().len(), 3);
        let mut coats = [Coat::default(); 6];
        coats[3].length = 0.0;
        assert_eq!(weld(&soup, &coats).unwrap().vertices().len(), 4);
        assert!(matches!(weld(&soup, &coats[1..]), Err(Error::Count { found: 5, expected: 6, .. })));
        coats[4].length = 1.5;
        assert!(matches!(weld(&soup, &coats), Err(Error::Range { .. })));
        assert_eq!(weld(&soup[1..], &[]), Err(Error::Corners { vertices: 5 }));
        assert_eq!(weld(&[], &[]), Err(Error::Empty));
    }

    #[test]
    fn meshes_with_doubled_vertices_become_closed_ones() {
        // A tetrahedron whose last face has corners of its own.
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ZERO, Vec3::Z, Vec3::Y];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [4, 5, 6]];
        let red = Coat { color: Vec3::X, length: 0.5 };
        let (mesh, placing) = prepare(&corners, &[red; 7], &faces).unwrap();
        assert_eq!(
            (mesh.coats(), mesh.open_edges(), placing.center),
            ([red; 4].as_slice(), 0, Vec3::splat(0.5))
        );
        let refused = |coats: &[Coat], faces: &[[u32; 3]]| prepare(&corners, coats, faces).err();
        let said = refused(&[], &[[0, 1, 7]]).unwrap().to_string();
        assert_eq!(said, "triangle 0 uses vertex 7 of 7: numbers start at 0");
        assert!(matches!(refused(&[red; 6], &faces), Some(Error::Count { .. })));
        assert_eq!(refused(&[], &[]), Some(Error::Empty));
    }

    #[test]
    fn the_radii_of_the_thesis_and_points_that_are_refused() {
        let mut soup = cube(10.0);
        soup.iter_mut().for_each(|v| v.position += Vec3::new(3.0, -2.0, 7.0));
        let placing = center(&mut soup).unwrap();
        assert_eq!(placing.center, Vec3::new(3.0, -2.0, 7.0));
        // Table 7.1: 8.66.
        assert!((placing.aabb_radius - 75f32.sqrt()).abs() < 1e-5);
        // Half the diagonal of its box is not the radius of a torus, which is 2.7.
        let placing = center(&mut torus(2.0, 0.7, 24, 8)).unwrap();
        assert!((placing.aabb_radius - 3.882).abs() < 1e-3, "{placing:?}");
        assert_eq!(center(&mut []), Err(Error::Empty));
        for x in [f32::NAN, f32::INFINITY, 1e10] {
            assert!(matches!(center(&mut [Vertex::at(Vec3::new(0.0, x, 0.0))]), Err(Error::Vertex { .. })));
        }
        assert_eq!(center(&mut [Vertex::at(Vec3::ONE); 4]).unwrap().aabb_radius, 0.0);
    }
}
