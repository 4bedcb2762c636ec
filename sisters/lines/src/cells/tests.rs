use casca_truth::cases;
use glam::{DVec3, UVec3, Vec3, vec3};
use proptest::prelude::*;

use super::*;
use crate::directions::decoded;
use crate::numeric::MOST_IN_ROW;
use crate::sets::random::Random;
use crate::testing::coordinate;

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
