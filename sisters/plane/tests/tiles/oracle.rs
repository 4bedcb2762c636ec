//! Exact visibility on small maps, without the sweep: rays between all neighbouring directions in
//! which a corner of a tile lies.
//!
//! Between two such directions, all rays cross the same tiles. All numbers are whole.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use casca_plane::BitGrid;

/// Units of a tile.
pub const UNIT: i128 = 1 << 28;

pub type Direction = [i128; 2];

/// What an eye may see: a map and a place, in units.
pub struct Oracle<'a> {
    pub opaque: &'a BitGrid,
    pub eye: [i128; 2],
}

fn cross(a: Direction, b: Direction) -> i128 {
    a[0] * b[1] - a[1] * b[0]
}

/// By angle, counterclockwise from the x axis.
fn by_angle(a: &Direction, b: &Direction) -> Ordering {
    let half = |d: &Direction| d[1] < 0 || d[1] == 0 && d[0] < 0;
    half(a).cmp(&half(b)).then_with(|| 0.cmp(&cross(*a, *b)))
}

impl Oracle<'_> {
    /// A direction in each range of directions without a corner inside; `more` are taken for
    /// corners.
    pub fn directions(&self, more: &[Direction]) -> Vec<Direction> {
        let (width, height) = (i128::from(self.opaque.width()), i128::from(self.opaque.height()));
        // The axes keep neighbours less than a half turn apart.
        let mut corners = vec![[1, 0], [0, 1], [-1, 0], [0, -1]];
        corners.extend_from_slice(more);
        for y in 0..=height {
            corners.extend((0..=width).map(|x| [x * UNIT - self.eye[0], y * UNIT - self.eye[1]]));
        }
        corners.retain(|&corner| corner != [0, 0]);
        corners.sort_by(by_angle);
        corners.dedup_by(|a, b| by_angle(a, b) == Ordering::Equal);
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| [a[0] + b[0], a[1] + b[1]]).collect()
    }

    /// The tiles of the map that a ray crosses, with the opaque one that it ends at. It must meet
    /// no corner.
    pub fn tiles_along(&self, direction: Direction) -> Vec<(u32, u32)> {
        let mut tile = [0, 1].map(|axis| {
            let on_border = self.eye[axis].rem_euclid(UNIT) == 0;
            self.eye[axis].div_euclid(UNIT) - i128::from(on_border && direction[axis] < 0)
        });
        let inside = self.eye.iter().all(|at| at.rem_euclid(UNIT) != 0);
        let size = [i128::from(self.opaque.width()), i128::from(self.opaque.height())];
        let step = direction.map(i128::signum);
        let (mut tiles, mut entered) = (Vec::new(), false);
        // Beyond the map, in the direction of the ray, is nothing more.
        while !(0..2).any(|axis| match step[axis] {
            1 => tile[axis] >= size[axis],
            -1 => tile[axis] < 0,
            _ => tile[axis] < 0 || tile[axis] >= size[axis],
        }) {
            if (0..2).all(|axis| (0..size[axis]).contains(&tile[axis])) {
                let (x, y) = (tile[0] as u32, tile[1] as u32);
                tiles.push((x, y));
                if self.opaque.get(x, y) && (entered || !inside) {
                    break;
                }
            }
            // The distance to the next border of columns is a[0] / |direction[0]|, and of rows
            // likewise.
            let to = [0, 1].map(|axis| {
                let border = tile[axis] + i128::from(step[axis] > 0);
                (border * UNIT - self.eye[axis]).abs()
            });
            let axis = match (step[0], step[1]) {
                (0, _) => 1,
                (_, 0) => 0,
                _ => usize::from(to[1] * direction[0].abs() < to[0] * direction[1].abs()),
            };
            tile[axis] += step[axis];
            entered = true;
        }
        tiles
    }

    /// The tiles that are seen.
    pub fn seen(&self) -> BTreeSet<(u32, u32)> {
        self.directions(&[]).into_iter().flat_map(|direction| self.tiles_along(direction)).collect()
    }

    /// Whether some point inside a tile is nearer to the eye than a range, in units.
    pub fn in_range(&self, (x, y): (u32, u32), range: i128) -> bool {
        let apart = [0, 1].map(|axis| {
            let low = i128::from([x, y][axis]) * UNIT;
            (low - self.eye[axis]).max(self.eye[axis] - low - UNIT).max(0)
        });
        apart[0] * apart[0] + apart[1] * apart[1] < range * range
    }
}
