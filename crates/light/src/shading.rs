//! Light in voxels, and the six directional mips (thesis 2.2 to 2.5; digest S4 to S7).

use casca_stage::gpu::Gpu;
use casca_stage::kernel::Kernel;
use casca_stage::wgpu::{
    self, BindingResource, Buffer, BufferUsages, CommandEncoder, Extent3d, TextureUsages, TextureView,
};

use crate::device::{filled, held, shader, zeros};
use crate::error::{LightError, Part};
use crate::layers::Others;
use crate::volume::{BRICK, BRICK_CELLS, LEVELS, Volume};

/// Mips up to this level have texels that lie in one brick: they are made for the bricks listed.
/// Coarser ones are made whole.
const LISTED: u32 = 3;

/// The light of voxels, and the textures that cones read.
pub struct Shading {
    volume: Volume,
    direct: Buffer,
    bounced: Buffer,
    base: TextureView,
    /// For each direction all levels, and each level alone.
    mips: [(TextureView, Vec<TextureView>); 6],
    /// By direction, level and whether it is listed.
    plans: Vec<Buffer>,
    sampler: wgpu::Sampler,
    shade: Kernel,
    bounce: Kernel,
    inject: [Kernel; 2],
    reduce: Kernel,
}

/// A list of bricks on the device.
pub struct List {
    /// Their numbers.
    pub buffer: Buffer,
    /// How many.
    pub count: usize,
}

impl List {
    /// A list of these bricks.
    ///
    /// # Errors
    /// The adapter has no buffer as large.
    pub fn new(gpu: &Gpu, bricks: &[u32]) -> Result<Self, LightError> {
        Ok(Self {
            buffer: filled(gpu, Part::of_cells("a list of bricks"), bricks, BufferUsages::STORAGE)?,
            count: bricks.len(),
        })
    }
}

fn texture(gpu: &Gpu, size: glam::UVec3, mip_level_count: u32) -> Result<wgpu::Texture, LightError> {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("voxels"),
        size: Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z },
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
        view_formats: &[],
    };
    held(gpu, Part::of_cells("the textures of voxels"), || gpu.device.create_texture(&descriptor))
}

/// Buffers for the light of this many slots.
fn buffers(gpu: &Gpu, slots: usize) -> Result<[Buffer; 2], LightError> {
    let size = slots as u64 * u64::from(BRICK_CELLS) * 8;
    Ok([
        zeros(gpu, Part::of_cells("direct light"), size)?,
        zeros(gpu, Part::of_cells("light that bounces"), size)?,
    ])
}

impl Shading {
    /// Dark textures for a grid and memory for this many slots.
    ///
    /// # Errors
    /// The adapter has no textures or buffers as large.
    pub fn new(gpu: &Gpu, volume: Volume, slots: usize) -> Result<Self, LightError> {
        let (needed, limit) =
            (volume.dims.max_element().into(), gpu.device.limits().max_texture_dimension_3d.into());
        if needed > limit {
            return Err(LightError::TooLarge {
                what: "an edge of the textures",
                needed,
                limit,
                unit: "texels",
                by: "cells",
            });
        }
        let module = shader(gpu, "shade", include_str!("shade.wgsl"));
        let [direct, bounced] = buffers(gpu, slots)?;
        let base = texture(gpu, volume.dims, 1)?;
        let textures = (0..6).map(|_| texture(gpu, volume.dims / 2, LEVELS));
        let textures = textures.collect::<Result<Vec<_>, _>>()?;
        let mips = std::array::from_fn(|i| {
            let texture = &textures[i];
            let level = |base_mip_level| {
                let one = wgpu::TextureViewDescriptor {
                    base_mip_level,
                    mip_level_count: Some(1),
                    ..Default::default()
                };
                texture.create_view(&one)
            };
            (texture.create_view(&Default::default()), (0..LEVELS).map(level).collect())
        });
        let mut plans = Vec::new();
        for direction in 0..6 {
            for level in 1..=LEVELS {
                let plan = [direction / 2, direction % 2, level, u32::from(level <= LISTED)];
                plans.push(filled(gpu, Part::of_cells("a level"), &plan, BufferUsages::UNIFORM)?);
            }
        }
        let voxels = [0, 1, 2, 3, 6];
        let cones = [7, 8, 9, 10, 11, 12, 13, 14];
        Ok(Self {
            volume,
            direct,
            bounced,
            base: base.create_view(&Default::default()),
            mips,
            plans,
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
            shade: Kernel::new(gpu, &module, "shade", &[&voxels[..], &[5, 40]].concat()),
            bounce: Kernel::new(gpu, &module, "bounce", &[&voxels[..], &cones, &[41]].concat()),
            inject: [
                Kernel::new(gpu, &module, "inject_direct", &[0, 1, 2, 6, 40, 41, 42]),
                Kernel::new(gpu, &module, "inject_all", &[0, 1, 2, 6, 40, 41, 42]),
            ],
            reduce: Kernel::new(gpu, &module, "reduce", &[0, 1, 3, 6, 43, 44, 45]),
        })
    }

    /// Makes memory for this many slots; all light is lost.
    ///
    /// # Errors
    /// The adapter has no buffers as large.
    pub fn resize(&mut self, gpu: &Gpu, slots: usize) -> Result<(), LightError> {
        [self.direct, self.bounced] = buffers(gpu, slots)?;
        Ok(())
    }

    /// Direct light in the bricks listed.
    pub fn shade(&self, gpu: &Gpu, encoder: &mut CommandEncoder, list: &List, others: Others<'_, '_>) {
        self.run(gpu, encoder, &self.shade, list, 8, others);
    }

    /// Light from other voxels in the bricks listed.
    pub fn bounce(&self, gpu: &Gpu, encoder: &mut CommandEncoder, list: &List, others: Others<'_, '_>) {
        self.run(gpu, encoder, &self.bounce, list, 8, others);
    }

    /// Writes light and opacity of the bricks listed into the finest texture, with the light that
    /// bounced or without.
    pub fn inject(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        list: &List,
        bounced: bool,
        others: Others<'_, '_>,
    ) {
        self.run(gpu, encoder, &self.inject[usize::from(bounced)], list, 1, others);
    }

    /// Runs a kernel with so many groups a brick.
    fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        kernel: &Kernel,
        list: &List,
        groups: usize,
        others: Others<'_, '_>,
    ) {
        kernel.run_groups(gpu, encoder, groups * list.count, &|binding| match binding {
            6 => Some(list.buffer.as_entire_binding()),
            40 => Some(self.direct.as_entire_binding()),
            41 => Some(self.bounced.as_entire_binding()),
            42 => Some(BindingResource::TextureView(&self.base)),
            other => others(other),
        });
    }

    /// Makes the mips of the bricks listed.
    pub fn reduce(&self, gpu: &Gpu, encoder: &mut CommandEncoder, list: &List, others: Others<'_, '_>) {
        if list.count == 0 {
            return;
        }
        for level in 1..=LEVELS {
            let texels = if level <= LISTED {
                list.count * (BRICK >> level).pow(3) as usize
            } else {
                (self.volume.dims / (1 << level)).element_product() as usize
            };
            for (direction, (_, levels)) in self.mips.iter().enumerate() {
                let at = level as usize - 1;
                self.reduce.run_groups(gpu, encoder, texels.div_ceil(64), &|binding| match binding {
                    6 => Some(list.buffer.as_entire_binding()),
                    43 => Some(self.plans[direction * LEVELS as usize + at].as_entire_binding()),
                    44 if level == 1 => Some(BindingResource::TextureView(&self.base)),
                    44 => Some(BindingResource::TextureView(&levels[at - 1])),
                    45 => Some(BindingResource::TextureView(&levels[at])),
                    other => others(other),
                });
            }
        }
    }

    /// The bindings that cones read.
    pub fn resource(&self, binding: u32) -> Option<BindingResource<'_>> {
        match binding {
            7 => Some(BindingResource::TextureView(&self.base)),
            8..14 => Some(BindingResource::TextureView(&self.mips[binding as usize - 8].0)),
            14 => Some(BindingResource::Sampler(&self.sampler)),
            _ => None,
        }
    }

    /// The textures, to be read back: the finest one, and that of a direction (along x, against x,
    /// along y ...) with its levels.
    pub fn textures(&self) -> (&wgpu::Texture, [&wgpu::Texture; 6]) {
        (self.base.texture(), std::array::from_fn(|i| self.mips[i].0.texture()))
    }
}
