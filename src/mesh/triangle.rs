//! Single triangles against boxes and lines.

use glam::DVec3;

use crate::numeric::mesh::NORMAL;

/// Separating-axis test of a triangle against a closed box widened by `margin`.
pub(crate) fn triangle_meets_box(t: &[DVec3; 3], (min, max): (DVec3, DVec3), margin: f64) -> bool {
    let center = (min + max) * 0.5;
    let half = (max - min) * 0.5 + margin;
    let [a, b, c] = t.map(|p| p - center);
    let apart = |axis: DVec3| {
        let (pa, pb, pc) = (axis.dot(a), axis.dot(b), axis.dot(c));
        let radius = axis.abs().dot(half);
        pa.min(pb).min(pc) > radius || pa.max(pb).max(pc) < -radius
    };
    let (ab, bc, ca) = (b - a, c - b, a - c);
    if [DVec3::X, DVec3::Y, DVec3::Z].into_iter().any(apart) {
        return false;
    }
    // Seen from the nearest corner: products with far ones are large, and their roundings, too.
    let nearest = |[p, q, r]: [DVec3; 3]| p.length_squared() <= q.length_squared().min(r.length_squared());
    let turns = [[a, b, c], [b, c, a], [c, a, b]];
    let [p, q, r] = turns.into_iter().find(|&turn| nearest(turn)).unwrap_or(turns[0]);
    let normal = (q - p).cross(r - p);
    let doubt = NORMAL * (q - p).length() * (r - p).length() * p.length();
    if normal.dot(p).abs() > normal.abs().dot(half) + doubt {
        return false;
    }
    ![ab, bc, ca].into_iter().any(|e| {
        apart(DVec3::new(0.0, -e.z, e.y))
            || apart(DVec3::new(e.z, 0.0, -e.x))
            || apart(DVec3::new(-e.y, e.x, 0.0))
    })
}

/// Where the line along `axis` through `point` crosses the triangle, and by how much that
/// changes the winding number. Each edge
/// is judged from its two ends in a fixed order, so that triangles which share
/// it agree, and crossings of a closed mesh come in pairs whatever is rounded.
pub(crate) fn crossing(t: &[DVec3; 3], axis: usize, point: DVec3) -> Option<(f64, i32)> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (pu, pv) = (point[u], point[v]);
    let above = t.map(|p| p[v] > pv);
    if above[0] == above[1] && above[1] == above[2] {
        return None;
    }
    let mut winding = 0;
    for i in 0..3 {
        let j = (i + 1) % 3;
        if above[i] != above[j] {
            let (a, b) = if above[i] { (t[j], t[i]) } else { (t[i], t[j]) };
            let at = a[u] + (pv - a[v]) / (b[v] - a[v]) * (b[u] - a[u]);
            if at > pu {
                winding += if above[i] { 1 } else { -1 };
            }
        }
    }
    if winding == 0 {
        return None;
    }
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let along = (normal[u] * (t[0][u] - pu) + normal[v] * (t[0][v] - pv)) / normal[axis] + t[0][axis];
    let (lo, hi) = (t[0].min(t[1]).min(t[2])[axis], t[0].max(t[1]).max(t[2])[axis]);
    Some((if along.is_nan() { lo } else { along.clamp(lo, hi) }, winding))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn boxes_around_points_of_long_narrow_triangles_are_met() {
        let mut random = Random::new(4);
        for round in 0..2000 {
            // One corner far away, or all three.
            let far = random.point(1e7);
            let (b, c) =
                if round % 2 == 0 { (far, random.point(10.0)) } else { (far, far + random.point(10.0)) };
            let (at, u, v) = (random.point(10.0), random.next() * 1e-6, random.within(0.1, 0.6));
            let (u, v) = if round % 2 == 0 { (u, v) } else { (v * 0.5, v) };
            let a = (at - b * u - c * v) / (1.0 - u - v);
            let t = [a, b, c];
            let room = DVec3::splat(1e-4);
            for turn in 0..3 {
                let t = [t[turn], t[(turn + 1) % 3], t[(turn + 2) % 3]];
                assert!(triangle_meets_box(&t, (at - room, at + room), 0.0), "{t:?} {at}");
            }
        }
    }
}
