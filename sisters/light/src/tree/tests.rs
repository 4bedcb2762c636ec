use super::*;
use crate::input::{Grid, Material};
use crate::spread::unit;
use glam::Vec3;

/// Triangles of all sizes, some of them turned along the axes.
fn scene(count: u64) -> (Lattice, Vec<Surface>) {
    let lattice = Lattice::new(&Grid { min: Vec3::ZERO, max: Vec3::splat(8.0), cells: 32 }, &[]);
    let point = |key: u64, size: f64| {
        DVec3::from_array([0, 1, 2].map(|axis| (unit(key, axis) - 0.5) * size)).as_vec3().as_dvec3()
    };
    let surface = |i: u64| {
        let size = [0.3, 3.0, 40.0][i as usize % 3];
        let middle = point(4 * i, 32.0) + 17.0;
        let mut corners = [1, 2, 3].map(|k| middle + point(4 * i + k, size));
        if i.is_multiple_of(5) {
            corners.iter_mut().for_each(|c| c.y = middle.y.round());
        }
        Surface::new(corners, 0, 0, &Material::default())
    };
    (lattice, (0..count).filter_map(surface).collect())
}

#[test]
fn the_tree_finds_what_a_test_of_all_triangles_finds() {
    for count in [0, 1, 3, 5, 400] {
        let (lattice, surfaces) = scene(count);
        let tree = Tree::new(&lattice, &surfaces, |_| true);
        let mut hits = 0;
        for i in 0..4000_u64 {
            let random = |k: u64| DVec3::from_array([0, 1, 2].map(|axis| unit(i << 8 | k, axis)));
            // One of eight starts outside, one of seven goes along an axis.
            let from = random(0) * 34.0 - if i % 8 == 0 { DVec3::X * 40.0 } else { DVec3::ZERO };
            let way = if i % 7 == 0 { DVec3::AXES[i as usize % 3] } else { random(1) - 0.5 };
            let Some(direction) = way.try_normalize() else { continue };
            let reach = [1.0, 10.0, f64::INFINITY][i as usize % 3];
            let met = |(number, f): (usize, Facet)| {
                tree.meet(&f, from, direction).filter(|d| *d <= reach).map(|d| (d, number as u32))
            };
            let facets = (0..).zip(&surfaces).map(|(k, s)| (k as usize, Facet::new(s, k)));
            let all = facets.filter_map(met).min_by(|a, b| a.partial_cmp(b).unwrap());
            assert_eq!(tree.first(from, direction, reach), all, "{from} {direction} {reach}");
            assert_eq!(tree.blocker(from, direction, reach, i as u32).is_some(), all.is_some());
            hits += usize::from(all.is_some());
        }
        assert!(hits > 1500 || count < 400, "{hits}");
    }
}
