use glam::{DVec3, Quat, Vec2, Vec3, vec3};
use proptest::prelude::*;

use super::columns::Prism;
use super::*;
use crate::sets::LineSet;
use crate::sets::generate::{Family, Recipe};
use crate::slabs::SLICES;
use crate::testing::{cases, places};
use crate::view::Lens;

fn receiver(position: Vec3, tangent: Vec3) -> Fragment {
    Fragment { position, tangent: tangent.normalize_or_zero(), line: 0, along: 0.0 }
}

fn view(fov_y: Option<f64>, size: u32) -> View {
    View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, fov_y, [size; 2]).unwrap()
}

/// A grid with a dot in the middle of each slice of each column that is asked for.
fn filled(view: &View, wanted: impl Fn(u32) -> bool) -> SlabGrid {
    let (size, [near, far]) = (view.size()[0], view.depths());
    let half = f64::from(size) / 2.0;
    let dot = |i: u32| {
        let depth = near + (far - near) * (f64::from(i % SLICES) + 0.5) / f64::from(SLICES);
        let across = |p: u32| (f64::from(p) + 0.5 - half) * view.pixel_size(depth);
        let eye = DVec3::new(across(i / SLICES % size), -across(i / SLICES / size), -depth);
        [view.to_world(eye.as_vec3()).as_vec3()]
    };
    let all = (0..size * size * SLICES).filter(|i| wanted(i % SLICES));
    SlabGrid::of_lines(&LineSet::new(all.map(dot)).unwrap(), view)
}

/// Length of the part of a column in a hemisphere, by points along it.
fn sampled_length(pole: DVec3, start: DVec3, step: DVec3) -> f64 {
    let (steps, reach) = (4000, 2.5 / step.length());
    let width = 2.0 * reach / f64::from(steps);
    let inside = |i: &i32| {
        let from = start + step * (-reach + (f64::from(*i) + 0.5) * width);
        from.length() < 1.0 && pole.dot(from) > 0.0
    };
    (0..steps).filter(inside).count() as f64 * width
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn columns_are_clipped_as_points_along_them_say(
        at in (-0.6f32..0.6, -0.6f32..0.6, 2.0f32..6.0), tangent in places(1.0),
        sample in (-0.7f32..0.7, -0.7f32..0.7), along_view: bool, perspective: bool
    ) {
        let fov_y = if perspective { Some(1.0) } else { None };
        let position = vec3(at.0, at.1, -at.2);
        // A tangent along the view gives a base that is parallel to the picture; one across it may
        // give w_z near 0.
        let tangent = if along_view { vec3(tangent.x * 1e-3, 0.0, 1.0) } else { tangent };
        let mut above = Hemisphere::new(&receiver(position, tangent), 0.5, &view(fov_y, 8)).unwrap();
        let sample = Vec2::new(sample.0, sample.1);
        let prism = Prism::new(&above, sample);
        // Without a pole there is no base plane: the whole column in the ball.
        let pole = std::mem::take(&mut above.pole);
        let whole = Prism::new(&above, sample).unwrap();
        let [pole, start, step] = [pole, whole.start, whole.step].map(Vec3::as_dvec3);
        let truth = sampled_length(pole, start, step);
        let length = prism.map_or(0.0, |p| f64::from(p.to - p.from));
        prop_assert!((length - truth).abs() < 4e-3, "{} {} {:?}", length, truth, prism);
    }
}

#[test]
fn an_empty_grid_is_open_a_full_one_closed_and_slices_behind_the_base_do_not_count() {
    let samples = SampleSets::discs(300, 1, 1).unwrap();
    for fov_y in [None, Some(0.6)] {
        let view = view(fov_y, 24);
        let middle = view.to_eye(Vec3::ZERO).as_vec3();
        let [empty, full, behind] = [(0, 0), (0, SLICES), (65, SLICES)]
            .map(|(from, to)| filled(&view, |slice| (from..to).contains(&slice)));
        let at = |grid: &SlabGrid, tangent: Vec3| {
            let occlusion = Occlusion::by_columns(grid, &samples, AoOptions::thesis(0.5)).unwrap();
            occlusion.at(&receiver(middle, tangent), 0)
        };
        for tangent in [Vec3::X, Vec3::Y, vec3(1.0, 1.0, 0.3), Vec3::Z] {
            assert_eq!([at(&empty, tangent), at(&full, tangent)], [0.0, 1.0], "{tangent}");
        }
        // The base of a line across the view is parallel to the picture (nearly, in perspective).
        assert!(fov_y.is_some() || at(&behind, Vec3::X) == 0.0);
        assert!(at(&behind, vec3(0.0, 1.0, 1.0)) > 0.1);
    }
}

/// The method of the thesis and rays on a set in a view: of each pixel with a line.
fn run(lines: &LineSet, view: &View, [radius, tube]: [f32; 2]) -> [Vec<Option<f32>>; 2] {
    let buffer = LineBuffer::new(lines, view);
    let options = AoOptions::rays(radius, tube);
    let (grid, cells) = (SlabGrid::of_lines(lines, view), Cells::new(lines, options.margin()));
    let [discs, spirals] = [SampleSets::discs, SampleSets::spirals].map(|make| make(60, 8, 1).unwrap());
    let thesis = Occlusion::by_columns(&grid, &discs, AoOptions::thesis(radius)).unwrap();
    let rays = Occlusion::by_rays(&cells, view, &spirals, options).unwrap();
    [thesis, rays]
        .map(|by| buffer.fragments().iter().zip(by.of(&buffer)).map(|(f, v)| f.map(|_| v)).collect())
}

fn same(a: &[Option<f32>], b: &[Option<f32>]) -> usize {
    let is_same = |(a, b): &(&Option<f32>, &Option<f32>)| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() < 1e-3,
        (a, b) => a == b,
    };
    a.iter().zip(b).filter(is_same).count()
}

#[test]
fn a_turned_scene_with_its_camera_gives_the_same_and_a_moved_picture_does_by_rays() {
    let lines = Recipe { lines: 150, vertices: 60, ..Recipe::new(Family::Dipole, 1) }.make().unwrap();
    let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(1.1);
    let turned = lines.moved(|p| turn * p).unwrap();
    for lens in [Lens::Orthographic { half_height: 1.2 }, Lens::Perspective { fov_y: 0.6 }] {
        let look = |turn: Quat| {
            let [eye, up] = [vec3(0.0, 0.0, 4.0), Vec3::Y].map(|v| turn * v);
            View::look_at([eye, Vec3::ZERO, up], lens, [2.0, 6.0], [64; 2]).unwrap()
        };
        let still = run(&lines, &look(Quat::IDENTITY), [0.25, 0.01]);
        let turned = run(&turned, &look(turn), [0.25, 0.01]);
        for (still, turned) in still.iter().zip(&turned) {
            // Rounding in single precision moves a few lines over the border of a pixel or slice.
            assert!(same(still, turned) > 64 * 64 * 98 / 100, "{lens:?}: {}", same(still, turned));
        }
    }
    let view = View::around(lines.bounds(), Vec3::Z, None, [64; 2]).unwrap();
    let [still, moved] = [view, view.moved_by_pixels(3.0, 2.0)].map(|v| run(&lines, &v, [0.25, 0.01]));
    let differ = |which: usize| {
        let (a, b) = (&still[which], &moved[which]);
        // Away from the border: there columns are unknown that were known before.
        let pixels = (20..44).flat_map(|y| (20..44).map(move |x| (x, y)));
        let pairs = pixels.filter_map(|(x, y)| Some((a[y * 64 + x]?, b[(y - 2) * 64 + x - 3]?)));
        let differences: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
        assert!(differences.len() > 200);
        differences.iter().filter(|d| **d > 1e-3).count() as f32 / differences.len() as f32
    };
    assert!(differ(1) < 0.02, "{}", differ(1));
    assert!(differ(0) > 0.5, "samples fixed to the screen flicker: {}", differ(0));
}

#[test]
fn estimates_do_not_depend_on_the_unit_of_length() {
    let lines = Recipe { lines: 120, ..Recipe::new(Family::Spiral, 3) }.make().unwrap();
    for fov_y in [None, Some(0.6)] {
        // Powers of two change no digit of a number.
        let run = |unit: f32| {
            let lines = lines.moved(|p| p * unit).unwrap();
            let view = View::around(lines.bounds(), vec3(0.5, 0.6, 1.0), fov_y, [48; 2]).unwrap();
            run(&lines, &view, [0.26 * unit, 0.01 * unit])
        };
        let usual = run(1.0);
        assert!(usual.iter().all(|u| u.iter().flatten().sum::<f32>() > 0.1 * 48.0));
        for power in [-90, -40, 40, 90] {
            for (usual, other) in usual.iter().zip(run(2f32.powi(power))) {
                assert!(same(usual, &other) > 48 * 48 * 99 / 100, "2^{power}, {fov_y:?}");
            }
        }
    }
}

#[test]
fn options_and_receivers_out_of_range_give_errors_or_numbers() {
    let lines = LineSet::new([[Vec3::ZERO, Vec3::X], [Vec3::Y, Vec3::Z]]).unwrap();
    let (view, samples) = (view(Some(0.6), 8), SampleSets::spirals(9, 2, 1).unwrap());
    let (grid, cells) = (filled(&view, |_| true), Cells::new(&lines, 0.1));
    let columns = |options| Occlusion::by_columns(&grid, &samples, options);
    let rays = |options| Occlusion::by_rays(&cells, &view, &samples, options);
    let sides = |options| Sides::new(&lines, &cells, &samples, options).map(|_| ());
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(columns(AoOptions::thesis(bad)).err(), Some(OptionsError::Radius(_))), "{bad}");
        assert!(matches!(rays(AoOptions::rays(bad, 0.1)).err(), Some(OptionsError::Radius(_))), "{bad}");
        assert!(matches!(sides(AoOptions::places(bad, 0.1)), Err(OptionsError::Radius(_))), "{bad}");
        let value = rays(AoOptions::rays(1.0, bad)).err();
        assert!(bad == 0.0 || matches!(value, Some(OptionsError::Estimator(_))), "{bad}: {value:?}");
    }
    assert!(matches!(rays(AoOptions::rays(0.3, 0.101)).err(), Some(OptionsError::Margin { .. })));
    assert!(matches!(sides(AoOptions::places(0.3, 0.101)), Err(OptionsError::Margin { .. })));
    assert_eq!(columns(AoOptions::rays(0.3, 0.1)).err(), Some(OptionsError::Source));
    assert_eq!(rays(AoOptions::places(0.3, 0.1)).err(), Some(OptionsError::Source));
    assert_eq!(sides(AoOptions::rays(0.3, 0.1)), Err(OptionsError::Source));
    let odd = [f32::NAN, f32::INFINITY, 0.0, 1e30, -1e30, 1e-30, -1e-3];
    let rays = [(0.3, 0.0), (0.3, 0.1), (1e10, 0.1), (1e-44, 0.1), (3e38, 0.0)]
        .map(|(a, b)| rays(AoOptions::rays(a, b)));
    for occlusion in
        rays.into_iter().chain([0.4, 1e10, 1e-44].map(|radius| columns(AoOptions::thesis(radius))))
    {
        let occlusion = occlusion.unwrap();
        for (x, z, t) in odd.iter().flat_map(|&x| odd.iter().map(move |&z| (x, z, x * z))) {
            for tangent in [Vec3::ZERO, Vec3::Z, vec3(t, 1.0, z)] {
                let fragment = Fragment { position: vec3(x, 0.0, z), tangent, line: u32::MAX, along: x };
                let value = occlusion.at(&fragment, occlusion.set_of(&fragment, [1, 2]));
                assert!((0.0..=1.0).contains(&value), "{fragment:?}: {value}");
            }
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let lines = Recipe { lines: 100, ..Recipe::new(Family::PomPom, 2) }.make().unwrap();
    let view = View::around(lines.bounds(), Vec3::Z, Some(0.7), [50, 70]).unwrap();
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let [one, five] = [1, 5].map(|n| pool(n).install(|| run(&lines, &view, [0.3, 0.01])));
    assert!(one == five);
}
