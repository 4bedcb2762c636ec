//! All steps of the preparation at once.

use glam::Vec3;

use super::center::{Placing, center};
use super::normals::{NormalRule, continuous_normals};
use super::types::{Coat, Mesh, Vertex};
use super::weld::weld;
use crate::error::Error;

/// Prepares an indexed mesh, of a file for example: [`center`], [`continuous_normals`], [`weld`] and [`Mesh::ordered`]. Coats are one for each
/// position, or none for white fur of full length. Vertices at one position become one if their coats are equal.
///
/// # Errors
/// What these steps refuse, and indices without a position.
pub fn prepare(
    positions: &[Vec3],
    coats: &[Coat],
    triangles: &[[u32; 3]],
    rule: NormalRule,
) -> Result<(Mesh, Placing), Error> {
    if !coats.is_empty() && coats.len() != positions.len() {
        return Err(Error::Count { what: "coats", found: coats.len(), expected: positions.len() });
    }
    let mut soup = Vec::with_capacity(3 * triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for &vertex in corners {
            let position = positions.get(vertex as usize);
            soup.push(Vertex::at(*position.ok_or(Error::Index {
                triangle,
                vertex,
                vertices: positions.len(),
            })?));
        }
    }
    let placing = center(&mut soup)?;
    continuous_normals(&mut soup, rule)?;
    let corners = triangles.as_flattened().iter();
    let soup_coats: Vec<Coat> = corners.filter_map(|&v| coats.get(v as usize).copied()).collect();
    Ok((weld(&soup, &soup_coats)?.ordered(), placing))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_with_doubled_vertices_become_closed_ones() {
        // A tetrahedron whose last face has corners of its own.
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ZERO, Vec3::Z, Vec3::Y];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [4, 5, 6]];
        let (mesh, placing) = prepare(&corners, &[], &faces, NormalRule::default()).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.open_edges()), (4, 0));
        assert_eq!(placing.center, Vec3::splat(0.5));
        let red = Coat { color: Vec3::X, length: 0.5 };
        let (mesh, _) = prepare(&corners, &[red; 7], &faces, NormalRule::default()).unwrap();
        assert!(mesh.coats().len() == 4 && mesh.coats().iter().all(|c| *c == red));
        let refused =
            |coats: &[Coat], faces: &[[u32; 3]]| prepare(&corners, coats, faces, NormalRule::default()).err();
        assert_eq!(refused(&[], &[[0, 1, 7]]), Some(Error::Index { triangle: 0, vertex: 7, vertices: 7 }));
        assert!(matches!(refused(&[red; 6], &faces), Some(Error::Count { .. })));
        assert_eq!(refused(&[], &[]), Some(Error::Empty));
    }
}
