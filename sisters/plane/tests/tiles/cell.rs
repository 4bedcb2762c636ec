//! The thesis' way to hide cells, of the example `cell`, against exact visibility between cells.

// The example asks for more than the test.
#[allow(dead_code)]
#[path = "../../examples/cell/caps.rs"]
mod caps;

use caps::Walk;
use casca_plane::BitGrid;
use glam::IVec2;
use proptest::prelude::*;

use crate::cases::cases;
use crate::exact::is_visible;

/// A map, its opaque cells, and a viewer's cell that is not opaque.
type Map = (BitGrid, Vec<IVec2>, IVec2);

fn map(dims: IVec2, opaque: Vec<IVec2>, v: IVec2) -> Map {
    let mut bits = BitGrid::new(dims.x as u32, dims.y as u32);
    opaque.iter().for_each(|c| bits.set(c.x as u32, c.y as u32, true));
    (bits, opaque, v)
}

fn hidden((bits, _, v): &Map, l_shaped: bool) -> Vec<IVec2> {
    let seen = Walk::run(bits, *v, l_shaped).seen;
    let (width, height) = (bits.width() as i32, bits.height() as i32);
    let cells = (0..height).flat_map(|y| (0..width).map(move |x| IVec2::new(x, y)));
    cells.filter(|c| !seen.get(c.x as u32, c.y as u32)).collect()
}

/// Maps of single cells, rows, columns and blocks.
fn maps(side: i32) -> impl Strategy<Value = Map> {
    let pieces = prop::collection::vec((0..side, 0..side, 1..5i32, 1..5i32, 0..4u8), 0..9);
    ((3..=side, 3..=side), pieces, (0..side, 0..side)).prop_map(|((w, h), pieces, v)| {
        let (dims, v) = (IVec2::new(w, h), IVec2::new(v.0 % w, v.1 % h));
        let mut opaque = Vec::new();
        for (x, y, a, b, kind) in pieces {
            let (a, b) = [(a, b), (a + b, 1), (1, a + b), (1, 1)][kind as usize];
            let block = (0..a).flat_map(|i| (0..b).map(move |j| IVec2::new(x + i, y + j)));
            opaque.extend(block.filter(|c| c.cmplt(dims).all() && *c != v));
        }
        opaque.sort_unstable_by_key(|c| c.to_array());
        opaque.dedup();
        map(dims, opaque, v)
    })
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn no_cell_that_can_be_seen_is_hidden(map in maps(11)) {
        for l_shaped in [false, true] {
            for cell in hidden(&map, l_shaped) {
                prop_assert!(!is_visible(&map.1, map.2, cell), "{l_shaped} {cell}");
            }
        }
    }
}

#[test]
fn an_l_hides_what_neither_arm_hides() {
    // The viewer looks at the corner of an L; behind it lies a cell between both shadows.
    let arm = |step: IVec2| (0..4).map(move |i| IVec2::splat(5) + step * i);
    let map = map(IVec2::splat(24), arm(IVec2::X).chain(arm(IVec2::Y).skip(1)).collect(), IVec2::ONE);
    let (straight, l_shaped) = (hidden(&map, false).len(), hidden(&map, true).len());
    assert!(straight <= l_shaped && l_shaped > 80, "{straight} {l_shaped}");
}
