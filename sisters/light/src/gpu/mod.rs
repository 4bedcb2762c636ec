//! Passes and answers on the graphics processor of an application: its device comes in, and neither
//! a window nor a picture of ours.
//!
//! Rays of states are gathered by the processor. The device passes light along their stored hits,
//! in single precision, and all states at once (Jacobi), where the processor takes one after the
//! other: the same light in the end, after about twice as many passes. It answers by the states
//! around a point, each behind a short ray against the triangles, as [`Cache::irradiance`] does.
//! Where no state is seen the processor sends rays; the device says so, and fills such gaps by rays
//! if it is asked to ([`Gaps`]). Rays on the device also make pictures of what glossy surfaces
//! mirror ([`Mirrors`]).

mod data;
mod filter;
mod mirrors;
mod shading;

pub use mirrors::{Gaps, Gloss, Mirrors};
pub use shading::{Answers, Input, Shading, Surfaces};

use std::f32::consts::PI;

use bytemuck::Pod;
use wgpu::util::DeviceExt;
use wgpu::{BindGroup, Buffer, BufferUsages, CommandEncoder, ComputePipeline, Device, Queue};

use crate::cache::Cache;
use crate::states::DARK;

/// Threads of a group of passes, and groups in a row: adapters take 65,535.
const GROUP: usize = 64;
const ROW: usize = 32_768;

/// Why the device cannot hold a cache.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// A buffer that is larger than the device's limits.
    #[error("{what} take {bytes} bytes, but buffers of the device hold {most}")]
    TooLarge {
        /// What it holds.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The limit.
        most: u64,
    },
    /// The cache has other states than when it was uploaded: it was gathered or changed since.
    #[error("the cache has {now} gathered states, not the {then} that were uploaded: upload it anew")]
    Changed {
        /// Gathered states of the cache.
        now: usize,
        /// Those on the device.
        then: usize,
    },
}

/// Links, and two buffers of means that are written in turn.
#[derive(Debug)]
struct Filter {
    means: [Buffer; 2],
    /// From the light of passes, from the first means and from the second ones.
    groups: [BindGroup; 3],
}

/// Pipelines, compiled once.
#[derive(Debug, Clone)]
struct Pipelines {
    spread: ComputePipeline,
    renew: ComputePipeline,
    /// Made for the first links.
    smoothed: Option<ComputePipeline>,
}

/// A cache on the device: its states, hits, entries and triangles.
#[derive(Debug)]
pub struct GpuCache {
    /// Gathered states.
    states: usize,
    sky: Buffer,
    direct: Buffer,
    indirect: Buffer,
    /// Passes read one half of the sent light and write the other: a bind group for each way.
    passes: [BindGroup; 2],
    renewals: [BindGroup; 2],
    pipelines: Pipelines,
    /// Which half the next pass reads.
    turn: usize,
    lookup: [Buffer; 6],
    /// Lights and lamps, and how many there are.
    sources: [Buffer; 2],
    /// The colours and normals of triangles, and the radiance where nothing is: for mirrors.
    skins: Buffer,
    open_sky: [[f32; 4]; 4],
    count: Buffer,
    blocks: Buffer,
    filter: Option<Filter>,
    /// 0 for the light of passes, else 1 more than the number of the means.
    shown: usize,
}

fn filled<T: Pod>(
    device: &Device,
    what: &'static str,
    contents: &[T],
    usage: BufferUsages,
) -> Result<Buffer, GpuError> {
    let limits = device.limits();
    let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    let mut bytes = bytemuck::cast_slice::<T, u8>(contents).to_vec();
    // Nothing of size 0 can be bound; the largest element has 48 bytes.
    bytes.resize(bytes.len().max(48), 0);
    if bytes.len() as u64 > most {
        return Err(GpuError::TooLarge { what, bytes: bytes.len() as u64, most });
    }
    let usage = usage | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
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

fn bind(device: &Device, layout: &wgpu::BindGroupLayout, all: &[(u32, &Buffer)]) -> BindGroup {
    let mut entries = Vec::new();
    for (binding, buffer) in all {
        entries.push(wgpu::BindGroupEntry { binding: *binding, resource: buffer.as_entire_binding() });
    }
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

impl GpuCache {
    /// Uploads a cache with its light. The device needs eight storage buffers for a shader, as all
    /// have by default. Costs the bytes of the cache.
    ///
    /// # Errors
    /// If the device's buffers are too small.
    pub fn new(device: &Device, cache: &Cache) -> Result<Self, GpuError> {
        let source = format!("const PI = {PI:?};\nconst DARK = {DARK}u;\n{}", include_str!("pass.wgsl"));
        let spread = pipeline(device, source.clone(), "spread");
        let renew = pipeline(device, source, "renew");
        Self::with(device, cache, Pipelines { spread, renew, smoothed: None })
    }

    /// Uploads the cache anew: it was gathered further, or objects moved. As [`Self::new`], but
    /// nothing is compiled. Links are none then: see [`GpuCache::link`].
    ///
    /// # Errors
    /// If the device's buffers are too small; then the cache stays that was there.
    pub fn renew(&mut self, device: &Device, cache: &Cache) -> Result<(), GpuError> {
        *self = Self::with(device, cache, self.pipelines.clone())?;
        Ok(())
    }

    fn with(device: &Device, cache: &Cache, pipelines: Pipelines) -> Result<Self, GpuError> {
        let storage = |what, contents: &[[f32; 4]]| filled(device, what, contents, BufferUsages::STORAGE);
        let of = |part: fn(&crate::cache::Glow) -> glam::Vec3| {
            cache.glow.iter().map(|g| data::four(part(g), 0.0)).collect::<Vec<_>>()
        };
        let count = [cache.gathered.len() as u32, (ROW * GROUP) as u32, 0, 0];
        let count = filled(device, "the number of states", &count, BufferUsages::UNIFORM)?;
        let blocks = filled(device, "gathered states", &data::blocks(cache), BufferUsages::STORAGE)?;
        let hits = filled(device, "hits", &data::hits(cache), BufferUsages::STORAGE)?;
        let sky = filled(device, "surfaces", &data::surfaces(cache), BufferUsages::STORAGE)?;
        let [direct, indirect] =
            [storage("direct light", &of(|g| g.direct))?, storage("indirect light", &of(|g| g.indirect))?];
        let out = [storage("sent light", &of(|g| g.out))?, storage("sent light", &of(|g| g.out))?];
        let passes = [0, 1].map(|turn| {
            let all: [&Buffer; 8] =
                [&count, &blocks, &hits, &sky, &direct, &out[turn], &out[1 - turn], &indirect];
            bind(device, &pipelines.spread.get_bind_group_layout(0), &number(&all))
        });
        let renewals = [0, 1].map(|turn| {
            // What the next pass reads is written.
            let all = [(0, &count), (1, &blocks), (3, &sky), (4, &direct), (6, &out[turn]), (7, &indirect)];
            bind(device, &pipelines.renew.get_bind_group_layout(0), &all)
        });
        let lookup = Self::tables(device, cache)?;
        let sources = Self::sources(device, cache)?;
        let skins = filled(device, "colours", &data::skins(cache), BufferUsages::STORAGE)?;
        let states = cache.gathered.len();
        Ok(Self {
            states,
            sky,
            direct,
            indirect,
            passes,
            renewals,
            pipelines,
            turn: 0,
            lookup,
            sources,
            skins,
            open_sky: data::open_sky(cache),
            count,
            blocks,
            filter: None,
            shown: 0,
        })
    }

    /// What answers are found in, but for the light.
    fn tables(device: &Device, cache: &Cache) -> Result<[Buffer; 6], GpuError> {
        let storage = BufferUsages::STORAGE;
        let (grid, cells) = data::cells(cache);
        let (states, starts) = data::states(cache);
        let entry = |e: &crate::voxels::Entry| data::four(e.normal, e.area);
        let entries: Vec<[f32; 4]> = cache.voxels.entries.iter().map(entry).collect();
        Ok([
            filled(device, "the grid", &[grid], BufferUsages::UNIFORM)?,
            filled(device, "cells", &cells, storage)?,
            filled(device, "entries", &entries, storage)?,
            filled(device, "states", &states, storage)?,
            filled(device, "starts", &starts, storage)?,
            filled(device, "triangles", &data::triangles(cache), storage)?,
        ])
    }

    fn sources(device: &Device, cache: &Cache) -> Result<[Buffer; 2], GpuError> {
        let (counts, sources) = data::sources(cache);
        Ok([
            filled(device, "lights and lamps", &sources, BufferUsages::STORAGE)?,
            filled(device, "the number of lights", &[counts], BufferUsages::UNIFORM)?,
        ])
    }

    /// Runs passes: each gathered state takes in what its rays read of the light before the pass.
    pub fn pass(&mut self, encoder: &mut CommandEncoder, passes: u32) {
        self.shown = 0;
        for _ in 0..passes {
            self.dispatch(encoder, &self.pipelines.spread, &self.passes[self.turn]);
            self.turn = 1 - self.turn;
        }
    }

    fn dispatch(&self, encoder: &mut CommandEncoder, pipeline: &ComputePipeline, group: &BindGroup) {
        let groups = self.states.div_ceil(GROUP);
        if groups == 0 {
            return;
        }
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(groups.min(ROW) as u32, groups.div_ceil(ROW) as u32, 1);
    }

    /// Uploads the lights, the direct light and the sky of the same cache, after
    /// [`Cache::set_lights`], [`Cache::direct`] or [`Cache::set_sky`]. Indirect light stays on the
    /// device: run passes.
    ///
    /// # Errors
    /// If the cache was gathered since, an object was moved that changed the number of states, or
    /// the device's buffers are too small for so many lights.
    pub fn set_direct(
        &mut self,
        device: &Device,
        queue: &Queue,
        encoder: &mut CommandEncoder,
        cache: &Cache,
    ) -> Result<(), GpuError> {
        let (now, then) = (cache.gathered.len(), self.states);
        let bytes = cache.glow.len() as u64 * size_of::<[f32; 4]>() as u64;
        if now != then || bytes.max(48) != self.direct.size() {
            return Err(GpuError::Changed { now, then });
        }
        self.sources = Self::sources(device, cache)?;
        self.open_sky = data::open_sky(cache);
        let direct: Vec<[f32; 4]> = cache.glow.iter().map(|g| data::four(g.direct, 0.0)).collect();
        queue.write_buffer(&self.direct, 0, bytemuck::cast_slice(&direct));
        queue.write_buffer(&self.sky, 0, bytemuck::cast_slice(&data::surfaces(cache)));
        self.dispatch(encoder, &self.pipelines.renew, &self.renewals[self.turn]);
        Ok(())
    }

    /// The indirect irradiance of all states, four numbers each: to be copied from and read back.
    pub fn indirect(&self) -> &Buffer {
        &self.indirect
    }

    /// Takes over indirect light that was read back from [`Self::indirect`], so that the processor
    /// answers with it.
    ///
    /// # Errors
    /// If it is not that of so many states.
    pub fn read_back(&self, cache: &mut Cache, indirect: &[[f32; 4]]) -> Result<(), GpuError> {
        let (now, then) = (cache.gathered.len(), self.states);
        if now != then || indirect.len() < cache.glow.len() {
            return Err(GpuError::Changed { now, then });
        }
        for i in 0..now {
            let state = cache.gathered[i];
            let [x, y, z, _] = indirect[state as usize];
            cache.glow[state as usize].indirect = glam::Vec3::new(x, y, z);
            cache.send(state);
        }
        cache.smoothed.clear();
        Ok(())
    }
}

fn number<'a>(buffers: &[&'a Buffer]) -> Vec<(u32, &'a Buffer)> {
    (0..).zip(buffers.iter().copied()).collect()
}
