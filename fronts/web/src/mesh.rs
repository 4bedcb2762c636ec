//! Prepared meshes.

use std::ops::ControlFlow;
use std::sync::Arc;

use casca::{Facing, MeshOptions, TriMesh};
use wasm_bindgen::prelude::*;

use crate::arrays::{groups, points, refused};

/// Triangles that were prepared once, for any number of objects.
#[wasm_bindgen]
pub struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

#[wasm_bindgen]
impl Mesh {
    /// Prepares a mesh: positions, 3 numbers each, and triangles, 3 vertices each. Whether it hides
    /// others (default: yes), and whether from both sides (default: yes) or only where its
    /// triangles run counter-clockwise.
    #[wasm_bindgen(constructor)]
    pub fn new(
        positions: &[f32],
        triangles: &[u32],
        occludes: Option<bool>,
        two_sided: Option<bool>,
    ) -> Result<Mesh, JsError> {
        let positions = points("positions", positions)?;
        let corners: &[[u32; 3]] = groups("triangles", triangles)?;
        let facing = if two_sided.unwrap_or(true) { Facing::Both } else { Facing::Front };
        let how = MeshOptions::default().facing(facing).occludes(occludes.unwrap_or(true));
        let go_on = &mut |_| ControlFlow::Continue(());
        let mesh = TriMesh::prepare(positions, corners.to_vec(), &how, go_on).map_err(refused)?;
        Ok(Self { mesh: Arc::new(mesh) })
    }

    /// Whether every edge has two triangles.
    #[wasm_bindgen(getter, js_name = isClosed)]
    pub fn is_closed(&self) -> bool {
        self.mesh.is_closed()
    }

    /// Whether it may hide others.
    #[wasm_bindgen(getter)]
    pub fn occludes(&self) -> bool {
        self.mesh.occludes()
    }

    /// How many triangles it has.
    #[wasm_bindgen(getter)]
    pub fn length(&self) -> usize {
        self.mesh.triangles().len()
    }

    /// Bytes that it takes.
    #[wasm_bindgen(getter, js_name = memoryBytes)]
    pub fn memory_bytes(&self) -> usize {
        self.mesh.memory_bytes()
    }
}
