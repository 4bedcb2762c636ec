use glam::{DVec3, Vec3, vec3};

use super::*;
use crate::buffers::Fragment;
use crate::occlusion::{AoOptions, Occlusion};
use crate::samples::SampleSets;
use crate::sets::LineSet;
use crate::sets::random::Random;
use crate::testing::{coordinate, rmse};

fn short_lines(count: u32, long: f64, seed: u64) -> LineSet {
    let mut random = Random::new(seed);
    let mut point = || DVec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0)));
    LineSet::new((0..count).map(|_| {
        let (middle, way) = (point(), point().normalize_or_zero() * long / 2.0);
        [(middle - way).as_vec3(), (middle + way).as_vec3()]
    }))
    .unwrap()
}

/// One of 125 receivers of all directions; those of greater numbers have other sets of rays.
fn receiver(view: &View, i: usize) -> Fragment {
    let place = vec3((i % 5) as f32, (i / 5 % 5) as f32, (i / 25 % 5) as f32) * 0.2 - 0.4;
    let turn = (i % 125) as f32;
    let tangent = vec3(turn.sin(), (turn * 1.7).cos(), 0.4).normalize();
    Fragment { position: view.to_eye(place).as_vec3(), tangent, line: i as u32, along: 0.0 }
}

/// The distance of a point from a segment.
fn distance([a, b]: [DVec3; 2], p: DVec3) -> f64 {
    let axis = b - a;
    let share = (p - a).dot(axis) / axis.length_squared().max(f64::MIN_POSITIVE);
    p.distance(a + axis * share.clamp(0.0, 1.0))
}

/// Lines that bend sharply at each vertex.
fn bent_lines(count: u32, seed: u64) -> LineSet {
    let mut random = Random::new(seed);
    let mut point = |s: f64| DVec3::from_array(std::array::from_fn(|_| coordinate(&mut random, s)));
    LineSet::new((0..count).map(|_| {
        let mut at = point(1.0);
        let next = |_| {
            at += point(0.25);
            at.as_vec3()
        };
        (0..6).map(next).collect::<Vec<_>>()
    }))
    .unwrap()
}

/// Steps along a ray end here, far below the 2% of a radius by which tubes are made thinner and
/// thicker.
const SHORTEST_STEP: f64 = 1e-4;

#[test]
fn thin_rays_stop_at_the_tubes_and_balls_that_small_steps_meet() {
    for (lines, radius) in [(short_lines(125, 1.0, 3), 0.02), (bent_lines(60, 4), 0.05)] {
        // No margin beyond the tubes: rays have no width.
        let cells = Cells::new(&lines, radius);
        let ends: Vec<[DVec3; 2]> = cells.ends().iter().map(|e| e.map(|p| p.as_dvec3())).collect();
        let mut random = Random::new(8);
        let mut point = || DVec3::from_array(std::array::from_fn(|_| coordinate(&mut random, 1.2)));
        let mut counts = [0; 3];
        for _ in 0..1500 {
            let (start, way) = (point(), point().normalize_or(DVec3::X));
            let outside = |e: &&[DVec3; 2]| distance(**e, start) > f64::from(radius);
            let others: Vec<[DVec3; 2]> = ends.iter().filter(outside).copied().collect();
            let nearest =
                |t: f64| others.iter().map(|&e| distance(e, start + way * t)).fold(f64::MAX, f64::min);
            // Steps as long as the way that is surely free; a tube as thin and one as thick tell
            // what rounding may decide.
            let meets = |radius: f64, long: f64| {
                let mut t = 0.0;
                while t < long {
                    let free = nearest(t) - radius;
                    if free < SHORTEST_STEP {
                        return true;
                    }
                    t += free;
                }
                false
            };
            let open = thin(&cells, start.as_vec3(), radius).passed(way.as_vec3());
            assert!(open == 0.0 || open == 1.0, "{open}");
            match (
                meets(f64::from(radius) * 0.98, 1.0 - 3.0 * f64::from(radius)),
                meets(f64::from(radius) * 1.02, 1.0),
            ) {
                (true, true) => counts[usize::from(open == 0.0)] += 1,
                (false, false) => counts[2] += usize::from(open == 0.0),
                _ => {}
            }
        }
        // Rays that end in a tube, before they come nearest to its line, may pass.
        let [missed, met, wrong] = counts;
        assert!(met > 250 && missed * 60 < met && wrong == 0, "{counts:?}");
    }
}

#[test]
fn splitting_straight_lines_changes_nothing_and_a_bend_is_round_whatever_the_width() {
    let whole = short_lines(3000, 0.3, 9);
    let split = LineSet::new(whole.iter().map(|l| (0..=9).map(|i| l[0].lerp(l[1], i as f32 / 9.0)))).unwrap();
    let samples = SampleSets::spirals(24, 8).unwrap();
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [32; 2]).unwrap();
    let values = |lines: &LineSet| -> Vec<f32> {
        let cells = Cells::new(lines, 0.012);
        let occlusion = Occlusion::by_rays(&cells, &view, &samples, AoOptions::rays(0.4, 0.004)).unwrap();
        (0..125).map(|i| occlusion.at(&receiver(&view, i))).collect()
    };
    let (a, b) = (values(&whole), values(&split));
    // A joint that rounding moves to one side or the other, at most.
    assert!(rmse(&a, &b) < 2e-3 && a.iter().sum::<f32>() > 5.0, "{}", rmse(&a, &b));
    // A right angle, seen from before it: parallel rays of a width show the area of a quarter of a
    // ball beyond the two tubes, whatever the width is.
    let corner = LineSet::new([[Vec3::X, Vec3::ZERO, Vec3::Y]]).unwrap();
    for soft in [0.0, 0.02, 0.05, 0.1] {
        let cells = Cells::new(&corner, 0.05 + soft);
        let (mut area, side) = (0.0, 0.004);
        for (i, j) in (-60..0).flat_map(|i| (-60..0).map(move |j| (i, j))) {
            let start = vec3(i as f32 + 0.5, j as f32 + 0.5, 0.0) * side + Vec3::Z * 0.5;
            // As wide at the corner as they may be.
            let rays = Rays { cells: &cells, start, scale: 1.0, tube: 0.05, soft, spread: 1.0 };
            area += (1.0 - rays.passed(Vec3::NEG_Z)) * side * side;
        }
        let wanted = std::f32::consts::FRAC_PI_4 * 0.05 * 0.05;
        assert!((0.8..1.35).contains(&(area / wanted)), "{soft}: {area}, wanted {wanted}");
    }
}

#[test]
fn in_a_fog_of_lines_as_much_is_stopped_as_known_however_wide_rays_are() {
    let lines = short_lines(20_000, 0.1, 9);
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [32; 2]).unwrap();
    // pi / 4 * 2 * 0.004 * 2000 / 8 of a ray for each unit.
    let truth = 1.0 - (-std::f32::consts::FRAC_PI_4 * 2.0 * 0.004 * 250.0 * 0.4f32).exp();
    let mut all = Vec::new();
    for margin in [0.004, 0.012, 0.03] {
        let cells = Cells::new(&lines, margin);
        for rays in [16, 64] {
            let samples = SampleSets::spirals(rays, 8).unwrap();
            let occlusion = Occlusion::by_rays(&cells, &view, &samples, AoOptions::rays(0.4, 0.004)).unwrap();
            let at = |i: usize| occlusion.at(&receiver(&view, i));
            all.push((0..1000).map(at).sum::<f32>() / 1000.0);
        }
    }
    assert!(all.iter().all(|v| (0.94 * truth..1.04 * truth).contains(v)), "{all:?}, wanted {truth}");
    let most = all.iter().fold(0.0, |m: f32, &v| m.max(v));
    assert!(all.iter().all(|v| *v > 0.95 * most), "widths differ: {all:?}");
}

#[test]
fn a_line_alone_is_open_and_half_of_the_sky_behind_a_wall_is_hidden() {
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [32; 2]).unwrap();
    let samples = SampleSets::spirals(400, 1).unwrap();
    let at = |lines: &LineSet, tangent: Vec3, margin: f32| {
        let cells = Cells::new(lines, margin);
        let occlusion = Occlusion::by_rays(&cells, &view, &samples, AoOptions::rays(1.0, 0.01)).unwrap();
        let position = view.to_eye(Vec3::ZERO).as_vec3();
        occlusion.at(&Fragment { position, tangent, line: 0, along: 0.0 })
    };
    let own = LineSet::new([(-20..=20).map(|i| vec3(i as f32 * 0.05, 0.0, 0.0))]).unwrap();
    assert_eq!(at(&own, Vec3::X, 0.03), 0.0);
    // The tangent along the view: its pole points at the viewer.
    assert_eq!(at(&own, Vec3::Z, 0.03), 0.0);
    // An endless wall half a radius before the line: directions below 60 degrees from the pole meet
    // it, sin(60)^2 of them.
    let wall = (-300..300).map(|i| [vec3(-2.0, i as f32 * 0.01, 0.51), vec3(2.0, i as f32 * 0.01, 0.51)]);
    let wall = LineSet::new(wall).unwrap();
    let hidden = at(&wall, Vec3::X, 0.01);
    assert!((hidden - 0.75).abs() < 0.01, "{hidden}");
    // Tubes beside each other are taken as independent: wide rays see some light between them.
    let hidden = at(&wall, Vec3::X, 0.03);
    assert!((0.7..0.74).contains(&hidden), "{hidden}");
    let behind = (-300..300).map(|i| [vec3(-2.0, i as f32 * 0.01, -0.51), vec3(2.0, i as f32 * 0.01, -0.51)]);
    assert_eq!(at(&LineSet::new(behind).unwrap(), Vec3::X, 0.03), 0.0);
}

#[test]
fn solid_tubes_of_other_lines_stop_rays_that_start_in_them() {
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [32; 2]).unwrap();
    let samples = SampleSets::spirals(60, 1).unwrap();
    // A line whose bend is narrower than its tube, and one beside its other end. The rays start
    // 0.101 above the middle of the line.
    let bent = vec![vec3(0.0, 0.05, 0.08), Vec3::ZERO, Vec3::X * 0.9];
    let lines = |z: f32| LineSet::new([bent.clone(), vec![vec3(0.9, -1.0, z), vec3(0.9, 1.0, z)]]).unwrap();
    for (z, x, wanted) in [(0.03, 0.9, 1.0), (0.03, 0.0, 0.0), (-0.01, 0.9, 0.0)] {
        let (cells, position) = (Cells::new(&lines(z), 0.1), view.to_eye(Vec3::X * x).as_vec3());
        let fragment = Fragment { position, tangent: Vec3::X, line: 0, along: 0.0 };
        let at = |solid| {
            let options = AoOptions { solid, ..AoOptions::rays(0.5, 0.1) };
            Occlusion::by_rays(&cells, &view, &samples, options).unwrap().at(&fragment)
        };
        assert_eq!([at(true), at(false)], [wanted, 0.0], "{z} {x}");
    }
}

#[test]
fn margins_of_cells_keep_the_rays_of_thin_tubes_wide_within_bounds() {
    let margin = |tube: f32| AoOptions::rays(2.0, tube).margin();
    // Three tubes, a twentieth of the radius, nine tubes.
    for (tube, wanted) in [(0.04, 0.12), (0.02, 0.1), (0.001, 0.009), (0.0, 0.0)] {
        assert!((margin(tube) - wanted).abs() < 1e-6, "{tube}: {}", margin(tube));
        assert_eq!(AoOptions::places(2.0, tube).margin(), margin(tube));
    }
}

/// Rays without a width in a world whose unit is the radius of the hemisphere.
fn thin(cells: &Cells, start: Vec3, tube: f32) -> Rays<'_> {
    Rays { cells, start, scale: 1.0, tube, soft: 0.0, spread: 0.1 }
}

#[test]
fn rays_at_the_borders_of_cells_lose_no_tube_to_rounding() {
    // Upright lines in a row of a thousand cells, whose tubes have the margin of the cells and
    // hardly overlap. Rays just touch them; where a border lies between, rounding may put the ray
    // behind it.
    let mut random = Random::new(4);
    let row: Vec<f32> = (0..150_000).map(|_| random.within(0.0, 1.0) as f32).collect();
    // So short that cells are a thousandth of the row, and so thin that tubes hardly overlap.
    let (half, tube) = (1e-3, 5e-7);
    let lines = LineSet::new(row.iter().map(|x| [vec3(*x, 0.0, -half), vec3(*x, 0.0, half)])).unwrap();
    let cells = Cells::new(&lines, tube);
    assert!(cells.dims().x > 900, "{:?}", cells.dims());
    let lost = |x: f32| thin(&cells, vec3(x, -0.01, 0.0), tube).passed(Vec3::Y) > 0.0;
    let touching = |x: &f32| {
        [*x - tube, *x + tube].into_iter().filter(|t| (t - x).abs() < tube * 0.999_999).collect::<Vec<_>>()
    };
    let rays: Vec<f32> = row.iter().flat_map(touching).collect();
    assert!(rays.len() > 50_000);
    assert_eq!(rays.iter().filter(|x| lost(**x)).count(), 0);
}

#[test]
fn rays_along_the_axes_meet_tubes_on_the_borders_of_cells_too() {
    let step = |way: Vec3| step_of(way, 0.125);
    for way in [Vec3::X, Vec3::NEG_Y, vec3(-0.0, 0.0, -1.0), Vec3::ZERO] {
        // A border at the place itself is crossed at once, not at a place that is no number.
        let here = Vec3::ZERO / step(way);
        assert!(here == Vec3::ZERO && step(way).signum() == way.map(|w| 1f32.copysign(w)), "{way} {here}");
    }
    // Cells of a power of 2, and rods across all borders. Rays of many cells stay in their row.
    let rods = (0..400).map(|i| {
        let at = vec3((i % 20) as f32, (i / 20) as f32, 0.0) / 16.0;
        [at - Vec3::Z, at + Vec3::Z]
    });
    let turned = |axis: usize| move |p: Vec3| Vec3::from_array(std::array::from_fn(|i| p[(i + axis) % 3]));
    // Rays half a radius beside the axis of a tube meet it, those 20 radii beside it do not.
    let tube = 1e-3;
    for axis in 0..3 {
        let lines = LineSet::new(rods.clone().map(|rod| rod.map(turned(axis)))).unwrap();
        let cells = Cells::new(&lines, tube);
        for i in 0..20 {
            for (side, zero) in [(-1.0, 0.0), (1.0, -0.0)] {
                let at = vec3(0.5 + side * 0.8, i as f32 / 16.0 + tube / 2.0, 0.0);
                let start = turned(axis)(at);
                let rays = thin(&cells, start, tube);
                let way = turned(axis)(vec3(-side, zero, zero));
                assert_eq!(rays.passed(way), 0.0, "{axis} {at}");
                let beside = turned(axis)(at + Vec3::Y * (20.0 * tube));
                assert_eq!(thin(&cells, beside, tube).passed(way), 1.0, "{axis} {at}");
            }
        }
    }
}

#[test]
fn rays_pass_lines_beside_them_that_are_parallel_and_meet_those_that_almost_are() {
    let mut random = Random::new(6);
    let mut point = || DVec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0)));
    for _ in 0..2000 {
        let (start, way) = (point(), point().normalize());
        let off = way.cross(point()).normalize() * 0.1;
        let at = |t: f64| (start + way * t + off).as_vec3();
        let lines = LineSet::new([[at(0.2), at(0.7)]]).unwrap();
        let cells = Cells::new(&lines, 0.05);
        let rays = Rays { soft: 0.03, spread: 1.0, ..thin(&cells, start.as_vec3(), 0.02) };
        assert_eq!(rays.passed(way.as_vec3()), 1.0, "{start} {way}");
    }
    // Rays into the end of a tube, along it or within `RAY_PARALLEL` of it.
    let slants = [0.0, 1e-8, 1e-6, 1e-5];
    for i in 0..4000 {
        let (start, way) = (point(), point().normalize());
        let [off, slant] = [(); 2].map(|()| way.cross(point()).normalize());
        let (off, slant) = (off * 0.01, slant * slants[i % 4]);
        let ends = [0.2, 0.7].map(|t| (start + (way + slant) * t + off).as_vec3());
        let ends = if i % 8 < 4 { ends } else { [ends[1], ends[0]] };
        let cells = Cells::new(&LineSet::new([ends]).unwrap(), 0.02);
        assert_eq!(thin(&cells, start.as_vec3(), 0.02).passed(way.as_vec3()), 0.0, "{start} {way}");
    }
    // Angles of a thousandth, where a tube is crossed within a fifth of its length.
    let (rise, tube) = (4e-4, 1e-4);
    let lines = LineSet::new([[vec3(0.1, -rise, 0.0), vec3(0.9, rise, 0.0)]]).unwrap();
    let cells = Cells::new(&lines, tube);
    assert_eq!(thin(&cells, Vec3::ZERO, tube).passed(Vec3::X), 0.0);
}
