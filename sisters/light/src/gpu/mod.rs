//! Answers on the graphics processor of an application: its device comes in, and neither a window
//! nor a picture of ours.
//!
//! The processor gathers rays, passes light along them and smooths it. The device answers by the
//! states around a point, each behind a short ray against the triangles, as [`Cache::irradiance`]
//! does. Where no state is seen the processor sends rays; the device says so, and fills such gaps
//! by rays if it is asked to ([`Gaps`]). Rays on the device also make pictures of what glossy
//! surfaces mirror ([`Mirrors`]).

mod data;
mod mirrors;
mod shading;

pub use mirrors::{Gaps, Gloss, Mirrors};
pub use shading::{Answers, Shading, Surfaces};

use bytemuck::Pod;
use wgpu::util::DeviceExt;
use wgpu::{BindGroup, Buffer, BufferUsages, ComputePipeline, Device};

use crate::cache::Cache;

/// A buffer that is larger than the device's limits.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{what} take {bytes} bytes, but buffers of the device hold {most}")]
pub struct TooLarge {
    /// What it holds.
    pub what: &'static str,
    /// Its size.
    pub bytes: u64,
    /// The limit.
    pub most: u64,
}

/// A cache on the device: its light, states, entries and triangles.
#[derive(Debug)]
pub struct GpuCache {
    /// What answers are found in, but for the light.
    lookup: [Buffer; 6],
    direct: Buffer,
    indirect: Buffer,
    /// Lights and lamps, and how many there are.
    sources: [Buffer; 2],
    /// The colours and normals of triangles, and the radiance where nothing is: for mirrors.
    skins: Buffer,
    open_sky: [[f32; 4]; 4],
}

fn filled<T: Pod>(
    device: &Device,
    what: &'static str,
    contents: &[T],
    usage: BufferUsages,
) -> Result<Buffer, TooLarge> {
    let limits = device.limits();
    let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    let mut bytes = bytemuck::cast_slice::<T, u8>(contents).to_vec();
    // Nothing of size 0 can be bound; the largest element has 48 bytes.
    bytes.resize(bytes.len().max(48), 0);
    if bytes.len() as u64 > most {
        return Err(TooLarge { what, bytes: bytes.len() as u64, most });
    }
    let descriptor = wgpu::util::BufferInitDescriptor { label: Some(what), contents: &bytes, usage };
    Ok(device.create_buffer_init(&descriptor))
}

fn pipeline(device: &Device, source: String, name: &'static str) -> ComputePipeline {
    let source = wgpu::ShaderSource::Wgsl(source.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(name),
        layout: None,
        module: &module,
        entry_point: Some(name),
        compilation_options: Default::default(),
        cache: None,
    })
}

/// The buffers of a pass: its group 1.
fn bind<'a>(
    device: &Device,
    pipeline: &ComputePipeline,
    buffers: impl IntoIterator<Item = (u32, &'a Buffer)>,
) -> BindGroup {
    let entry = |(binding, buffer): (u32, &'a Buffer)| {
        let resource = buffer.as_entire_binding();
        wgpu::BindGroupEntry { binding, resource }
    };
    let entries: Vec<_> = buffers.into_iter().map(entry).collect();
    let layout = &pipeline.get_bind_group_layout(1);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

impl GpuCache {
    /// Uploads a cache with its light, as it is smoothed now: anew when that changed. The device
    /// needs eight storage buffers for a shader, as all have by default. Costs the bytes of the
    /// cache without its rays.
    ///
    /// # Errors
    /// If the device's buffers are too small.
    pub fn new(device: &Device, cache: &Cache) -> Result<Self, TooLarge> {
        let storage = BufferUsages::STORAGE;
        let (grid, cells) = data::cells(cache);
        let (states, starts) = data::states(cache);
        let entry = |e: &crate::voxels::Entry| data::four(e.normal, e.area);
        let entries: Vec<[f32; 4]> = cache.voxels.entries.iter().map(entry).collect();
        let direct: Vec<_> = cache.glow.iter().map(|g| data::four(g.direct, 0.0)).collect();
        let indirect: Vec<_> =
            (0..cache.voxels.states()).map(|state| data::four(cache.shown(state), 0.0)).collect();
        let (counts, sources) = data::sources(cache);
        Ok(Self {
            lookup: [
                filled(device, "the grid", &[grid], BufferUsages::UNIFORM)?,
                filled(device, "cells", &cells, storage)?,
                filled(device, "entries", &entries, storage)?,
                filled(device, "states", &states, storage)?,
                filled(device, "starts", &starts, storage)?,
                filled(device, "triangles", &data::triangles(cache), storage)?,
            ],
            direct: filled(device, "direct light", &direct, storage)?,
            indirect: filled(device, "indirect light", &indirect, storage)?,
            sources: [
                filled(device, "lights and lamps", &sources, storage)?,
                filled(device, "the number of lights", &[counts], BufferUsages::UNIFORM)?,
            ],
            skins: filled(device, "colours", &data::skins(cache), storage)?,
            open_sky: data::open_sky(cache),
        })
    }

    /// The tables of answers and the indirect light, by binding.
    fn tables(&self) -> impl Iterator<Item = (u32, &Buffer)> {
        (0..).zip(self.lookup.iter().chain([&self.indirect]))
    }
}
