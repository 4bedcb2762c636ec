//! Rasterised depth, front to back.

use glam::{Vec3, Vec4};

use super::{DepthPyramid, Screen, bounds, front_to_back};
use crate::world::{Camera, Object, Shape};

/// Spheres whose radius is less than this many pixels are drawn with 80 triangles
/// instead of 320, and below a pixel not at all.
const COARSE: f32 = 12.0;

/// A software occlusion buffer.
pub struct Hzb {
    depth: DepthPyramid,
    fine: (Vec<Vec3>, Vec<[u16; 3]>),
    coarse: (Vec<Vec3>, Vec<[u16; 3]>),
    clip: Vec<Vec4>,
}

/// An icosahedron cut into 4^`cuts` times its triangles, with vertices at distance 1.
fn ball(cuts: u32) -> (Vec<Vec3>, Vec<[u16; 3]>) {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut points: Vec<Vec3> = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        points.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
    }
    let mut triangles = Vec::new();
    for i in 0..12u16 {
        for j in 0..12u16 {
            for k in 0..12u16 {
                let [a, b, c] = [i, j, k].map(|v| points[usize::from(v)]);
                let edge = |p: Vec3, q: Vec3| (p.distance(q) - 2.0).abs() < 1e-3;
                let first = i < j && i < k;
                let outward = (b - a).cross(c - a).dot(a) > 0.0;
                if first && outward && edge(a, b) && edge(b, c) && edge(c, a) {
                    triangles.push([i, j, k]);
                }
            }
        }
    }
    for _ in 0..cuts {
        let mut middles = std::collections::HashMap::new();
        let mut next = Vec::new();
        for t in triangles {
            let mut middle = |a: u16, b: u16| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (p, q) = (points[usize::from(a)].normalize(), points[usize::from(b)].normalize());
                    points.push(p + q);
                    points.len() as u16 - 1
                })
            };
            let [a, b, c] = t;
            let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = next;
    }
    (points.into_iter().map(Vec3::normalize).collect(), triangles)
}

/// Corners by bits: 1 the greater x, 2 the greater y, 4 the greater z; outward counter-clockwise.
const BOX: [[u16; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

impl Hzb {
    /// A buffer of `width` by `height` pixels.
    pub fn new(width: usize, height: usize) -> Self {
        Self { depth: DepthPyramid::new(width, height), fine: ball(2), coarse: ball(1), clip: Vec::new() }
    }

    /// The buffer as the last frame left it.
    pub fn depth(&self) -> &DepthPyramid {
        &self.depth
    }

    /// Which of the objects given are visible, front to back. Every visible one that occludes is
    /// drawn before the next one is tested.
    pub fn frame(&mut self, objects: &[Object], in_frustum: &[usize], camera: &Camera) -> Vec<usize> {
        let screen = Screen::new(camera, self.depth.width(), self.depth.height());
        self.depth.clear();
        let mut visible = Vec::new();
        for (_, i) in front_to_back(objects, in_frustum, camera.eye) {
            let object = &objects[i];
            let seen = screen.rectangle(bounds(&object.shape)).is_none_or(|r| self.depth.sees(&r));
            if seen {
                visible.push(i);
                if object.occludes {
                    self.draw(&object.shape, &screen, camera.eye);
                }
            }
        }
        visible
    }

    /// Draws the objects given, none tested: a depth buffer without any culling but of back faces.
    pub fn draw_all(&mut self, objects: &[Object], given: impl IntoIterator<Item = usize>, camera: &Camera) {
        let screen = Screen::new(camera, self.depth.width(), self.depth.height());
        self.depth.clear();
        for object in given.into_iter().filter_map(|i| objects.get(i)) {
            self.draw(&object.shape, &screen, camera.eye);
        }
    }

    fn draw(&mut self, shape: &Shape, screen: &Screen, eye: Vec3) {
        let mut clip = std::mem::take(&mut self.clip);
        clip.clear();
        match shape {
            Shape::Sphere { center, radius } => {
                let distance = center.distance(eye);
                if distance <= *radius {
                    self.clip = clip;
                    return;
                }
                let scale = screen.matrix.row(1).truncate().length() * screen.height * 0.5;
                let pixels = radius / distance * scale;
                if pixels >= 1.0 {
                    let (points, triangles) = if pixels < COARSE { &self.coarse } else { &self.fine };
                    clip.extend(points.iter().map(|&p| screen.clip(*center + p * *radius)));
                    for t in triangles {
                        triangle(&mut self.depth, screen, t.map(|v| clip[usize::from(v)]), true);
                    }
                }
            }
            Shape::Box { min, max } => {
                clip.extend((0..8).map(|i| {
                    screen.clip(Vec3::new(
                        if i & 1 == 0 { min.x } else { max.x },
                        if i & 2 == 0 { min.y } else { max.y },
                        if i & 4 == 0 { min.z } else { max.z },
                    ))
                }));
                for t in BOX {
                    triangle(&mut self.depth, screen, t.map(|v| clip[usize::from(v)]), true);
                }
            }
            Shape::Mesh { mesh, transform } => {
                clip.extend(mesh.positions.iter().map(|&p| screen.clip(transform.transform_point3(p))));
                for t in &mesh.triangles {
                    triangle(&mut self.depth, screen, t.map(|v| clip[v as usize]), false);
                }
            }
        }
        self.clip = clip;
    }
}

/// Clips a triangle at the near plane and fills what is left.
fn triangle(depth: &mut DepthPyramid, screen: &Screen, corners: [Vec4; 3], cull: bool) {
    if corners.iter().all(|c| c.w >= screen.near) {
        return fill(depth, corners.map(|c| screen.project(c)), cull);
    }
    let mut kept: [Vec4; 4] = [Vec4::ZERO; 4];
    let mut count = 0;
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.w >= screen.near {
            kept[count] = a;
            count += 1;
        }
        if (a.w >= screen.near) != (b.w >= screen.near) {
            kept[count] = a + (b - a) * ((screen.near - a.w) / (b.w - a.w));
            count += 1;
        }
    }
    for i in 2..count {
        fill(depth, [kept[0], kept[i - 1], kept[i]].map(|c| screen.project(c)), cull);
    }
}

/// Writes the pixels whose centres lie in a triangle where it is nearer.
fn fill(depth: &mut DepthPyramid, corners: [Vec3; 3], cull: bool) {
    let [a, mut b, mut c] = corners;
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    // With y down, fronts are clockwise.
    if area.is_nan() || area.abs() <= 1e-12 || cull && area > 0.0 {
        return;
    }
    let inverse = 1.0 / area;
    let dx = ((b.z - a.z) * (c.y - a.y) - (c.z - a.z) * (b.y - a.y)) * inverse;
    let dy = ((c.z - a.z) * (b.x - a.x) - (b.z - a.z) * (c.x - a.x)) * inverse;
    if area < 0.0 {
        std::mem::swap(&mut b, &mut c);
    }
    let low = a.y.min(b.y).min(c.y);
    let high = a.y.max(b.y).max(c.y);
    let y0 = (low - 0.5).ceil().max(0.0) as usize;
    let y1 = (high + 0.5).floor().clamp(0.0, depth.height() as f32) as usize;
    let width = depth.width() as f32;
    let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| (p.y > q.y, p, (q.x - p.x) / (q.y - p.y), p.y == q.y));
    for y in y0..y1 {
        let at = y as f32 + 0.5;
        let (mut lo, mut hi) = (0.0f32, width);
        for &(up, p, slope, flat) in &edges {
            if flat {
                continue;
            }
            let x = p.x + (at - p.y) * slope;
            // Going up the screen, the inside lies to the right.
            if up { lo = lo.max(x) } else { hi = hi.min(x) }
        }
        let x0 = (lo - 0.5).ceil().max(0.0) as usize;
        let x1 = (hi + 0.5).floor().clamp(0.0, width) as usize;
        if x0 >= x1 {
            continue;
        }
        let start = a.z + (x0 as f32 + 0.5 - a.x) * dx + (at - a.y) * dy;
        for (i, n) in depth.row(y, x0, x1).iter_mut().enumerate() {
            *n = n.max(start + i as f32 * dx);
        }
    }
}
