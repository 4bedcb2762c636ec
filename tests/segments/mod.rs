//! Segments against boxes, for tests of visibility that share no code with the library.

use casca::Aabb;
use glam::DVec3;

/// Whether a box cuts the segment between two points, its surface included.
pub fn cuts_box(b: &Aabb, from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (lo, hi) = (f64::from(b.min[axis]) - from[axis], f64::from(b.max[axis]) - from[axis]);
        if way[axis] == 0.0 {
            if lo > 0.0 || hi < 0.0 {
                return false;
            }
            continue;
        }
        let (x, y) = (lo / way[axis], hi / way[axis]);
        (enter, leave) = (enter.max(x.min(y)), leave.min(x.max(y)));
    }
    enter <= leave
}
