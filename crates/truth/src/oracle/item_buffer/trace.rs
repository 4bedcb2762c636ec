//! Where the rays of a tile hit a solid or a triangle.

use std::ops::Range;

use casca_scenes::world::Shape;
use glam::{DVec3, Vec3};

use super::frame::{AREA, Entry, Frame, TILE};
use super::pixel_rays::PixelRays;
use super::triangle::TriangleSetup;

/// Where a tile lies.
pub(super) struct Area {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
}

/// The pixels of a tile that an entry may cover.
struct Pixels<'a> {
    area: &'a Area,
    columns: Range<usize>,
    rows: Range<usize>,
}

impl Pixels<'_> {
    /// The number of a pixel in the tile.
    #[inline(always)]
    fn place(&self, x: usize, y: usize) -> usize {
        (y - self.area.y) * TILE + (x - self.area.x)
    }
}

/// Calls `plot` with each pixel of the tile whose ray hits the entry, and the
/// depth of the hit.
#[inline(always)]
pub(super) fn trace(
    area: &Area,
    inverse: &[DVec3; AREA],
    frame: &Frame,
    entry: &Entry,
    plot: impl FnMut(usize, f64),
) {
    let [left, top, right, bottom] = entry.rect.map(usize::from);
    let columns = left.max(area.x)..(right + 1).min(area.x + area.columns);
    let rows = top.max(area.y)..(bottom + 1).min(area.y + area.rows);
    let pixels = Pixels { area, columns, rows };
    match frame.objects[entry.object as usize].shape {
        Shape::Sphere { center, radius } => sphere(&pixels, frame, center, radius, plot),
        Shape::Box { min, max } => solid_box(&pixels, inverse, frame, [min, max], plot),
        Shape::Mesh { ref mesh, .. } => {
            let vertices = &frame.meshes[entry.slot as usize];
            let corners = mesh.triangles[entry.triangle as usize].map(|v| vertices[v as usize]);
            triangle(&pixels, &frame.rays, corners, plot);
        }
    }
}

/// As [`trace`], a sphere.
#[inline(always)]
fn sphere(pixels: &Pixels, frame: &Frame, center: Vec3, radius: f32, mut plot: impl FnMut(usize, f64)) {
    let rays = &frame.rays;
    let center = center.as_dvec3() - frame.eye;
    let squared = f64::from(radius) * f64::from(radius);
    let slope = if rays.perspective { DVec3::ZERO } else { rays.start[1] };
    for y in pixels.rows.clone() {
        // a t^2 - 2 b t + c = 0, with a, b and c polynomials in x.
        let step = rays.step(0, y);
        let to_center = center - rays.start(0, y);
        let (a0, a1, a2) =
            (step.length_squared(), 2.0 * step.dot(rays.step[1]), rays.step[1].length_squared());
        let (b0, b1) = (step.dot(to_center), rays.step[1].dot(to_center) - step.dot(slope));
        let (c0, c1, c2) =
            (to_center.length_squared() - squared, -2.0 * to_center.dot(slope), slope.length_squared());
        for x in pixels.columns.clone() {
            let px = x as f64;
            let a = a0 + px * (a1 + px * a2);
            let b = b0 + px * b1;
            let c = c0 + px * (c1 + px * c2);
            let rest = b * b - a * c;
            if rest >= 0.0 {
                let t = (b - rest.sqrt()) / a;
                if t >= rays.near && t <= rays.far {
                    plot(pixels.place(x, y), t);
                }
            }
        }
    }
}

/// As [`trace`], a box from a corner to another. `inverse` has one over each component of the steps
/// of rays.
#[inline(always)]
fn solid_box(
    pixels: &Pixels,
    inverse: &[DVec3; AREA],
    frame: &Frame,
    [min, max]: [Vec3; 2],
    mut plot: impl FnMut(usize, f64),
) {
    let rays = &frame.rays;
    let (min, max) = (min.as_dvec3() - frame.eye, max.as_dvec3() - frame.eye);
    for y in pixels.rows.clone() {
        for x in pixels.columns.clone() {
            let inverse = inverse[pixels.place(x, y)];
            let (low, high) = if rays.perspective {
                (min, max)
            } else {
                let start = rays.start(x, y);
                (min - start, max - start)
            };
            let (a, b) = (low * inverse, high * inverse);
            let enter = a.min(b).max_element();
            let leave = a.max(b).min_element();
            if enter <= leave && enter >= rays.near && enter <= rays.far {
                plot(pixels.place(x, y), enter);
            }
        }
    }
}

/// As [`trace`], a triangle.
#[inline(always)]
fn triangle(pixels: &Pixels, rays: &PixelRays, corners: [DVec3; 3], mut plot: impl FnMut(usize, f64)) {
    let Some(triangle) = TriangleSetup::new(rays, corners) else { return };
    let (columns, rows) = (&pixels.columns, &pixels.rows);
    if columns.len() * rows.len() >= 64
        && triangle.misses([columns.start, columns.end - 1], [rows.start, rows.end - 1])
    {
        return;
    }
    for y in pixels.rows.clone() {
        let py = y as f64;
        let e = triangle.edges.map(|[e, _, ey]| e + py * ey);
        let number = triangle.number[0] + py * triangle.number[2];
        let over = triangle.over[0] + py * triangle.over[2];
        for x in pixels.columns.clone() {
            let px = x as f64;
            let e: [f64; 3] = std::array::from_fn(|i| e[i] + px * triangle.edges[i][1]);
            let inside =
                (e[0] >= 0.0 && e[1] >= 0.0 && e[2] >= 0.0) || (e[0] <= 0.0 && e[1] <= 0.0 && e[2] <= 0.0);
            if !inside {
                continue;
            }
            let t = (number + px * triangle.number[1]) / (over + px * triangle.over[1]);
            if triangle.behind && (t < rays.near || t.is_nan()) {
                continue;
            }
            let t = t.max(triangle.depths[0]).min(triangle.depths[1]);
            if t >= rays.near && t <= rays.far {
                plot(pixels.place(x, y), t);
            }
        }
    }
}
