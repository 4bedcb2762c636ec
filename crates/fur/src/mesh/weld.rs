//! Welding: a triangle list becomes an indexed mesh.

use std::collections::HashMap;

use super::types::{Coat, Mesh, Vertex, check_count};
use crate::error::Error;

/// Makes one vertex of all corners with the same position, normal and coat (thesis, algorithm 3), in the order of their first
/// corner. Coats may be left out: white fur of full length. Costs a hash table of the vertices.
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

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::mesh::{NormalRule, continuous_normals, indexed_bytes};
    use crate::samples::{cube, torus};

    fn welded(mut soup: Vec<Vertex>, rule: NormalRule) -> Mesh {
        continuous_normals(&mut soup, rule).unwrap();
        weld(&soup, &[]).unwrap()
    }

    #[test]
    fn the_cube_and_the_torus_of_the_thesis() {
        for rule in [NormalRule::SumDistinct, NormalRule::AngleWeighted] {
            let cube = welded(cube(10.0), rule);
            assert_eq!((cube.triangles().len(), cube.vertices().len(), cube.bytes()), (12, 8, 264));
            let torus = welded(torus(3.0, 1.0, 24, 8), rule);
            assert_eq!((torus.triangles().len(), torus.vertices().len(), torus.bytes()), (384, 192, 6912));
            // Euler: a torus has as many vertices and faces as edges.
            assert_eq!((torus.vertices().len() + torus.triangles().len()) as i64 - 3 * 384 / 2, 0);
            assert_eq!((cube.open_edges(), torus.open_edges()), (0, 0));
        }
        // With faceted normals nothing is shared but within the sides of the cube.
        assert_eq!(weld(&cube(10.0), &[]).unwrap().vertices().len(), 24);
    }

    #[test]
    fn the_sizes_of_table_7_4() {
        let rows = [
            ("cube", 12, 8, 0.258),
            ("torus", 384, 192, 6.750),
            ("bunny 0", 69_451, 34_834, 1223.361),
            // The thesis prints 208.436, with transposed digits.
            ("bunny 1", 16_301, 8_146, 286.436),
            ("bunny 2", 3_851, 1_887, 66.791),
            ("bunny 3", 948, 453, 16.172),
            ("dragon 0", 871_414, 434_856, 20_403.820),
            ("dragon 1", 202_520, 100_207, 4721.883),
            ("dragon 2", 47_794, 22_982, 818.684),
            ("dragon 3", 11_102, 5_203, 186.996),
            ("armadillo 0", 345_944, 172_974, 8108.109),
            ("armadillo 1", 83_026, 41_515, 1459.488),
            ("armadillo 2", 19_926, 9_965, 350.309),
            ("armadillo 3", 4_782, 2_393, 84.105),
            ("buddha 0", 1_087_716, 542_612, 25_464.141),
            ("buddha 1", 293_232, 144_628, 6826.031),
            ("buddha 2", 67_240, 32_316, 1151.391),
            ("buddha 3", 15_536, 7_102, 257.484),
        ];
        let mut saved = Vec::new();
        for (name, faces, unique, kilobytes) in rows {
            let bytes = indexed_bytes(unique, faces) as f64;
            assert!((bytes / 1024.0 - kilobytes).abs() < 1e-3, "{name}: {}", bytes / 1024.0);
            saved.push(1.0 - bytes / (72 * faces) as f64);
        }
        let best = saved.iter().copied().fold(0.0, f64::max);
        let mean = saved.iter().sum::<f64>() / saved.len() as f64;
        println!("bytes saved by indexing: at best {:.1}%, on average {:.1}%", 100.0 * best, 100.0 * mean);
        assert!((best - 0.764).abs() < 1e-3 && (mean - 0.727).abs() < 1e-3);
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
}
