//! Tests of the walk on small maps, against exact visibility between cells and against the chain
//! rule written down plainly.

#[path = "../../../tests/common/cases.rs"]
mod cases;
mod exact;
mod rule;

use glam::{DVec2, IVec2, UVec2};
use proptest::prelude::*;

use crate::cell::{CellMap, Hiding, Region, Walk};
use crate::matrix::CrossBits;
use cases::cases;
use exact::is_visible;
use rule::chain_rule;

const ROWS: Hiding = Hiding::Rows { narrowest: 0.0 };
const STRAIGHT: Hiding = Hiding::Caps { l_shaped: false, least_angle: 0.0 };
const L_SHAPED: Hiding = Hiding::Caps { l_shaped: true, least_angle: 0.0 };

/// Opaque cells of a small grid, and a viewer's cell that is not opaque.
#[derive(Debug, Clone)]
struct Map {
    dims: IVec2,
    opaque: Vec<IVec2>,
    v: IVec2,
}

impl Map {
    fn bits(&self) -> CrossBits {
        let mut bits = CrossBits::new(self.dims.as_uvec2());
        self.opaque.iter().for_each(|c| bits.set(c.x as u32, c.y as u32, true));
        bits
    }

    /// The cells in sight.
    fn seen(&self, region: &Region, hiding: Hiding) -> Vec<IVec2> {
        let (bits, empty) = (self.bits(), CrossBits::new(self.dims.as_uvec2()));
        let map = CellMap { dims: self.dims, opaque: &[&bits], found: [&bits, &empty] };
        let mut walk = Walk::default();
        let mut visited = Vec::new();
        walk.run(&map, self.v, region, hiding, |cell, shell| {
            assert_eq!(shell_of(self.v, cell), shell);
            visited.push(cell);
        });
        let seen: Vec<IVec2> = self.cells().filter(|&c| walk.is_seen(c)).collect();
        // The walk reports the opaque cells in sight, nearest shells first.
        assert!(visited.is_sorted_by_key(|&c| shell_of(self.v, c)));
        assert!(seen.iter().all(|c| !self.opaque.contains(c) || visited.contains(c)));
        assert!(visited.iter().all(|c| *c == self.v || self.opaque.contains(c) && seen.contains(c)));
        seen
    }

    fn cells(&self) -> impl Iterator<Item = IVec2> {
        let dims = self.dims;
        (0..dims.y).flat_map(move |y| (0..dims.x).map(move |x| IVec2::new(x, y)))
    }
}

fn shell_of(v: IVec2, cell: IVec2) -> i32 {
    (cell - v).abs().max_element()
}

/// Maps of single cells, rows, columns and blocks.
fn maps(side: i32) -> impl Strategy<Value = Map> {
    let pieces = prop::collection::vec((0..side, 0..side, 1..5i32, 1..5i32, 0..4u8), 0..9);
    let v = (0..side, 0..side);
    ((3..=side, 3..=side), pieces, v).prop_map(|((w, h), pieces, v)| {
        let dims = IVec2::new(w, h);
        let v = IVec2::new(v.0 % w, v.1 % h);
        let mut opaque = Vec::new();
        for (x, y, a, b, kind) in pieces {
            let (a, b) = [(a, b), (a + b, 1), (1, a + b), (1, 1)][kind as usize];
            let inside = |c: &IVec2| c.cmplt(dims).all() && *c != v;
            let block = (0..a).flat_map(|i| (0..b).map(move |j| IVec2::new(x + i, y + j)));
            opaque.extend(block.filter(inside));
        }
        opaque.sort_unstable_by_key(|c| c.to_array());
        opaque.dedup();
        Map { dims, opaque, v }
    })
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn viewers_outside_of_the_grid_lose_no_cell(map in maps(9), x in -5..14i32, y in -5..14i32) {
        let map = Map { v: IVec2::new(x, y), ..map };
        prop_assume!(!map.opaque.contains(&map.v));
        let seen = map.seen(&Region::default(), ROWS);
        for cell in map.cells().filter(|c| !seen.contains(c)) {
            prop_assert!(!is_visible(&map.opaque, map.v, cell), "{cell}");
        }
    }

    #[test]
    fn no_cell_that_can_be_seen_is_hidden(map in maps(11)) {
        for hiding in [ROWS, STRAIGHT, L_SHAPED] {
            let seen = map.seen(&Region::default(), hiding);
            for cell in map.cells().filter(|c| !seen.contains(c)) {
                prop_assert!(!is_visible(&map.opaque, map.v, cell), "{hiding:?} {cell}");
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn masks_hide_by_the_chain_rule_and_caps_hide_a_part_of_that(map in maps(15)) {
        let rows = map.seen(&Region::default(), ROWS);
        prop_assert_eq!(&rows, &chain_rule(map.dims, &map.opaque, map.v));
        let l_shaped = map.seen(&Region::default(), L_SHAPED);
        prop_assert!(rows.iter().all(|c| l_shaped.contains(c)));
    }

    #[test]
    fn a_region_leaves_out_no_cell_in_it_and_hides_nothing_that_can_be_seen(
        map in maps(11), turn in 0.0..6.2f64, wide in 0.1..1.5f64, range in 2.0..20.0f64,
        eye in (-0.5..0.5f64, -0.5..0.5f64),
    ) {
        let normals = [wide - std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2 - wide]
            .map(|by| DVec2::from_angle(turn + by));
        let eye = DVec2::from(eye);
        let region = Region::new(eye, &normals, 0.0, Some(range));
        let seen = map.seen(&region, ROWS);
        let center = map.v.as_dvec2() + eye;
        let in_view = |p: DVec2| p.distance(center) <= range && normals.iter().all(|n| n.dot(p - center) >= 0.0);
        let half = [DVec2::splat(0.5), DVec2::splat(-0.5), DVec2::new(0.5, -0.5), DVec2::new(-0.5, 0.5)];
        for cell in map.cells().filter(|c| !seen.contains(c)) {
            let whole = half.iter().all(|&corner| in_view(cell.as_dvec2() + corner));
            prop_assert!(!whole || !is_visible(&map.opaque, map.v, cell), "{cell}");
        }
    }
}

#[test]
fn an_l_hides_what_neither_arm_hides() {
    // The viewer looks at the corner of an L; behind it lies a cell between both shadows.
    let v = IVec2::new(1, 1);
    let arm = |step: IVec2| (0..4).map(move |i| IVec2::splat(5) + step * i);
    let l: Vec<IVec2> = arm(IVec2::X).chain(arm(IVec2::Y).skip(1)).collect();
    let map = Map { dims: IVec2::splat(24), opaque: l, v };
    let hidden = |hiding| {
        let seen = map.seen(&Region::default(), hiding);
        map.cells().filter(|c| !seen.contains(c)).count()
    };
    let (straight, l_shaped, rows) = (hidden(STRAIGHT), hidden(L_SHAPED), hidden(ROWS));
    assert!(straight <= l_shaped && l_shaped <= rows && rows > 80, "{straight} {l_shaped} {rows}");
}

#[test]
fn a_grid_of_one_cell() {
    let empty = Map { dims: IVec2::ONE, opaque: Vec::new(), v: IVec2::ZERO };
    assert_eq!(empty.seen(&Region::default(), ROWS), [IVec2::ZERO]);
}

#[test]
fn occluders_of_a_small_angle_hide_nothing() {
    let map = Map {
        dims: IVec2::splat(20),
        opaque: vec![IVec2::new(12, 10), IVec2::new(12, 11)],
        v: IVec2::splat(10),
    };
    let seen = |hiding| map.seen(&Region::default(), hiding).len();
    let all = UVec2::splat(20).element_product() as usize;
    assert!(seen(ROWS) < all && seen(L_SHAPED) < all);
    assert_eq!(seen(Hiding::Rows { narrowest: 0.6 }), all);
    assert_eq!(seen(Hiding::Caps { l_shaped: true, least_angle: 1.5 }), all);
    assert!(seen(Hiding::Rows { narrowest: 0.4 }) < all);
}
