//! Hidden point removal beside the truth of spheres, boxes and planes, which formulas give. Both
//! kinds of errors are counted.

use super::*;
use crate::samples::sphere;
use casca_truth::{cases, places::coordinates};
use proptest::collection::vec;
use proptest::prelude::*;

const USUAL: f64 = 2.9;

/// The numbers of falsely visible and of falsely hidden points.
fn errors(points: &[DVec3], eye: DVec3, log10_radius: f64, truth: impl Fn(DVec3) -> bool) -> [usize; 2] {
    let found = visible_points(points, eye, log10_radius).unwrap();
    [true, false].map(|visible| {
        points.iter().zip(&found).filter(|(p, found)| **found == visible && truth(**p) != visible).count()
    })
}

/// A square grid of points at a height, from -1 to 1.
fn sheet(side: usize, z: f64) -> impl Iterator<Item = DVec3> {
    let at = move |i: usize| 2.0 * i as f64 / (side - 1) as f64 - 1.0;
    (0..side * side).map(move |i| DVec3::new(at(i % side), at(i / side), z))
}

#[test]
fn the_near_half_of_a_sphere_is_visible() {
    let (points, eye) = (sphere(20_000), DVec3::new(3.0, 1.0, -2.0));
    let truth = |p: DVec3| p.dot(eye - p) > 0.0;
    assert!(points.iter().filter(|p| truth(**p)).count() > 7000);
    let errors = errors(&points, eye, USUAL, truth);
    assert!(errors[0] < 200 && errors[1] < 200, "{errors:?}");
}

#[test]
fn a_larger_radius_trades_false_hidden_for_false_visible_points() {
    // A floor, a wall beside it and a hidden sheet below. A small radius loses the corner of floor
    // and wall, a large one finds the lower sheet between the points of the floor.
    let wall = sheet(60, 0.0).map(|p| DVec3::new(1.0, p.x, p.y + 1.0));
    let points: Vec<DVec3> = sheet(60, 0.0).chain(wall).chain(sheet(60, -0.5)).collect();
    let (eye, truth) = (DVec3::new(-0.6, 0.02, 3.0), |p: DVec3| p.z >= 0.0);
    let [small, best, large] = [0.0, 2.5, 6.0].map(|log10_radius| errors(&points, eye, log10_radius, truth));
    assert!(small[1] > 1000 && small[0] == 0, "{small:?}");
    assert!(best[0] + best[1] < 100, "{best:?}");
    assert!(large[1] == 0 && large[0] > 2000, "{large:?}");
}

#[test]
fn points_at_the_eye_on_rays_and_twice_have_defined_answers() {
    let eye = DVec3::new(1.0, 2.0, 3.0);
    let at = |t: f64| eye + DVec3::X * t;
    let points = [eye, at(2.0), at(1.0), at(1.0), at(-4.0), at(-3.0), eye];
    let visible = visible_points(&points, eye, USUAL).unwrap();
    assert_eq!(visible.iter().by_vals().collect::<Vec<_>>(), [true, false, true, true, false, true, true]);
    assert!(visible_points(&[], eye, USUAL).unwrap().is_empty());
    assert!(visible_points(&[eye; 5], eye, USUAL).unwrap().all());
    assert!(visible_points(&[at(1.0)], eye, USUAL).unwrap().all());
}

#[test]
fn errors_name_the_cause() {
    let ask = |points: &[DVec3], eye, log10| visible_points(points, eye, log10).unwrap_err();
    let far = DVec3::splat(f64::MAX);
    assert_eq!(ask(&[DVec3::ZERO, DVec3::NAN], DVec3::ONE, USUAL), HprError::PointNotFinite { index: 1 });
    assert_eq!(ask(&[], DVec3::NAN, USUAL), HprError::EyeNotFinite);
    assert_eq!(ask(&[DVec3::ZERO, -far], far, USUAL), HprError::TooFar { index: 1 });
    for bad in [-0.1, 300.1, f64::NAN] {
        assert!(matches!(ask(&[], DVec3::ONE, bad), HprError::LogRadius { .. }));
    }
}

/// Any doubles, of which many are ordinary.
fn anywhere() -> impl Strategy<Value = DVec3> {
    let any = prop_oneof![-2.0..2.0, (-3..3_i32).prop_map(f64::from), any::<u64>().prop_map(f64::from_bits)];
    prop::array::uniform3(any).prop_map(DVec3::from)
}

fn in_planes() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(coordinates(-1.0..1.0, 1.0).prop_map(f64::from)).prop_map(DVec3::from)
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn any_input_has_an_answer_or_an_error(
        points in prop_oneof![vec(anywhere(), 0..30), vec(in_planes(), 0..30)],
        eye in prop_oneof![anywhere(), in_planes()],
        log10_radius in 0.0..300.0,
    ) {
        if let Ok(visible) = visible_points(&points, eye, log10_radius) {
            prop_assert_eq!(visible.len(), points.len());
            for i in 0..points.len() {
                prop_assert!(points[i] != eye || visible[i], "a point at the eye");
                for j in 0..i {
                    prop_assert!(points[i] != points[j] || visible[i] == visible[j], "points at one place");
                }
            }
        }
    }
}
