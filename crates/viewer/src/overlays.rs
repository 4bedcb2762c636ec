//! What the library knows, drawn over the picture.

use std::thread::{self, JoinHandle};

use casca::internals::{BitMatrix, Cap, QueryInternals, SceneInternals, occlusion_by_caps};
use casca::{Method, Query, Scene};
use casca_lab::drive::view_of;
use casca_lab::world::{Camera, Object, Shape};
use glam::{Affine3A, DVec3, IVec2, IVec3, Vec3};

use crate::playback::Frame;
use crate::renderer::{Corner, Line, Marks};

/// A layer of marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Objects in the frustum that are not drawn, in wireframe.
    Hidden,
    /// Temporal bounding volumes.
    Volumes,
    /// Cells near a horizontal slice through the eye.
    Cells,
    /// Outlines of what blocks the view from the eye's cell.
    Caps,
    /// The occlusion buffers.
    Buffers,
    /// The frustum that is culled for.
    Frustum,
}

impl Layer {
    /// All of them, in the order of their keys.
    pub const EVERY: [Self; 6] =
        [Self::Hidden, Self::Volumes, Self::Cells, Self::Caps, Self::Buffers, Self::Frustum];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hidden => "hidden objects",
            Self::Volumes => "temporal bounding volumes",
            Self::Cells => "grid cells",
            Self::Caps => "cap polygons",
            Self::Buffers => "occlusion buffers",
            Self::Frustum => "frustum",
        }
    }
}

const HIDDEN: [u8; 4] = [190, 70, 10, 190];
const VOLUME: [u8; 4] = [130, 30, 170, 220];
const OPAQUE_CELL: [u8; 4] = [40, 50, 70, 215];
const HIDDEN_CELL: [u8; 4] = [235, 120, 30, 90];
const OPEN_CELL: [u8; 4] = [60, 170, 90, 90];
const CAP: [u8; 4] = [0, 110, 140, 255];
const FRUSTUM: [u8; 4] = [20, 20, 30, 255];
const LOST: [u8; 4] = [225, 0, 20, 255];
/// Of how many shells caps are drawn: of all, they would fill the picture.
const CAP_SHELLS: i32 = 8;

/// Which layers are on, and what they keep.
#[derive(Default)]
pub struct Overlays {
    on: [bool; 6],
    recorder: Option<Query>,
    frustum: Option<Query>,
    caps: Caps,
}

/// The caps around an eye's cell, as the scene was when it came there. Tracing them takes seconds, and has
/// a thread of its own.
#[derive(Default)]
struct Caps {
    done: Option<(IVec3, Vec<Cap>)>,
    running: Option<JoinHandle<(IVec3, Vec<Cap>)>>,
}

impl Caps {
    /// Takes up what is done, and starts anew where the eye has come to another cell.
    fn update(&mut self, scene: &Scene, viewer: IVec3) {
        if let Some(thread) = self.running.take_if(|thread| thread.is_finished()) {
            self.done = thread.join().ok();
        }
        if self.running.is_none() && self.done.as_ref().is_none_or(|(at, _)| *at != viewer) {
            let mut opaque = scene.static_opacity().clone();
            scene.dynamic_opacity().iter().for_each(|cell| opaque.set(cell));
            self.running = Some(thread::spawn(move || (viewer, occlusion_by_caps(&opaque, viewer).1)));
        }
    }
}

impl Overlays {
    /// Whether a layer is on.
    pub fn is_on(&self, layer: Layer) -> bool {
        self.on[layer as usize]
    }

    /// Whether cap polygons are traced and drawn.
    pub fn are_caps_ready(&self) -> bool {
        self.caps.running.is_none()
    }

    /// Drops what was kept about a scene.
    pub fn forget_scene(&mut self) {
        self.caps = Caps::default();
    }

    /// Turns a layer on or off.
    pub fn toggle(&mut self, layer: Layer) {
        self.on[layer as usize] ^= true;
    }

    /// The marks of all layers that are on, and of objects that were lost.
    ///
    /// # Errors
    /// As [`view_of`] and [`Query::with_method`].
    pub fn marks(&mut self, frame: &Frame<'_>, lost: &[usize]) -> Result<Marks, casca::Error> {
        let mut marks = Marks::default();
        if self.is_on(Layer::Hidden) {
            self.hidden(frame, &mut marks)?;
        }
        if self.is_on(Layer::Volumes) {
            for (lo, hi) in frame.scene.ids().filter_map(|id| frame.scene.tbv(id).ok().flatten()) {
                marks.cuboid(lo.as_vec3(), hi.as_vec3(), Affine3A::IDENTITY, 1.0, VOLUME);
            }
        }
        if self.is_on(Layer::Cells) {
            self.cells(frame, &mut marks)?;
        }
        if self.is_on(Layer::Caps) {
            self.caps(frame, &mut marks);
        }
        if self.is_on(Layer::Frustum) {
            let grid = frame.scene.grid();
            marks.frustum(&frame.camera, (grid.max() - grid.min()).length() as f32 * 0.3);
        }
        for &i in lost {
            marks.wireframe(&frame.objects[i], 3.0, LOST);
        }
        Ok(marks)
    }

    fn hidden(&mut self, frame: &Frame<'_>, marks: &mut Marks) -> Result<(), casca::Error> {
        let query = match self.frustum.take() {
            Some(query) => query,
            None => Query::with_method(Method::Frustum)?,
        };
        let query = self.frustum.insert(query);
        for id in query.run(frame.scene, &view_of(&frame.camera)?).visible() {
            if frame.visible.binary_search(&id.index()).is_err() {
                marks.wireframe(&frame.objects[id.index()], 1.0, HIDDEN);
            }
        }
        Ok(())
    }

    fn cells(&mut self, frame: &Frame<'_>, marks: &mut Marks) -> Result<(), casca::Error> {
        let query = match self.recorder.take() {
            Some(query) => query,
            None => Query::with_method(Method::cell())?,
        };
        let query = self.recorder.insert(query);
        query.record_cells(true);
        query.run(frame.scene, &view_of(&frame.camera)?);
        let grid = frame.scene.grid();
        let level = grid.cell_of(frame.camera.eye.as_dvec3()).y.clamp(0, grid.dims().y - 1);
        for z in 0..grid.dims().z {
            for x in 0..grid.dims().x {
                let cell = IVec3::new(x, level, z);
                let is_in = |cells: Option<&BitMatrix>| cells.is_some_and(|c| c.get(cell));
                let colour = if frame.scene.is_opaque(cell) {
                    OPAQUE_CELL
                } else if is_in(query.hidden_cells()) {
                    HIDDEN_CELL
                } else if is_in(query.visited_cells()) {
                    OPEN_CELL
                } else {
                    continue;
                };
                let (lo, hi) = grid.cell_bounds(cell);
                marks.tile(lo.as_vec3(), hi.as_vec3(), colour);
            }
        }
        Ok(())
    }

    fn caps(&mut self, frame: &Frame<'_>, marks: &mut Marks) {
        let grid = frame.scene.grid();
        let viewer = grid.cell_of(frame.camera.eye.as_dvec3());
        if !grid.contains(viewer) {
            return;
        }
        self.caps.update(frame.scene, viewer);
        let every = (grid.dims().max_element() / (2 * CAP_SHELLS)).max(1);
        let caps = self.caps.done.iter().flat_map(|(_, caps)| caps);
        for cap in caps.filter(|cap| cap.shell % every == every / 2) {
            let (axis, sign) = cap.side;
            let [column, row] = [(1, 2), (0, 2), (0, 1)].map(|(c, r)| [c, r])[axis];
            let cell = |at: IVec2| {
                let mut cell = viewer;
                cell[axis] += cap.shell * sign;
                cell[column] += at.x;
                cell[row] += at.y;
                cell
            };
            let point = |at: IVec2| {
                let (lo, hi) = grid.cell_bounds(cell(at));
                ((lo + hi) * 0.5).as_vec3()
            };
            for polygon in &cap.polygons {
                if !polygon.outer.iter().any(|&at| in_view(&frame.camera, point(at))) {
                    continue;
                }
                for ring in std::iter::once(&polygon.outer).chain(&polygon.holes) {
                    for (i, &at) in ring.iter().enumerate() {
                        marks.line(point(at), point(ring[(i + 1) % ring.len()]), 2.0, CAP);
                    }
                }
            }
        }
    }
}

fn in_view(camera: &Camera, p: Vec3) -> bool {
    let c = camera.view_projection() * p.extend(1.0);
    c.w > 0.0 && c.x.abs() <= c.w && c.y.abs() <= c.w
}

impl Marks {
    /// A line of `width` pixels.
    pub fn line(&mut self, start: Vec3, end: Vec3, width: f32, colour: [u8; 4]) {
        self.lines.push(Line { start: start.to_array(), width, end: end.to_array(), colour });
    }

    /// The edges of a box under a transform.
    pub fn cuboid(&mut self, lo: Vec3, hi: Vec3, transform: Affine3A, width: f32, colour: [u8; 4]) {
        let corner = |i: usize| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
            transform.transform_point3(Vec3::new(pick(0), pick(1), pick(2)))
        };
        for i in 0..8 {
            for axis in 0..3 {
                if i >> axis & 1 == 0 {
                    self.line(corner(i), corner(i | 1 << axis), width, colour);
                }
            }
        }
    }

    /// An object in wireframe: three rings, or the edges of its box.
    pub fn wireframe(&mut self, object: &Object, width: f32, colour: [u8; 4]) {
        const SIDES: usize = 16;
        match &object.shape {
            Shape::Sphere { center, radius } => {
                for (a, b) in [(Vec3::X, Vec3::Y), (Vec3::X, Vec3::Z), (Vec3::Y, Vec3::Z)] {
                    let at = |i: usize| {
                        let (sin, cos) = (i as f32 * std::f32::consts::TAU / SIDES as f32).sin_cos();
                        *center + (a * cos + b * sin) * *radius
                    };
                    (0..SIDES).for_each(|i| self.line(at(i), at(i + 1), width, colour));
                }
            }
            Shape::Box { min, max } => self.cuboid(*min, *max, Affine3A::IDENTITY, width, colour),
            Shape::Mesh { mesh, transform } => {
                let lo = mesh.positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
                let hi = mesh.positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
                if lo.is_finite() && hi.is_finite() {
                    self.cuboid(lo, hi, *transform, width, colour);
                }
            }
        }
    }

    /// A horizontal tile in the middle of a box, with gaps between neighbours.
    fn tile(&mut self, lo: Vec3, hi: Vec3, colour: [u8; 4]) {
        let gap = (hi - lo) * 0.06;
        let (lo, hi, y) = (lo + gap, hi - gap, (lo.y + hi.y) * 0.5);
        for (x, z) in [(lo.x, lo.z), (hi.x, lo.z), (hi.x, hi.z), (lo.x, lo.z), (hi.x, hi.z), (lo.x, hi.z)] {
            self.fills.push(Corner { position: [x, y, z], colour });
        }
    }

    /// The frustum of a camera, as far as `reach`.
    pub fn frustum(&mut self, camera: &Camera, reach: f32) {
        let inverse = camera.view_projection().as_dmat4().inverse();
        let corner = |x: f64, y: f64| {
            let ray = inverse.project_point3(DVec3::new(x, y, 0.5)) - camera.eye.as_dvec3();
            camera.eye + (ray.normalize_or_zero() * f64::from(reach)).as_vec3()
        };
        let far = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y));
        for i in 0..4 {
            self.line(camera.eye, far[i], 2.5, FRUSTUM);
            self.line(far[i], far[(i + 1) % 4], 2.5, FRUSTUM);
        }
    }
}
