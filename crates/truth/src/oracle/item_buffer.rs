//! The nearest object at every pixel, found analytically.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::frustum::Frustum;
use super::geometry::{MeshCache, Primitive, safe_inverse};
use casca_scenes::world::{Camera, Object, Shape};

/// No object.
pub const NONE: u32 = u32::MAX;

/// Edge of a tile in pixels.
const TILE: usize = 16;
/// Pixels of a tile.
const AREA: usize = TILE * TILE;
/// By how much screen rectangles are widened against rounding, in pixels.
const SLACK: f64 = 1e-6;

/// An exact item buffer: for each pixel the nearest occluder along the ray
/// through the pixel's centre, and how many pixels show each object.
///
/// - All in f64, from the exact eye. Triangles that share an edge leave no
///   gap, nor do abutting boxes.
/// - Depth is in metres along the camera's forward axis. What lies nearer
///   than the near plane or beyond the far plane is neither seen nor hides.
/// - Spheres and boxes are solid and seen from outside only: one that holds
///   the eye, or the point where a pixel's ray leaves the near plane, neither
///   shows nor hides there. One that holds the eye of a perspective camera
///   and reaches beyond the near plane counts as visible all the same.
/// - Meshes are two-sided surfaces.
/// - The nearest wins; at exactly equal depth the lower index.
///
/// The result does not depend on the number of threads.
#[derive(Debug, Default)]
pub struct ItemBuffer {
    width: usize,
    height: usize,
    index: Vec<u32>,
    depth: Vec<f64>,
    visible: Vec<u32>,
    holding_eye: Vec<u32>,
    meshes: MeshCache,
}

/// The rays through pixel centres: affine in pixel coordinates.
#[derive(Debug, Clone, Copy)]
struct PixelRays {
    perspective: bool,
    /// Start of the ray relative to the eye, at depth 0: value at (0, 0) and
    /// steps per pixel in x and y.
    start: [DVec3; 3],
    /// Way per metre of depth.
    step: [DVec3; 3],
    forward: DVec3,
    near: f64,
    far: f64,
}

impl PixelRays {
    fn new(frustum: &Frustum, width: usize, height: usize) -> Self {
        let (dx, dy) = (2.0 / width as f64, -2.0 / height as f64);
        let (start, step) = frustum.ray(-1.0 + 0.5 * dx, 1.0 + 0.5 * dy);
        let (start_x, step_x) = frustum.ray(0.0, 0.0);
        let (right, step_right) = frustum.ray(1.0, 0.0);
        let (up, step_up) = frustum.ray(0.0, 1.0);
        Self {
            perspective: frustum.is_perspective(),
            start: [start, (right - start_x) * dx, (up - start_x) * dy],
            step: [step, (step_right - step_x) * dx, (step_up - step_x) * dy],
            forward: frustum.forward(),
            near: frustum.near(),
            far: frustum.far(),
        }
    }

    /// Depth of a point relative to the eye.
    fn depth(&self, relative: DVec3) -> f64 {
        self.forward.dot(relative)
    }

    fn start(&self, x: usize, y: usize) -> DVec3 {
        self.start[0] + self.start[2] * y as f64 + self.start[1] * x as f64
    }

    fn step(&self, x: usize, y: usize) -> DVec3 {
        self.step[0] + self.step[2] * y as f64 + self.step[1] * x as f64
    }
}

/// Something to draw: a solid, or a triangle of a mesh.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// At most its least depth behind the near plane.
    near: f32,
    object: u32,
    /// Triangle of the mesh.
    triangle: u32,
    /// Which of the meshes in view.
    slot: u32,
    /// First and last pixel: x, y, x, y.
    rect: [u16; 4],
}

/// Entries by tile.
#[derive(Debug, Default)]
struct Bins {
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Bins {
    fn new(entries: &[Entry], columns: usize, rows: usize) -> Self {
        let mut starts = vec![0_u32; columns * rows + 1];
        let tiles = |entry: &Entry| {
            let [x0, y0, x1, y1] = entry.rect.map(|v| usize::from(v) / TILE);
            (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * columns + x))
        };
        for entry in entries {
            tiles(entry).for_each(|tile| starts[tile + 1] += 1);
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut list = vec![0_u32; starts[columns * rows] as usize];
        let mut next = starts.clone();
        for (i, entry) in entries.iter().enumerate() {
            tiles(entry).for_each(|tile| {
                list[next[tile] as usize] = i as u32;
                next[tile] += 1;
            });
        }
        Self { starts, entries: list }
    }

    fn of(&self, tile: usize) -> &[u32] {
        &self.entries[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

/// Everything to draw in one frame.
struct Frame<'a> {
    objects: &'a [Object],
    rays: PixelRays,
    /// Vertices relative to the eye, for each mesh in view.
    meshes: Vec<Vec<DVec3>>,
    eye: DVec3,
}

impl ItemBuffer {
    /// An empty buffer of `width` times `height` pixels, each at most 65,535.
    pub fn new(width: usize, height: usize) -> Self {
        assert!(width <= 65_535 && height <= 65_535, "at most 65,535 pixels a side");
        Self {
            width,
            height,
            index: vec![NONE; width * height],
            depth: vec![f64::INFINITY; width * height],
            ..Self::default()
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The nearest occluder at each pixel, row by row from the top left;
    /// [`NONE`] where there is none.
    pub fn items(&self) -> &[u32] {
        &self.index
    }

    /// The depth of the nearest occluder at each pixel: metres along the
    /// camera's forward axis, infinite where there is none.
    pub fn depths(&self) -> &[f64] {
        &self.depth
    }

    /// For each object the number of pixels that show it. For an occluder,
    /// those where it is nearest; for others, those where no occluder is
    /// nearer. One that holds the eye has at least 1. Objects that neither
    /// hide nor are tested have 0.
    pub fn visible(&self) -> &[u32] {
        &self.visible
    }

    /// The solids that hold the eye and are counted visible for that.
    pub fn holding_eye(&self) -> &[u32] {
        &self.holding_eye
    }

    /// Draws `objects` as seen by `camera`.
    pub fn render(&mut self, objects: &[Object], camera: &Camera) {
        let (width, height) = (self.width, self.height);
        self.meshes.learn(objects);
        self.visible.clear();
        self.visible.resize(objects.len(), 0);
        self.holding_eye.clear();
        if width == 0 || height == 0 {
            return;
        }
        let frustum = Frustum::new(camera);
        let rays = PixelRays::new(&frustum, width, height);
        let setup = Setup { frustum: &frustum, rays, width, height };

        let mut entries: Vec<Entry> =
            objects.par_iter().enumerate().filter_map(|(i, object)| setup.solid(i as u32, object)).collect();
        let in_view: Vec<u32> = objects
            .par_iter()
            .enumerate()
            .filter(|(_, object)| setup.mesh_in_view(object, &self.meshes))
            .map(|(i, _)| i as u32)
            .collect();
        let drawn: Vec<(Vec<DVec3>, Vec<Entry>)> = in_view
            .par_iter()
            .enumerate()
            .map(|(slot, &object)| setup.mesh(object, slot as u32, &objects[object as usize]))
            .collect();
        let mut meshes = Vec::with_capacity(drawn.len());
        for (vertices, triangles) in drawn {
            meshes.push(vertices);
            entries.extend(triangles);
        }
        let frame = Frame { objects, rays, meshes, eye: frustum.eye() };

        let (mut hiding, mut others): (Vec<Entry>, Vec<Entry>) =
            entries.into_iter().partition(|entry| objects[entry.object as usize].occludes);
        // Front to back; what does not hide is kept together by object.
        hiding.par_sort_unstable_by_key(|entry| (entry.near.to_bits(), entry.object, entry.triangle));
        others.par_sort_unstable_by_key(|entry| (entry.object, entry.triangle));
        let columns = width.div_ceil(TILE);
        let rows = height.div_ceil(TILE);
        let (hiding_bins, other_bins) =
            rayon::join(|| Bins::new(&hiding, columns, rows), || Bins::new(&others, columns, rows));

        let counts: Vec<AtomicU32> = objects.iter().map(|_| AtomicU32::new(0)).collect();
        self.index
            .par_chunks_mut(width * TILE)
            .zip(self.depth.par_chunks_mut(width * TILE))
            .enumerate()
            .for_each(|(row, (index, depth))| {
                let mut tile = Tile::new();
                for column in 0..columns {
                    let number = row * columns + column;
                    tile.reset(column * TILE, row * TILE, width, height);
                    for &i in hiding_bins.of(number) {
                        let entry = &hiding[i as usize];
                        if f64::from(entry.near) + rays.near > tile.farthest {
                            break;
                        }
                        tile.draw(&frame, entry);
                    }
                    tile.count(&counts);
                    tile.show(&frame, &others, other_bins.of(number), &counts);
                    for y in 0..tile.rows {
                        let from = y * TILE..y * TILE + tile.columns;
                        let to = y * width + tile.x..y * width + tile.x + tile.columns;
                        index[to.clone()].copy_from_slice(&tile.index[from.clone()]);
                        depth[to].copy_from_slice(&tile.depth[from]);
                    }
                }
            });
        self.visible.clear();
        self.visible.extend(counts.into_iter().map(AtomicU32::into_inner));

        if rays.perspective {
            self.holding_eye = objects
                .par_iter()
                .enumerate()
                .filter(|(_, object)| setup.holds_eye(object))
                .map(|(i, _)| i as u32)
                .collect();
            for &i in &self.holding_eye {
                self.visible[i as usize] = self.visible[i as usize].max(1);
            }
        }
    }

    /// The ray through the centre of a pixel of a buffer of this size: where
    /// it leaves the near plane, and its way per metre of depth.
    pub(super) fn pixel_ray(&self, frustum: &Frustum, pixel: usize) -> (DVec3, DVec3) {
        let rays = PixelRays::new(frustum, self.width, self.height);
        let (x, y) = (pixel % self.width, pixel / self.width);
        let step = rays.step(x, y);
        (frustum.eye() + rays.start(x, y) + step * rays.near, step)
    }

    /// The first and last pixel (x, y, x, y) an object may cover.
    pub(super) fn rectangle(&self, frustum: &Frustum, object: &Object) -> Option<[u16; 4]> {
        let setup = Setup {
            frustum,
            rays: PixelRays::new(frustum, self.width, self.height),
            width: self.width,
            height: self.height,
        };
        match object.shape {
            Shape::Mesh { .. } => {
                let (min, max) = self.meshes.bounds(&object.shape);
                setup.box_rect(min - frustum.eye(), max - frustum.eye()).map(|(rect, _)| rect)
            }
            _ => setup.solid(0, object).map(|entry| entry.rect),
        }
    }
}

/// Finds what to draw, and where on the screen.
struct Setup<'a> {
    frustum: &'a Frustum,
    rays: PixelRays,
    width: usize,
    height: usize,
}

impl Setup<'_> {
    fn solid(&self, index: u32, object: &Object) -> Option<Entry> {
        let is_mesh = matches!(object.shape, Shape::Mesh { .. });
        if is_mesh || (!object.occludes && !object.tested) || !Primitive::of(&object.shape, 0).is_sound() {
            return None;
        }
        let eye = self.frustum.eye();
        let (rect, near) = match object.shape {
            Shape::Sphere { center, radius } => {
                let (center, radius) = (center.as_dvec3() - eye, f64::from(radius));
                let depth = self.frustum.forward().dot(center);
                if depth + radius < self.rays.near || !self.frustum.may_meet_sphere(center + eye, radius) {
                    return None;
                }
                let range = |axis| self.frustum.sphere_range(center, radius, axis);
                if let (Some(x), Some(y)) = (range(0), range(1)) {
                    (self.rect([x[0], y[0]], [x[1], y[1]])?, depth - radius)
                } else {
                    (self.box_rect(center - radius, center + radius)?.0, depth - radius)
                }
            }
            Shape::Box { min, max } => self.box_rect(min.as_dvec3() - eye, max.as_dvec3() - eye)?,
            Shape::Mesh { .. } => return None,
        };
        Some(Entry { near: self.key(near)?, object: index, triangle: 0, slot: 0, rect })
    }

    fn mesh_in_view(&self, object: &Object, meshes: &MeshCache) -> bool {
        if !matches!(object.shape, Shape::Mesh { .. }) || (!object.occludes && !object.tested) {
            return false;
        }
        let (min, max) = meshes.bounds(&object.shape);
        min.cmple(max).all() && self.frustum.may_meet_box(min, max)
    }

    /// Vertices relative to the eye, and the triangles on screen.
    fn mesh(&self, object: u32, slot: u32, shape: &Object) -> (Vec<DVec3>, Vec<Entry>) {
        let Shape::Mesh { mesh, transform } = &shape.shape else { return (Vec::new(), Vec::new()) };
        let transform = transform.as_daffine3();
        let eye = self.frustum.eye();
        let forward = self.frustum.forward();
        let clip = self.clip_depth();
        // Relative to the eye; on the screen in pixels; depth.
        let projected: Vec<(DVec3, [f64; 2], f64)> = mesh
            .positions
            .par_iter()
            .with_min_len(4096)
            .map(|position| {
                let relative = transform.transform_point3(position.as_dvec3()) - eye;
                (relative, self.pixel(self.frustum.project(relative)), forward.dot(relative))
            })
            .collect();
        let entries = mesh
            .triangles
            .par_iter()
            .enumerate()
            .with_min_len(4096)
            .filter_map(|(i, triangle)| {
                let corners = triangle.map(|v| &projected[v as usize]);
                let depths = corners.map(|c| c.2);
                let near = depths[0].min(depths[1]).min(depths[2]);
                let far = depths[0].max(depths[1]).max(depths[2]);
                if far < self.rays.near {
                    return None;
                }
                let rect = if near >= clip {
                    let [a, b, c] = corners.map(|c| c.1);
                    self.pixels(
                        [a[0].min(b[0]).min(c[0]), a[1].min(b[1]).min(c[1])],
                        [a[0].max(b[0]).max(c[0]), a[1].max(b[1]).max(c[1])],
                    )?
                } else {
                    let points = corners.map(|c| c.0);
                    self.clipped_rect(&points, &[(0, 1), (1, 2), (2, 0)])?
                };
                Some(Entry { near: self.key(near)?, object, triangle: i as u32, slot, rect })
            })
            .collect();
        (projected.into_iter().map(|(relative, ..)| relative).collect(), entries)
    }

    /// The rectangle and the least depth of a box given relative to the eye.
    fn box_rect(&self, min: DVec3, max: DVec3) -> Option<([u16; 4], f64)> {
        const EDGES: [(usize, usize); 12] =
            [(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7)];
        let corners: [DVec3; 8] = std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
        });
        let forward = self.frustum.forward();
        let depths = corners.map(|corner| forward.dot(corner));
        let near = depths.into_iter().fold(f64::INFINITY, f64::min);
        let far = depths.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if far < self.rays.near || near > self.rays.far {
            return None;
        }
        Some((self.clipped_rect(&corners, &EDGES)?, near))
    }

    /// Points nearer than this cannot be projected.
    fn clip_depth(&self) -> f64 {
        if self.rays.perspective { self.rays.near } else { f64::NEG_INFINITY }
    }

    fn clipped_rect(&self, points: &[DVec3], edges: &[(usize, usize)]) -> Option<[u16; 4]> {
        let clip = self.clip_depth();
        let forward = self.frustum.forward();
        let mut min = [f64::INFINITY; 2];
        let mut max = [f64::NEG_INFINITY; 2];
        let mut add = |point: DVec3| {
            let at = self.frustum.project(point);
            for axis in 0..2 {
                min[axis] = min[axis].min(at[axis]);
                max[axis] = max[axis].max(at[axis]);
            }
        };
        for &point in points {
            if forward.dot(point) >= clip {
                add(point);
            }
        }
        for &(a, b) in edges {
            let (a, b) = (points[a], points[b]);
            let (da, db) = (forward.dot(a), forward.dot(b));
            if (da < clip) != (db < clip) {
                add(a + (b - a) * ((clip - da) / (db - da)));
            }
        }
        self.rect(min, max)
    }

    fn pixel(&self, at: [f64; 2]) -> [f64; 2] {
        [(at[0] + 1.0) * 0.5 * self.width as f64, (1.0 - at[1]) * 0.5 * self.height as f64]
    }

    /// Pixels whose centre is in the range, given in device coordinates.
    fn rect(&self, min: [f64; 2], max: [f64; 2]) -> Option<[u16; 4]> {
        let (a, b) = (self.pixel(min), self.pixel(max));
        self.pixels([a[0], b[1]], [b[0], a[1]])
    }

    /// Pixels whose centre is in the range, given in pixels.
    fn pixels(&self, min: [f64; 2], max: [f64; 2]) -> Option<[u16; 4]> {
        let x0 = (min[0] - 0.5 - SLACK).ceil().max(0.0);
        let y0 = (min[1] - 0.5 - SLACK).ceil().max(0.0);
        let x1 = (max[0] - 0.5 + SLACK).floor().min(self.width as f64 - 1.0);
        let y1 = (max[1] - 0.5 + SLACK).floor().min(self.height as f64 - 1.0);
        (x0 <= x1 && y0 <= y1).then_some([x0 as u16, y0 as u16, x1 as u16, y1 as u16])
    }

    /// The key to sort by; None beyond the far plane.
    fn key(&self, near: f64) -> Option<f32> {
        (near <= self.rays.far).then(|| ((near - self.rays.near) * (1.0 - 1e-6)).max(0.0) as f32)
    }

    /// Whether a tested solid holds the eye and reaches beyond the near plane
    /// in view.
    fn holds_eye(&self, object: &Object) -> bool {
        if !object.tested {
            return false;
        }
        let eye = self.frustum.eye();
        let leave: Box<dyn Fn(DVec3) -> f64> = match object.shape {
            Shape::Sphere { center, radius } => {
                let to_center = center.as_dvec3() - eye;
                let outside = to_center.length_squared() - f64::from(radius) * f64::from(radius);
                if outside >= 0.0 {
                    return false;
                }
                Box::new(move |step| {
                    let (a, b) = (step.length_squared(), step.dot(to_center));
                    (b + (b * b - a * outside).sqrt()) / a
                })
            }
            Shape::Box { min, max } => {
                let (low, high) = (min.as_dvec3() - eye, max.as_dvec3() - eye);
                if !(low.max_element() < 0.0 && high.min_element() > 0.0) {
                    return false;
                }
                Box::new(move |step| {
                    let inverse = safe_inverse(step);
                    (low * inverse).max(high * inverse).min_element()
                })
            }
            Shape::Mesh { .. } => return false,
        };
        let (w, h) = (self.width - 1, self.height - 1);
        [(0, 0), (w, 0), (0, h), (w, h), (w / 2, h / 2)]
            .into_iter()
            .any(|(x, y)| leave(self.rays.step(x, y)) >= self.rays.near)
    }
}

/// The pixels being drawn.
struct Tile {
    x: usize,
    y: usize,
    columns: usize,
    rows: usize,
    depth: [f64; AREA],
    index: [u32; AREA],
    /// Pixels without an occluder.
    bare: usize,
    /// No pixel is farther than this.
    farthest: f64,
    /// Draws since `farthest` was found.
    age: u32,
    /// One over the steps of the rays, once `inverted`.
    inverse: Box<[DVec3; AREA]>,
    inverted: bool,
}

impl Tile {
    fn new() -> Self {
        Self {
            x: 0,
            y: 0,
            columns: 0,
            rows: 0,
            depth: [f64::INFINITY; AREA],
            index: [NONE; AREA],
            bare: 0,
            farthest: f64::INFINITY,
            age: 0,
            inverse: Box::new([DVec3::ZERO; AREA]),
            inverted: false,
        }
    }

    fn reset(&mut self, x: usize, y: usize, width: usize, height: usize) {
        self.x = x;
        self.y = y;
        self.columns = TILE.min(width - x);
        self.rows = TILE.min(height - y);
        self.depth.fill(f64::INFINITY);
        self.index.fill(NONE);
        self.bare = self.columns * self.rows;
        self.farthest = f64::INFINITY;
        self.age = 7;
        self.inverted = false;
    }

    /// Draws an occluder.
    fn draw(&mut self, frame: &Frame, entry: &Entry) {
        self.prepare(frame, entry);
        let object = entry.object;
        let Self { depth, index, bare, inverse, .. } = self;
        let area = Area { x: self.x, y: self.y, columns: self.columns, rows: self.rows };
        trace(&area, inverse, frame, entry, |pixel, t| {
            let old = depth[pixel];
            if t < old || (t == old && object < index[pixel]) {
                *bare -= usize::from(index[pixel] == NONE);
                depth[pixel] = t;
                index[pixel] = object;
            }
        });
        if self.bare == 0 {
            self.age += 1;
            if self.age >= 8 {
                self.age = 0;
                self.farthest = (0..self.rows)
                    .flat_map(|y| &self.depth[y * TILE..y * TILE + self.columns])
                    .fold(f64::NEG_INFINITY, |a, &b| if b > a { b } else { a });
            }
        }
    }

    /// Computes what boxes need.
    fn prepare(&mut self, frame: &Frame, entry: &Entry) {
        if self.inverted || !matches!(frame.objects[entry.object as usize].shape, Shape::Box { .. }) {
            return;
        }
        self.inverted = true;
        for y in 0..self.rows {
            for x in 0..self.columns {
                self.inverse[y * TILE + x] = safe_inverse(frame.rays.step(self.x + x, self.y + y));
            }
        }
    }

    /// Counts the pixels of the occluders.
    fn count(&self, counts: &[AtomicU32]) {
        for y in 0..self.rows {
            for run in self.index[y * TILE..y * TILE + self.columns].chunk_by(|a, b| a == b) {
                if run[0] != NONE {
                    counts[run[0] as usize].fetch_add(run.len() as u32, Ordering::Relaxed);
                }
            }
        }
    }

    /// Counts the pixels of what does not hide, once the occluders are drawn.
    fn show(&mut self, frame: &Frame, entries: &[Entry], list: &[u32], counts: &[AtomicU32]) {
        let area = Area { x: self.x, y: self.y, columns: self.columns, rows: self.rows };
        for group in list.chunk_by(|&a, &b| entries[a as usize].object == entries[b as usize].object) {
            let mut seen = [false; AREA];
            for &i in group {
                let entry = &entries[i as usize];
                self.prepare(frame, entry);
                let (depth, inverse) = (&self.depth, &self.inverse);
                trace(&area, inverse, frame, entry, |pixel, t| seen[pixel] |= t <= depth[pixel]);
            }
            let count = seen.iter().filter(|&&seen| seen).count() as u32;
            if count > 0 {
                counts[entries[group[0] as usize].object as usize].fetch_add(count, Ordering::Relaxed);
            }
        }
    }
}

/// Where a tile lies.
struct Area {
    x: usize,
    y: usize,
    columns: usize,
    rows: usize,
}

/// Calls `plot` with each pixel of the tile whose ray hits the entry, and the
/// depth of the hit.
#[inline(always)]
fn trace(
    area: &Area,
    inverse: &[DVec3; AREA],
    frame: &Frame,
    entry: &Entry,
    mut plot: impl FnMut(usize, f64),
) {
    let [left, top, right, bottom] = entry.rect.map(usize::from);
    let columns = left.max(area.x)..(right + 1).min(area.x + area.columns);
    let rows = top.max(area.y)..(bottom + 1).min(area.y + area.rows);
    let rays = &frame.rays;
    let (near, far) = (rays.near, rays.far);
    let place = |x: usize, y: usize| (y - area.y) * TILE + (x - area.x);
    match frame.objects[entry.object as usize].shape {
        Shape::Sphere { center, radius } => {
            let center = center.as_dvec3() - frame.eye;
            let squared = f64::from(radius) * f64::from(radius);
            let slope = if rays.perspective { DVec3::ZERO } else { rays.start[1] };
            for y in rows {
                // a t^2 - 2 b t + c = 0, with a, b and c polynomials in x.
                let step = rays.step(0, y);
                let to_center = center - rays.start(0, y);
                let (a0, a1, a2) =
                    (step.length_squared(), 2.0 * step.dot(rays.step[1]), rays.step[1].length_squared());
                let (b0, b1) = (step.dot(to_center), rays.step[1].dot(to_center) - step.dot(slope));
                let (c0, c1, c2) = (
                    to_center.length_squared() - squared,
                    -2.0 * to_center.dot(slope),
                    slope.length_squared(),
                );
                for x in columns.clone() {
                    let px = x as f64;
                    let a = a0 + px * (a1 + px * a2);
                    let b = b0 + px * b1;
                    let c = c0 + px * (c1 + px * c2);
                    let rest = b * b - a * c;
                    if rest >= 0.0 {
                        let t = (b - rest.sqrt()) / a;
                        if t >= near && t <= far {
                            plot(place(x, y), t);
                        }
                    }
                }
            }
        }
        Shape::Box { min, max } => {
            let (min, max) = (min.as_dvec3() - frame.eye, max.as_dvec3() - frame.eye);
            for y in rows {
                for x in columns.clone() {
                    let inverse = inverse[place(x, y)];
                    let (low, high) = if rays.perspective {
                        (min, max)
                    } else {
                        let start = rays.start(x, y);
                        (min - start, max - start)
                    };
                    let (a, b) = (low * inverse, high * inverse);
                    let enter = a.min(b).max_element();
                    let leave = a.max(b).min_element();
                    if enter <= leave && enter >= near && enter <= far {
                        plot(place(x, y), enter);
                    }
                }
            }
        }
        Shape::Mesh { ref mesh, .. } => {
            let vertices = &frame.meshes[entry.slot as usize];
            let corners = mesh.triangles[entry.triangle as usize].map(|v| vertices[v as usize]);
            let Some(triangle) = TriangleSetup::new(rays, corners) else { return };
            if columns.len() * rows.len() >= 64
                && triangle.misses([columns.start, columns.end - 1], [rows.start, rows.end - 1])
            {
                return;
            }
            for y in rows {
                let py = y as f64;
                let e = triangle.edges.map(|[e, _, ey]| e + py * ey);
                let number = triangle.number[0] + py * triangle.number[2];
                let over = triangle.over[0] + py * triangle.over[2];
                for x in columns.clone() {
                    let px = x as f64;
                    let e: [f64; 3] = std::array::from_fn(|i| e[i] + px * triangle.edges[i][1]);
                    let inside = (e[0] >= 0.0 && e[1] >= 0.0 && e[2] >= 0.0)
                        || (e[0] <= 0.0 && e[1] <= 0.0 && e[2] <= 0.0);
                    if !inside {
                        continue;
                    }
                    let t = (number + px * triangle.number[1]) / (over + px * triangle.over[1]);
                    if triangle.behind && (t < near || t.is_nan()) {
                        continue;
                    }
                    let t = t.max(triangle.depths[0]).min(triangle.depths[1]);
                    if t >= near && t <= far {
                        plot(place(x, y), t);
                    }
                }
            }
        }
    }
}

/// A triangle's functions, affine in pixel coordinates: value at (0, 0) and
/// steps in x and y.
struct TriangleSetup {
    /// On which side of each edge a ray passes. For the same edge of a
    /// neighbour exactly the negative.
    edges: [[f64; 3]; 3],
    /// The depth of the plane is `number` over `over`.
    number: [f64; 3],
    over: [f64; 3],
    /// Least and greatest depth of the corners.
    depths: [f64; 2],
    /// Whether a corner lies before the near plane.
    behind: bool,
}

impl TriangleSetup {
    #[inline]
    fn new(rays: &PixelRays, corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        if normal == DVec3::ZERO {
            return None;
        }
        let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            if rays.perspective {
                let side = p.cross(q);
                rays.step.map(|step| side.dot(step))
            } else {
                let (start, step) = (rays.start[0], rays.step[0]);
                let across = (p - q).cross(step);
                [step.dot((p - start).cross(q - start)), rays.start[1].dot(across), rays.start[2].dot(across)]
            }
        });
        let over = if rays.perspective {
            rays.step.map(|step| normal.dot(step))
        } else {
            [normal.dot(rays.step[0]), 0.0, 0.0]
        };
        let number = if rays.perspective {
            [normal.dot(a), 0.0, 0.0]
        } else {
            [normal.dot(a - rays.start[0]), -normal.dot(rays.start[1]), -normal.dot(rays.start[2])]
        };
        let depths = corners.map(|corner| rays.depth(corner));
        let near = depths[0].min(depths[1]).min(depths[2]);
        let far = depths[0].max(depths[1]).max(depths[2]);
        Some(Self { edges, number, over, depths: [near, far], behind: near < rays.near })
    }

    /// Whether the triangle surely misses a rectangle of pixels.
    fn misses(&self, x: [usize; 2], y: [usize; 2]) -> bool {
        let mut negative = false;
        let mut positive = false;
        for [e, ex, ey] in self.edges {
            let values =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| e + y[j] as f64 * ey + x[i] as f64 * ex);
            negative |= values.iter().all(|&v| v < 0.0);
            positive |= values.iter().all(|&v| v > 0.0);
        }
        negative && positive
    }
}
