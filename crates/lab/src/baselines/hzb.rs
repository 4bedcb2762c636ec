//! Rasterised depth, front to back.

use glam::{Vec3, Vec4};

use super::{DepthPyramid, Screen, bounds, front_to_back};
use crate::world::{BOX_TRIANGLES, Camera, Mesh, Object, Shape, box_corners};

/// Spheres whose radius is less than this many pixels are drawn with 80 triangles
/// instead of 320, and below a pixel not at all.
const COARSE: f32 = 12.0;

/// A software occlusion buffer.
pub struct Hzb {
    depth: DepthPyramid,
    fine: Mesh,
    coarse: Mesh,
    clip: Vec<Vec4>,
}

impl Hzb {
    /// A buffer of `width` by `height` pixels.
    pub fn new(width: usize, height: usize) -> Self {
        let (fine, coarse) = (Mesh::ball(2), Mesh::ball(1));
        Self { depth: DepthPyramid::new(width, height), fine, coarse, clip: Vec::new() }
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
                    let ball = if pixels < COARSE { &self.coarse } else { &self.fine };
                    clip.extend(ball.positions.iter().map(|&p| screen.clip(*center + p * *radius)));
                    for t in &ball.triangles {
                        triangle(&mut self.depth, screen, t.map(|v| clip[v as usize]), true);
                    }
                }
            }
            Shape::Box { min, max } => {
                clip.extend(box_corners(*min, *max).map(|corner| screen.clip(corner)));
                for t in BOX_TRIANGLES {
                    triangle(&mut self.depth, screen, t.map(|v| clip[v as usize]), true);
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
