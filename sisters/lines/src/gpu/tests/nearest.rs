//! The nearest lines beside the processor's.

use super::*;
use crate::buffers::nearest_lines;

#[test]
fn nearest_lines_are_those_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let (mut covered, mut others) = (0, 0);
    // The last view is from as far away as the renderer takes.
    let from_afar = View::around([-Vec3::ONE, Vec3::ONE], vec3(0.3, 0.4, 1.0), Some(0.0335), SIZE).unwrap();
    let views = views([-Vec3::ONE, Vec3::ONE]).into_iter().chain([from_afar]);
    // A line on the border of two rows of pixels counts as in the lower one.
    let border = LineSet::new([[vec3(-0.5, 0.0, 0.01), vec3(0.5, 0.0, 0.01)]]).unwrap();
    let straight = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, SIZE).unwrap();
    let sets = [wild(3), set(Family::Spiral, 80), set(Family::Reservoir, 100)];
    let pairs = sets.iter().flat_map(|lines| views.clone().map(move |view| (lines, view)));
    for (lines, view) in pairs.chain([(&border, straight)]) {
        let renderer = run(&gpu, lines, &view, Settings::new(0.3, 0.01));
        let found = renderer.read_fragments(&gpu).unwrap();
        let nearest = nearest_lines(lines, &view);
        for (found, expected) in found.iter().zip(&nearest) {
            covered += usize::from(expected.is_some());
            let is_same = match (found, expected) {
                (None, None) => true,
                (Some(a), Some(b)) if a.line == b.line => {
                    let off = a.position.distance(b.position).max(a.tangent.distance(b.tangent) * 0.1);
                    off < 1e-3 && (a.along - b.along).abs() < 1e-3
                }
                _ => false,
            };
            assert!(is_same || lines.len() > 1, "{found:?} {expected:?}");
            others += usize::from(!is_same);
        }
    }
    assert!(covered > 3000 && others * 500 < covered, "{others} of {covered} fragments differ");
}
