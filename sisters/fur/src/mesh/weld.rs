//! Welding: a triangle list becomes an indexed mesh.

use std::collections::HashMap;

use glam::Vec3;

use super::center::{Placing, center};
use super::image::TexCoord;
use super::normals::{NormalRule, continuous_normals};
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
pub fn prepare(
    positions: &[Vec3],
    coats: &[Coat],
    triangles: &[[u32; 3]],
    rule: NormalRule,
) -> Result<(Mesh, Placing), Error> {
    let given = positions.iter().map(|&p| Vertex::at(p)).collect();
    let mesh = Mesh::new(given, coats.to_vec(), triangles.to_vec())?;
    let corners = || triangles.as_flattened().iter().map(|&v| v as usize);
    let mut soup: Vec<Vertex> = corners().map(|v| mesh.vertices()[v]).collect();
    let coats: Vec<Coat> = corners().map(|v| mesh.coats()[v]).collect();
    let placing = center(&mut soup)?;
    continuous_normals(&mut soup, rule)?;
    Ok((weld(&soup, &coats)?.ordered(), placing))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::indexed_bytes;
    use crate::samples::{cube, torus};

    #[test]
    fn the_cube_and_the_torus_of_the_thesis() {
        for rule in [NormalRule::SumDistinct, NormalRule::AngleWeighted] {
            for (mut soup, size) in [(cube(10.0), (12, 8, 264)), (torus(3.0, 1.0, 24, 8), (384, 192, 6912))] {
                continuous_normals(&mut soup, rule).unwrap();
                let mesh = weld(&soup, &[]).unwrap();
                assert_eq!((mesh.triangles().len(), mesh.vertices().len(), mesh.bytes()), size);
                assert_eq!(mesh.open_edges(), 0);
            }
        }
        // With flat normals nothing is shared but within the sides of the cube.
        assert_eq!(weld(&cube(10.0), &[]).unwrap().vertices().len(), 24);
    }

    #[test]
    fn the_sizes_of_table_7_4() {
        // Faces, vertices and kilobytes. The thesis prints 208.436 for the second bunny, with
        // transposed digits.
        let rows = [
            ("cube, torus", vec![(12, 8, 0.258), (384, 192, 6.750)]),
            (
                "bunny",
                vec![
                    (69_451, 34_834, 1223.361),
                    (16_301, 8_146, 286.436),
                    (3_851, 1_887, 66.791),
                    (948, 453, 16.172),
                ],
            ),
            ("dragon", vec![(871_414, 434_856, 20_403.820), (202_520, 100_207, 4721.883)]),
            ("dragon", vec![(47_794, 22_982, 818.684), (11_102, 5_203, 186.996)]),
            ("armadillo", vec![(345_944, 172_974, 8108.109), (83_026, 41_515, 1459.488)]),
            ("armadillo", vec![(19_926, 9_965, 350.309), (4_782, 2_393, 84.105)]),
            ("buddha", vec![(1_087_716, 542_612, 25_464.141), (293_232, 144_628, 6826.031)]),
            ("buddha", vec![(67_240, 32_316, 1151.391), (15_536, 7_102, 257.484)]),
        ];
        let mut saved = Vec::new();
        for (name, faces, unique, kilobytes) in
            rows.iter().flat_map(|(n, r)| r.iter().map(move |r| (n, r.0, r.1, r.2)))
        {
            let bytes = indexed_bytes(unique, faces) as f64;
            assert!((bytes / 1024.0 - kilobytes).abs() < 1e-3, "{name}: {}", bytes / 1024.0);
            saved.push(1.0 - bytes / (72 * faces) as f64);
        }
        let (best, mean) = (saved.iter().copied().fold(0.0, f64::max), saved.iter().sum::<f64>() / 18.0);
        println!("bytes saved by indexing: at best {:.1}%, on average {:.1}%", 100.0 * best, 100.0 * mean);
        assert!(saved.len() == 18 && (best - 0.764).abs() < 1e-3 && (mean - 0.727).abs() < 1e-3);
        assert_eq!(indexed_bytes(u64::MAX, u64::MAX), u64::MAX);
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
        let (mesh, placing) = prepare(&corners, &[red; 7], &faces, NormalRule::default()).unwrap();
        assert_eq!(
            (mesh.coats(), mesh.open_edges(), placing.center),
            ([red; 4].as_slice(), 0, Vec3::splat(0.5))
        );
        let refused =
            |coats: &[Coat], faces: &[[u32; 3]]| prepare(&corners, coats, faces, NormalRule::default()).err();
        assert_eq!(refused(&[], &[[0, 1, 7]]), Some(Error::Index { triangle: 0, vertex: 7, vertices: 7 }));
        assert!(matches!(refused(&[red; 6], &faces), Some(Error::Count { .. })));
        assert_eq!(refused(&[], &[]), Some(Error::Empty));
    }
}
