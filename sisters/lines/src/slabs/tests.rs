use std::collections::BTreeMap;

use glam::{DVec3, Vec3, vec3};
use proptest::prelude::*;

use super::*;
use crate::buffers::LineBuffer;
use crate::sets::random::Random;
use crate::testing::{cases, places};
use crate::view::Lens;

fn box_view(fov_y: Option<f64>, size: [u32; 2]) -> View {
    View::around([-Vec3::ONE, Vec3::ONE], vec3(0.3, 0.4, 1.0), fov_y, size).unwrap()
}

#[test]
fn counts_are_those_of_a_loop_for_all_ranges() {
    let mut random = Random::new(3);
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [1, 1]).unwrap();
    let column = (0..SLICES).fold(0, |bits, i| bits | u128::from(random.unit() < 0.5) << i);
    let grid = SlabGrid { view, columns: vec![column] };
    let [near, far] = view.depths();
    let depth = |slice: u32| near + (far - near) * (f64::from(slice) + 0.5) / f64::from(SLICES);
    for first in 0..SLICES {
        for last in first..SLICES {
            let on = (first..=last).filter(|&s| column >> s & 1 == 1).count() as u32;
            assert_eq!(
                grid.count(0, 0, [depth(first), depth(last)]),
                [on, last - first + 1],
                "{first} {last}"
            );
        }
    }
    for outside in [[far + 1.0, far + 2.0], [near - 2.0, near - 1.0], [f64::NAN, far], [far, near]] {
        assert_eq!(grid.count(0, 0, outside), [0; 2]);
    }
    assert_eq!(grid.count(0, 0, [f64::NEG_INFINITY, f64::INFINITY])[1], SLICES);
    assert_eq!([grid.column(1, 0), grid.column(0, 1)], [0; 2]);
}

/// Columns and slices that points all along a segment lie in; those so near to a border that
/// rounding decides are left out.
fn marched(view: &View, ends: [Vec3; 2]) -> BTreeMap<(u32, u32), u128> {
    let [near, far] = view.depths();
    let [a, b] = ends.map(|e| view.to_eye(e));
    let mut found = BTreeMap::new();
    let inside = |v: f64| (v - v.round()).abs() > 1e-6;
    let [width, height] = view.size().map(f64::from);
    for i in 0..=40_000 {
        let p: DVec3 = a.lerp(b, f64::from(i) / 40_000.0);
        let place = view.project(p);
        let (x, y) = (place.x / place.z, place.y / place.z);
        let slice = (-p.z - near) / (far - near) * f64::from(SLICES);
        let shown = |v: f64, most: f64| v > 0.0 && v < most && inside(v);
        if place.z > 0.0 && shown(x, width) && shown(y, height) && shown(slice, f64::from(SLICES)) {
            *found.entry((x as u32, y as u32)).or_default() |= 1u128 << slice as u32;
        }
    }
    found
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn a_segment_sets_the_slices_that_its_points_lie_in_and_no_gaps(a in places(2.0), b in places(2.0), perspective: bool) {
        let view = box_view(perspective.then_some(0.7), [24, 17]);
        let grid = SlabGrid::of_lines(&LineSet::new([[a, b]]).unwrap(), &view);
        let found = marched(&view, [a, b]);
        let mut all = 0u128;
        let is_run = |bits: u128| {
            let run = bits >> bits.trailing_zeros();
            run == u128::MAX || run & (run + 1) == 0
        };
        for (&(x, y), &wanted) in &found {
            let column = grid.column(x, y);
            all |= column;
            prop_assert_eq!(wanted & !column, 0, "column {} {} misses slices", x, y);
            prop_assert!(is_run(column), "column {} {} has a gap", x, y);
            // Rounding may add a slice at each end.
            prop_assert!(column.count_ones() <= wanted.count_ones() + 2);
        }
        prop_assert!(all == 0 || is_run(all), "the columns leave a gap");
        let set = (0..17).flat_map(|y| (0..24).map(move |x| (x, y))).filter(|&(x, y)| grid.column(x, y) != 0);
        prop_assert!(set.count() <= found.len() + 4);
    }

    #[test]
    fn absurd_lines_and_views_end(
        points in proptest::collection::vec(any::<[f32; 3]>(), 0..9), size: [u32; 2], depths: [f64; 2], value: f64, perspective: bool
    ) {
        let finite = points.iter().map(|p| Vec3::from_array(*p)).filter(|p| p.is_finite());
        let lines = LineSet::new([finite.collect::<Vec<_>>()]).unwrap();
        let lens = match perspective {
            true => Lens::Perspective { fov_y: value },
            false => Lens::Orthographic { half_height: value },
        };
        for (lens, depths) in [(lens, depths), (Lens::Perspective { fov_y: 1.0 }, [1e-3, 1e30])] {
            let size = [size[0] % 3000, size[1] % 300];
            let Ok(view) = View::look_at([Vec3::Z, Vec3::ZERO, Vec3::Y], lens, depths, size) else { continue };
            let grid = SlabGrid::of_lines(&lines, &view);
            let [on, all] = grid.count(0, 0, depths);
            prop_assert!(on <= all);
            let buffer = LineBuffer::new(&lines, &view);
            prop_assert!(buffer.fragments().iter().flatten().all(|f| f.position.is_finite() && f.tangent.is_finite()));
        }
    }
}

#[test]
fn a_line_along_the_view_sets_its_whole_range_in_one_column() {
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [9, 9]).unwrap();
    let lines = LineSet::new([[vec3(0.1, 0.1, -0.6), vec3(0.1, 0.1, 0.7)]]).unwrap();
    let grid = SlabGrid::of_lines(&lines, &view);
    let set: Vec<u32> = grid.columns.iter().map(|c| c.count_ones()).filter(|&on| on > 0).collect();
    let [near, far] = view.depths();
    assert!(set.len() == 1 && (f64::from(set[0]) - 1.3 / (far - near) * 128.0).abs() <= 1.0, "{set:?}");
}

#[test]
fn lines_and_dots_on_the_border_of_two_bands_of_rows_count_once() {
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [64, 64]).unwrap();
    let [left, right] = [vec3(-0.5, 0.0, 0.0), vec3(0.5, 0.0, 0.0)];
    for line in [vec![left, right], vec![right, left], vec![left]] {
        let is_dot = line.len() == 1;
        let lines = LineSet::new([line]).unwrap();
        let grid = SlabGrid::of_lines(&lines, &view);
        let row = |y: u32| (0..64).filter(|&x| grid.column(x, y) != 0).count();
        assert!(row(31) == 0 && row(32) > 0 && (row(32) == 1) == is_dot, "{}", row(32));
        assert_eq!(LineBuffer::new(&lines, &view).covered(), row(32));
    }
}
