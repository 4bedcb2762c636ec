use glam::{Quat, Vec3, vec3};

use super::*;
use crate::buffers::nearest_lines;
use crate::sets::LineSet;
use crate::sets::generate::{Family, Recipe};
use crate::testing::moved;
use crate::view::Lens;

/// The occlusion by rays of each pixel with a line.
fn run(lines: &LineSet, view: &View, [radius, tube]: [f32; 2]) -> Vec<Option<f32>> {
    let options = AoOptions::rays(radius, tube);
    let (cells, samples) = (Cells::new(lines, options.margin()), SampleSets::spirals(60, 8).unwrap());
    let rays = Occlusion::by_rays(&cells, view, &samples, options).unwrap();
    nearest_lines(lines, view).iter().map(|f| f.as_ref().map(|f| rays.at(f))).collect()
}

fn same(a: &[Option<f32>], b: &[Option<f32>]) -> usize {
    let is_same = |(a, b): &(&Option<f32>, &Option<f32>)| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() < 1e-3,
        (a, b) => a == b,
    };
    a.iter().zip(b).filter(is_same).count()
}

#[test]
fn a_turned_scene_with_its_camera_and_a_moved_picture_give_the_same() {
    let lines = Recipe { lines: 150, vertices: 60, ..Recipe::new(Family::Dipole, 1) }.make().unwrap();
    let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(1.1);
    let turned = moved(&lines, |p| turn * p);
    for lens in [Lens::Orthographic { half_height: 1.2 }, Lens::Perspective { fov_y: 0.6 }] {
        let look = |turn: Quat| {
            let [eye, up] = [vec3(0.0, 0.0, 4.0), Vec3::Y].map(|v| turn * v);
            View::look_at([eye, Vec3::ZERO, up], lens, [2.0, 6.0], [64; 2]).unwrap()
        };
        let still = run(&lines, &look(Quat::IDENTITY), [0.25, 0.01]);
        let turned = run(&turned, &look(turn), [0.25, 0.01]);
        // Rounding in single precision moves a few lines over the border of a pixel.
        assert!(same(&still, &turned) > 64 * 64 * 98 / 100, "{lens:?}: {}", same(&still, &turned));
    }
    let view = View::around(lines.bounds(), Vec3::Z, None, [64; 2]).unwrap();
    let [still, moved] = [view, view.moved_by_pixels(3.0, 2.0)].map(|v| run(&lines, &v, [0.25, 0.01]));
    let pixels = (20..44).flat_map(|y| (20..44).map(move |x| (x, y)));
    let pairs = pixels.filter_map(|(x, y)| Some((still[y * 64 + x]?, moved[(y - 2) * 64 + x - 3]?)));
    let differences: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
    let differing = differences.iter().filter(|d| **d > 1e-3).count();
    assert!(differences.len() > 200 && differing * 50 < differences.len(), "{differing}");
}

#[test]
fn estimates_do_not_depend_on_the_unit_of_length() {
    let lines = Recipe { lines: 120, ..Recipe::new(Family::Spiral, 3) }.make().unwrap();
    for fov_y in [None, Some(0.6)] {
        // Powers of two change no digit of a number.
        let run = |unit: f32| {
            let lines = moved(&lines, |p| p * unit);
            let view = View::around(lines.bounds(), vec3(0.5, 0.6, 1.0), fov_y, [48; 2]).unwrap();
            run(&lines, &view, [0.26 * unit, 0.01 * unit])
        };
        let usual = run(1.0);
        assert!(usual.iter().flatten().sum::<f32>() > 0.1 * 48.0);
        for power in [-90, -40, 40, 90] {
            let other = run(2f32.powi(power));
            assert!(same(&usual, &other) > 48 * 48 * 99 / 100, "2^{power}, {fov_y:?}");
        }
    }
}

#[test]
fn options_and_receivers_out_of_range_give_errors_or_numbers() {
    let lines = LineSet::new([[Vec3::ZERO, Vec3::X], [Vec3::Y, Vec3::Z]]).unwrap();
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, Some(0.6), [8; 2]).unwrap();
    let (samples, cells) = (SampleSets::spirals(9, 2).unwrap(), Cells::new(&lines, 0.1));
    let rays = |options| Occlusion::by_rays(&cells, &view, &samples, options);
    let sides = |options| Sides::new(&lines, &cells, &samples, options).map(|_| ());
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(rays(AoOptions::rays(bad, 0.1)).err(), Some(OptionsError::Radius(_))), "{bad}");
        assert!(matches!(sides(AoOptions::places(bad, 0.1)), Err(OptionsError::Radius(_))), "{bad}");
        let value = rays(AoOptions::rays(1.0, bad)).err();
        assert!(bad == 0.0 || matches!(value, Some(OptionsError::LineRadius(_))), "{bad}: {value:?}");
    }
    assert!(matches!(rays(AoOptions::rays(0.3, 0.101)).err(), Some(OptionsError::Margin { .. })));
    assert!(matches!(sides(AoOptions::places(0.3, 0.101)), Err(OptionsError::Margin { .. })));
    assert_eq!(rays(AoOptions::places(0.3, 0.1)).err(), Some(OptionsError::Source));
    assert_eq!(sides(AoOptions::rays(0.3, 0.1)), Err(OptionsError::Source));
    let odd = [f32::NAN, f32::INFINITY, 0.0, 1e30, -1e30, 1e-30, -1e-3];
    for (radius, tube) in [(0.3, 0.0), (0.3, 0.1), (1e10, 0.1), (1e-44, 0.1), (3e38, 0.0)] {
        let occlusion = rays(AoOptions::rays(radius, tube)).unwrap();
        for (x, z, t) in odd.iter().flat_map(|&x| odd.iter().map(move |&z| (x, z, x * z))) {
            for tangent in [Vec3::ZERO, Vec3::Z, vec3(t, 1.0, z)] {
                let fragment = Fragment { position: vec3(x, 0.0, z), tangent, line: u32::MAX, along: x };
                let value = occlusion.at(&fragment);
                assert!((0.0..=1.0).contains(&value), "{fragment:?}: {value}");
            }
        }
    }
}

#[test]
fn cells_do_not_depend_on_the_number_of_threads() {
    let lines = Recipe { lines: 100, ..Recipe::new(Family::PomPom, 2) }.make().unwrap();
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let [one, five] = [1, 5].map(|n| pool(n).install(|| Cells::new(&lines, 0.03)));
    assert!(one == five);
}
