//! How fur looks: its strands, its layers, and how it is lit.

use crate::Error;
use crate::maps::blue_noise;
use crate::mesh::{Coat, Mesh, TexCoord, Vertex};
use crate::shading::Material;
use crate::strands::{Fur, MAX_PER_CELL};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::gpu::numeric::MAP_SIDE;
use crate::numeric::{COARSE, FINE, STEPS};

/// How a fragment finds its strand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mapping {
    /// Points in hashed cells: [`Fur::strand_at`].
    Cells,
    /// The thesis' map on the faces of a cube, looked up in the direction normal + position, for
    /// comparison. Its hairs are blue noise.
    CubeMap,
}

/// How much of the sun strands take from each other and from the skin. The light from everywhere
/// always has the factor by height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SelfShadow {
    /// A factor that grows from root to tip ([`Material::root`]), wherever the sun stands.
    Height,
    /// By how many strands the sun's ray meets on its way out: [`Fur::sun_through`].
    Depth,
}

/// The fur of all meshes of a renderer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The strands.
    pub fur: Fur,
    /// How fragments find them.
    pub mapping: Mapping,
    /// Whether a fragment follows its ray through the slab below its shell, so that shells seen
    /// from the side do not come apart. Without it a fragment knows only its own height, as in the
    /// thesis.
    pub marched: bool,
    /// How strands throw light back.
    pub material: Material,
    /// How much strands differ in colour, 0 to 1.
    pub vary: f32,
    /// How strands shade each other.
    pub self_shadow: SelfShadow,
}

impl Look {
    /// Hashed cells, followed rays, the usual light, and shadows among strands by depth.
    pub fn new(fur: Fur) -> Self {
        Self {
            fur,
            mapping: Mapping::Cells,
            marched: true,
            material: Material::default(),
            vary: 0.22,
            self_shadow: SelfShadow::Depth,
        }
    }

    pub(crate) fn record(&self) -> LookRecord {
        let (fur, material) = (&self.fur, &self.material);
        LookRecord {
            bend: fur.bend.to_array(),
            height: fur.height,
            spacing: fur.spacing,
            radius: fur.radius,
            taper: fur.taper,
            variation: fur.variation,
            per_cell: fur.per_cell.min(MAX_PER_CELL),
            seed: fur.seed,
            mapping: u32::from(self.mapping == Mapping::CubeMap),
            steps: if self.marched { STEPS } else { 1 },
            fine: FINE * fur.spacing,
            coarse: COARSE * fur.spacing,
            exponent: material.exponent,
            wrap: material.wrap,
            dark: material.root,
            ambient: material.ambient,
            diffuse: material.diffuse,
            specular: material.specular,
            vary: self.vary,
            self_shadow: u32::from(self.self_shadow == SelfShadow::Depth),
            pad: [0.0; 2],
        }
    }

    /// The side of the faces of the fur map, and their texels; a single empty texel where it is not
    /// used.
    ///
    /// # Errors
    /// The map cannot hold as many hairs as the fur has.
    pub(crate) fn map_faces(&self) -> Result<(u32, Vec<u8>), Error> {
        if self.mapping == Mapping::Cells {
            return Ok((1, vec![0; 6]));
        }
        let texels = (0..6).map(|face| {
            let seed = u64::from(self.fur.seed) * 6 + face;
            blue_noise(MAP_SIDE, f64::from(self.fur.density()), seed).map(|map| map.texels())
        });
        let faces: Vec<Vec<[u8; 4]>> = texels.collect::<Result<_, _>>()?;
        Ok((MAP_SIDE, faces.concat().iter().map(|texel| texel[3]).collect()))
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

/// A [`Look`] as the shaders take it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct LookRecord {
    bend: [f32; 3],
    height: f32,
    spacing: f32,
    radius: f32,
    taper: f32,
    variation: f32,
    per_cell: u32,
    seed: u32,
    mapping: u32,
    steps: u32,
    fine: f32,
    coarse: f32,
    exponent: f32,
    wrap: f32,
    dark: f32,
    ambient: f32,
    diffuse: f32,
    specular: f32,
    vary: f32,
    self_shadow: u32,
    pad: [f32; 2],
}

/// A vertex as the shaders take it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Corner {
    position: [f32; 3],
    normal: [f32; 3],
    coat: [f32; 4],
    tex: [f32; 2],
    /// The number of its image plus one; 0 for none.
    image: u32,
}

pub(crate) fn corners_of(mesh: &Mesh) -> Vec<Corner> {
    let places = mesh.tex_coords().iter().copied().chain(std::iter::repeat(TexCoord::default()));
    let rows = mesh.vertices().iter().zip(mesh.coats()).zip(places);
    let corner = |((v, c), place): ((&Vertex, &Coat), TexCoord)| Corner {
        position: v.position.to_array(),
        normal: v.normal.to_array(),
        coat: c.color.extend(c.length).to_array(),
        tex: place.uv.to_array(),
        image: place.image.map_or(0, |image| u32::from(image) + 1),
    };
    rows.map(corner).collect()
}
