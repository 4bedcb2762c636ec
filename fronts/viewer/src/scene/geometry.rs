//! What is drawn: one record for each object, in one order for all pictures.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use casca_scenes::world::{Mesh, Object, Shape};

/// An object as the shaders take it.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Instance {
    a: [f32; 4],
    b: [f32; 4],
    c: [f32; 4],
    colour: [u8; 4],
    id: u32,
}

/// Objects to draw, grouped by what they have in common.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DrawList {
    /// In the order of drawing.
    pub instances: Vec<Instance>,
    /// Which of them share a mesh; solids have none.
    pub runs: Vec<(Option<usize>, Range<u32>)>,
}

/// The meshes of a scene, and which object has which.
pub struct Geometry {
    /// Corners of all meshes, in object space.
    pub vertices: Vec<[f32; 3]>,
    /// Corners of all triangles, counted from the first vertex of their mesh.
    pub indices: Vec<u32>,
    /// Of each mesh: its indices and its first vertex.
    pub meshes: Vec<(Range<u32>, i32)>,
    /// Of each object: its mesh.
    mesh_of: Vec<Option<usize>>,
}

impl Geometry {
    /// The meshes of these objects; meshes that are shared are kept once.
    pub fn new(objects: &[Object]) -> Self {
        let mut geometry = Self { vertices: vec![], indices: vec![], meshes: vec![], mesh_of: vec![] };
        let mut known: HashMap<*const Mesh, usize> = HashMap::new();
        for object in objects {
            let mesh = match &object.shape {
                Shape::Mesh { mesh, .. } => {
                    let key = Arc::as_ptr(mesh);
                    Some(*known.entry(key).or_insert_with(|| geometry.add(mesh)))
                }
                _ => None,
            };
            geometry.mesh_of.push(mesh);
        }
        geometry
    }

    fn add(&mut self, mesh: &Mesh) -> usize {
        let (first, base) = (self.indices.len() as u32, self.vertices.len() as i32);
        self.vertices.extend(mesh.positions.iter().map(|p| p.to_array()));
        self.indices.extend(mesh.triangles.iter().flatten());
        self.meshes.push((first..self.indices.len() as u32, base));
        self.meshes.len() - 1
    }

    /// The list that draws some of the objects: solids first, then mesh by mesh, each by ascending
    /// index. Lists of fewer objects keep this order, so that ties of depth are decided alike.
    pub fn list(
        &self,
        objects: &[Object],
        visible: impl IntoIterator<Item = usize>,
        colour: &dyn Fn(usize) -> [u8; 4],
    ) -> DrawList {
        let mut order: Vec<(Option<usize>, usize)> =
            visible.into_iter().map(|i| (self.mesh_of[i], i)).collect();
        order.sort_unstable();
        let mut list = DrawList::default();
        for (mesh, i) in order {
            let at = list.instances.len() as u32;
            list.instances.push(Instance::new(&objects[i].shape, i as u32, colour(i)));
            match list.runs.last_mut() {
                Some((last, run)) if *last == mesh => run.end = at + 1,
                _ => list.runs.push((mesh, at..at + 1)),
            }
        }
        list
    }
}

impl Instance {
    fn new(shape: &Shape, id: u32, colour: [u8; 4]) -> Self {
        let zero = [0.0; 4];
        let (a, b, c) = match shape {
            Shape::Sphere { center, radius } => (center.extend(*radius).to_array(), zero, zero),
            Shape::Box { min, max } => (min.extend(-1.0).to_array(), max.extend(0.0).to_array(), zero),
            Shape::Mesh { transform, .. } => {
                let m = glam::Mat4::from(*transform);
                (m.row(0).to_array(), m.row(1).to_array(), m.row(2).to_array())
            }
        };
        Self { a, b, c, colour, id }
    }
}

/// The colour of an object: its own, but quiet.
pub fn colour_of(index: usize, object: &Object) -> [u8; 4] {
    let mut bits = (index as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits ^= bits >> 29;
    bits = bits.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let dice = |shift: u32| ((bits >> shift) & 0xff) as f32 / 255.0;
    // Meshes are mostly walls: near to stone.
    let strength = if matches!(object.shape, Shape::Mesh { .. }) { 0.2 } else { 0.42 };
    let (hue, light) = (dice(8) * 6.0, 0.8 + 0.2 * dice(24));
    let channel = |offset: f32| {
        let wave = ((hue + offset) % 6.0 - 3.0).abs() - 1.0;
        (255.0 * light * (1.0 - strength + strength * wave.clamp(0.0, 1.0))) as u8
    };
    [channel(0.0), channel(4.0), channel(2.0), 255]
}
