use std::f32::consts::FRAC_PI_2;

use glam::vec3;

use super::*;
use crate::numeric::PLACE_STEP;

#[test]
fn pixels_take_the_places_beside_them_and_the_sides_beside_their_pole() {
    let lines = LineSet::new([vec![Vec3::ONE], vec![Vec3::ZERO, Vec3::X]]).unwrap();
    let (cells, samples) = (Cells::new(&lines, 0.1), SampleSets::spirals(4, 2).unwrap());
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
    let samples = SampleSets::spirals(400, 1).unwrap();
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
