//! Rasterised depth, front to back.

mod raster;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch, f32x8};
use glam::{Affine3A, Vec3, Vec4};

use self::raster::{Corners, Sides, draw};
use super::DepthPyramid;
use super::models::{Block, Model, Models};
use super::screen::{Boxes, Screen};
use casca_scenes::world::{Camera, Mesh, Object, Shape};

/// Spheres whose radius is less than this many pixels are drawn with 80 triangles
/// instead of 320, and below a pixel not at all.
const COARSE: f32 = 12.0;

/// The solids, and what drawing needs in between.
struct Pen {
    fine: Model,
    coarse: Model,
    cube: Model,
    /// Columns, rows and nearness of the vertices of the mesh being drawn; nearness -1 in front of
    /// the near plane.
    projected: Vec<Block>,
}

/// A software occlusion buffer.
pub struct Hzb {
    depth: DepthPyramid,
    models: Models,
    boxes: Boxes,
    order: Vec<u64>,
    pen: Pen,
}

impl Hzb {
    /// A buffer of `width` by `height` pixels.
    pub fn new(width: usize, height: usize) -> Self {
        let model = |mesh: Mesh| Model::new(&mesh);
        Self {
            depth: DepthPyramid::new(width, height),
            models: Models::default(),
            boxes: Boxes::default(),
            order: Vec::new(),
            pen: Pen {
                fine: model(Mesh::ball(2)),
                coarse: model(Mesh::ball(1)),
                cube: model(Mesh::cuboid(Vec3::ZERO, Vec3::ONE)),
                projected: Vec::new(),
            },
        }
    }

    /// The buffer as the last frame left it.
    #[cfg(test)]
    pub(super) fn depth(&self) -> &DepthPyramid {
        &self.depth
    }

    /// Which of the objects given are visible, front to back. Each that occludes is tested and, if
    /// the buffer does not hide it, drawn before the next one; then those are tested once more, and
    /// all others.
    pub fn frame(&mut self, objects: &[Object], in_frustum: &[usize], camera: &Camera) -> Vec<usize> {
        let screen = self.begin(objects, in_frustum, camera);
        self.depth.clear();
        let Self { depth, models, boxes, order, pen } = self;
        let mut visible = Vec::with_capacity(order.len());
        dispatch!(depth.level(), simd => {
            boxes.project(simd, &screen);
            boxes.front_to_back(order);
            let mut open = Vec::with_capacity(order.len());
            for key in order.iter() {
                let number = *key as u32 as usize;
                let index = in_frustum[number];
                let object = &objects[index];
                if object.occludes {
                    if depth.hides_in(simd, &boxes.rects[number]) {
                        continue;
                    }
                    pen.draw(simd, depth, models, &screen, index, &object.shape);
                }
                open.push(number);
            }
            for number in open {
                if !depth.hides_in(simd, &boxes.rects[number]) {
                    visible.push(in_frustum[number]);
                }
            }
        });
        visible
    }

    /// Draws the objects given, none tested: a depth buffer without any culling but of backs.
    pub fn draw_all(&mut self, objects: &[Object], given: impl IntoIterator<Item = usize>, camera: &Camera) {
        let given: Vec<usize> = given.into_iter().filter(|&i| i < objects.len()).collect();
        let screen = self.begin(objects, &given, camera);
        self.depth.clear();
        let Self { depth, models, pen, .. } = self;
        dispatch!(depth.level(), simd => {
            for &index in &given {
                pen.draw(simd, depth, models, &screen, index, &objects[index].shape);
            }
        });
    }

    /// Collects the boxes.
    fn begin(&mut self, objects: &[Object], given: &[usize], camera: &Camera) -> Screen {
        let models = &mut self.models;
        models.prepare(objects);
        self.boxes.fill(given.iter().map(|&i| models.bounds(i, &objects[i].shape)));
        Screen::new(camera, self.depth.width(), self.depth.height())
    }
}

impl Pen {
    #[inline(always)]
    fn draw<S: Simd>(
        &mut self,
        simd: S,
        depth: &mut DepthPyramid,
        models: &mut Models,
        screen: &Screen,
        index: usize,
        shape: &Shape,
    ) {
        let Self { fine, coarse, cube, projected } = self;
        let (model, transform): (&Model, Affine3A) = match shape {
            Shape::Sphere { center, radius } => {
                let distance = center.distance(screen.eye);
                let pixels = radius / distance * screen.scale;
                if distance <= *radius || pixels < 1.0 {
                    return;
                }
                let ball = if pixels < COARSE { coarse } else { fine };
                (ball, scaled(Vec3::splat(*radius), *center))
            }
            Shape::Box { min, max } => (cube, scaled(*max - *min, *min)),
            Shape::Mesh { mesh, transform } => (models.model(index, mesh), *transform),
        };
        simd.vectorize(
            #[inline(always)]
            || draw_model(simd, depth, screen, model, &transform, projected),
        );
    }
}

fn scaled(size: Vec3, at: Vec3) -> Affine3A {
    Affine3A::from_mat3_translation(glam::Mat3::from_diagonal(size), at)
}

/// Draws all triangles of a model.
#[inline(always)]
fn draw_model<S: Simd>(
    simd: S,
    depth: &mut DepthPyramid,
    screen: &Screen,
    model: &Model,
    transform: &Affine3A,
    projected: &mut Vec<Block>,
) {
    let rows = screen.rows_from(transform);
    let sides = match (model.closed, transform.matrix3.determinant() >= 0.0) {
        (false, _) => Sides::Both,
        (true, true) => Sides::Clockwise,
        (true, false) => Sides::CounterClockwise,
    };
    let crosses = project(simd, &rows, screen.near, &model.vertices, projected);
    let mut clipped = Clipped::default();
    for triangles in model.triangles.chunks(8) {
        let mut corners = Corners::default();
        for (i, triangle) in triangles.iter().enumerate() {
            for (k, &v) in triangle.iter().enumerate() {
                let (block, lane) = (&projected[v as usize >> 3], v as usize & 7);
                corners.x[k][i & 7] = block[0][lane];
                corners.y[k][i & 7] = block[1][lane];
                corners.near[k][i & 7] = block[2][lane];
            }
        }
        draw(simd, depth, &corners, sides);
        if crosses {
            for (i, triangle) in triangles.iter().enumerate() {
                let behind = (0..3).filter(|&k| corners.near[k][i & 7] < 0.0).count();
                if behind == 1 || behind == 2 {
                    clipped.push(
                        triangle.map(|v| {
                            let p = model.vertex(v).extend(1.0);
                            Vec3::from_array(rows.map(|row: Vec4| row.dot(p)))
                        }),
                        screen.near,
                    );
                    if clipped.is_full() {
                        draw(simd, depth, &clipped.take(), sides);
                    }
                }
            }
        }
    }
    if crosses {
        draw(simd, depth, &clipped.take(), sides);
    }
}

/// Projects vertices; returns whether one lies in front of the near plane.
#[inline(always)]
fn project<S: Simd>(simd: S, rows: &[Vec4; 3], near: f32, vertices: &[Block], out: &mut Vec<Block>) -> bool {
    out.resize(vertices.len(), [[0.0; 8]; 3]);
    let none = f32x8::splat(simd, -1.0);
    let mut crosses = false;
    for (block, out) in vertices.iter().zip(out.iter_mut()) {
        let [x, y, z] = block.each_ref().map(|lanes| f32x8::from_slice(simd, lanes));
        let [px, py, w] = rows.map(|row| x * row.x + (y * row.y + (z * row.z + row.w)));
        let inverse = 1.0 / w;
        let behind = w.simd_lt(near);
        crosses |= behind.any_true();
        (px * inverse).store_slice(&mut out[0]);
        (py * inverse).store_slice(&mut out[1]);
        behind.select(none, inverse).store_slice(&mut out[2]);
    }
    crosses
}

/// Triangles cut at the near plane, until there are eight.
#[derive(Default)]
struct Clipped {
    corners: Corners,
    count: usize,
}

impl Clipped {
    /// Whether another triangle might not find room: it leaves one or two.
    fn is_full(&self) -> bool {
        self.count > 6
    }

    fn take(&mut self) -> Corners {
        std::mem::take(self).corners
    }

    /// Adds the part of a triangle behind the near plane. Corners are x and y times depth, and
    /// depth.
    fn push(&mut self, corners: [Vec3; 3], near: f32) {
        let mut kept = [Vec3::ZERO; 4];
        let mut count = 0;
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if a.z >= near {
                kept[count] = a;
                count += 1;
            }
            if (a.z >= near) != (b.z >= near) {
                kept[count] = (a + (b - a) * ((near - a.z) / (b.z - a.z))).with_z(near);
                count += 1;
            }
        }
        for i in 2..count {
            for (k, p) in [kept[0], kept[i - 1], kept[i]].into_iter().enumerate() {
                self.corners.x[k][self.count] = p.x / p.z;
                self.corners.y[k][self.count] = p.y / p.z;
                self.corners.near[k][self.count] = 1.0 / p.z;
            }
            self.count += 1;
        }
    }
}
