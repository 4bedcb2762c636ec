//! The nearest object at every pixel, by a ray through its centre.

use casca_scenes::world::{Camera, Object, Shape, Sides};
use glam::DVec3;
use rayon::prelude::*;

use super::frustum::Frustum;
use super::geometry::{Primitive, sides_of};
use super::rays::RayOracle;
use super::tree::Trees;

/// No object.
pub const NONE: u32 = u32::MAX;

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
/// - Meshes are surfaces that are seen from both sides; each triangle hides as its sides say.
/// - The nearest wins; at exactly equal depth the lower index.
///
/// The result does not depend on the number of threads.
pub struct ItemBuffer {
    width: usize,
    height: usize,
    index: Vec<u32>,
    depth: Vec<f64>,
    visible: Vec<u32>,
    holding_eye: Vec<u32>,
    /// The objects that pixels show, and those pixels, ascending.
    shown: Vec<(u32, u32)>,
    /// What shows but lets rays pass.
    passing: Trees,
    /// What stops rays, and where all objects were, if the buffer is drawn by itself.
    own: Option<(RayOracle, Vec<Shape>)>,
}

/// Whether a primitive of an object shows where rays go on through it: then from any side.
fn passing(object: &Object, primitive: u32) -> Option<Sides> {
    let passes = !object.occludes || sides_of(&object.shape, primitive) != Sides::Both;
    (object.tested && passes).then_some(Sides::Both)
}

/// Whether two shapes are the same one in the same place.
fn same(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (Shape::Sphere { center: a, radius: r }, Shape::Sphere { center: b, radius: s }) => (a, r) == (b, s),
        (Shape::Box { min: a, max: b }, Shape::Box { min: c, max: d }) => (a, b) == (c, d),
        (Shape::Mesh { mesh: a, transform: s }, Shape::Mesh { mesh: b, transform: t }) => {
            std::sync::Arc::ptr_eq(a, b) && s == t
        }
        _ => false,
    }
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
            visible: Vec::new(),
            holding_eye: Vec::new(),
            shown: Vec::new(),
            passing: Trees::new(&[], passing),
            own: None,
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

    /// For each object, the number of pixels that show it. An occluder is counted where it is the
    /// nearest object, any other object where no occluder is nearer. An object around the eye has
    /// at least 1. Objects that neither hide nor are tested have 0.
    pub fn visible(&self) -> &[u32] {
        &self.visible
    }

    /// The solids that hold the eye and are counted visible for that.
    pub fn holding_eye(&self) -> &[u32] {
        &self.holding_eye
    }

    /// Draws `objects` as seen by `camera`.
    pub fn render(&mut self, objects: &[Object], camera: &Camera) {
        let (mut rays, before) = self.own.take().unwrap_or_else(|| (RayOracle::new(&[]), Vec::new()));
        let moves = |i: &usize| !before.get(*i).is_some_and(|old| same(old, &objects[*i].shape));
        let moved: Vec<usize> = (0..objects.len()).filter(moves).collect();
        rays.update(objects, &moved);
        self.update(objects, &moved);
        self.draw(&rays, objects, camera);
        self.own = Some((rays, objects.iter().map(|object| object.shape.clone()).collect()));
    }

    /// Takes up the new shapes of the objects `moved`, as [`RayOracle::update`] does.
    pub(super) fn update(&mut self, objects: &[Object], moved: &[usize]) {
        self.passing.update(objects, moved);
    }

    /// Draws `objects` where they are; `rays` holds what stops rays.
    pub(super) fn draw(&mut self, rays: &RayOracle, objects: &[Object], camera: &Camera) {
        let width = self.width;
        let frustum = Frustum::new(camera);
        let pixels = PixelRays::new(&frustum, width, self.height);
        let reach = frustum.far() - frustum.near();
        let rows = self.index.par_chunks_mut(width.max(1)).zip(self.depth.par_chunks_mut(width.max(1)));
        let passing = &self.passing;
        self.shown = rows
            .enumerate()
            .flat_map_iter(|(y, (index, depth))| {
                let (mut shown, mut last) = (Vec::new(), None);
                for x in 0..width {
                    let (origin, step) = pixels.at(x, y);
                    let pixel = (y * width + x) as u32;
                    // Often the next pixel shows the same.
                    let hit = rays.trees.first(origin, step, &mut last).filter(|(_, t)| *t <= reach);
                    (index[x], depth[x]) =
                        hit.map_or((NONE, f64::INFINITY), |(i, t)| (i, frustum.near() + t));
                    shown.extend(hit.map(|(object, _)| (object, pixel)));
                    let end = hit.map_or(reach, |(_, t)| t);
                    passing.any(origin, step, end, |part| {
                        let shows = part.enter(origin, step, false).is_some_and(|t| t <= end);
                        shown.extend(shows.then_some((part.object, pixel)));
                        false
                    });
                }
                shown
            })
            .collect();
        self.shown.par_sort_unstable();
        self.shown.dedup();
        self.visible.clear();
        self.visible.resize(objects.len(), 0);
        self.shown.iter().for_each(|(object, _)| self.visible[*object as usize] += 1);
        self.holding_eye.clear();
        if frustum.is_perspective() && width > 0 && self.height > 0 {
            let (w, h) = (width - 1, self.height - 1);
            let starts = [(0, 0), (w, 0), (0, h), (w, h), (w / 2, h / 2)].map(|(x, y)| pixels.at(x, y).0);
            let holds = |object: &Object| {
                if !object.tested || matches!(object.shape, Shape::Mesh { .. }) {
                    return false;
                }
                // It reaches beyond the near plane in view.
                let solid = Primitive::of(&object.shape, 0);
                solid.holds(frustum.eye()) && starts.iter().any(|start| solid.holds(*start))
            };
            self.holding_eye = (0..objects.len() as u32).filter(|&i| holds(&objects[i as usize])).collect();
            for &i in &self.holding_eye {
                self.visible[i as usize] = self.visible[i as usize].max(1);
            }
        }
    }

    /// The ray through the centre of a pixel of a buffer of this size: where
    /// it leaves the near plane, and its way per metre of depth.
    pub(super) fn pixel_ray(&self, frustum: &Frustum, pixel: usize) -> (DVec3, DVec3) {
        PixelRays::new(frustum, self.width, self.height).at(pixel % self.width, pixel / self.width)
    }

    /// The pixels that show an object, ascending.
    pub(super) fn pixels_of(&self, object: usize) -> impl ExactSizeIterator<Item = usize> {
        let from = self.shown.partition_point(|shown| (shown.0 as usize) < object);
        let count = self.shown[from..].partition_point(|shown| shown.0 as usize == object);
        self.shown[from..from + count].iter().map(|shown| shown.1 as usize)
    }
}

/// The rays through pixel centres: affine in pixel coordinates.
struct PixelRays {
    /// Where they leave the near plane: value at (0, 0) and steps per pixel in x and y.
    start: [DVec3; 3],
    /// Way per metre of depth, likewise.
    step: [DVec3; 3],
}

impl PixelRays {
    fn new(frustum: &Frustum, width: usize, height: usize) -> Self {
        let (dx, dy) = (2.0 / width as f64, -2.0 / height as f64);
        let (first, middle) = (frustum.ray(-1.0 + 0.5 * dx, 1.0 + 0.5 * dy), frustum.ray(0.0, 0.0));
        let (right, up) = (frustum.ray(1.0, 0.0), frustum.ray(0.0, 1.0));
        let step = [first.1, (right.1 - middle.1) * dx, (up.1 - middle.1) * dy];
        let start = [first.0, (right.0 - middle.0) * dx, (up.0 - middle.0) * dy];
        let start = [0, 1, 2].map(|i| start[i] + step[i] * frustum.near());
        Self { start: [frustum.eye() + start[0], start[1], start[2]], step }
    }

    fn at(&self, x: usize, y: usize) -> (DVec3, DVec3) {
        let along = |row: &[DVec3; 3]| row[0] + row[2] * y as f64 + row[1] * x as f64;
        (along(&self.start), along(&self.step))
    }
}
