//! Pictures by rays that read states: what glossy surfaces mirror, and gaps of irradiance.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use wgpu::util::DeviceExt;
use wgpu::{
    BindGroupEntry, BindingResource, BufferUsages, CommandEncoder, ComputePipeline, Device, TextureView,
};

use super::shading::{Surfaces, draw, drawn, shader};
use super::{GpuCache, bind, pipeline};
use crate::error::{LightError, numbers};
use crate::numeric::{LEAST_COSINE, LEAST_ROUGH, LEAST_TRIES, MOST_MIRRORED};
use crate::voxels::NONE;

/// A pass that makes pictures of what glossy surfaces mirror, of any cache: [`Cache::reflection`]
/// for every pixel.
///
/// A ray goes through the tree of triangles to the nearest one. It brings that surface's emission,
/// and its share of the light that gathered states hold around there, each behind a short ray: so
/// no light crosses walls, and shadows in mirrors are as soft as a cell is wide. Rays that hit
/// nothing see the sky.
///
/// Lobes are those of Trowbridge and Reitz (GGX, Walter et al. 2007) with the shadowing of Smith,
/// correlated by height (Heitz 2014), sampled by visible normals (Heitz 2018).
///
/// [`Cache::reflection`]: crate::Cache::reflection
#[derive(Debug)]
pub struct Mirrors(ComputePipeline);

impl Mirrors {
    /// Compiles it. The device needs eight storage buffers for a shader, as all have by default.
    pub fn new(device: &Device) -> Self {
        Self(by_rays(device, include_str!("mirrors.wgsl"), "mirrors"))
    }
}

/// A pass of rays. Each reads the states around its hit.
fn by_rays(device: &Device, main: &str, name: &'static str) -> ComputePipeline {
    let constants = format!(
        "const NONE = {NONE}u;\nconst LEAST_ROUGH: f32 = {LEAST_ROUGH:?};\n\
         const LEAST_COSINE: f32 = {LEAST_COSINE:?};\n"
    );
    let parts =
        [&constants, include_str!("spread.wgsl"), include_str!("walk.wgsl"), include_str!("rays.wgsl"), main];
    pipeline(device, shader(&parts), name)
}

/// A pass that sends rays where no state stands for a pixel: see [`GpuCache::fill`].
#[derive(Debug)]
pub struct Gaps(ComputePipeline);

impl Gaps {
    /// Compiles it. The device needs eight storage buffers for a shader, as all have by default.
    pub fn new(device: &Device) -> Self {
        Self(by_rays(device, include_str!("gaps.wgsl"), "gaps"))
    }
}

/// How surfaces mirror, and who looks.
#[derive(Debug, Clone, Copy)]
pub struct Gloss<'a> {
    /// The width of GGX of each pixel, in the first component of any format of floats or unsigned
    /// normalised numbers: the square of the roughness of most engines. 0 is a mirror, 1 is dull,
    /// and more counts as 1. Pixels with less than 0, or with what is not finite, mirror nothing
    /// and cost nothing.
    pub roughness: &'a TextureView,
    /// The eye, in metres.
    pub eye: Vec3,
    /// Rays of each pixel, 1 to 64; a mirror takes one.
    pub rays: u32,
}

/// `Gloss` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Uniform {
    eye: [f32; 3],
    rays: u32,
    sky: [[f32; 4]; 4],
    tile: [u32; 2],
    lanes: u32,
    tries: u32,
}

/// Threads of a workgroup: those of the shader.
const THREADS: u32 = 64;

/// Threads that share the rays of a pixel at most.
///
/// More at once than one after the other; and software adapters (llvmpipe) end all loops of a
/// thread after 65,535 turns without a word, which 48 rays in a furnished room take.
const MOST_LANES: u32 = 8;

impl Uniform {
    fn new(eye: Vec3, rays: u32, sky: [[f32; 4]; 4]) -> Self {
        let lanes = rays.next_power_of_two().min(MOST_LANES);
        // About as high as wide, a power of two.
        let height = 1 << ((THREADS / lanes).ilog2() / 2);
        let tile = [THREADS / lanes / height, height];
        Self { eye: eye.to_array(), rays, sky, tile, lanes, tries: LEAST_TRIES.div_ceil(rays) }
    }
}

impl GpuCache {
    /// Makes a picture of mirrored light, `rgba32float` with `STORAGE_BINDING`, of the size of what
    /// the application drew: the mean radiance of each pixel's lobe, in watts per square metre and
    /// steradian. Multiply it by the surface's directional albedo (the usual table of two sums).
    ///
    /// The last component is 1 where all rays found light; less by half of the share of rays, as
    /// the lobe weighs them, that hit a surface for which no gathered state stands: 0.5 if all did.
    /// They bring its emission only, and [`Cache::request_reflections`] asks for its states. It is 0
    /// where no ray was sent: where nothing was drawn or mirrors, the eye is below the surface, or
    /// a number is not finite.
    ///
    /// A pixel's rays depend on its position alone, so that nothing flickers while the eye stands
    /// still; each set of rays differs from the next pixel's, so that means over pixels tend to the
    /// lobe's.
    ///
    /// Costs for each ray a walk to its hit, and there a look-up with its short rays.
    ///
    /// # Errors
    /// If there are no or too many rays, or the eye is not finite.
    ///
    /// [`Cache::request_reflections`]: crate::Cache::request_reflections
    pub fn mirror(
        &self,
        device: &Device,
        encoder: &mut CommandEncoder,
        mirrors: &Mirrors,
        surfaces: Surfaces,
        gloss: Gloss,
        picture: &TextureView,
    ) -> Result<(), LightError> {
        numbers("the eye", 0, gloss.eye, -f32::MAX..=f32::MAX)?;
        let of = Uniform::new(gloss.eye, checked(gloss.rays)?, self.open_sky);
        self.send(device, encoder, &mirrors.0, (surfaces, gloss.roughness, picture), &of);
        Ok(())
    }

    /// Runs a pass of [`by_rays`], which reads one more picture.
    fn send(
        &self,
        device: &Device,
        encoder: &mut CommandEncoder,
        pipeline: &ComputePipeline,
        (surfaces, given, picture): (Surfaces, &TextureView, &TextureView),
        of: &Uniform,
    ) {
        let uniform = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("the rays"),
            contents: bytemuck::bytes_of(of),
            usage: BufferUsages::UNIFORM,
        });
        let more = [
            BindGroupEntry { binding: 4, resource: BindingResource::TextureView(given) },
            BindGroupEntry { binding: 5, resource: uniform.as_entire_binding() },
        ];
        let group = drawn(device, pipeline, surfaces, picture, &more);
        let all = self.tables().chain([(9, &self.direct), (10, &self.skins)]);
        draw(encoder, pipeline, [&group, &bind(device, pipeline, all)], picture, of.tile);
    }

    /// Fills the gaps of a picture of irradiance that [`GpuCache::shade`] made: where no state
    /// stands for a pixel, so many rays (1 to 64) read the states around their hits, as
    /// [`Cache::irradiance`] does. `before` is that picture, and `picture` another one of its size
    /// and format.
    ///
    /// The last component is 0.5 in what were gaps. Costs a copy, and the rays there.
    ///
    /// # Errors
    /// If there are no or too many rays.
    ///
    /// [`Cache::irradiance`]: crate::Cache::irradiance
    pub fn fill(
        &self,
        device: &Device,
        encoder: &mut CommandEncoder,
        (gaps, rays): (&Gaps, u32),
        surfaces: Surfaces,
        (before, picture): (&TextureView, &TextureView),
    ) -> Result<(), LightError> {
        let of = Uniform::new(Vec3::ZERO, checked(rays)?, self.open_sky);
        self.send(device, encoder, &gaps.0, (surfaces, before, picture), &of);
        Ok(())
    }
}

fn checked(rays: u32) -> Result<u32, LightError> {
    numbers("the rays of a pixel", 0, Vec3::splat(rays as f32), 1.0..=MOST_MIRRORED as f32)?;
    Ok(rays)
}
