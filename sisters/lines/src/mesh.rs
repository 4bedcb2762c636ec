//! Triangle meshes that stand among lines: a cortex, a layer of the ground, a ship's hull.

use glam::Vec3;

/// An indexed triangle mesh, open or closed, wound in any way. It is smooth where triangles share
/// a vertex, and has an edge where they have vertices of their own at one place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// The places of the vertices.
    pub positions: Vec<Vec3>,
    /// The numbers of the vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A mesh of convex polygons, by the numbers of their vertices; those of less than three have
    /// no part in it.
    pub fn of_polygons<'a>(positions: Vec<Vec3>, polygons: impl IntoIterator<Item = &'a [u32]>) -> Self {
        let fan =
            |polygon: &'a [u32]| polygon.windows(2).skip(1).map(move |side| [polygon[0], side[0], side[1]]);
        Self { positions, triangles: polygons.into_iter().flat_map(fan).collect() }
    }

    /// Boxes, by their least and greatest corners.
    pub fn of_boxes(boxes: &[[Vec3; 2]]) -> Self {
        let mut all = Self::default();
        // A face: the axis that it is normal to, and whether it lies at the greatest corner.
        for ([min, max], face) in boxes.iter().flat_map(|corners| (0..6).map(move |face| (corners, face))) {
            let (axis, high) = (face / 2, face % 2 == 1);
            let first = all.positions.len() as u32;
            for (u, v) in [(false, false), (true, false), (true, true), (false, true)] {
                let mut at = *min;
                for (axis, high) in [(axis, high), ((axis + 1) % 3, u), ((axis + 2) % 3, v)] {
                    at[axis] = if high { max[axis] } else { min[axis] };
                }
                all.positions.push(at);
            }
            // Counter-clockwise, seen from outside.
            let [b, d] = if high { [1, 3] } else { [3, 1] };
            all.triangles.extend([[first, first + b, first + 2], [first, first + 2, first + d]]);
        }
        all
    }

    /// The normal of each vertex, of length 1: the mean of its triangles' by their areas. 0 where
    /// that has no direction, and for vertices without triangles. Triangles that name vertices
    /// which are not there count for nothing.
    pub fn normals(&self) -> Vec<Vec3> {
        let mut sums = vec![glam::DVec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let corner = |i: usize| self.positions.get(triangle[i] as usize).map(|p| p.as_dvec3());
            let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
            let area = (b - a).cross(c - a);
            triangle.iter().for_each(|&v| sums[v as usize] += area);
        }
        sums.into_iter().map(|sum| sum.normalize_or_zero().as_vec3()).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::vec3;

    use super::*;

    #[test]
    fn boxes_are_closed_and_their_normals_point_outwards() {
        let boxes = [[vec3(-1.0, -2.0, -3.0), vec3(1.0, 2.0, 3.0)], [Vec3::splat(4.0), Vec3::splat(5.0)]];
        let mesh = Mesh::of_boxes(&boxes);
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (48, 24));
        for (i, (position, normal)) in mesh.positions.iter().zip(mesh.normals()).enumerate() {
            let [min, max] = boxes[i / 24];
            let out = (*position - (min + max) / 2.0) / (max - min) * 2.0;
            assert!(normal.length() == 1.0 && (normal * out).element_sum() == 1.0, "{i}: {normal} {out}");
        }
        // The volume inside, by the theorem of Gauss.
        let volume = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        assert!((mesh.triangles.iter().map(volume).sum::<f64>() - 49.0).abs() < 1e-9);
    }

    #[test]
    fn polygons_become_fans_and_wrong_numbers_are_passed_over() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y].to_vec();
        let mesh = Mesh::of_polygons(square, [&[0, 1, 2, 3][..], &[0, 1], &[], &[1, 2, 9]]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 2, 9]]);
        assert_eq!(mesh.normals(), [Vec3::Z; 4]);
    }
}
