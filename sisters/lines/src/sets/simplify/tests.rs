//! Simplified lines against distances of Fréchet and Hausdorff between densely sampled lines, which
//! share no code with the method.

use std::cell::Cell;

use glam::{DVec3, Vec3, vec3};
use proptest::prelude::*;

use super::*;
use crate::sets::attributes::{Attributes, Groups, NO_GROUP, Scalars};
use crate::sets::generate::{Family, Recipe};
use crate::sets::random::Random;
use crate::testing::{cases, coordinate};

/// Rounding of distances in doubles, as a share of the extent: samples and the method differ by
/// some roundings of 2^-53.
const ROUNDING: f64 = 1e-12;

/// Points of a line, at most `step` apart.
fn samples(line: &[Vec3], step: f64) -> Vec<DVec3> {
    let mut all: Vec<DVec3> = line.iter().take(1).map(|p| p.as_dvec3()).collect();
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|p| p.as_dvec3());
        let count = (a.distance(b) / step).ceil().max(1.0) as u32;
        all.extend((1..=count).map(|i| a.lerp(b, f64::from(i) / f64::from(count))));
    }
    all
}

/// The discrete distance of Fréchet (Eiter and Mannila 1994): between samples `step` apart it
/// exceeds that of the lines by at most `step`.
fn frechet(a: &[DVec3], b: &[DVec3]) -> f64 {
    let mut row = vec![f64::INFINITY; b.len()];
    for (i, p) in a.iter().enumerate() {
        let mut diagonal = if i == 0 { 0.0 } else { f64::INFINITY };
        let mut before = f64::INFINITY;
        for (q, above) in b.iter().zip(row.iter_mut()) {
            let least = before.min(diagonal).min(*above);
            diagonal = *above;
            before = least.max(p.distance(*q));
            *above = before;
        }
    }
    row.last().copied().unwrap_or(0.0)
}

/// The greatest distance of a point from a line.
fn farthest(points: &[DVec3], line: &[Vec3]) -> f64 {
    let to_segment = |p: DVec3, pair: &[Vec3]| {
        let [a, b] = [pair[0], pair[1]].map(|p| p.as_dvec3());
        let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(if along.is_nan() { a } else { a + (b - a) * along })
    };
    let to_line = |p: &DVec3| line.windows(2).map(|w| to_segment(*p, w)).fold(f64::INFINITY, f64::min);
    points.iter().map(to_line).fold(0.0, f64::max)
}

/// Checks all lines of a set with its simplified one, and returns the greatest distance of Fréchet
/// as a share of the tolerance.
fn check(set: &LineSet, distance: f32) -> f64 {
    let simple = set.simplified(&Tolerance::within(distance));
    assert_eq!(simple.len(), set.len());
    let most = f64::from(distance);
    let mut greatest = 0.0f64;
    for (old, new) in set.iter().zip(simple.iter()) {
        assert_eq!(old.first(), new.first());
        assert_eq!(old.last(), new.last());
        assert!(new.len() <= old.len() && new.len() >= old.len().min(2));
        let mut left = old.iter();
        assert!(new.iter().all(|p| left.any(|q| q == p)), "vertices of the old line in its order");
        if old.len() < 3 {
            continue;
        }
        let long: f64 = old.windows(2).map(|w| f64::from(w[0].distance(w[1]))).sum();
        let (step, [min, max]) = ((most / 8.0).max(long / 800.0), set.bounds());
        let [dense_old, dense_new] = [old, new].map(|line| samples(line, step));
        let rounding = ROUNDING * f64::from((max - min).max_element());
        assert!(farthest(&dense_old, new) <= most + rounding, "{} > {most}", farthest(&dense_old, new));
        assert!(farthest(&dense_new, old) <= most + rounding, "{} > {most}", farthest(&dense_new, old));
        let off = frechet(&dense_old, &dense_new);
        assert!(off <= most + step + rounding, "{off} > {most}");
        greatest = greatest.max((off - step) / most);
    }
    greatest
}

#[test]
fn lines_keep_their_ends_and_lose_what_is_straight_or_within_the_tolerance() {
    let straight: Vec<Vec3> = (0..100).map(|i| Vec3::new(0.1, 0.7, -0.3) * i as f32).collect();
    let arc = |i: i32| vec3((i as f32 * 0.01).cos(), (i as f32 * 0.01).sin(), 0.0);
    let half_circle: Vec<Vec3> = (0..=314).map(arc).collect();
    let ring: Vec<Vec3> = (0..=100).map(|i| vec3((i as f32).sin(), (i as f32).cos(), 0.0) * 1e-3).collect();
    let turns = [Vec3::ZERO, Vec3::X * 3.0, Vec3::X, Vec3::X * 4.0];
    let lines = [straight, vec![], vec![Vec3::ONE], vec![Vec3::X; 7], half_circle, ring, turns.to_vec()];
    let set = LineSet::new(lines).unwrap();
    let counts = |distance: f32| -> Vec<usize> {
        let simple = set.simplified(&Tolerance::within(distance));
        simple.iter().map(<[Vec3]>::len).collect()
    };
    // A chord of a circle of radius 1 is off by t from an arc of sqrt(8 t): 0.283 of 3.14 here.
    assert_eq!(counts(0.01), [2, 0, 1, 2, 13, 2, 4]);
    // A way that waits while the line runs back by 2.
    assert_eq!(counts(2.001), [2, 0, 1, 2, 2, 2, 2]);
    assert_eq!(counts(f32::INFINITY), [2, 0, 1, 2, 2, 2, 2]);
    for none in [0.0, -1.0, f32::NAN] {
        let exact = counts(none);
        assert_eq!(exact[1..4], [0, 1, 2], "{none}");
        assert!(exact[4] > 300 && exact[6] == 4, "{exact:?}");
    }
    let ruler = LineSet::new([(0..64).map(|i| vec3(i as f32, -2.0 * i as f32, 0.5 * i as f32))]).unwrap();
    assert_eq!(ruler.simplified(&Tolerance::within(0.0)).points().len(), 2);
    assert_eq!(LineSet::default().simplified(&Tolerance::within(1.0)), LineSet::default());
}

#[test]
fn lines_of_all_families_stay_within_the_tolerance_and_use_it() {
    for family in Family::ALL {
        let (lines, vertices) = (12, 120);
        let set = Recipe { lines, vertices, ..Recipe::new(family, 3) }.make().unwrap();
        let greatest = [0.002, 0.02, 0.3].map(|distance| check(&set, distance));
        let simple = set.simplified(&Tolerance::within(0.02));
        // Straight lines of equal steps have nothing to lose but vertices.
        if family != Family::Parallel {
            assert!(greatest.iter().any(|g| *g > 0.5), "{family:?} {greatest:?}");
        }
        assert!(simple.points().len() * 3 < set.points().len(), "{family:?} {}", simple.points().len());
    }
}

#[test]
fn numbers_and_colours_stay_within_theirs_and_those_not_known_apart() {
    let count = 200;
    let points: Vec<Vec3> = (0..count).map(|i| Vec3::X * i as f32).collect();
    let set = LineSet::new([points.clone(), points]).unwrap();
    let of = |value: &dyn Fn(usize) -> f32| (0..2 * count).map(|v| value(v % count)).collect::<Vec<f32>>();
    let scalars = |of, values| Scalars { name: "s".into(), of, values };
    let kept = |attributes: Attributes, values: f32| {
        let set = set.clone().with_attributes(attributes).unwrap();
        let simple = set.simplified(&Tolerance { distance: 0.1, values });
        let attributes = simple.attributes().clone();
        assert!(attributes.check(simple.points().len(), 2).is_ok());
        // The old number of a vertex is its place.
        for s in attributes.scalars.iter().zip(&set.attributes().scalars).filter(|s| s.0.of == Of::Vertices) {
            for (p, value) in simple.points().iter().zip(&s.0.values) {
                assert_eq!(value.to_bits(), s.1.values[p.x as usize].to_bits());
            }
        }
        (simple.range(0).unwrap().len(), attributes)
    };
    let with =
        |values: Vec<f32>| Attributes { scalars: vec![scalars(Of::Vertices, values)], ..Default::default() };
    let wave = of(&|v| (v as f32 * 0.1).sin());
    assert_eq!(kept(with(of(&|v| v as f32)), 0.0).0, 2, "a ramp");
    assert_eq!(kept(with(of(&|_| f32::NAN)), 0.0).0, 2, "none known");
    assert_eq!(kept(with(of(&|v| if v == 50 { f32::NAN } else { 1.0 })), 0.5).0, 5, "one not known");
    assert_eq!(kept(with(of(&|v| if v == 50 { f32::INFINITY } else { 1.0 })), 0.5).0, 5, "one infinite");
    assert_eq!(kept(with(wave.clone()), f32::INFINITY).0, 2);
    let [fine, coarse] = [0.01, 0.1].map(|share| kept(with(wave.clone()), share).0);
    assert!(fine < 60 && coarse < fine && coarse > 6, "{fine} {coarse}");
    let of_lines = Attributes {
        scalars: vec![scalars(Of::Lines, vec![7.0, 8.0])],
        colours: Some((0..2 * count).map(|v| [0, if v % count < 100 { 10 } else { 20 }, 0]).collect()),
        groups: Some(Groups { names: vec!["left".into()], of: vec![NO_GROUP, 0] }),
    };
    let (count, made) = kept(of_lines.clone(), 4.5 / 255.0);
    assert_eq!((count, &made.scalars, &made.groups), (4, &of_lines.scalars, &of_lines.groups));
    assert_eq!(made.colours.unwrap()[..4], [[0, 10, 0], [0, 10, 0], [0, 20, 0], [0, 20, 0]]);
    assert_eq!(kept(of_lines, 10.0 / 255.0).0, 2);
}

#[test]
fn values_off_by_a_little_more_than_the_tolerance_stay() {
    let set = LineSet::new([(0..4).map(|i| Vec3::X * i as f32)]).unwrap();
    let numbers = Scalars { name: "s".into(), of: Of::Vertices, values: vec![0.0, 10.0, 0.0, 100.0] };
    let of_numbers = Attributes { scalars: vec![numbers], ..Default::default() };
    let colours = Some([0, 10, 0, 255].map(|green| [0, green, 0]).to_vec());
    let of_colours = Attributes { colours, ..Default::default() };
    for (attributes, range) in [(of_numbers, 100.0), (of_colours, 255.0)] {
        let set = set.clone().with_attributes(attributes).unwrap();
        let counts = [9.9, 10.1].map(|off| {
            let tolerance = Tolerance { distance: 1.0, values: off / range };
            set.simplified(&tolerance).points().len()
        });
        assert_eq!(counts, [4, 3]);
    }
}

/// Interpolated between the vertices that stay, numbers are those of the old vertices.
#[test]
fn numbers_between_vertices_are_interpolated_within_the_tolerance() {
    let mut random = Random::new(5);
    let points: Vec<Vec3> = (0..300).map(|i| vec3(i as f32, (i as f32 * 0.02).sin(), 0.0)).collect();
    let mut value = 0.0;
    let values: Vec<f32> = points
        .iter()
        .map(|_| {
            value += random.within(-1.0, 1.0) as f32;
            value
        })
        .collect();
    let high = values.iter().fold(f32::MIN, |a, b| a.max(*b));
    let range = high - values.iter().fold(f32::MAX, |a, b| a.min(*b));
    let scalars = vec![Scalars { name: "s".into(), of: Of::Vertices, values: values.clone() }];
    let set = LineSet::new([points.clone()]).unwrap();
    let set = set.with_attributes(Attributes { scalars, ..Default::default() }).unwrap();
    let simple = set.simplified(&Tolerance { distance: 5.0, values: 0.1 });
    let (new, kept) = (&simple.attributes().scalars[0].values, simple.points());
    assert!(kept.len() < 150, "{}", kept.len());
    for (p, value) in points.iter().zip(&values) {
        let next = kept.partition_point(|q| q.x <= p.x).clamp(1, kept.len() - 1);
        let share = (p.x - kept[next - 1].x) / (kept[next].x - kept[next - 1].x);
        let between = new[next - 1] + (new[next] - new[next - 1]) * share;
        // A vertex may lie at another share of the way by its distance.
        assert!((between - value).abs() <= 0.1 * range + 0.03 * range, "{p} {between} {value}");
    }
}

/// The vertices looked at, whatever fits and whatever does not.
#[test]
fn no_line_takes_more_than_n_log_n() {
    let count = 4096;
    let bound = |count: usize| count as f64 * (2.0 * (count as f64).log2() + 6.0);
    let cost = |fits: &dyn Fn(usize, usize) -> bool| {
        let looked = Cell::new(0);
        let kept = chain(count, |from, to| {
            assert!(to > from + 1 && to < count);
            looked.set(looked.get() + to - from);
            fits(from, to)
        });
        assert!(kept.windows(2).all(|w| w[0] < w[1]) && kept[0] == 0 && kept.last() == Some(&(count - 1)));
        (kept.len(), looked.get() as f64)
    };
    assert_eq!(cost(&|_, _| true).0, 2);
    assert_eq!(cost(&|_, _| false).0, count);
    for size in 1..40 {
        let (kept, looked) = cost(&|from, to| to - from <= size);
        assert_eq!(kept, (count - 1).div_ceil(size) + 1);
        assert!(looked <= bound(count), "{size}: {looked}");
    }
    for seed in 0..40u64 {
        // Long ways fit by chance, so that steps are long and then short.
        let chance = 1.0 / (2.0 + seed as f64 * 40.0);
        let fits = |from: usize, to: usize| {
            Random::new(seed << 40 ^ (from as u64) << 20 ^ to as u64).unit() > chance * (to - from) as f64
        };
        let looked = cost(&fits).1;
        assert!(looked <= bound(count), "{seed}: {looked}");
    }
    assert_eq!(chain(0, |_, _| true), [0usize; 0]);
    assert_eq!(chain(1, |_, _| false), [0]);
}

proptest! {
    #![proptest_config(cases(96))]

    /// Smooth, jittered, coincident and turning lines, far from the origin or at it.
    #[test]
    fn random_lines_stay_within_the_tolerance(
        seed in any::<u64>(), count in 3usize..60, step in 0.01f32..1.0, bend in 0.0f32..1.5,
        distance in 0.02f32..2.0, far in prop_oneof![Just(0.0f32), Just(1000.0)],
    ) {
        let mut random = Random::new(seed);
        let mut unit = || Vec3::from_array(std::array::from_fn(|_| coordinate(&mut random, 1.0) as f32));
        let (mut p, mut way) = (Vec3::splat(far), Vec3::X);
        let mut line = Vec::new();
        for i in 0..count {
            way = (way + unit() * bend).normalize_or(Vec3::Y);
            // Some vertices coincide, some steps run back.
            p += way * step * [1.0, 1.0, 0.0, 1.0, -0.5][(seed as usize + i * i) % 5];
            line.push(p);
        }
        check(&LineSet::new([line]).unwrap(), distance * step);
    }
}
