//! Where the rays through the centres of pixels cross triangles, so that closed meshes are crossed
//! an even number of times.
//!
//! Whether a ray passes a triangle is decided exactly: an edge that two triangles share gives both
//! the same answer, and a ray that meets an edge or a vertex is moved aside by an infinitesimal way
//! (Edelsbrunner and Mücke 1990, "Simulation of simplicity").

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

use super::slices::Slices;
use crate::view::View;

/// Why a solid was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// A vertex is NaN or infinite.
    #[error("vertex {0} is not finite")]
    NotFinite(usize),
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, of {vertices}")]
    NoVertex {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
}

/// Vertices in eye space, and for each triangle the rows of its bounding rectangle.
pub(super) type Placed = (Vec<DVec3>, Vec<Option<Range<u32>>>);

/// Checks a mesh, and places it in a view.
pub(super) fn place(vertices: &[Vec3], triangles: &[[u32; 3]], view: &View) -> Result<Placed, SolidError> {
    if let Some(bad) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(SolidError::NotFinite(bad));
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
            return Err(SolidError::NoVertex { triangle, vertex, vertices: vertices.len() });
        }
    }
    let placed: Vec<DVec3> = vertices.iter().map(|&v| view.to_eye(v)).collect();
    let rows = triangles.iter().map(|t| Some(rectangle(view, t.map(|v| placed[v as usize]))?.1)).collect();
    Ok((placed, rows))
}

/// The columns and rows whose centres a triangle may cover behind the nearest depth.
fn rectangle(view: &View, corners: [DVec3; 3]) -> Option<(Range<u32>, Range<u32>)> {
    let near = view.depths()[0];
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let mut hold = |eye: DVec3| {
        let p = view.project(eye);
        low = low.min(p.truncate() / p.z);
        high = high.max(p.truncate() / p.z);
    };
    for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b])) {
        if -a.z >= near {
            hold(a);
        }
        if (-a.z < near) != (-b.z < near) {
            hold(a + (b - a) * ((near + a.z) / (a.z - b.z)));
        }
    }
    // A pixel more on each side, for rounding.
    let range = |low: f64, high: f64, size: u32| {
        let (from, to) = ((low - 1.0).max(0.0) as u32, (high + 2.0).min(f64::from(size)) as u32);
        (from < to).then_some(from..to)
    };
    let [width, height] = view.size();
    Some((range(low.x, high.x, width)?, range(low.y, high.y, height)?))
}

/// Whether `a * d > b * c`, as 1, 0 or -1, exactly but for underflow.
fn compare_products([a, d]: [f64; 2], [b, c]: [f64; 2]) -> i32 {
    let (left, right) = (a * d, b * c);
    // Rounding keeps the order; equal products differ by their rounding errors.
    let difference = if left == right { a.mul_add(d, -left) - b.mul_add(c, -right) } else { left - right };
    i32::from(difference > 0.0) - i32::from(difference < 0.0)
}

/// On which side of the edge from `a` to `b` the origin lies; moved by an infinitesimal way if it
/// lies on it.
fn side(a: DVec2, b: DVec2) -> i32 {
    let order = |a: f64, b: f64| i32::from(a > b) - i32::from(a < b);
    match compare_products([a.x, b.y], [a.y, b.x]) {
        0 if a.y != b.y => order(a.y, b.y),
        0 => order(b.x, a.x),
        side => side,
    }
}

/// Calls `visit` with column, row and depth where rays cross a triangle; only `rows`.
pub(super) fn crossings(
    view: &View,
    corners: [DVec3; 3],
    rows: &Range<u32>,
    mut visit: impl FnMut(u32, u32, f64),
) {
    let Some((columns, own)) = rectangle(view, corners) else { return };
    let placed = corners.map(|c| view.project(c));
    for y in own.start.max(rows.start)..own.end.min(rows.end) {
        for x in columns.clone() {
            // The ray through the pixel's centre becomes the axis: its two other coordinates are 0.
            let centre = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let [a, b, c] = placed.map(|p| p.truncate() - centre * p.z);
            let sides = [side(b, c), side(c, a), side(a, b)];
            if sides[0] == 0 || sides != [sides[0]; 3] {
                continue;
            }
            let areas = DVec3::new(b.perp_dot(c), c.perp_dot(a), a.perp_dot(b));
            let sum = areas.element_sum();
            let depths = DVec3::new(-corners[0].z, -corners[1].z, -corners[2].z);
            let depth = areas.dot(depths) / sum;
            // A triangle seen edge on: any depth of it will do.
            visit(
                x,
                y,
                if sum != 0.0 { depth.clamp(depths.min_element(), depths.max_element()) } else { depths.x },
            );
        }
    }
}

/// The last slice whose middle lies before a depth.
pub(super) fn slices_before(view: &View, slices: Slices, depth: f64) -> Option<u32> {
    let [near, far] = view.depths();
    let count = f64::from(slices.count());
    let before = ((depth - near) / (far - near) * count + 0.5).floor().min(count);
    (before >= 1.0).then(|| before as u32 - 1)
}
