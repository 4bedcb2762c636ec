//! Continuous normals: one for each position, so that extruded layers have no holes.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::types::{Vertex, check_count, check_vertices};
use crate::error::Error;
use crate::numeric::{NO_DIRECTION, SAME_NORMAL};

/// How the normals at one position become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NormalRule {
    /// The sum of all given normals at the position. A flat side that is cut into more triangles
    /// pulls harder.
    SumAll,
    /// The sum of the normals that differ (thesis, algorithm 2); those within a hundredth of a
    /// degree are one.
    SumDistinct,
    /// The sum of the faces' normals, each weighted by the face's angle at the corner (Thürmer &
    /// Wüthrich 1998). Ignores the normals given, and does not depend on how flat sides are cut.
    #[default]
    AngleWeighted,
}

/// Gives all vertices at one position the same normal, bit for bit. Positions are equal if their
/// coordinates are.
///
/// Where a vertex of the list has no normal (length 0), that of its face counts. Where normals
/// cancel, as on the two sides of a thin sheet, the position gets its first normal that is not
/// zero; the result counts these positions. If all faces at a position have no area and no normals
/// are given, it gets the y axis. Costs a hash table of the positions, and with
/// [`NormalRule::SumDistinct`] one of the normals at each.
///
/// # Errors
/// Refuses lists whose length is no multiple of 3, empty ones, more than 2^29 triangles, and values
/// that are not finite or above 1e9.
pub fn continuous_normals(soup: &mut [Vertex], rule: NormalRule) -> Result<usize, Error> {
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
            let given = vertex.normal.as_dvec3().normalize_or_zero();
            let given = if given == DVec3::ZERO { normal } else { given };
            match rule {
                NormalRule::SumAll => sums[group].add(given, 1.0),
                NormalRule::SumDistinct => sums[group].add_distinct(given),
                NormalRule::AngleWeighted => {
                    let (a, b) = (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
                    let angle = a.cross(b).length().atan2(a.dot(b));
                    sums[group].add(normal, angle);
                }
            }
            group_of.push(group);
        }
    }
    let finished: Vec<(Vec3, bool)> = sums.iter().map(Sum::finish).collect();
    for (vertex, group) in soup.iter_mut().zip(group_of) {
        vertex.normal = finished[group].0;
    }
    Ok(finished.iter().filter(|f| f.1).count())
}

/// 1 or -1.
fn side(bit: u32) -> f64 {
    if bit == 0 { -1.0 } else { 1.0 }
}

/// What is known of one position.
#[derive(Default)]
struct Sum {
    sum: DVec3,
    weight: f64,
    first: Option<DVec3>,
    /// By cells of twice the tolerance: each holds a few.
    distinct: HashMap<[i64; 3], Vec<DVec3>>,
}

impl Sum {
    fn add(&mut self, normal: DVec3, weight: f64) {
        if normal != DVec3::ZERO {
            self.sum += normal * weight;
            self.weight += weight;
            self.first.get_or_insert(normal);
        }
    }

    fn add_distinct(&mut self, normal: DVec3) {
        let (near, cell) = (SAME_NORMAL.sqrt(), 2.0 * SAME_NORMAL.sqrt());
        let at = |offset: DVec3| ((normal + offset * near) / cell).floor().as_i64vec3().to_array();
        let around = |k: u32| DVec3::new(side(k & 1), side(k & 2), side(k & 4));
        let same = |n: &DVec3| n.distance_squared(normal) <= SAME_NORMAL;
        if !(0..8).any(|k| self.distinct.get(&at(around(k))).is_some_and(|cell| cell.iter().any(same))) {
            self.distinct.entry(at(DVec3::ZERO)).or_default().push(normal);
            self.add(normal, 1.0);
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
        let given = cube(2.0);
        for rule in [NormalRule::SumAll, NormalRule::SumDistinct, NormalRule::AngleWeighted] {
            let mut soup = given.clone();
            assert_eq!(continuous_normals(&mut soup, rule), Ok(0));
            let mut leaning = 0;
            for v in &soup {
                let error = v.normal.dot(v.position.normalize()).min(1.0).acos().to_degrees();
                // Where sides have one and two triangles at a corner, their sum leans (thesis,
                // figure 4.5).
                let at = |axis: Vec3| {
                    given.iter().filter(|g| g.position == v.position && g.normal.abs() == axis).count()
                };
                let even = at(Vec3::X) == at(Vec3::Y) && at(Vec3::Y) == at(Vec3::Z);
                assert_eq!(error < 0.05, even || rule != NormalRule::SumAll, "{rule:?}: {error} degrees");
                leaning += u32::from(error > 5.0);
            }
            assert_eq!(leaning > 0, rule == NormalRule::SumAll);
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
            continuous_normals(&mut soup, NormalRule::default()).unwrap();
            assert_eq!(weld(&extruded(&soup), &[]).unwrap().open_edges(), 0);
        }
    }

    #[test]
    fn normals_that_cancel_get_a_direction_and_bad_lists_an_error() {
        let sheet = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ZERO, Vec3::Y, Vec3::X];
        for rule in [NormalRule::SumAll, NormalRule::SumDistinct, NormalRule::AngleWeighted] {
            let mut soup = sheet.map(Vertex::at);
            assert_eq!(continuous_normals(&mut soup, rule), Ok(3));
            assert!(soup.iter().all(|v| v.normal == Vec3::Z), "{rule:?}");
            let mut flat = [Vertex::at(Vec3::ONE); 3];
            assert_eq!((continuous_normals(&mut flat, rule), flat[1].normal), (Ok(1), Vec3::Y));
            assert_eq!(continuous_normals(&mut [], rule), Err(Error::Empty));
            assert_eq!(
                continuous_normals(&mut [Vertex::default(); 4], rule),
                Err(Error::Corners { vertices: 4 })
            );
            soup[5].normal.x = f32::NAN;
            assert!(matches!(continuous_normals(&mut soup, rule), Err(Error::Vertex { vertex: 5, .. })));
        }
    }
}
