use super::*;
use crate::grid::REACH;
use crate::grid::mask::{beside, cells_of};
use crate::random::Random;

#[test]
fn neighbours_are_found_across_bricks() {
    let mut m = BitMatrix::default();
    for i in 0..24 * 24 * 24 {
        if i * 7919 % 31 < 9 {
            m.set(IVec3::new(i % 24, i / 24 % 24, i / 576));
        }
    }
    let brick = IVec3::ONE;
    for (axis, step) in IVec3::AXES.into_iter().enumerate() {
        for up in [false, true] {
            let step = if up { step } else { -step };
            let found = beside(m.brick(brick), m.brick(brick + step), axis, up);
            for cell in cells_of(brick, &ALL) {
                let bit = 8 * (cell.y & 7) + (cell.x & 7);
                assert_eq!(found[(cell.z & 7) as usize] >> bit & 1 != 0, m.get(cell + step), "{cell} {step}");
            }
        }
    }
}

#[test]
fn tiles_read_and_write_what_cells_say() {
    let dims = IVec3::new(20, 17, 30);
    let mut m = BitMatrix::default();
    let mut n = BitMatrix::default();
    let mut random = Random::new(7);
    for z in 0..dims.z {
        for y in 0..dims.y {
            for x in 0..dims.x {
                if random.below(4) == 0 {
                    m.set(IVec3::new(x, y, z));
                }
            }
        }
    }
    for axes in &SideAxes::ALL {
        n.clear();
        for bz in 0..4 {
            for by in 0..3 {
                for bx in 0..3 {
                    let brick = IVec3::new(bx, by, bz);
                    for at in 0..8 {
                        let tile = m.tile(brick, axes, at);
                        for row in 0..8 {
                            for col in 0..8 {
                                let mut c = brick * 8;
                                c[axes.normal] += at;
                                c[axes.row] += row;
                                c[axes.col] += col;
                                let set = tile >> (8 * row + col) & 1 != 0;
                                assert_eq!(set, m.get(c), "{axes:?} {c}");
                                if set {
                                    n.set(c);
                                }
                            }
                        }
                    }
                }
            }
        }
        assert!(m.is_subset(&n) && n.is_subset(&m));
        assert_eq!(n.count(), m.iter().count() as u64);
    }
}

#[test]
fn runs_and_clearing() {
    let mut m = BitMatrix::default();
    m.set_run(3, 28, 8, 5);
    assert_eq!(m.count(), 26);
    for x in 3..=28 {
        m.clear_cell(IVec3::new(x, 8, 5));
    }
    assert_eq!(m.count(), 0);
    assert_eq!(m.iter().count(), 0);
    let last = IVec3::new(REACH - 1, -REACH, 0);
    [last, last + IVec3::X, last - IVec3::Y].iter().for_each(|&cell| m.set(cell));
    assert_eq!(m.iter().collect::<Vec<_>>(), [last]);
    assert!(m.get(last) && !m.get(last + IVec3::X) && !m.get(IVec3::splat(i32::MAX)));
}

#[test]
fn what_is_full_takes_no_room_of_its_own() {
    let mut m = BitMatrix::default();
    let bare = m.bytes();
    m.fill_page(IVec3::ONE);
    // An entry of the table, the counts of planes.
    assert!(m.bytes() < bare + 600 && m.count() == 1 << 18, "{}", m.bytes() - bare);
    let mut runs = BitMatrix::default();
    for i in 0..64 * 64 {
        runs.set_run(64, 127, 64 + i % 64, 64 + i / 64);
    }
    assert!(runs.is_subset(&m) && m.is_subset(&runs));
    assert!(runs.holds_block(IVec3::splat(64), IVec3::splat(127)));
    assert!(!runs.holds_block(IVec3::splat(64), IVec3::new(128, 70, 70)));
    // The bricks that grew full share one: room for a page and a few bricks is left.
    assert!(runs.bytes() < bare + 16_384, "{}", runs.bytes() - bare);
    let cell = IVec3::new(70, 80, 90);
    m.clear_cell(cell);
    assert!(!m.get(cell) && m.get(cell + 1) && m.count() == (1 << 18) - 1);
    m.set(cell);
    assert!(m.holds_block(IVec3::splat(64), IVec3::splat(127)));
    m.clear_page(IVec3::ONE);
    assert_eq!(m.count(), 0);
}
