//! Columns and nearest lines beside the processor's and exact clipping.

use glam::{DVec3, Vec3, vec3};

use super::*;
use crate::buffers::LineBuffer;
use crate::gpu::numeric::IN_DOUBT;
use crate::slabs::{SlabGrid, SpanRule};

/// Whether a segment enters a cell of a column: exact clipping in homogeneous coordinates, in
/// double precision. The cell is larger on each side by a part of a pixel and of a slice.
fn enters(view: &View, [a, b]: [DVec3; 2], [x, y]: [u32; 2], slice: u32, slices: u32, larger: f64) -> bool {
    let [near, far] = view.depths();
    let thick = (far - near) / f64::from(slices);
    let cell = |i: u32| (f64::from(i) - larger, f64::from(i) + 1.0 + larger);
    let ((left, right), (top, bottom), (first, last)) = (cell(x), cell(y), cell(slice));
    let depths = (near + thick * first, near + thick * last);
    let sides = |p: DVec3| {
        let q = view.project(p);
        let (x, y) = ((q.x - left * q.z, right * q.z - q.x), (q.y - top * q.z, bottom * q.z - q.y));
        [x.0, x.1, y.0, y.1, -p.z - depths.0, depths.1 + p.z]
    };
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (at_a, at_b) in sides(a).into_iter().zip(sides(b)) {
        if at_a < 0.0 && at_b < 0.0 {
            return false;
        }
        let crossing = at_a / (at_a - at_b);
        if at_a < 0.0 {
            from = from.max(crossing);
        } else if at_b < 0.0 {
            to = to.min(crossing);
        }
    }
    from <= to
}

#[test]
fn columns_hold_the_slices_that_lines_enter_and_differ_from_the_processors_only_where_rounding_decides() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let (mut differing, mut all) = (0, 0);
    let sets = [wild(1), wild(2), set(Family::Abc, 60), set(Family::PomPom, 150), set(Family::Parallel, 200)];
    for (number, lines) in sets.iter().enumerate() {
        // The last view is from as far away as the renderer takes.
        let from_afar =
            View::around([-Vec3::ONE, Vec3::ONE], vec3(0.3, 0.4, 1.0), Some(0.0335), SIZE).unwrap();
        for view in views([-Vec3::ONE, Vec3::ONE]).into_iter().chain([from_afar]) {
            let slices = if number % 2 == 0 { Slices::S128 } else { Slices::S256 };
            let with = Settings { slices, ..settings(AoOptions::new(0.3, 0.01)) };
            let renderer = run(&gpu, lines, &view, with);
            let words = renderer.read_columns(&gpu).unwrap();
            let grid = SlabGrid::of_lines(lines, &view, slices, SpanRule::Span);
            let points: Vec<DVec3> = lines.points().iter().map(|&p| view.to_eye(p)).collect();
            let segments: Vec<[DVec3; 2]> =
                lines.segments().map(|s| [points[s.a as usize], points[s.b as usize]]).collect();
            let count = slices.count();
            for (column, words) in words.chunks(count as usize / 32).enumerate() {
                let at = [column as u32 % SIZE[0], column as u32 / SIZE[0]];
                let expected = grid.column(at[0], at[1]);
                for slice in 0..count {
                    let found = words[slice as usize / 32] >> (slice % 32) & 1 == 1;
                    let on_processor = expected[slice as usize / 128] >> (slice % 128) & 1 == 1;
                    all += usize::from(found);
                    if found != on_processor {
                        differing += 1;
                        let larger = f64::from(IN_DOUBT) * if found { 1.0 } else { -1.0 };
                        let entered = segments.iter().any(|&s| enters(&view, s, at, slice, count, larger));
                        assert_eq!(entered, found, "set {number}, column {at:?}, slice {slice}: {view:?}");
                    }
                }
            }
            let lengths = renderer.read_lengths(&gpu).unwrap();
            let groups = slices.groups();
            let (mut off, mut sum) = (0.0, 0.0);
            for (column, found) in lengths.chunks(groups).enumerate() {
                let expected = grid.lengths(column as u32 % SIZE[0], column as u32 / SIZE[0]);
                for (found, expected) in found.iter().zip(expected) {
                    off += (found - f64::from(*expected)).abs();
                    sum += found;
                }
            }
            assert!(sum > 1.0 && off < sum * 1e-4, "set {number}: {off} of {sum}");
        }
    }
    assert!(all > 50_000 && differing * 2000 < all, "{differing} of {all} bits differ");
}

#[test]
fn lines_on_borders_of_tiles_are_in_the_columns_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, SIZE).unwrap();
    let lines = LineSet::new([[vec3(-0.5, 0.0, 0.01), vec3(0.5, 0.0, 0.01)]]).unwrap();
    let renderer = run(&gpu, &lines, &view, settings(AoOptions::new(0.3, 0.01)));
    let grid = SlabGrid::of_lines(&lines, &view, Slices::S128, SpanRule::Span);
    let pixels = || (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    let words = pixels().flat_map(|[x, y]| (0..4).map(move |i| (x, y, i)));
    let expected: Vec<u32> = words.map(|(x, y, i)| (grid.column(x, y)[0] >> (32 * i)) as u32).collect();
    assert!(renderer.read_columns(&gpu).unwrap() == expected);
    let sum: f64 = renderer.read_lengths(&gpu).unwrap().iter().sum();
    assert!((sum - 1.0).abs() < 1e-5, "{sum}");
    let shown: Vec<bool> = renderer.read_fragments(&gpu).unwrap().iter().map(Option::is_some).collect();
    let buffer = LineBuffer::new(&lines, &view);
    assert!(shown.iter().eq(buffer.fragments().iter().map(Option::is_some).collect::<Vec<_>>().iter()));
}

#[test]
fn nearest_lines_are_those_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let (mut covered, mut others) = (0, 0);
    for lines in [wild(3), set(Family::Spiral, 80), set(Family::Reservoir, 100)] {
        for view in views([-Vec3::ONE, Vec3::ONE]) {
            let renderer = run(&gpu, &lines, &view, settings(AoOptions::new(0.3, 0.01)));
            let found = renderer.read_fragments(&gpu).unwrap();
            let buffer = LineBuffer::new(&lines, &view);
            for (found, expected) in found.iter().zip(buffer.fragments()) {
                covered += usize::from(expected.is_some());
                let is_same = match (found, expected) {
                    (None, None) => true,
                    (Some(a), Some(b)) if a.line == b.line => {
                        let off = a.position.distance(b.position).max(a.tangent.distance(b.tangent) * 0.1);
                        off < 1e-3 && (a.along - b.along).abs() < 1e-3
                    }
                    _ => false,
                };
                others += usize::from(!is_same);
            }
        }
    }
    assert!(covered > 2000 && others * 500 < covered, "{others} of {covered} fragments differ");
}
