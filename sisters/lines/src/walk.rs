//! The columns that a segment crosses, and the part of it in each.
//!
//! Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing", in homogeneous
//! pixel coordinates, so that the same steps serve both lenses. The thesis' rasteriser visits one
//! column for each step along the longer axis; here each column that a segment crosses is visited,
//! so that the parts of a segment are contiguous and their lengths add up.

use glam::DVec3;

use crate::view::View;

/// The part of a segment in the view's depths and in its picture (Liang and Barsky 1984), as two
/// shares of the way from its first end to its second.
fn clip(view: &View, [a, b]: [DVec3; 2]) -> Option<[f64; 2]> {
    let [near, far] = view.depths();
    let (pa, pb) = (view.project(a), view.project(b));
    let [width, height] = view.size().map(f64::from);
    let sides = [
        (-a.z - near, -b.z - near),
        (far + a.z, far + b.z),
        (pa.x, pb.x),
        (width * pa.z - pa.x, width * pb.z - pb.x),
        (pa.y, pb.y),
        (height * pa.z - pa.y, height * pb.z - pb.y),
    ];
    let [mut from, mut to] = [0.0f64, 1.0];
    for (at_a, at_b) in sides {
        if at_a < 0.0 && at_b < 0.0 {
            return None;
        }
        if at_a < 0.0 {
            from = from.max(at_a / (at_a - at_b));
        } else if at_b < 0.0 {
            to = to.min(at_a / (at_a - at_b));
        }
    }
    (from <= to).then_some([from, to])
}

/// Calls `visit` with each pixel whose column a segment of eye space crosses, in order, and the
/// part of the segment in it: two shares of the way from its first end to its second.
pub fn walk(view: &View, ends: [DVec3; 2], mut visit: impl FnMut([u32; 2], [f64; 2])) {
    let Some([from, to]) = clip(view, ends) else { return };
    let [pa, pb] = ends.map(|e| view.project(e));
    let at = |t: f64| pa + (pb - pa) * t;
    let (first, last) = (at(from), at(to));
    let [width, height] = view.size().map(i64::from);
    let pixel = |value: f64, w: f64, size: i64| ((value / w) as i64).clamp(0, size - 1);
    let (mut x, mut y) = (pixel(first.x, first.z, width), pixel(first.y, first.z, height));
    let (end_x, end_y) = (pixel(last.x, last.z, width), pixel(last.y, last.z, height));
    let (step_x, step_y) = ((end_x - x).signum(), (end_y - y).signum());
    // Where the segment crosses the border x / w = c.
    let crossing = |c: i64, step: i64, end: i64, from: [f64; 2], to: [f64; 2]| {
        if c == end {
            return f64::INFINITY;
        }
        let border = (c + i64::from(step > 0)) as f64;
        let (start, stop) = (from[0] - border * from[1], to[0] - border * to[1]);
        start / (start - stop)
    };
    let mut t = from;
    loop {
        let over_x = crossing(x, step_x, end_x, [pa.x, pa.z], [pb.x, pb.z]);
        let over_y = crossing(y, step_y, end_y, [pa.y, pa.z], [pb.y, pb.z]);
        let done = x == end_x && y == end_y;
        // Rounding must not let a part run backwards.
        let next = if done { to } else { over_x.min(over_y).clamp(t, to) };
        visit([x as u32, y as u32], [t, next]);
        if done {
            return;
        }
        t = next;
        // Towards the last column in any case: a crossing may be no number if coordinates are
        // absurd.
        if y == end_y || (x != end_x && over_x <= over_y) {
            x += step_x;
        } else {
            y += step_y;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use casca_truth::cases;
    use glam::{Vec3, vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::buffers::nearest_lines;
    use crate::sets::LineSet;
    use crate::testing::places;
    use crate::view::Lens;

    /// The least and the greatest share of the way of points all along a segment, by the column in
    /// which they lie; those so near to a border that rounding decides are left out.
    fn marched(view: &View, [a, b]: [DVec3; 2]) -> BTreeMap<[u32; 2], [f64; 2]> {
        let [near, far] = view.depths();
        let mut found = BTreeMap::new();
        let [width, height] = view.size().map(f64::from);
        for t in (0..=40_000).map(|i| f64::from(i) / 40_000.0) {
            let p = a.lerp(b, t);
            let place = view.project(p);
            let (x, y) = (place.x / place.z, place.y / place.z);
            let shown = |v: f64, most: f64| v > 0.0 && v < most && (v - v.round()).abs() > 1e-6;
            if place.z > 0.0 && shown(x, width) && shown(y, height) && -p.z > near && -p.z < far {
                let part: &mut [f64; 2] = found.entry([x as u32, y as u32]).or_insert([t; 2]);
                part[1] = t;
            }
        }
        found
    }

    proptest! {
        #![proptest_config(cases(48))]

        #[test]
        fn a_segment_visits_the_columns_of_its_points_and_leaves_no_gaps(
            a in places(2.0), b in places(2.0), perspective: bool
        ) {
            let view = View::around(
                [-Vec3::ONE, Vec3::ONE], vec3(0.3, 0.4, 1.0), perspective.then_some(0.7), [24, 17],
            ).unwrap();
            let ends = [a, b].map(|p| view.to_eye(p));
            let mut visited = Vec::new();
            walk(&view, ends, |pixel, part| visited.push((pixel, part)));
            let found = marched(&view, ends);
            for (pixel, [from, to]) in &found {
                let part = visited.iter().find(|(at, _)| at == pixel);
                prop_assert!(part.is_some(), "column {:?} is missing", pixel);
                let [first, last] = part.unwrap().1;
                prop_assert!(first <= from + 1e-6 && last >= to - 1e-6, "{:?}: {} {}", pixel, first, last);
            }
            prop_assert!(visited.len() <= found.len() + 4);
            prop_assert!(visited.iter().all(|(_, [from, to])| from <= to));
            prop_assert!(visited.windows(2).all(|w| w[0].1[1] == w[1].1[0]), "the parts leave a gap");
        }

        #[test]
        fn absurd_lines_and_views_end(
            points in proptest::collection::vec(any::<[f32; 3]>(), 0..9), size: [u32; 2], depths: [f64; 2],
            value: f64, perspective: bool
        ) {
            let finite = points.iter().map(|p| Vec3::from_array(*p)).filter(|p| p.is_finite());
            let lines = LineSet::new([finite.collect::<Vec<_>>()]).unwrap();
            let lens = match perspective {
                true => Lens::Perspective { fov_y: value },
                false => Lens::Orthographic { half_height: value },
            };
            for (lens, depths) in [(lens, depths), (Lens::Perspective { fov_y: 1.0 }, [1e-3, 1e30])] {
                let size = [size[0] % 3000, size[1] % 300];
                let eye = [Vec3::Z, Vec3::ZERO, Vec3::Y];
                let Ok(view) = View::look_at(eye, lens, depths, size) else { continue };
                let nearest = nearest_lines(&lines, &view);
                let mut found = nearest.iter().flatten();
                prop_assert!(found.all(|f| f.position.is_finite() && f.tangent.is_finite()));
            }
        }
    }
}
