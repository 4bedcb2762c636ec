use glam::{DVec3, Quat, Vec3, vec3};
use proptest::prelude::*;

use super::prism::Prism;
use super::*;
use crate::sets::LineSet;
use crate::sets::generate::{Family, Recipe};
use crate::sets::random::Random;
use crate::slabs::{Slices, SpanRule};
use crate::testing::{cases, places};
use crate::view::{Lens, View};

fn estimator(estimator: Estimator) -> AoOptions {
    let choice = SetChoice::One;
    AoOptions { estimator, by_distance: false, by_angle: false, choice, ..AoOptions::new(0.5, 0.01) }
}

const PLAIN: [Estimator; 2] =
    [Estimator::MeanOfRatios { factor: 1.0 }, Estimator::RatioOfSums { factor: 1.0 }];

fn receiver(position: Vec3, tangent: Vec3) -> Fragment {
    Fragment { position, tangent: tangent.normalize_or_zero(), line: 0, along: 0.0 }
}

fn view(fov_y: Option<f64>, size: u32) -> View {
    View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, fov_y, [size; 2]).unwrap()
}

/// A grid whose set slices are those of the points, each a line of no length.
fn grid_of(view: &View, points: impl Iterator<Item = Vec3>) -> SlabGrid {
    SlabGrid::of_lines(&LineSet::new(points.map(|p| [p])).unwrap(), view, Slices::S128, SpanRule::Span)
}

/// A point in the middle of each slice of each column.
fn all_cells(view: &View) -> impl Iterator<Item = (u32, Vec3)> {
    let size = view.size()[0];
    let empty = grid_of(view, std::iter::empty());
    let (view, half) = (*view, f64::from(size) / 2.0);
    (0..size * size * 128).map(move |i| {
        let depth = empty.slice_depth(i % 128);
        let side = view.pixel_size(depth);
        let across = |p: u32| (f64::from(p) + 0.5 - half) * side;
        let eye = DVec3::new(across(i / 128 % size), -across(i / 128 / size), -depth);
        (i % 128, view.to_world(eye.as_vec3()).as_vec3())
    })
}

/// Length of the part of a column in a hemisphere, by points along it; lengths in any unit.
fn sampled_length(pole: DVec3, radius: f64, start: DVec3, step: DVec3) -> f64 {
    let (steps, reach) = (4000, 2.5 * radius / step.length());
    let width = 2.0 * reach / f64::from(steps);
    let inside = |i: &i32| {
        let from = start + step * (-reach + (f64::from(*i) + 0.5) * width);
        from.length() < radius && pole.dot(from) > 0.0
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
        let sample = glam::Vec2::new(sample.0, sample.1);
        let prism = above.prism(sample, BasePlane::Tangent, 0.0);
        // Without a pole there is no base plane: the whole column in the ball.
        let pole = std::mem::take(&mut above.pole);
        let whole = above.prism(sample, BasePlane::Tangent, 0.0).unwrap();
        let [pole, start, step] = [pole, whole.start, whole.step].map(Vec3::as_dvec3);
        let truth = sampled_length(pole, 1.0, start, step);
        let length = prism.map_or(0.0, |p| f64::from(p.to - p.from));
        prop_assert!((length - truth).abs() < 4e-3, "{} {} {:?}", length, truth, prism);
    }
}

#[test]
fn prisms_add_up_to_the_hemisphere_and_the_literal_sign_does_not_give_it() {
    let sets = SampleSets::new(3000, 1, 5).unwrap();
    let mut random = Random::new(2);
    let mut missed = 0;
    for fov_y in [None, Some(0.9)] {
        for _ in 0..20 {
            let tangent = vec3(
                random.within(-1.0, 1.0) as f32,
                random.within(-1.0, 1.0) as f32,
                random.within(-1.0, 1.0) as f32,
            );
            let position = vec3(random.within(-0.5, 0.5) as f32, random.within(-0.5, 0.5) as f32, -3.0);
            let above = Hemisphere::new(&receiver(position, tangent), 0.4, &view(fov_y, 8)).unwrap();
            let sum = |plane: BasePlane, of: &dyn Fn(&Prism) -> f32| -> f32 {
                let set = sets.set(0).iter();
                set.filter_map(|s| Some(s.area * of(&above.prism(s.at, plane, 0.0)?))).sum()
            };
            let volume = sum(BasePlane::Tangent, &|p| p.to - p.from);
            // In radii, as all lengths of prisms.
            let truth = 2.0 / 3.0 * std::f32::consts::PI;
            // Columns of a perspective view spread: their volume is not exactly length times area.
            assert!(
                (volume / truth - 1.0).abs() < if fov_y.is_some() { 0.12 } else { 0.06 },
                "{volume} {truth}"
            );
            let weight = sum(BasePlane::Tangent, &|p| p.weight(above.pole));
            assert!((weight - 1.0).abs() < 0.15, "{weight}");
            // Mirrored limits hold points under the base plane.
            let below = |p: &Prism| {
                let inside = (0..50).filter(|i| {
                    above.pole.dot(p.at(p.from + (p.to - p.from) * (*i as f32 + 0.5) / 50.0)) > 0.0
                });
                (p.to - p.from) * inside.count() as f32 / 50.0
            };
            assert!(sum(BasePlane::Tangent, &below) > 0.97 * volume);
            missed += usize::from(sum(BasePlane::ThesisSign, &below) < 0.9 * volume);
        }
    }
    assert!(missed >= 25, "the literal sign loses a tenth of the hemisphere in most places: {missed}");
}

#[test]
fn an_empty_grid_is_open_a_full_one_closed_and_a_random_one_between() {
    let samples = SampleSets::new(300, 1, 1).unwrap();
    for fov_y in [None, Some(0.6)] {
        let view = view(fov_y, 24);
        let middle = view.to_eye(Vec3::ZERO).as_vec3();
        let receivers = [Vec3::X, Vec3::Y, vec3(1.0, 1.0, 0.3), Vec3::Z].map(|t| receiver(middle, t));
        let at = |grid: &SlabGrid, e: Estimator, f: &Fragment| {
            Occlusion::new(grid, &samples, estimator(e)).unwrap().at(f, 0)
        };
        let empty = grid_of(&view, std::iter::empty());
        let full = grid_of(&view, all_cells(&view).map(|(_, p)| p));
        let behind = grid_of(&view, all_cells(&view).filter(|(slice, _)| *slice > 64).map(|(_, p)| p));
        let mut random = Random::new(6);
        let third = grid_of(&view, all_cells(&view).filter(|_| random.unit() < 0.3).map(|(_, p)| p));
        assert!((full.fill_fraction(0..24, 0..24, view.depths()) - 1.0).abs() < 1e-9);
        for f in &receivers {
            for e in PLAIN {
                assert_eq!((at(&empty, e, f), at(&full, e, f)), (0.0, 1.0), "{e:?}");
                let beside =
                    |i: i32| vec3((i % 3 - 1) as f32, (i / 3 % 3 - 1) as f32, (i / 9 - 1) as f32) * 0.5;
                let moved = |i| at(&third, e, &Fragment { position: f.position + beside(i), ..*f });
                let share = (0..27).map(moved).sum::<f32>() / 27.0;
                assert!((share - 0.3).abs() < 0.03, "{e:?}: {share}");
            }
            let other = [Estimator::Extinction { k: 3.0 }, Estimator::OpticalDepth { line_radius: 0.1 }];
            assert_eq!(other.map(|e| at(&empty, e, f)), [0.0; 2]);
        }
        // The base of a line across the view is parallel to the picture (nearly, in perspective):
        // no slice behind it counts.
        if fov_y.is_none() {
            assert_eq!(PLAIN.map(|e| at(&behind, e, &receivers[0])), [0.0; 2]);
            assert!(at(&behind, PLAIN[1], &receiver(middle, vec3(0.0, 1.0, 1.0))) > 0.1);
        }
    }
}

/// Random short lines in all directions, so dense that light gets some share of the way.
fn fog(lines: u32) -> LineSet {
    let mut random = Random::new(9);
    let mut point = || DVec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0)));
    LineSet::new((0..lines).map(|_| {
        let (middle, way) = (point(), point().normalize_or_zero() * 0.05);
        [(middle - way).as_vec3(), (middle + way).as_vec3()]
    }))
    .unwrap()
}

#[test]
fn in_a_fog_of_lines_the_optical_depth_is_known_and_depends_on_no_grid() {
    let lines = fog(20_000);
    // 20,000 lines of length 0.1 and radius 0.004 in a box of volume 8 hide pi / 4 * 2 * 0.004 *
    // 2000 / 8 of a ray for each unit.
    let truth = 1.0 - (-std::f32::consts::FRAC_PI_4 * 2.0 * 0.004 * 250.0 * 0.4f32).exp();
    let samples = SampleSets::new(2000, 8, 1).unwrap();
    let mean = |view: &View, slices, estimator: Estimator| {
        let grid = SlabGrid::of_lines(&lines, view, slices, SpanRule::Span);
        let options = AoOptions { radius: 0.4, estimator, ..AoOptions::new(0.4, 0.004) };
        let occlusion = Occlusion::new(&grid, &samples, options).unwrap();
        let at = |i: usize| {
            let place = vec3((i % 5) as f32, (i / 5 % 5) as f32, (i / 25) as f32) * 0.2 - 0.4;
            let tangent = vec3((i as f32).sin(), (i as f32 * 1.7).cos(), 0.4);
            occlusion.at(&receiver(view.to_eye(place).as_vec3(), tangent), i)
        };
        (0..125).map(at).sum::<f32>() / 125.0
    };
    let mut all = Vec::new();
    for fov_y in [None, Some(0.8)] {
        for (size, slices) in
            [(40, Slices::S128), (80, Slices::S128), (160, Slices::S256), (400, Slices::S128)]
        {
            all.push(mean(&view(fov_y, size), slices, Estimator::OpticalDepth { line_radius: 0.004 }));
        }
    }
    // Noise makes 1 - exp(-x) smaller on average.
    assert!(all.iter().all(|v| (0.93 * truth..1.02 * truth).contains(v)), "{all:?}, wanted {truth}");
    let most = all.iter().fold(0.0, |m: f32, &v| m.max(v));
    assert!(all.iter().all(|v| *v > 0.97 * most), "grids differ: {all:?}");
    let share = |size, slices| mean(&view(None, size), slices, Estimator::MeanOfRatios { factor: 1.0 });
    let (coarse, fine) = (share(80, Slices::S128), share(400, Slices::S128));
    assert!(coarse > 3.0 * fine, "the thesis' share fades with a finer grid: {coarse} {fine}");
}

#[test]
fn noise_falls_with_the_root_of_the_number_of_samples() {
    let lines = Recipe { lines: 200, ..Recipe::new(Family::Spiral, 1) }.make().unwrap();
    let view = View::around(lines.bounds(), vec3(0.4, 0.5, 1.0), None, [96; 2]).unwrap();
    let grid = SlabGrid::of_lines(&lines, &view, Slices::S128, SpanRule::Span);
    let buffer = LineBuffer::new(&lines, &view);
    let some: Vec<Fragment> = buffer.fragments().iter().flatten().step_by(29).copied().collect();
    for e in [Estimator::MeanOfRatios { factor: 0.5 }, Estimator::OpticalDepth { line_radius: 0.01 }] {
        let values = |n: u32| -> Vec<f32> {
            let samples = SampleSets::new(n, (4096 / n).min(32), 7).unwrap();
            let occlusion =
                Occlusion::new(&grid, &samples, AoOptions { estimator: e, ..AoOptions::new(0.26, 0.01) })
                    .unwrap();
            some.iter().enumerate().map(|(i, f)| occlusion.at(f, i)).collect()
        };
        let reference = values(3000);
        let error = |n: u32| {
            let squares: f32 = values(n).iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum();
            (squares / some.len() as f32).sqrt()
        };
        let power = (error(256) / error(16)).ln() / 16f32.ln();
        assert!((-0.75..-0.35).contains(&power), "{e:?}: N^{power}");
    }
}

#[test]
fn a_turned_scene_with_its_camera_and_a_moved_picture_give_the_same() {
    let lines = Recipe { lines: 150, vertices: 60, ..Recipe::new(Family::Dipole, 1) }.make().unwrap();
    let samples = SampleSets::new(60, 8, 1).unwrap();
    let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(1.1);
    let turned = LineSet::new(lines.iter().map(|l| l.iter().map(|&p| turn * p).collect::<Vec<_>>())).unwrap();
    let run = |lines: &LineSet, view: &View, choice: SetChoice| -> Vec<Option<f32>> {
        let grid = SlabGrid::of_lines(lines, view, Slices::S128, SpanRule::Span);
        let buffer = LineBuffer::new(lines, view);
        let options = AoOptions { choice, ..AoOptions::new(0.25, 0.01) };
        let values = Occlusion::new(&grid, &samples, options).unwrap().of(&buffer);
        buffer.fragments().iter().zip(values).map(|(f, v)| f.map(|_| v)).collect()
    };
    for lens in [Lens::Orthographic { half_height: 1.2 }, Lens::Perspective { fov_y: 0.6 }] {
        let look = |turn: Quat| {
            let [eye, up] = [vec3(0.0, 0.0, 4.0), Vec3::Y].map(|v| turn * v);
            View::look_at([eye, Vec3::ZERO, up], lens, [2.0, 6.0], [64; 2]).unwrap()
        };
        let surface = SetChoice::Surface { step: 0.03 };
        let (still, turned) =
            (run(&lines, &look(Quat::IDENTITY), surface), run(&turned, &look(turn), surface));
        let same = still.iter().zip(&turned).filter(|(a, b)| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < 1e-3,
            (a, b) => a == b,
        });
        // Rounding in single precision moves a few lines over the border of a pixel or slice.
        assert!(same.count() > 64 * 64 * 98 / 100, "{lens:?}");
    }
    let view = View::around(lines.bounds(), Vec3::Z, None, [64; 2]).unwrap();
    let moved = view.moved_by_pixels(3.0, 2.0);
    let differ = |choice: SetChoice| {
        let (a, b) = (run(&lines, &view, choice), run(&lines, &moved, choice));
        // Away from the border: there columns are unknown that were known before.
        let pixels = (20..44).flat_map(|y| (20..44).map(move |x| (x, y)));
        let pairs = pixels.filter_map(|(x, y)| Some((a[y * 64 + x]?, b[(y - 2) * 64 + x - 3]?)));
        let differences: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
        assert!(differences.len() > 200);
        differences.iter().filter(|d| **d > 1e-3).count() as f32 / differences.len() as f32
    };
    assert!(differ(SetChoice::Surface { step: 0.03 }) < 0.02);
    assert!(differ(SetChoice::One) < 0.02);
    assert!(differ(SetChoice::Screen) > 0.5, "samples fixed to the screen flicker");
}

#[test]
fn estimates_do_not_depend_on_the_unit_of_length() {
    let samples = SampleSets::new(60, 4, 1).unwrap();
    let lines = Recipe { lines: 120, ..Recipe::new(Family::Spiral, 3) }.make().unwrap();
    for fov_y in [None, Some(0.6)] {
        // Powers of two change no digit of a number.
        let run = |unit: f32, thesis: bool| {
            let lines = LineSet::new(lines.iter().map(|l| l.iter().map(|&p| p * unit))).unwrap();
            let view = View::around(lines.bounds(), vec3(0.5, 0.6, 1.0), fov_y, [48; 2]).unwrap();
            let grid = SlabGrid::of_lines(&lines, &view, Slices::S128, SpanRule::Span);
            let options = AoOptions::new(0.26 * unit, 0.01 * unit);
            let options = if thesis { AoOptions::thesis(0.26 * unit) } else { options };
            Occlusion::new(&grid, &samples, options).unwrap().of(&LineBuffer::new(&lines, &view))
        };
        for thesis in [false, true] {
            let usual = run(1.0, thesis);
            assert!(usual.iter().sum::<f32>() > 0.1 * 48.0);
            for power in [-90, -40, 40, 90] {
                let other = run(2f32.powi(power), thesis);
                let same = usual.iter().zip(&other).filter(|(a, b)| (*a - *b).abs() < 1e-4).count();
                assert!(same > 48 * 48 * 99 / 100, "2^{power}, {fov_y:?}, {thesis}: {same} pixels");
            }
        }
    }
}

#[test]
fn options_and_receivers_out_of_range_give_errors_or_zero() {
    let (view, samples) = (view(Some(0.6), 8), SampleSets::new(9, 2, 1).unwrap());
    let grid = grid_of(&view, all_cells(&view).map(|(_, p)| p));
    let new = |options| Occlusion::new(&grid, &samples, options).map(|_| ());
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(new(AoOptions::new(radius, 0.1)), Err(OptionsError::Radius(_))), "{radius}");
    }
    for bad in [f32::NAN, -1.0, f32::INFINITY] {
        assert!(matches!(new(AoOptions::new(1.0, bad)), Err(OptionsError::Estimator(_))));
        let extinction = AoOptions { estimator: Estimator::Extinction { k: bad }, ..AoOptions::thesis(1.0) };
        assert!(matches!(new(extinction), Err(OptionsError::Estimator(_))));
    }
    let choice = SetChoice::Surface { step: 0.0 };
    assert_eq!(new(AoOptions { choice, ..AoOptions::thesis(1.0) }), Err(OptionsError::Step(0.0)));
    let odd = [f32::NAN, f32::INFINITY, 0.0, 1e30, -1e30, 1e-30, -1e-3];
    for options in [
        AoOptions::thesis(0.4),
        AoOptions::new(0.4, 0.1),
        AoOptions::new(1e10, 1e30),
        AoOptions::new(1e-44, 1e30),
    ] {
        let occlusion = Occlusion::new(&grid, &samples, options).unwrap();
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
    let samples = SampleSets::new(30, 4, 1).unwrap();
    let run = || {
        let grid = SlabGrid::of_lines(&lines, &view, Slices::S256, SpanRule::Span);
        let buffer = LineBuffer::new(&lines, &view);
        let values = Occlusion::new(&grid, &samples, AoOptions::new(0.3, 0.01)).unwrap().of(&buffer);
        (grid, buffer, values)
    };
    let with = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(run);
    assert!(with(1) == with(5));
}
