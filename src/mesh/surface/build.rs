//! From triangles to a surface: weld, grow patches, simplify their outlines, gather.

#[cfg(test)]
use std::ops::ControlFlow;

#[cfg(test)]
use glam::Vec3;

use crate::error::Error;
use crate::mesh::preparation::Progress;

use crate::mesh::surface::chain::{borders, simplify};
use crate::mesh::surface::gather::gather;
use crate::mesh::surface::grow::grow;
use crate::mesh::surface::patch::{Rules, Surface};
use crate::mesh::surface::weld::Welded;

impl Surface {
    /// Finds the patches of triangles. Indices are known to be valid, positions to be finite.
    #[cfg(test)]
    pub(crate) fn new(positions: &[Vec3], triangles: &[[u32; 3]], rules: &Rules) -> Self {
        let mut tell = |_| ControlFlow::Continue(());
        let welded = Welded::new(positions, triangles);
        let surface = Self::of(&welded, rules, &mut Progress::new(&mut tell)).unwrap();
        Self { positions: positions.into(), ..surface }
    }

    /// Finds the patches of welded triangles.
    ///
    /// # Errors
    /// Only [`Error::Cancelled`].
    pub(crate) fn of(welded: &Welded, rules: &Rules, progress: &mut Progress) -> Result<Self, Error> {
        let patches = grow(welded, rules);
        progress.tell(0.25)?;
        let straight = simplify(welded, &borders(welded, &patches), rules.tolerance);
        progress.tell(0.4)?;
        gather(welded, &patches, &straight, rules, &mut progress.part(0.4, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::mesh::surface::index::PatchIndex;

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
        assert!(surface.sides.iter().all(|s| s.is_open() || s.twin() == PatchIndex::NONE && !s.opposite()));
        // A cone around the vertex is one ring of patches.
        let cone: Vec<[u32; 3]> = (0..n).map(|i| [0, i + 2, (i + 1) % n + 2]).collect();
        let surface = Surface::new(&p, &cone, &rules(0.01));
        assert!(surface.patches.len() < 200 && surface.sides.len() < 500, "{}", surface.sides.len());
    }

    /// Rolling ground of n by n squares.
    fn ground(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let height = |x: f32, z: f32| 2.0 * (x * 0.31).sin() * (z * 0.23).cos() + 0.2 * (x * 1.7 + z).sin();
        let point = |i: u32| ((i % (n + 1)) as f32, (i / (n + 1)) as f32);
        let positions =
            (0..(n + 1) * (n + 1)).map(point).map(|(x, z)| Vec3::new(x, height(x, z), z)).collect();
        let square = |i: u32| {
            let a = i / n * (n + 1) + i % n;
            [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]
        };
        (positions, (0..n * n).flat_map(square).collect())
    }

    #[test]
    fn groups_have_closed_outlines_around_all_of_their_parts() {
        let (p, t) = ground(40);
        let surface = Surface::new(&p, &t, &rules(0.001));
        let patches = &surface.patches;
        assert_eq!(patches[0].next.index(), patches.len(), "the first one contains all");
        let mut groups = 0;
        for (i, patch) in surface.indexed() {
            let parts: Vec<PatchIndex> = surface.parts(i).collect();
            assert_eq!(parts.is_empty(), patch.next == i.after());
            for &part in &parts {
                let part = surface.patch(part);
                assert!(part.min.cmpge(patch.min).all() && part.max.cmple(patch.max).all());
                assert!(part.next <= patch.next && part.sine <= 1.0);
            }
            let mut balance = std::collections::BTreeMap::new();
            for (_, side) in surface.outline(i) {
                let [from, to] = surface.ends(&side);
                for p in [from, to] {
                    let along = patch.normal.dot(p.as_dvec3());
                    assert!(patch.lo <= along && along <= patch.hi, "{i:?}");
                }
                *balance.entry(from.to_array().map(f32::to_bits)).or_insert(0) += 1;
                *balance.entry(to.to_array().map(f32::to_bits)).or_insert(0) -= 1;
                assert!(side.slack <= patch.slack);
            }
            assert!(balance.values().all(|&b| b == 0), "the outline of {i:?} is closed");
            if !parts.is_empty() && surface.has_outline(i) {
                groups += 1;
                let inside: usize = parts.iter().map(|&p| surface.outline(p).len()).sum();
                assert!(surface.outline(i).len() < inside, "sides inside cancel");
                // Each part that is cancelled is one of the group.
                let own = i..patch.next;
                assert!(surface.outline(i).all(|(_, s)| !(s.opposite() && own.contains(&s.twin()))));
            }
        }
        assert!(groups > 50, "{groups} of {}", patches.len());
    }
}
