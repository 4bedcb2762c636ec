//! How fur looks: its strands, its layers, and how it is lit.

use crate::mesh::Mesh;
use crate::shader::look;
use crate::shading::Material;
use crate::strands::Fur;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The fur of all meshes of a renderer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The strands.
    pub fur: Fur,
    /// Whether a fragment walks along its ray from cell to cell until it meets a strand, for studies.
    /// Without it a fragment looks one strand up, the one next to its way.
    pub walked: bool,
    /// How strands throw light back.
    pub material: Material,
    /// How much strands differ in colour, 0 to 1.
    pub vary: f32,
}

impl Look {
    /// One look-up a fragment and the usual light.
    pub fn new(fur: Fur) -> Self {
        Self { fur, walked: false, material: Material::default(), vary: 0.22 }
    }

    pub(crate) fn words(&self) -> [u32; 20] {
        look(&self.fur, &self.material, self.vary)
    }
}

/// The colour behind everything, in linear light.
pub(crate) const SKY: [f32; 3] = [0.58, 0.71, 0.86];

/// The bytes of a pixel that shows the sky alone, without haze.
pub fn sky_pixel() -> [u8; 4] {
    let [r, g, b] = stored(Vec3::from_array(SKY)).to_array().map(|c| (c * 255.0).round() as u8);
    [r, g, b, 255]
}

/// Linear light as pictures store it, 0 to 1.
pub(crate) fn stored(light: Vec3) -> Vec3 {
    light.clamp(Vec3::ZERO, Vec3::ONE).powf(1.0 / 2.2)
}

/// A vertex as the shaders take it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Corner {
    position: [f32; 3],
    normal: [f32; 3],
    coat: [f32; 4],
}

pub(crate) fn corners_of(mesh: &Mesh) -> Vec<Corner> {
    let rows = mesh.vertices().iter().zip(mesh.coats());
    rows.map(|(v, c)| Corner {
        position: v.position.to_array(),
        normal: v.normal.to_array(),
        coat: c.color.extend(c.length).to_array(),
    })
    .collect()
}
