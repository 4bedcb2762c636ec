//! The lattice rule of the thesis as a slow procedure, for tests against the masks.
//!
//! Cost: O(n^4) for n^3 cells. Use [`crate::Query`] for work.

use glam::IVec3;

use crate::grid::side::Side;
use crate::matrix::bits::{BitMatrix, OcclusionMatrix};

/// The cells that the viewer's cell cannot see, by the lattice rule over all
/// pairs of shells: the most that the rule finds.
///
/// `opaque` is O, of which the cells from 0 to `dims` are looked at; `viewer` is one of these.
pub fn occlusion_by_lattice(opaque: &BitMatrix, dims: IVec3, viewer: IVec3) -> OcclusionMatrix {
    let mut hidden = BitMatrix::default();
    let farthest = viewer.abs().max((dims - 1 - viewer).abs()).max_element();
    for m in 2..=farthest {
        let mut found = Vec::new();
        for side in &Side::ALL {
            for row in -m..=m {
                for col in -m..=m {
                    let c = viewer + cell_of(side, m, col, row);
                    if c.cmplt(IVec3::ZERO).any() || c.cmpge(dims).any() {
                        continue;
                    }
                    let blocked_at = |k: i32| {
                        let around = |v: i32| {
                            let lo = (i64::from(v) * i64::from(k)).div_euclid(i64::from(m));
                            let exact = (i64::from(v) * i64::from(k)).rem_euclid(i64::from(m)) == 0;
                            (lo as i32, lo as i32 + i32::from(!exact))
                        };
                        let ((r0, r1), (c0, c1)) = (around(row), around(col));
                        (r0..=r1).all(|r| {
                            (c0..=c1).all(|c| {
                                let cell = viewer + cell_of(side, k, c, r);
                                opaque.get(cell) || hidden.get(cell)
                            })
                        })
                    };
                    if (1..m).any(blocked_at) {
                        found.push(c);
                    }
                }
            }
        }
        found.into_iter().for_each(|c| hidden.set(c));
    }
    hidden
}

fn cell_of(side: &Side, shell: i32, col: i32, row: i32) -> IVec3 {
    let mut c = IVec3::ZERO;
    c[side.axes.normal] = shell * side.sign;
    c[side.axes.col] = col;
    c[side.axes.row] = row;
    c
}
