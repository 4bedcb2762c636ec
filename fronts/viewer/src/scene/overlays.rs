//! What the library knows, drawn over the picture.

use casca::{Method, Query, Scene};
use casca_scenes::drive::view_of;
use casca_scenes::world::{Camera, Object, Shape};
use casca_tools::pictures::palette::{self, rgba};
use glam::{Affine3A, DVec3, DVec4, Vec3};

use crate::scene::camera_fit::Solid;
use crate::scene::playback::Frame;
use crate::scene::renderer::{Corner, Line, Marks};

/// A layer of marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Objects in the frustum that are not drawn, in wireframe.
    Hidden,
    /// Temporal bounding volumes.
    Volumes,
    /// The frustum that is culled for.
    Frustum,
}

/// The layers by their names, in their order above, which is that of their keys.
pub const LAYERS: [(&str, Layer); 3] =
    [("hidden", Layer::Hidden), ("volumes", Layer::Volumes), ("frustum", Layer::Frustum)];

/// The wireframe of a hidden object.
pub const HIDDEN: [u8; 4] = rgba(palette::HIDDEN, 200);
/// A temporal bounding volume.
pub const VOLUME: [u8; 4] = rgba(palette::VOLUME, 220);
/// The border of the frustum that is culled for.
pub const FRUSTUM: [u8; 4] = rgba(palette::CAMERA, 255);
/// Its section at the height of the eye.
pub const LIT: [u8; 4] = rgba(palette::LIT, 70);
/// The wireframe of a visible object that was lost.
pub const LOST: [u8; 4] = [220, 0, 30, 255];

/// Which layers are on, and what they keep.
#[derive(Default)]
pub struct Overlays {
    /// Whether each layer is on.
    pub on: [bool; 3],
    /// Whether of the frustum only its section at the height of the eye is drawn.
    pub is_frustum_flat: bool,
    frustum: Option<Query>,
}

impl Overlays {
    /// Whether a layer is on.
    fn is_on(&self, layer: Layer) -> bool {
        self.on[layer as usize]
    }

    /// The marks of all layers that are on, and of objects that were lost.
    pub fn marks(&mut self, frame: &Frame<'_>, lost: &[usize]) -> Result<Marks, casca::Error> {
        let mut marks = Marks::default();
        if self.is_on(Layer::Hidden) {
            for i in self.culled(frame)? {
                marks.wireframe(&frame.objects[i], 1.0, HIDDEN);
            }
        }
        if self.is_on(Layer::Volumes) {
            for (lo, hi) in frame.scene.ids().filter_map(|id| frame.scene.tbv(id).ok().flatten()) {
                marks.cuboid(lo.as_vec3(), hi.as_vec3(), Affine3A::IDENTITY, 1.0, VOLUME);
            }
        }
        if self.is_on(Layer::Frustum) {
            let mut seen = Solid::seen(&frame.camera, frame.level.0, frame.level.1);
            if !self.is_frustum_flat {
                seen.faces.iter().for_each(|face| marks.outline(face, 1.0, FRUSTUM));
            }
            marks.section(&mut seen, f64::from(frame.camera.eye.y));
        }
        for &i in lost {
            marks.wireframe(&frame.objects[i], 3.0, LOST);
        }
        Ok(marks)
    }

    /// The objects in the frustum that are not drawn, ascending.
    pub fn culled(&mut self, frame: &Frame<'_>) -> Result<Vec<usize>, casca::Error> {
        let mut culled = self.in_frustum(frame.scene, &frame.camera)?;
        culled.retain(|i| frame.visible.binary_search(i).is_err());
        Ok(culled)
    }

    /// The objects in the frustum of a camera, ascending.
    pub fn in_frustum(&mut self, scene: &Scene, camera: &Camera) -> Result<Vec<usize>, casca::Error> {
        let query = match &mut self.frustum {
            Some(query) => query,
            none => none.insert(Query::with_method(Method::Frustum)?),
        };
        let found = query.run(scene, &view_of(camera)?).visible();
        let mut found: Vec<usize> = found.iter().map(|id| id.index()).collect();
        found.sort_unstable();
        Ok(found)
    }
}

impl Marks {
    /// A line of `width` pixels.
    pub fn line(&mut self, start: Vec3, end: Vec3, width: f32, colour: [u8; 4]) {
        self.lines.push(Line { start: start.to_array(), width, end: end.to_array(), colour });
    }

    /// The edges of a box under a transform.
    pub fn cuboid(&mut self, lo: Vec3, hi: Vec3, transform: Affine3A, width: f32, colour: [u8; 4]) {
        let corner = |i: usize| {
            let at = Vec3::from_array(std::array::from_fn(|axis| [lo, hi][i >> axis & 1][axis]));
            transform.transform_point3(at)
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

    /// The border of a polygon.
    fn outline(&mut self, corners: &[DVec3], width: f32, colour: [u8; 4]) {
        for (i, corner) in corners.iter().enumerate() {
            self.line(corner.as_vec3(), corners[(i + 1) % corners.len()].as_vec3(), width, colour);
        }
    }

    /// The section of the seen part of a scene at some height: its border, and the area inside.
    fn section(&mut self, seen: &mut Solid, height: f64) {
        let section = seen.cut(DVec4::new(0.0, -1.0, 0.0, height)).unwrap_or_default();
        self.outline(&section, 3.0, FRUSTUM);
        for i in 2..section.len() {
            for p in [section[0], section[i - 1], section[i]] {
                self.fills.push(Corner { position: p.as_vec3().to_array(), colour: LIT });
            }
        }
    }
}
