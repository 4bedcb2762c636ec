use std::f32::consts::FRAC_PI_2;

use glam::{DMat4, vec3};

use super::*;
use crate::buffers::{Fragment, LineBuffer};
use crate::numeric::{MARGIN_IN_TUBES, PLACE_STEP, USUAL_SIDE_RAYS};
use crate::occlusion::Occlusion;
use crate::sets::generate::{Family, Recipe};
use crate::view::View;

fn rmse(a: &[f32], b: &[f32]) -> f32 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f32>() / a.len() as f32).sqrt()
}

#[test]
fn pixels_take_the_places_beside_them_and_the_sides_beside_their_pole() {
    let lines = LineSet::new([vec![Vec3::ONE], vec![Vec3::ZERO, Vec3::X]]).unwrap();
    let (cells, samples) = (Cells::new(&lines, 0.1), SampleSets::spirals(4, 2, 1).unwrap());
    let options = AoOptions::places(0.25 / PLACE_STEP, 0.1);
    let sides = Sides::new(&lines, &cells, &samples, options).unwrap();
    let (across, up) = Vec3::X.any_orthonormal_pair();
    let turned = |sides: f32| {
        let angle = sides * TAU / SIDES as f32;
        across * angle.cos() + up * angle.sin()
    };
    // The dot has one place, the line five.
    for (along, side, wanted) in [
        (0.0, 0.0, [(1, 0, 1.0), (1, 1, 0.0), (2, 0, 0.0), (2, 1, 0.0)]),
        (0.3, 2.5, [(2, 2, 0.4), (2, 3, 0.4), (3, 2, 0.1), (3, 3, 0.1)]),
        (1.0, 15.75, [(4, 15, 0.0), (4, 0, 0.0), (5, 15, 0.25), (5, 0, 0.75)]),
        (9.0, 8.25, [(4, 8, 0.0), (4, 9, 0.0), (5, 8, 0.75), (5, 9, 0.25)]),
    ] {
        let found = sides.parts(1, along, turned(side));
        let same = |(f, w): (&Part, &Part)| {
            let exact = f.2 < 1e-3 || (f.0, f.1) == (w.0, w.1);
            exact && (f.2 - w.2).abs() < 1e-3
        };
        // A pole at a side may count as the end of the side before it.
        let is_near_side = side.fract() == 0.0;
        assert!(is_near_side || found.iter().zip(&wanted).all(same), "{along} {side}: {found:?}");
        let sum: f32 = found.iter().map(|p| p.2).sum();
        assert!((sum - 1.0).abs() < 1e-5 && found.iter().all(|p| p.2 >= 0.0), "{found:?}");
    }
    assert_eq!(sides.parts(0, 0.0, Vec3::X)[0].0, 0);
    assert!(sides.parts(7, 0.0, Vec3::X).iter().all(|p| p.2 == 0.0));
    assert_eq!(sides.at(0, f32::NAN, Vec3::NAN).to_bits(), sides.at(0, f32::NAN, Vec3::NAN).to_bits());
}

#[test]
fn a_wall_hides_the_sides_that_face_it() {
    let own = (0..=20).map(|i| vec3(i as f32 * 0.1 - 1.0, 0.0, 0.0)).collect::<Vec<_>>();
    let wall = (-300..300).map(|i| vec![vec3(-3.0, i as f32 * 0.01, 0.51), vec3(3.0, i as f32 * 0.01, 0.51)]);
    let lines = LineSet::new(std::iter::once(own).chain(wall)).unwrap();
    let cells = Cells::new(&lines, 0.01);
    let samples = SampleSets::spirals(400, 1, 1).unwrap();
    let sides = Sides::new(&lines, &cells, &samples, AoOptions::places(1.0, 0.01)).unwrap();
    // sin(60 degrees)^2 of the rays, as for rays of pixels.
    for along in [0.63, 1.0, 1.27] {
        assert!((sides.at(0, along, Vec3::Z) - 0.75).abs() < 0.012, "{}", sides.at(0, along, Vec3::Z));
        assert_eq!(sides.at(0, along, Vec3::NEG_Z), 0.0);
    }
    // Beside the wall, a part of the hemisphere: less and less.
    let turned = |angle: f32| sides.at(0, 1.0, vec3(0.0, angle.sin(), angle.cos()));
    let fall: Vec<f32> = (0..=8).map(|i| turned(i as f32 * FRAC_PI_2 / 6.0)).collect();
    assert!(fall.is_sorted_by(|a, b| a >= b) && fall[3] < 0.6 && fall[3] > 0.3 && fall[8] < 0.06, "{fall:?}");
}

#[test]
fn few_rays_of_places_are_near_many_of_pixels_and_a_turn_changes_little() {
    let set = Recipe { lines: 150, ..Recipe::new(Family::Spiral, 3) }.make().unwrap();
    let view = View::around(set.bounds(), vec3(0.5, 0.6, 1.0), Some(0.7), [160, 120]).unwrap();
    let [near, far] = view.depths();
    let (radius, tube) = (0.26, view.pixel_size((near + far) / 2.0) as f32 / 2.0);
    let cells = Cells::new(&set, tube * MARGIN_IN_TUBES);
    let buffer = LineBuffer::new(&set, &view);
    let some: Vec<Fragment> = buffer.fragments().iter().flatten().step_by(7).copied().collect();
    assert!(some.len() > 300);
    let many = SampleSets::spirals(1000, 4, 1).unwrap();
    let by_rays = Occlusion::by_rays(&cells, &view, &many, AoOptions::rays(radius, tube)).unwrap();
    let truth: Vec<f32> = some.iter().map(|f| by_rays.at(f, by_rays.set_of(f, [0; 2]))).collect();
    let few = SampleSets::spirals(USUAL_SIDE_RAYS, 16, 1).unwrap();
    let error = |step: f32| {
        let estimator = Estimator::Places { line_radius: tube, step };
        let options = AoOptions { estimator, ..AoOptions::places(radius, tube) };
        let sides = Sides::new(&set, &cells, &few, options).unwrap();
        let here = Occlusion::by_places(&sides, &view);
        let values: Vec<f32> = some.iter().map(|f| here.at(f, 0)).collect();
        let computed = sides.computed();
        // The same place of a line in a view that is turned by 0.2 degrees.
        let turn = DMat4::from_rotation_y(0.2f64.to_radians()) * DMat4::from(view.eye_from_world());
        let turned = View::new(turn, view.lens(), view.depths(), view.size()).unwrap();
        let there = Occlusion::by_places(&sides, &turned);
        let moved = |f: &Fragment| {
            let position = turned.to_eye(view.to_world(f.position).as_vec3()).as_vec3();
            let tangent = view.eye_from_world().matrix3.transpose() * f.tangent.as_dvec3();
            Fragment { position, tangent: (turned.eye_from_world().matrix3 * tangent).as_vec3(), ..*f }
        };
        let after: Vec<f32> = some.iter().map(|f| there.at(&moved(f), 0)).collect();
        let new = sides.computed() - computed;
        assert!(computed > 500 && new * 20 < computed, "{new} new values of {computed}");
        (rmse(&values, &truth), rmse(&values, &after))
    };
    let (usual, change) = error(radius * PLACE_STEP);
    assert!(usual < 0.065 && change < 0.003, "{usual} {change}");
    assert!(error(radius).0 > 1.15 * usual, "places far apart are as near: {usual}");
}

#[test]
fn wrong_estimators_and_thick_tubes_are_refused() {
    let lines = LineSet::new([[Vec3::ZERO, Vec3::X]]).unwrap();
    let (cells, samples) = (Cells::new(&lines, 0.01), SampleSets::spirals(4, 2, 1).unwrap());
    let error = |options| Sides::new(&lines, &cells, &samples, options).map(|_| ()).unwrap_err();
    assert_eq!(error(AoOptions::rays(0.3, 0.01)), OptionsError::Source);
    assert!(matches!(error(AoOptions::places(0.3, 0.011)), OptionsError::Margin { .. }));
    assert!(matches!(error(AoOptions::places(f32::NAN, 0.01)), OptionsError::Radius(_)));
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [8; 2]).unwrap();
    let rays = Occlusion::by_rays(&cells, &view, &samples, AoOptions::places(0.3, 0.01)).map(|_| ());
    assert_eq!(rays.unwrap_err(), OptionsError::Source);
}
