//! Exact visibility by rays, on the part of the map in range.

use std::collections::BTreeSet;

use casca_plane::BitGrid;

#[path = "../../tests/tiles/oracle.rs"]
#[allow(dead_code)]
mod oracle;

/// The tiles that the centre of a tile sees. Those far beyond a range may be left out.
pub fn seen(opaque: &BitGrid, eye: (u32, u32), range: u32) -> BTreeSet<(u32, u32)> {
    let reach = if range == 0 { u32::MAX } else { range + 2 };
    let window =
        |at: u32, size: u32| at.saturating_sub(reach)..at.saturating_add(reach).saturating_add(1).min(size);
    let (columns, rows) = (window(eye.0, opaque.width()), window(eye.1, opaque.height()));
    let mut part = BitGrid::new(columns.len() as u32, rows.len() as u32);
    for y in rows.clone() {
        for x in columns.clone() {
            part.set(x - columns.start, y - rows.start, opaque.get(x, y));
        }
    }
    let center = |at: u32| i128::from(at) * oracle::UNIT + oracle::UNIT / 2;
    let eye = [center(eye.0 - columns.start), center(eye.1 - rows.start)];
    let seen = oracle::Oracle { opaque: &part, eye }.seen();
    seen.into_iter().map(|(x, y)| (x + columns.start, y + rows.start)).collect()
}
