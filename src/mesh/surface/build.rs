//! From triangles to a surface: weld, grow patches, simplify their outlines, gather.

use glam::Vec3;

use crate::mesh::surface::chain::{rims, simplify};
use crate::mesh::surface::gather::gather;
use crate::mesh::surface::grow::grow;
use crate::mesh::surface::patch::{Rules, Surface};
use crate::mesh::surface::weld::Welded;

impl Surface {
    /// Finds the patches of triangles. Indices are known to be valid, positions to be finite.
    pub(crate) fn new(positions: &[Vec3], triangles: &[[u32; 3]], rules: &Rules) -> Self {
        let welded = Welded::new(positions, triangles);
        let patches = grow(&welded, rules);
        let straight = simplify(&welded, &rims(&welded, &patches), rules.tolerance);
        gather(&welded, &patches, &straight, rules)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::mesh::surface::patch::NONE;

    fn rules(tolerance: f64) -> Rules {
        Rules { tolerance, cosine: 0.2, least: 0.0, front: false }
    }

    /// A comb: a ridge with long teeth, ever shorter.
    fn comb(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let x = |i: u32| i as f32 * 0.05;
        let mut p: Vec<Vec3> = (0..=n).map(|i| Vec3::new(x(i), 0.0, 0.0)).collect();
        p.extend((0..=n).map(|i| Vec3::new(x(i), -1.0, 0.0)));
        p.extend((0..n).map(|i| Vec3::new(x(i) + 0.025, 4000.0 - 2000.0 * i as f32 / n as f32, 0.0)));
        let (low, tip) = (n + 1, 2 * n + 2);
        let tooth = |i: u32| [[i, i + 1, tip + i], [i + 1, i, low + i], [i + 1, low + i, low + i + 1]];
        (p, (0..n).flat_map(tooth).collect())
    }

    #[test]
    fn long_zigzags_are_cut_evenly() {
        let (p, t) = comb(20_000);
        let surface = Surface::new(&p, &t, &rules(2.5));
        // Always cut at the farthest point, each tooth would keep its two sides.
        let (sides, teeth) = (surface.sides.len(), 20_000);
        assert!(surface.leaves() == 1 && sides > 100 && sides < teeth, "{sides}");
    }

    #[test]
    fn thousands_of_triangles_share_an_edge_or_a_vertex() {
        let n = 20_000u32;
        let around = |i: u32| {
            let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            DVec3::new(5.0 * angle.cos(), 5.0 * angle.sin(), 1.0).as_vec3()
        };
        let mut p = vec![Vec3::ZERO, Vec3::Z * 3.0];
        p.extend((0..n).map(around));
        // Where more than two meet, each is a patch of its own, and none hides the edge.
        let leaves: Vec<[u32; 3]> = (0..n).map(|i| [0, 1, i + 2]).collect();
        let surface = Surface::new(&p, &leaves, &rules(0.01));
        assert_eq!((surface.leaves(), surface.sides.len()), (n as usize, 3 * n as usize));
        assert!(surface.sides.iter().all(|s| s.twin == NONE && !s.opposite));
        // A cone around the vertex is one ring of patches.
        let cone: Vec<[u32; 3]> = (0..n).map(|i| [0, i + 2, (i + 1) % n + 2]).collect();
        let surface = Surface::new(&p, &cone, &rules(0.01));
        assert!(surface.patches.len() < 200 && surface.sides.len() < 500, "{}", surface.sides.len());
    }
}
