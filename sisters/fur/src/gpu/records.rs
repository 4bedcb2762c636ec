//! What the shaders read, as it lies in memory, and lists of what to draw.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use casca_tools::camera::Camera;
use glam::{Affine3A, Mat4, Vec3};

use crate::error::Error;
use crate::skin::Pose;
use crate::strands::Lean;

/// The camera and the light of one frame.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Frame {
    clip: [[f32; 4]; 4],
    sun_clip: [[f32; 4]; 4],
    eye: [f32; 4],
    sun: [f32; 4],
    sky: [f32; 4],
    shadow: [f32; 4],
}

impl Frame {
    pub(crate) fn new(camera: &Camera, height: u32, light: &Sun, sky: ([f32; 3], f32)) -> Self {
        // The height of a pixel at distance 1.
        let pixel = 2.0 / (camera.projection.y_axis.y.abs().max(f32::MIN_POSITIVE) * height.max(1) as f32);
        Self {
            clip: camera.view_projection().to_cols_array_2d(),
            sun_clip: light.matrix().to_cols_array_2d(),
            eye: camera.eye.extend(pixel).to_array(),
            sun: light.direction().extend(f32::from(u8::from(light.shadows))).to_array(),
            sky: [sky.0[0], sky.0[1], sky.0[2], sky.1],
            shadow: [light.texel(), 1.0 / SHADOW_SIZE as f32, 0.0, 0.0],
        }
    }
}

/// Texels along a side of the shadow map. A software adapter fills 2048² of them in about 0.1 s.
pub(crate) const SHADOW_SIZE: u32 = 2048;

/// The light of the sun, and the ball that its shadow map covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// The direction towards the sun; of any length but 0.
    pub towards: Vec3,
    /// The middle of the part of the world that gets shadows.
    pub center: Vec3,
    /// Its radius. Outside of the ball nothing is in shadow.
    pub radius: f32,
    /// Whether there are shadows at all.
    pub shadows: bool,
}

impl Sun {
    /// The unit vector towards the sun; upwards for vectors without direction.
    pub fn direction(&self) -> Vec3 {
        self.towards.normalize_or(Vec3::Y)
    }

    /// World space to the shadow map: depth 0 towards the sun, 1 away from it.
    fn matrix(&self) -> Mat4 {
        let z = self.direction();
        let (x, y) = z.any_orthonormal_pair();
        let scale = 1.0 / self.radius.max(f32::MIN_POSITIVE);
        let turn = Mat4::from_cols(x.extend(0.0), y.extend(0.0), (-z).extend(0.0), glam::Vec4::W).transpose();
        Mat4::from_translation(Vec3::new(0.0, 0.0, 0.5))
            * Mat4::from_scale(Vec3::new(scale, scale, 0.5 * scale))
            * turn
            * Mat4::from_translation(-self.center)
    }

    /// The width of a texel of the shadow map.
    fn texel(&self) -> f32 {
        2.0 * self.radius / SHADOW_SIZE as f32
    }
}

/// A place where a furry mesh stands, and its colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// Which of the renderer's meshes.
    pub mesh: usize,
    /// Object space to world space: turned, moved and scaled alike along all axes.
    pub place: Affine3A,
    /// The colour of strands at the skin: red, green, blue, linear, 0 to 1.
    pub root: [f32; 3],
    /// Their colour at the tip.
    pub tip: [f32; 3],
}

/// A [`Stand`] as the shaders take it.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct Record {
    rows: [[f32; 4]; 3],
    root: [f32; 4],
    tip: [f32; 4],
    /// How strands lean, in world space, and the longest bend.
    lean: [f32; 4],
    /// The first joint and the number of joints.
    pose: [u32; 4],
}

impl Record {
    fn new(stand: &Stand) -> Self {
        let colour = |c: [f32; 3]| [c[0], c[1], c[2], 0.0];
        Self {
            rows: rows_of(&stand.place),
            root: colour(stand.root),
            tip: colour(stand.tip),
            lean: [0.0; 4],
            pose: [0; 4],
        }
    }
}

/// The rows of a matrix.
pub(crate) fn rows_of(m: &Affine3A) -> [[f32; 4]; 3] {
    std::array::from_fn(|i| [m.x_axis[i], m.y_axis[i], m.z_axis[i], m.translation[i]])
}

/// A box of the surroundings: a wall or the ground.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Block {
    /// Least corner.
    pub min: [f32; 3],
    /// How it is painted: 0 as ground, 1 as a wall of bricks.
    pub paint: u32,
    /// Greatest corner.
    pub max: [f32; 3],
    /// Unused.
    pub pad: u32,
}

/// What a frame draws: animals with their layers, grouped by mesh, and blocks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DrawList {
    pub(crate) records: Vec<Record>,
    /// Of each shell: the number of its record, and its layer in the low half and the number of
    /// layers in the high one.
    pub(crate) shells: Vec<[u32; 2]>,
    /// The skins of each mesh, and its shells.
    pub(crate) runs: Vec<(usize, [Range<u32>; 2])>,
    /// The joints of all animals that are posed: rows of matrices.
    pub(crate) joints: Vec<[[f32; 4]; 3]>,
    /// Walls and ground.
    pub blocks: Vec<Block>,
}

impl DrawList {
    /// A list of animals with their numbers of layers above the skin, best near to far. One draw
    /// holds all layers of all animals of one mesh: first the skins, then the shells of each animal
    /// from the outermost to the innermost, so that nearer fragments come first.
    pub fn new(animals: &[(Stand, u32)], blocks: Vec<Block>) -> Self {
        let mut list = Self { blocks, ..Self::default() };
        list.records = animals.iter().map(|(stand, _)| Record::new(stand)).collect();
        let mut order: Vec<(usize, u32, u32)> = (0..)
            .zip(animals)
            .map(|(i, (stand, layers))| (stand.mesh, i, *layers.min(&MOST_LAYERS)))
            .collect();
        // Stable: near to far within a mesh.
        order.sort_by_key(|&(mesh, ..)| mesh);
        for of_mesh in order.chunk_by(|a, b| a.0 == b.0) {
            let first = list.shells.len() as u32;
            list.shells.extend(of_mesh.iter().map(|&(_, i, layers)| [i, layers << 16]));
            for &(_, i, layers) in of_mesh {
                list.shells.extend((1..=layers).rev().map(|layer| [i, layers << 16 | layer]));
            }
            let skins = first + of_mesh.len() as u32;
            list.runs.push((of_mesh[0].0, [first..skins, skins..list.shells.len() as u32]));
        }
        list
    }

    /// Poses an animal, by its number in the list; others are drawn at rest, and so are those whose
    /// mesh has no [weights](crate::gpu::renderer::Renderer::set_weights). Costs a copy of the
    /// joints.
    ///
    /// # Errors
    /// Refuses numbers that the list lacks.
    pub fn pose(&mut self, animal: usize, pose: &Pose) -> Result<(), Error> {
        let first = self.joints.len() as u32;
        self.record(animal)?.pose = [first, pose.matrices().len() as u32, 0, 0];
        self.joints.extend(pose.matrices().iter().map(rows_of));
        Ok(())
    }

    /// Lets the strands of an animal lean, by its number in the list. Its bounds must be those of
    /// [`Fur::leaning`](crate::strands::Fur::leaning).
    ///
    /// # Errors
    /// Refuses numbers that the list lacks.
    pub fn lean(&mut self, animal: usize, lean: Lean) -> Result<(), Error> {
        self.record(animal)?.lean = lean.towards.extend(lean.most).to_array();
        Ok(())
    }

    /// The record of an animal.
    fn record(&mut self, animal: usize) -> Result<&mut Record, Error> {
        let most = self.records.len() as f64 - 1.0;
        let refused =
            Error::Range { what: "the number of an animal", value: animal as f64, least: 0.0, most };
        self.records.get_mut(animal).ok_or(refused)
    }

    /// How many instances of meshes it draws: skins and layers.
    pub fn shells(&self) -> usize {
        self.shells.len()
    }
}

/// Layers above the skin that an animal can have.
pub const MOST_LAYERS: u32 = 1024;
