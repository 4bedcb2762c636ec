use glam::{Vec3, vec3};

use super::*;
use crate::directions::decoded;

#[test]
fn each_line_has_places_at_its_ends_and_at_equal_ways_between_them() {
    let corner = vec![vec3(0.0, 0.0, 0.0), vec3(3.0, 0.0, 0.0), vec3(3.0, 4.0, 0.0)];
    let twice = vec![Vec3::ONE, Vec3::ONE];
    let lines = LineSet::new([vec![], corner, vec![Vec3::ONE], twice, vec![]]).unwrap();
    let places = Places::new(&lines, 2.0);
    let steps: Vec<u32> = places.spans().iter().map(|s| s.steps).collect();
    assert_eq!(steps, [0, 4, 0, 1, 0]);
    assert_eq!(places.count(), 5 + 1 + 2 + 2);
    let lengths = lines.arc_lengths();
    let span = &places.spans()[1];
    let at: Vec<(u32, f32)> = (0..5).map(|n| segment(&lengths, span, n)).collect();
    assert_eq!(at, [(0, 0.0), (0, 1.75 / 3.0), (1, 0.125), (1, 0.5625), (1, 1.0)]);
    let tangents: Vec<Vec3> = (0..5).map(|n| decoded(places.tangents()[1 + n])).collect();
    assert!(tangents[0].distance(Vec3::X) < 1e-4 && tangents[4].distance(Vec3::Y) < 1e-4, "{tangents:?}");
    // Between those of the vertices, which are (1, 0), (0.6, 0.8) and (0, 1).
    let wanted = Vec3::X.lerp(vec3(0.6, 0.8, 0.0), 1.75 / 3.0).normalize();
    assert!(tangents[1].distance(wanted) < 1e-4, "{tangents:?}");
}

#[test]
fn there_are_never_too_many_places_whatever_the_step() {
    let far = Vec3::splat(3e38);
    let lines = LineSet::new([[Vec3::ZERO, Vec3::X], [-far, far], [Vec3::ONE, Vec3::ONE]]).unwrap();
    for step in [0.0, -1.0, f32::NAN, 1e-45, 1e-3, 1.0, f32::INFINITY] {
        for some in [&lines, &LineSet::new(lines.iter().take(1).map(<[Vec3]>::to_vec)).unwrap()] {
            let places = Places::new(some, step);
            assert!(places.count() <= MOST_PLACES, "{step}: {}", places.count());
            let last = places.spans().last().unwrap();
            assert_eq!(last.place + last.steps + 1, places.count());
        }
    }
    let long = LineSet::new([vec![], vec![Vec3::ONE], vec![Vec3::ZERO, Vec3::X * 2e7]]).unwrap();
    assert_eq!(Places::step_for(&long, 3.0), 3.0);
    let step = Places::step_for(&long, 0.1);
    assert!(step > 2.38 && step < 2.39, "{step}");
    assert_eq!(Places::new(&LineSet::default(), 1.0).count(), 0);
    assert_eq!(Places::new(&LineSet::new([[], []] as [[Vec3; 0]; 2]).unwrap(), 1.0).count(), 2);
}
