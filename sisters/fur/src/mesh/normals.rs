//! Continuous normals: one for each position, so that extruded layers have no holes.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::types::{Vertex, check_count, check_vertices};
use crate::error::Error;
use crate::numeric::NO_DIRECTION;

/// Gives all vertices at one position the same normal, bit for bit: the sum of the faces' normals,
/// each weighted by the face's angle at the corner (Thürmer & Wüthrich 1998), so that it does not
/// matter how flat sides are cut. Normals given are ignored. Positions are equal if their
/// coordinates are.
///
/// Where normals cancel, as on the two sides of a thin sheet, the position gets the first that is
/// not zero; the result counts these positions. If all faces at a position have no area, it gets
/// the y axis. Costs a hash table of the positions.
///
/// # Errors
/// Refuses lists whose length is no multiple of 3, empty ones, more than 2^29 triangles, and values
/// that are not finite or above 1e9.
pub fn continuous_normals(soup: &mut [Vertex]) -> Result<usize, Error> {
    if !soup.len().is_multiple_of(3) {
        return Err(Error::Corners { vertices: soup.len() });
    }
    check_count(soup.len() / 3)?;
    check_vertices(soup)?;
    let mut groups: HashMap<[u32; 3], usize> = HashMap::new();
    let mut sums: Vec<Sum> = Vec::new();
    let mut group_of = Vec::with_capacity(soup.len());
    for face in soup.chunks_exact(3) {
        let p: [DVec3; 3] = std::array::from_fn(|i| face[i].position.as_dvec3());
        let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        for (i, vertex) in face.iter().enumerate() {
            let key = vertex.position.to_array().map(|c| (c + 0.0).to_bits());
            let group = *groups.entry(key).or_insert_with(|| {
                sums.push(Sum::default());
                sums.len() - 1
            });
            let (a, b) = (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
            sums[group].add(normal, a.cross(b).length().atan2(a.dot(b)));
            group_of.push(group);
        }
    }
    let finished: Vec<(Vec3, bool)> = sums.iter().map(Sum::finish).collect();
    for (vertex, group) in soup.iter_mut().zip(group_of) {
        vertex.normal = finished[group].0;
    }
    Ok(finished.iter().filter(|f| f.1).count())
}

/// What is known of one position.
#[derive(Default)]
struct Sum {
    sum: DVec3,
    weight: f64,
    first: Option<DVec3>,
}

impl Sum {
    fn add(&mut self, normal: DVec3, weight: f64) {
        if normal != DVec3::ZERO {
            self.sum += normal * weight;
            self.weight += weight;
            self.first.get_or_insert(normal);
        }
    }

    /// The unit normal, and whether the sum had no direction.
    fn finish(&self) -> (Vec3, bool) {
        let cancels = self.sum.length() <= NO_DIRECTION * self.weight;
        let normal = if cancels { self.first.unwrap_or(DVec3::Y) } else { self.sum.normalize() };
        (normal.as_vec3(), cancels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::weld;
    use crate::samples::{cube, torus};

    #[test]
    fn corners_of_a_cube_point_along_its_diagonals() {
        let mut soup = cube(2.0);
        assert_eq!(continuous_normals(&mut soup), Ok(0));
        for v in &soup {
            let error = v.normal.dot(v.position.normalize()).min(1.0).acos().to_degrees();
            assert!(error < 0.05, "{error} degrees");
        }
    }

    #[test]
    fn extruded_meshes_stay_closed() {
        for mut soup in [cube(1.0), torus(3.0, 1.0, 24, 8)] {
            let extruded = |soup: &[Vertex]| -> Vec<Vertex> {
                soup.iter().map(|v| Vertex::at(v.position + v.normal * 0.1)).collect()
            };
            // Flat normals tear the layers apart.
            assert!(weld(&extruded(&soup), &[]).unwrap().open_edges() > 0);
            continuous_normals(&mut soup).unwrap();
            assert_eq!(weld(&extruded(&soup), &[]).unwrap().open_edges(), 0);
        }
    }

    #[test]
    fn normals_that_cancel_get_a_direction_and_bad_lists_an_error() {
        let sheet = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ZERO, Vec3::Y, Vec3::X];
        let mut soup = sheet.map(Vertex::at);
        assert_eq!(continuous_normals(&mut soup), Ok(3));
        assert!(soup.iter().all(|v| v.normal == Vec3::Z));
        let mut flat = [Vertex::at(Vec3::ONE); 3];
        assert_eq!((continuous_normals(&mut flat), flat[1].normal), (Ok(1), Vec3::Y));
        assert_eq!(continuous_normals(&mut []), Err(Error::Empty));
        assert_eq!(continuous_normals(&mut [Vertex::default(); 4]), Err(Error::Corners { vertices: 4 }));
        soup[5].normal.x = f32::NAN;
        assert!(matches!(continuous_normals(&mut soup), Err(Error::Vertex { vertex: 5, .. })));
    }
}
