use glam::{DVec3, UVec3, Vec3, vec3};
use proptest::prelude::*;

use super::*;
use crate::directions::decoded;
use crate::numeric::MOST_IN_ROW;
use crate::sets::random::Random;
use crate::testing::{cases, coordinate};

fn random_set(lines: u32, long: f64, seed: u64) -> LineSet {
    let mut random = Random::new(seed);
    let mut point = || DVec3::from_array(std::array::from_fn(|_| coordinate(&mut random, 1.0)));
    let line = |_| {
        let (middle, way) = (point(), point().normalize_or_zero() * long);
        [(middle - way).as_vec3(), (middle + way).as_vec3()]
    };
    LineSet::new((0..lines).map(line)).unwrap()
}

/// The cell of a point, if it lies in the grid.
fn cell_of(cells: &Cells, p: DVec3) -> Option<UVec3> {
    let at = (p - cells.origin().as_dvec3()) / f64::from(cells.side());
    let inside = at.cmpge(DVec3::ZERO).all() && at.cmplt(cells.dims().as_dvec3()).all();
    inside.then(|| at.as_uvec3())
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn cells_name_all_segments_nearer_than_the_margin(seed: u64, margin in 0.0f32..0.2, long in 0.005f64..0.9, flat: bool) {
        let mut lines = random_set(60, long, seed);
        if flat {
            lines = LineSet::new(lines.iter().map(|l| l.iter().map(|&p| p * Vec3::new(1.0, 1.0, 0.0)).collect::<Vec<_>>())).unwrap();
        }
        let cells = Cells::new(&lines, margin);
        let mut random = Random::new(seed ^ 1);
        for (number, [a, b]) in cells.ends().iter().enumerate() {
            for _ in 0..20 {
                let off = DVec3::from_array(std::array::from_fn(|_| coordinate(&mut random, 1.0))).normalize_or_zero();
                let p = a.as_dvec3().lerp(b.as_dvec3(), random.unit()) + off * f64::from(margin) * 0.999;
                let cell = cell_of(&cells, p);
                prop_assert!(cell.is_some(), "{p} lies outside of the grid");
                prop_assert!(cells.named(cell.unwrap()).contains(&(number as u32)), "{p} {number} {cells:?}");
            }
        }
    }
}

#[test]
fn cells_name_few_segments_whatever_their_lengths_and_margins() {
    for (count, long, margin) in [
        (3000, 0.001, 0.0),
        (3000, 0.001, 0.01),
        (3000, 0.02, 0.01),
        (3000, 1.0, 0.001),
        (3000, 0.02, 0.5),
        (300, 1.0, 0.0),
        (1, 1.0, 0.0),
    ] {
        let cells = Cells::new(&random_set(count, long, 4), margin);
        let names = cells.lists().len() as f64 / f64::from(count);
        assert!((1.0..60.0).contains(&names), "{count} of {long} with {margin}: {names} cells each");
        // A bound of their lengths in cells: long ones in cells for short ones cross thirty.
        assert!(names < 16.0 || count < 3000 || long < 0.5, "{count} of {long}: {names}");
        let all = cells.dims().as_u64vec3().element_product();
        // Two cells a segment, and those at the sides.
        assert!(all < 100 + 6 * u64::from(count), "{count} of {long} with {margin}: {:?}", cells.dims());
        assert!(names < 16.0 || margin > 0.0 || long > 0.5, "{count} of {long}: {names}");
    }
    // Not a segment in one row: no more cells than single precision tells apart.
    let row = (0..20_000).map(|i| [vec3(i as f32, 0.0, 0.0), vec3(i as f32 + 0.5, 0.0, 0.0)]);
    let cells = Cells::new(&LineSet::new(row).unwrap(), 0.0);
    assert!(f64::from(cells.dims().x) <= MOST_IN_ROW + 1.0 && cells.dims().x > 900, "{:?}", cells.dims());
}

#[test]
fn neighbours_in_memory_lie_near_each_other() {
    let cells = Cells::new(&random_set(4000, 0.001, 2), 0.0);
    let steps = cells.ends().windows(2).map(|w| w[0][0].distance(w[1][0]));
    let mean = steps.sum::<f32>() / 4000.0;
    // 0.9 in any order.
    assert!(mean < 0.45, "{mean}");
}

#[test]
fn absurd_sets_and_margins_give_cells() {
    let most = Vec3::splat(3e38);
    let sets = [
        LineSet::default(),
        LineSet::new([[Vec3::ONE]]).unwrap(),
        LineSet::new([[Vec3::ONE, Vec3::ONE]]).unwrap(),
        LineSet::new([[most, -most], [Vec3::ZERO, most]]).unwrap(),
        LineSet::new([[Vec3::splat(1e-45), Vec3::ZERO]]).unwrap(),
        LineSet::new([[Vec3::splat(1e9), Vec3::splat(1e9 + 128.0)]]).unwrap(),
    ];
    for lines in sets {
        for margin in [0.0, 1.0, 1e30, f32::NAN, -1.0, f32::INFINITY, f32::MAX] {
            let cells = Cells::new(&lines, margin);
            assert!(cells.side() > 0.0 && cells.dims().min_element() > 0, "{lines:?} {margin}");
            assert_eq!(cells.starts().len() as u64, cells.dims().as_u64vec3().element_product() + 1);
            assert!(cells.margin() >= 0.0 && cells.margin().is_finite());
        }
    }
}

#[test]
fn segments_know_where_their_line_leads_on_whatever_lies_between() {
    // A vertex twice, and lines that end where others begin.
    let bent = vec![Vec3::ZERO, Vec3::X, Vec3::X, vec3(1.0, 1.0, 0.0)];
    let lines = LineSet::new([bent, vec![vec3(1.0, 1.0, 0.0), Vec3::ONE], vec![Vec3::ONE]]).unwrap();
    let cells = Cells::new(&lines, 0.1);
    let of = |a: Vec3| {
        let at = cells.ends().iter().position(|e| e[0] == a).unwrap();
        cells.neighbours()[at].map(|code| (code != NONE).then(|| decoded(code)))
    };
    assert_eq!(cells.ends().len(), 3);
    assert_eq!(of(Vec3::ZERO), [None, Some(Vec3::Y)]);
    assert_eq!(of(Vec3::X), [Some(Vec3::NEG_X), None]);
    assert_eq!(of(vec3(1.0, 1.0, 0.0)), [None, None]);
    assert!((0..=2000).all(|i| coded(vec3(-1.0, i as f32 - 1000.0, -1.0)) != NONE));
}

/// The same lines with some of them moved.
fn with_moved(lines: &LineSet, moved: &[u32], by: Vec3) -> LineSet {
    let at = |(i, line): (usize, &[Vec3])| {
        let by = if moved.contains(&(i as u32)) { by } else { Vec3::ZERO };
        line.iter().map(|p| *p + by).collect::<Vec<_>>()
    };
    LineSet::new(lines.iter().enumerate().map(at)).unwrap()
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn cells_of_moved_lines_are_those_that_the_grid_has_when_it_is_filled_anew(
        seed: u64, margin in 0.0f32..0.1, long in 0.005f64..0.3, count in 0usize..12, back: bool,
    ) {
        let lines = random_set(80, long, seed);
        let mut cells = Cells::new(&lines, margin);
        let mut random = Random::new(seed);
        let mut moved: Vec<u32> = (0..count).map(|_| random.within(0.0, 80.0) as u32).collect();
        moved.sort_unstable();
        moved.dedup();
        let by = Vec3::from_array(std::array::from_fn(|_| coordinate(&mut random, 0.4) as f32));
        let before = cells.clone();
        for step in 0..2 {
            let to = with_moved(&lines, &moved, by * if back && step == 1 { 0.0 } else { 1.0 + step as f32 });
            let Some(change) = cells.update(&to, &moved) else {
                // Nothing may be half moved.
                prop_assert!(step == 1 || cells == before);
                break;
            };
            prop_assert!(change.segments.is_sorted() && change.segments.len() == moved.len());
            let mut anew = cells.clone();
            anew.fill();
            prop_assert!(anew == cells, "{moved:?} by {by}");
            let usual = Cells::new(&to, margin);
            let order = |c: &Cells, of: &dyn Fn(usize) -> [u32; 6]| {
                let mut all: Vec<[u32; 6]> = (0..c.ends().len()).map(of).collect();
                all.sort_unstable();
                all
            };
            let bits = |c: &Cells, i: usize| {
                let [a, b] = c.ends()[i];
                let [c, d] = c.neighbours()[i];
                let [a, b] = [a, b].map(|p| p.x.to_bits() ^ p.y.to_bits().rotate_left(9) ^ p.z.to_bits().rotate_left(18));
                [a, b, c, d, 0, 0]
            };
            prop_assert_eq!(order(&cells, &|i| bits(&cells, i)), order(&usual, &|i| bits(&usual, i)));
        }
    }
}

#[test]
fn lines_that_leave_the_grid_or_gain_segments_or_fill_it_are_refused() {
    let dot = vec![Vec3::ZERO, Vec3::ZERO];
    let lines = LineSet::new([vec![-Vec3::ONE, Vec3::ONE], vec![Vec3::ZERO, Vec3::X * 0.5], dot]).unwrap();
    let cells = Cells::new(&lines, 0.05);
    let update = |line: u32, to: [Vec3; 2]| {
        let set =
            lines.iter().enumerate().map(|(i, l)| if i == line as usize { to.to_vec() } else { l.to_vec() });
        cells.clone().update(&LineSet::new(set).unwrap(), &[line])
    };
    assert_eq!(update(1, [Vec3::ZERO, Vec3::X * 0.5]), Some(Change { segments: vec![1], cells: 0 }));
    assert!(update(1, [Vec3::ZERO, Vec3::Y * 0.5]).is_some_and(|c| c.cells > 0));
    assert_eq!(update(1, [Vec3::ZERO, Vec3::X * 9.0]), None);
    assert_eq!(update(1, [Vec3::X; 2]), None);
    assert_eq!(update(2, [Vec3::ZERO, Vec3::X * 0.1]), None);
    assert_eq!(cells.clone().update(&LineSet::default(), &[0]), None);
    assert_eq!(cells.clone().update(&lines, &[7]), None);
    // Short lines that become long: their cells are too small for them.
    let short = random_set(500, 0.002, 3);
    let all: Vec<u32> = (0..500).collect();
    let long = LineSet::new(short.iter().map(|l| [l[0], l[0] * -0.9])).unwrap();
    assert_eq!(Cells::new(&short, 0.0).update(&long, &all), None);
}
