//! Centring, and the radius by which the thesis measures.

use glam::Vec3;

use super::types::{Vertex, check_vertices};
use crate::error::Error;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{cube, torus};

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
