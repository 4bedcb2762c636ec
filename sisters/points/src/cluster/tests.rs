//! Clusters beside the analytic truth of a sphere and of a hollow.

use super::*;
use crate::samples::{cases, coordinate, sphere};
use proptest::prelude::*;

const KERNEL: Kernel = Kernel::Relative { log10_radius: 2.9 };

/// Falsely visible and falsely hidden points of a sphere.
fn errors(clustering: Clustering, radius: Radius, passes: Passes) -> (usize, usize) {
    let (points, eye) = (sphere(20_000), DVec3::new(3.0, 1.0, -2.0));
    let found = visible_clusters(&points, eye, KERNEL, clustering, radius, passes).unwrap();
    let truth = |p: DVec3| p.dot(eye - p) > 0.0;
    let count = |wanted: bool| {
        points.iter().zip(&found).filter(|(p, found)| **found != truth(**p) && **found == wanted).count()
    };
    (count(true), count(false))
}

#[test]
fn clusters_of_a_sphere_err_at_its_limb() {
    for clustering in [Clustering::Grid { cells: [30; 3] }, Clustering::Octree { max_points: 12 }] {
        let (false_visible, false_hidden) = errors(clustering, Radius::Rescaled, Passes::One);
        assert!(false_visible < 700 && false_hidden < 700, "{clustering:?} {false_visible} {false_hidden}");
    }
}

#[test]
fn few_clusters_need_a_rescaled_radius() {
    let coarse = Clustering::Grid { cells: [12; 3] };
    let (given, _) = errors(coarse, Radius::AsGiven, Passes::One);
    let (rescaled, hidden) = errors(coarse, Radius::Rescaled, Passes::One);
    assert!(given > 2 * rescaled && hidden < 1500, "{given} {rescaled} {hidden}");
}

#[test]
fn a_second_pass_removes_falsely_visible_points() {
    let clusters = Clustering::Octree { max_points: 12 };
    let one = errors(clusters, Radius::Rescaled, Passes::One);
    let two = errors(clusters, Radius::Rescaled, Passes::Two);
    assert!(two.0 < one.0 && two.1 >= one.1, "{one:?} {two:?}");
}

#[test]
fn every_point_is_in_one_cell_and_leaves_are_small() {
    let mut points = sphere(3000);
    points.extend([DVec3::MAX, DVec3::MIN, DVec3::ONE, DVec3::ONE, DVec3::ONE]);
    for clustering in [Clustering::Grid { cells: [1 << 20, 1, 7] }, Clustering::Octree { max_points: 1 }] {
        for points in [&points[..], &points[..3000], &points[3002..], &[]] {
            let cells = Cells::new(points, clustering).unwrap();
            let mut all: Vec<u32> = cells.iter().flatten().copied().collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..points.len() as u32) && cells.iter().all(|cell| !cell.is_empty()));
        }
    }
    let leaves = Cells::new(&sphere(3000), Clustering::Octree { max_points: 5 }).unwrap();
    assert!(leaves.iter().all(|leaf| leaf.len() <= 5) && leaves.iter().count() < 3000);
    assert_eq!(cluster_count(&sphere(3000), Clustering::Octree { max_points: 5 }), Ok(leaves.iter().count()));
}

#[test]
fn a_rescaled_radius_still_holds_all_representatives() {
    for i in 0..200 {
        let far = 0.1 + f64::from(i).sqrt();
        let points: Vec<DVec3> = sphere(50).into_iter().map(|p| p * far + DVec3::Y).collect();
        let kernel = Kernel::Absolute { radius: 2.0 * far + 2.0 };
        let grid = Clustering::Grid { cells: [2; 3] };
        let eye = DVec3::new(0.3, 0.7, far);
        let found = visible_clusters(&points, eye, kernel, grid, Radius::Rescaled, Passes::One);
        assert!(found.is_ok(), "{found:?}");
    }
}

#[test]
fn no_points_have_no_visible_points() {
    let kernels = [KERNEL, Kernel::Absolute { radius: 2.0 }, Kernel::Exponential { gamma: -0.001 }];
    for kernel in kernels {
        let grid = Clustering::Grid { cells: [2; 3] };
        let found = visible_clusters(&[], DVec3::ONE, kernel, grid, Radius::Rescaled, Passes::Two);
        assert_eq!(found.map(|bits| bits.len()), Ok(0), "{kernel:?}");
    }
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn points_at_one_place_have_one_answer(
        points in prop::collection::vec(prop::array::uniform3(coordinate(1.0).prop_map(f64::from)), 0..40),
        eye in prop::array::uniform3(coordinate(2.0).prop_map(f64::from)),
        (most, cells, two) in (1..5_u32, prop::array::uniform3(1..4_u32), any::<bool>()),
    ) {
        let points: Vec<DVec3> = points.into_iter().map(DVec3::from_array).collect();
        let passes = if two { Passes::Two } else { Passes::One };
        for clustering in [Clustering::Octree { max_points: most }, Clustering::Grid { cells }] {
            let eye = DVec3::from_array(eye);
            let found = visible_clusters(&points, eye, KERNEL, clustering, Radius::Rescaled, passes).unwrap();
            prop_assert_eq!(found.len(), points.len());
            for (i, j) in (0..points.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
                let grid = matches!(clustering, Clustering::Grid { .. });
                prop_assert!(!grid || points[i] != points[j] || found[i] == found[j]);
            }
        }
    }
}

#[test]
fn errors_name_the_cause() {
    let ask = |points: &[DVec3], clustering| {
        visible_clusters(points, DVec3::ZERO, KERNEL, clustering, Radius::Rescaled, Passes::One).unwrap_err()
    };
    for cells in [[1, 0, 1], [1, 1, (1 << 20) + 1]] {
        assert_eq!(ask(&[DVec3::ONE], Clustering::Grid { cells }), ClusterError::Cells { cells });
    }
    assert_eq!(ask(&[], Clustering::Octree { max_points: 0 }), ClusterError::NoPoints);
    let bad = [DVec3::ONE, DVec3::NAN];
    let error = ClusterError::Hpr(HprError::PointNotFinite { index: 1 });
    assert_eq!(ask(&bad, Clustering::Octree { max_points: 3 }), error);
}
