use super::*;
use crate::grid::REACH;
use crate::random::Random;

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
    // The bricks that grew full share one: room for a page and a few bricks is left.
    assert!(runs.bytes() < bare + 16_384, "{}", runs.bytes() - bare);
    let cell = IVec3::new(70, 80, 90);
    m.clear_cell(cell);
    assert!(!m.get(cell) && m.get(cell + 1) && m.count() == (1 << 18) - 1);
    m.set(cell);
    assert_eq!(m.count(), 1 << 18);
    m.clear_page(IVec3::ONE);
    assert_eq!(m.count(), 0);
}
