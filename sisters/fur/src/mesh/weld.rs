//! Welding: a triangle list becomes an indexed mesh.

use std::collections::HashMap;

use glam::Vec3;

use super::center::{Placing, center};
use super::image::TexCoord;
use super::normals::continuous_normals;
use super::types::{Coat, Mesh, Vertex, check_count};
use crate::error::Error;

/// Makes one vertex of all corners with the same position, normal and coat (thesis, algorithm 3),
/// in the order of their first corner. Coats may be left out: white fur of full length. Costs a
/// hash table of the vertices.
///
/// # Errors
/// Refuses lists whose length is no multiple of 3, and what [`Mesh::new`] refuses.
pub fn weld(soup: &[Vertex], coats: &[Coat]) -> Result<Mesh, Error> {
    weld_textured(soup, coats, &[])
}

/// The same for corners on images: those with the same place on the same image become one.
/// Coordinates may be left out.
///
/// # Errors
/// As [`weld`], and what [`Mesh::with_tex_coords`] refuses.
pub fn weld_textured(soup: &[Vertex], coats: &[Coat], coords: &[TexCoord]) -> Result<Mesh, Error> {
    if !soup.len().is_multiple_of(3) {
        return Err(Error::Corners { vertices: soup.len() });
    }
    check_count(soup.len() / 3)?;
    if !coats.is_empty() && coats.len() != soup.len() {
        return Err(Error::Count { what: "coats", found: coats.len(), expected: soup.len() });
    }
    if !coords.is_empty() && coords.len() != soup.len() {
        return Err(Error::Count { what: "texture coordinates", found: coords.len(), expected: soup.len() });
    }
    let mut numbers: HashMap<[u32; 13], u32> = HashMap::new();
    let (mut vertices, mut kept, mut places) = (Vec::new(), Vec::new(), Vec::new());
    let mut corners = Vec::with_capacity(soup.len());
    for (i, vertex) in soup.iter().enumerate() {
        let coat = coats.get(i).copied().unwrap_or_default();
        let coord = coords.get(i).copied().unwrap_or_default();
        let mut key = [0; 13];
        key[12] = coord.image.map_or(u32::MAX, u32::from);
        let values = [vertex.position.to_array(), vertex.normal.to_array(), coat.color.to_array()];
        // Adding 0 makes -0 the same as 0.
        let more = [coat.length, coord.uv.x, coord.uv.y];
        for (slot, value) in key.iter_mut().zip(values.into_iter().flatten().chain(more)) {
            *slot = (value + 0.0).to_bits();
        }
        corners.push(*numbers.entry(key).or_insert_with(|| {
            vertices.push(*vertex);
            kept.push(coat);
            places.push(coord);
            vertices.len() as u32 - 1
        }));
    }
    let triangles = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let mesh = Mesh::new(vertices, kept, triangles)?;
    mesh.with_tex_coords(if coords.is_empty() { Vec::new() } else { places })
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
        assert_eq!(refused(&[], &[[0, 1, 7]]), Some(Error::Index { triangle: 0, vertex: 7, vertices: 7 }));
        assert!(matches!(refused(&[red; 6], &faces), Some(Error::Count { .. })));
        assert_eq!(refused(&[], &[]), Some(Error::Empty));
    }
}
