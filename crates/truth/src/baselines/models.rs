//! What is kept of objects from frame to frame: boxes and meshes in the layout of vectors.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use casca_scenes::world::{Mesh, Object, Shape};

/// Coordinates x, y and z of eight vertices.
pub(super) type Block = [[f32; 8]; 3];

/// A mesh as it is drawn.
pub(super) struct Model {
    pub(super) vertices: Vec<Block>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether only fronts can be seen from outside.
    pub(super) closed: bool,
}

impl Model {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut vertices = vec![[[0.0; 8]; 3]; mesh.positions.len().div_ceil(8)];
        for (i, p) in mesh.positions.iter().enumerate() {
            for (axis, c) in p.to_array().into_iter().enumerate() {
                vertices[i / 8][axis][i % 8] = c;
            }
        }
        // A buffer of today's engines knows what hides, but draws both sides of sheets.
        let triangles = mesh.hiding().map(|(triangles, _)| triangles.into_owned()).unwrap_or_default();
        let closed = triangles.len() == mesh.triangles.len() && mesh.is_closed();
        Self { vertices, triangles, closed }
    }

    pub(super) fn vertex(&self, v: u32) -> Vec3 {
        let block = &self.vertices[v as usize / 8];
        Vec3::from_array(block.map(|lanes| lanes[v as usize % 8]))
    }
}

/// A mesh where it was when it was last looked at.
struct Seen {
    mesh: Arc<Mesh>,
    transform: Affine3A,
    bounds: (Vec3, Vec3),
    model: Option<usize>,
}

/// Boxes and models of the meshes of a scene.
#[derive(Default)]
pub(super) struct Models {
    /// By object.
    seen: Vec<Option<Seen>>,
    /// With the meshes that they are made of, so that no other one takes their address.
    models: Vec<(Arc<Mesh>, Model)>,
    /// Numbers of models by the address of their mesh.
    numbers: HashMap<usize, usize>,
}

impl Models {
    /// Takes up a scene, if it has another number of objects than the last: makes the models of all
    /// occluders, so that no frame has to when it first sees one.
    pub(super) fn prepare(&mut self, objects: &[Object]) {
        if self.seen.len() == objects.len() {
            return;
        }
        *self = Self::default();
        self.seen.resize_with(objects.len(), || None);
        for (i, object) in objects.iter().enumerate().filter(|(_, o)| o.occludes) {
            if let Shape::Mesh { mesh, .. } = &object.shape {
                self.bounds(i, &object.shape);
                self.model(i, mesh);
            }
        }
    }

    /// The box of an object in world space.
    pub(super) fn bounds(&mut self, object: usize, shape: &Shape) -> (Vec3, Vec3) {
        match shape {
            Shape::Sphere { center, radius } => (*center - *radius, *center + *radius),
            Shape::Box { min, max } => (*min, *max),
            Shape::Mesh { mesh, transform } => {
                let seen = &mut self.seen[object];
                match seen {
                    Some(s) if Arc::ptr_eq(&s.mesh, mesh) && s.transform == *transform => s.bounds,
                    _ => {
                        let bounds = mesh.bounds(transform);
                        let model = seen.take().filter(|s| Arc::ptr_eq(&s.mesh, mesh)).and_then(|s| s.model);
                        *seen = Some(Seen { mesh: mesh.clone(), transform: *transform, bounds, model });
                        bounds
                    }
                }
            }
        }
    }

    /// The model of an object's mesh, made if it is new.
    pub(super) fn model(&mut self, object: usize, mesh: &Arc<Mesh>) -> &Model {
        let known = self.seen[object].as_ref().filter(|s| Arc::ptr_eq(&s.mesh, mesh)).and_then(|s| s.model);
        let number = known.unwrap_or_else(|| {
            let number = *self.numbers.entry(Arc::as_ptr(mesh) as usize).or_insert_with(|| {
                self.models.push((mesh.clone(), Model::new(mesh)));
                self.models.len() - 1
            });
            if let Some(seen) = self.seen[object].as_mut().filter(|s| Arc::ptr_eq(&s.mesh, mesh)) {
                seen.model = Some(number);
            }
            number
        });
        &self.models[number].1
    }
}
