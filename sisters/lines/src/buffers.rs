//! The nearest line in each pixel: its position and tangent (Benevides 2015, section 3.1).

use glam::{DVec3, Vec3};

use crate::sets::{LineSet, Segment};
use crate::view::View;
use crate::walk::walk;

/// The nearest point of a line in a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    /// The middle of the part of the line in the pixel, in eye space.
    pub position: Vec3,
    /// The unit tangent in eye space; zero on dots.
    pub tangent: Vec3,
    /// The number of the line.
    pub line: u32,
    /// The way along the line from its first vertex: it stays the same when the view moves.
    pub along: f32,
}

/// The nearest line in each pixel, row by row from the upper left one. Each pixel that a line
/// crosses shows it, so that lines have no gaps. Among lines at the same depth the one with the
/// lowest number counts as nearest.
///
/// Time: proportional to the vertices and to the pixels that lines cross. Memory: 36 bytes a pixel;
/// 40 bytes a vertex while it runs.
pub fn nearest_lines(lines: &LineSet, view: &View) -> Vec<Option<Fragment>> {
    let places: Vec<DVec3> = lines.points().iter().map(|&p| view.to_eye(p)).collect();
    let (tangents, lengths) = (lines.tangents(), lines.arc_lengths());
    let turn = view.eye_from_world().matrix3;
    let [width, height] = view.size().map(|s| s as usize);
    let mut nearest: Vec<Option<Fragment>> = vec![None; width * height];
    for Segment { line, a, b } in lines.segments() {
        let [a, b] = [a as usize, b as usize];
        let ends = [places[a], places[b]];
        walk(view, ends, |[x, y], [from, to]| {
            let pixel = &mut nearest[y as usize * width + x as usize];
            // The middle of the part.
            let t = (from + to) / 2.0;
            let (position, t) = ((ends[0] + (ends[1] - ends[0]) * t).as_vec3(), t as f32);
            if pixel.is_some_and(|old| old.position.z >= position.z) {
                return;
            }
            let tangent = turn * tangents[a].lerp(tangents[b], t).as_dvec3();
            let along = lengths[a] + (lengths[b] - lengths[a]) * t;
            *pixel = Some(Fragment { position, tangent: tangent.normalize_or_zero().as_vec3(), line, along });
        });
    }
    nearest
}

#[cfg(test)]
mod tests {
    use glam::vec3;

    use super::*;
    use crate::view::Lens;

    #[test]
    fn the_nearest_line_is_kept_with_its_tangent_in_both_lenses() {
        let far = [vec3(-1.0, 0.1, 0.0), vec3(1.0, 0.1, 0.0)];
        let near = [vec3(0.1, -1.0, 1.0), vec3(0.1, 1.0, 1.0)];
        let lines = LineSet::new([far, near]).unwrap();
        for lens in [Lens::Orthographic { half_height: 1.0 }, Lens::Perspective { fov_y: 0.5 }] {
            let eye = [Vec3::Z * 5.0, Vec3::ZERO, Vec3::Y];
            let view = View::look_at(eye, lens, [1.0, 9.0], [64, 64]).unwrap();
            let nearest = nearest_lines(&lines, &view);
            let at = |world: Vec3| {
                let [x, y] = view.pixel(view.to_eye(world).as_vec3()).unwrap();
                nearest[(y * 64 + x) as usize].unwrap()
            };
            let crossing = at(vec3(0.1, 0.1 * 4.0 / 5.0, 1.0));
            assert_eq!((crossing.line, crossing.tangent), (1, Vec3::Y), "{lens:?}");
            let beside = at(vec3(-0.5, 0.1, 0.0));
            assert_eq!((beside.line, beside.tangent, beside.position.z), (0, Vec3::X, -5.0));
            assert!((beside.along - 0.5).abs() < 0.05, "{beside:?}");
            assert!(nearest.iter().flatten().count() >= 100);
        }
    }

    #[test]
    fn a_line_along_the_view_and_a_dot_show_one_pixel_each() {
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [32, 32]).unwrap();
        let along = vec![vec3(0.3, 0.3, -1.0), vec3(0.3, 0.3, 1.0)];
        let lines = LineSet::new([along, vec![Vec3::splat(-0.5)]]).unwrap();
        let nearest = nearest_lines(&lines, &view);
        let shown: Vec<_> = nearest.iter().flatten().map(|f| (f.line, f.tangent.z)).collect();
        assert_eq!(shown, [(0, 1.0), (1, 0.0)]);
    }
}
