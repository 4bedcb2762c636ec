use std::collections::BTreeMap;

use glam::{DVec3, Vec3, vec3};
use proptest::prelude::*;

use super::*;
use crate::sets::random::Random;
use crate::testing::{cases, places};
use crate::view::Lens;

fn box_view(fov_y: Option<f64>, size: [u32; 2]) -> View {
    View::around([-Vec3::ONE, Vec3::ONE], vec3(0.3, 0.4, 1.0), fov_y, size).unwrap()
}

/// Whether a slice is set, by shifting.
fn is_set(column: [u128; 2], slice: u32) -> bool {
    (column[(slice / 128) as usize] >> (slice % 128)) & 1 == 1
}

#[test]
fn counts_are_those_of_a_loop_for_all_ranges() {
    let mut random = Random::new(3);
    for slices in [Slices::S128, Slices::S256] {
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [1, 1]).unwrap();
        let mut grid =
            SlabGrid::of_lines(&LineSet::new([[Vec3::ZERO]]).unwrap(), &view, slices, SpanRule::Span);
        grid.words.fill_with(|| (hash_of(&mut random) << 64) | hash_of(&mut random));
        let column = grid.column(0, 0);
        for first in 0..slices.count() {
            for last in first..slices.count() {
                let on = (first..=last).filter(|&s| is_set(column, s)).count() as u32;
                let depths = [first, last].map(|s| grid.slice_depth(s));
                assert_eq!(grid.count(0, 0, depths), Count { on, total: last - first + 1 }, "{first} {last}");
            }
            let front = (0..first).any(|s| is_set(column, s));
            assert_eq!(grid.any_in_front(0, 0, grid.slice_depth(first)), front, "{first}");
        }
        let [near, far] = view.depths();
        for outside in [[far + 1.0, far + 2.0], [near - 2.0, near - 1.0], [f64::NAN, far], [far, near]] {
            assert_eq!(grid.count(0, 0, outside), Count::default());
        }
        assert_eq!(grid.count(0, 0, [f64::NEG_INFINITY, f64::INFINITY]).total, slices.count());
        assert!(grid.any_in_front(0, 0, far * 2.0) && !grid.any_in_front(0, 0, near - 1.0));
        assert_eq!((grid.column(1, 0), grid.length(0, 1)), ([0; 2], 0.0));
    }
}

fn hash_of(random: &mut Random) -> u128 {
    u128::from((random.unit() * 2f64.powi(53)) as u64) << 11 | u128::from((random.unit() * 2048.0) as u64)
}

/// Columns and slices that points all along a segment lie in; those so near to a border that
/// rounding decides are left out.
fn marched(view: &View, grid: &SlabGrid, ends: [Vec3; 2]) -> BTreeMap<(u32, u32), Vec<u32>> {
    let [near, far] = view.depths();
    let [a, b] = ends.map(|e| view.to_eye(e));
    let mut found: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
    let inside = |v: f64| (v - v.round()).abs() > 1e-6;
    for i in 0..=40_000 {
        let p: DVec3 = a.lerp(b, f64::from(i) / 40_000.0);
        let place = view.project(p);
        let (x, y) = (place.x / place.z, place.y / place.z);
        let slice = (-p.z - near) / (far - near) * f64::from(grid.slices().count());
        let [width, height] = view.size().map(f64::from);
        let shown = x > 0.0
            && y > 0.0
            && x < width
            && y < height
            && slice > 0.0
            && slice < f64::from(grid.slices().count());
        if shown && place.z > 0.0 && inside(x) && inside(y) && inside(slice) {
            let slices = found.entry((x as u32, y as u32)).or_default();
            if !slices.contains(&(slice as u32)) {
                slices.push(slice as u32);
            }
        }
    }
    found
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn a_segment_sets_the_slices_that_its_points_lie_in_and_no_gaps(a in places(2.0), b in places(2.0), perspective: bool) {
        let view = box_view(perspective.then_some(0.7), [24, 17]);
        let grid = SlabGrid::of_lines(&LineSet::new([[a, b]]).unwrap(), &view, Slices::S128, SpanRule::Span);
        let found = marched(&view, &grid, [a, b]);
        let mut all = 0u128;
        for (&(x, y), slices) in &found {
            let column = grid.column(x, y)[0];
            all |= column;
            let wanted = slices.iter().fold(0u128, |w, s| w | 1 << s);
            prop_assert_eq!(wanted & !column, 0, "column {} {} misses slices", x, y);
            // Rounding may add a slice at each end.
            let run = column >> column.trailing_zeros();
            prop_assert_eq!(run & (run + 1), 0, "column {} {} has a gap", x, y);
            prop_assert!(column.count_ones() as usize <= slices.len() + 2);
            for (group, &length) in grid.lengths(x, y).iter().enumerate() {
                let bits = (column >> (16 * group)) & 0xffff;
                prop_assert!(length == 0.0 || bits != 0, "group {} of {} {} has length without bits", group, x, y);
                let few = bits.count_ones() < 3;
                prop_assert!(length > 0.0 || few, "group {} of {} {} has bits without length", group, x, y);
            }
        }
        if all != 0 {
            let run = all >> all.trailing_zeros();
            prop_assert!(run == u128::MAX || run & (run + 1) == 0, "the columns leave a gap");
        }
        let set = (0..17).flat_map(|y| (0..24).map(move |x| (x, y))).filter(|&(x, y)| grid.column(x, y) != [0; 2]);
        prop_assert!(set.count() <= found.len() + 4);
    }

    #[test]
    fn lengths_of_the_columns_add_up_to_those_of_the_lines(
        points in proptest::collection::vec(places(2.0), 2..30), perspective: bool, height in 1u32..90
    ) {
        // Within the box, so that nothing is clipped.
        let lines = LineSet::new([points.iter().map(|&p| p * 0.5)]).unwrap();
        let view = box_view(perspective.then_some(0.7), [height * 2, height]);
        let grid = SlabGrid::of_lines(&lines, &view, Slices::S256, SpanRule::Span);
        let sum: f32 = (0..height).flat_map(|y| (0..2 * height).map(move |x| (x, y))).map(|(x, y)| grid.length(x, y)).sum();
        let long: f32 = lines.arc_lengths().last().copied().unwrap();
        prop_assert!((sum - long).abs() <= 1e-4 * (1.0 + long), "{} {}", sum, long);
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
            let grid = SlabGrid::of_lines(&lines, &view, Slices::S128, SpanRule::Span);
            prop_assert!(grid.fill_fraction(0..size[0], 0..size[1], depths) <= 1.0);
            let buffer = crate::buffers::LineBuffer::new(&lines, &view);
            prop_assert!(buffer.fragments().iter().flatten().all(|f| f.position.is_finite() && f.tangent.is_finite()));
        }
    }
}

#[test]
fn a_line_along_the_view_sets_its_whole_range_in_one_column_and_one_slice_without_the_rule() {
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [9, 9]).unwrap();
    let lines = LineSet::new([[vec3(0.1, 0.1, -0.6), vec3(0.1, 0.1, 0.7)]]).unwrap();
    let set = |rule| {
        let grid = SlabGrid::of_lines(&lines, &view, Slices::S128, rule);
        let columns: Vec<u128> = (0..81).map(|i| grid.column(i % 9, i / 9)[0]).filter(|&c| c != 0).collect();
        (columns.len(), columns[0].count_ones(), grid.length(4, 4), grid.lengths(4, 4).to_vec())
    };
    let [near, far] = view.depths();
    let slices = 1.3 / (far - near) * 128.0;
    let (columns, on, length, groups) = set(SpanRule::Span);
    assert!(columns == 1 && (f64::from(on) - slices).abs() <= 1.0 && (length - 1.3).abs() < 1e-5, "{on}");
    // Groups in the middle of the line hold as much of it as they are deep.
    let group = ((far - near) / 8.0) as f32;
    assert!(groups.len() == 8 && groups[3..5].iter().all(|l| (l - group).abs() < 1e-5), "{groups:?}");
    assert_eq!(groups[7] + groups[0], 0.0, "{groups:?}");
    assert_eq!((set(SpanRule::Middle).0, set(SpanRule::Middle).1), (1, 1));
}

#[test]
fn lines_and_dots_on_the_border_of_two_rows_of_tiles_count_once() {
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [64, 64]).unwrap();
    let [left, right] = [vec3(-0.5, 0.0, 0.0), vec3(0.5, 0.0, 0.0)];
    for (line, long) in [(vec![left, right], 1.0), (vec![right, left], 1.0), (vec![left], 0.0)] {
        let lines = LineSet::new([line]).unwrap();
        let grid = SlabGrid::of_lines(&lines, &view, Slices::S128, SpanRule::Span);
        let row = |y: u32| {
            let columns = (0..64).map(|x| (grid.length(x, y), u32::from(grid.column(x, y) != [0; 2])));
            columns.fold((0.0, 0), |sum, column| (sum.0 + column.0, sum.1 + column.1))
        };
        assert_eq!(row(31), (0.0, 0));
        let (length, columns) = row(32);
        assert!((length - long).abs() < 1e-5 && (long == 0.0) == (columns == 1), "{length} {columns}");
        let buffer = crate::buffers::LineBuffer::new(&lines, &view);
        assert_eq!(buffer.covered() as u32, columns);
    }
}

#[test]
fn lengths_that_are_no_numbers_are_left_out() {
    let view = box_view(None, [9, 9]);
    let [near, far] = view.depths();
    let spread = |ends: [f64; 2], length: f64| {
        let mut lengths = [0.0; 8];
        slices::spread(&view, Slices::S128, ends, length, &mut lengths);
        lengths
    };
    for (ends, length) in
        [([-f64::NAN, far], f64::NAN), ([near, f64::NAN], f64::NAN), ([near, far], f64::INFINITY)]
    {
        assert_eq!(spread(ends, length), [0.0; 8], "{ends:?}");
    }
    assert!(spread([near, far], 8.0).iter().all(|l| (l - 1.0).abs() < 1e-6));
    // A view whose pixels are so small that pixel coordinates overflow.
    let lens = Lens::Orthographic { half_height: 1e-300 };
    let tiny = View::look_at([Vec3::Z, Vec3::ZERO, Vec3::Y], lens, [-1e38, 1e38], [40, 30]).unwrap();
    let far = vec3(3e38, -3e38, 3e38);
    let lines = LineSet::new([[far, -far], [far, Vec3::ZERO], [Vec3::ZERO, vec3(0.0, 0.0, 1e38)]]).unwrap();
    let grid = SlabGrid::of_lines(&lines, &tiny, Slices::S256, SpanRule::Span);
    assert!(grid.lengths(20, 15).iter().all(|l| l.is_finite()), "{:?}", grid.lengths(20, 15));
}

/// Corners and triangles of a tetrahedron, and the planes of its sides.
const TETRAHEDRON: [Vec3; 4] =
    [vec3(-0.7, -0.6, -0.5), vec3(0.8, -0.5, -0.4), vec3(0.0, 0.9, -0.3), vec3(0.1, 0.0, 0.8)];
const SIDES: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

fn inside(p: DVec3) -> bool {
    SIDES.iter().enumerate().all(|(i, side)| {
        let [a, b, c] = side.map(|v| TETRAHEDRON[v as usize].as_dvec3());
        let opposite = TETRAHEDRON[[3, 2, 0, 1][i]].as_dvec3();
        let normal = (b - a).cross(c - a);
        normal.dot(p - a) * normal.dot(opposite - a) > 0.0
    })
}

#[test]
fn slices_of_a_solid_are_those_whose_middles_lie_inside() {
    for fov_y in [None, Some(0.8), Some(2.0)] {
        let view = box_view(fov_y, [33, 21]);
        for slices in [Slices::S128, Slices::S256] {
            let grid = SlabGrid::of_solid(&TETRAHEDRON, &SIDES, &view, slices).unwrap();
            let mut set = 0;
            for (x, y) in (0..21).flat_map(|y| (0..33).map(move |x| (x, y))) {
                for slice in 0..slices.count() {
                    let depth = grid.slice_depth(slice);
                    let side = view.pixel_size(depth);
                    let eye = vec3(
                        ((f64::from(x) + 0.5 - 16.5) * side) as f32,
                        (-(f64::from(y) + 0.5 - 10.5) * side) as f32,
                        -depth as f32,
                    );
                    let truth = inside(view.to_world(eye));
                    let near_border = [-1.0, 1.0]
                        .iter()
                        .any(|e| inside(view.to_world(eye + vec3(0.0, 0.0, e * 1e-5))) != truth);
                    set += usize::from(truth);
                    assert!(
                        is_set(grid.column(x, y), slice) == truth || near_border,
                        "{fov_y:?} {x} {y} {slice}"
                    );
                }
            }
            assert!(set > 100, "{set}");
            assert!(grid.tiles() < 15, "tiles without bits take no memory: {}", grid.tiles());
        }
    }
}

/// 16 x 16 pixels of the size 1 around the axis z.
fn parallel_view() -> View {
    let lens = Lens::Orthographic { half_height: 8.0 };
    View::look_at([Vec3::Z * 8.0, Vec3::ZERO, Vec3::Y], lens, [1.0, 15.0], [16, 16]).unwrap()
}

#[test]
fn rays_through_edges_and_vertices_leave_no_column_open() {
    // Vertices and edges of these cubes lie on the rays through pixel centres.
    let view = parallel_view();
    let corners: Vec<Vec3> =
        (0..8).map(|i| vec3((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 4.0 - 2.5).collect();
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles: Vec<[u32; 3]> =
        quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    let grid = SlabGrid::of_solid(&corners, &triangles, &view, Slices::S128).unwrap();
    let filled: Vec<u32> = (0..256).map(|i| grid.column(i % 16, i / 16)[0].count_ones()).collect();
    // A square of 4 x 4 columns: of pixels on the border, those of two sides belong to it.
    assert_eq!(filled.iter().filter(|&&n| n > 0).count(), 16, "{filled:?}");
    // 4 of 14 units of depth.
    assert!(filled.iter().all(|n| [0, 36, 37].contains(n)), "{filled:?}");
    let all = grid.fill_fraction(0..16, 0..16, [1.0, 15.0]);
    assert!((all - 16.0 / 256.0 * 4.0 / 14.0).abs() < 1e-3, "{all}");
    let bad = SlabGrid::of_solid(&corners, &[[0, 1, 8]], &view, Slices::S128);
    assert_eq!(bad, Err(SolidError::NoVertex { triangle: 0, vertex: 8, vertices: 8 }));
    assert_eq!(SlabGrid::of_solid(&[Vec3::NAN], &[], &view, Slices::S128), Err(SolidError::NotFinite(0)));
}

#[test]
fn solids_may_cross_the_borders_of_the_picture() {
    let view = parallel_view();
    for step in 0..200 {
        for axis in [Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Y] {
            let corners = [[0.0, 0.0], [0.7, 0.0], [0.0, 0.7]]
                .map(|[x, y]| vec3(x, y, 0.0) + axis * (step as f32 * 0.1));
            assert!(SlabGrid::of_solid(&corners, &[[0, 1, 2]], &view, Slices::S128).is_ok());
        }
    }
}
