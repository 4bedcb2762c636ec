//! The splat operator by compute shaders (Tavares 2009, chapter 5; there by geometry and fragment shaders).
//!
//! Squares are drawn by atomic minima of depths, as in Schütz, Kerbl & Wimmer 2021, "Rendering Point Clouds with Compute Shaders and
//! Vertex Order Optimization". Their shaders pack the depth with the index of a point, since a pixel shows one point. Here each point is
//! tested against the depths, so that these are enough, and any adapter has the 32-bit operations for them.

use bitvec::vec::BitVec;
use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::wgpu::util::{BufferInitDescriptor, DeviceExt};
use casca_stage::wgpu::{self, BufferBindingType, BufferUsages, ShaderStages};
use glam::Vec3;

use crate::camera::Camera;
use crate::splat::{Bias, Filter, Radius, SplatError, SplatOptions, check};

/// Points in a buffer: 50 MB, less than the least limit of any adapter.
const CHUNK: usize = 1 << 22;
/// Levels of squares; the largest has `2^(LEVELS - 1)` pixels on a side.
const LEVELS: usize = 11;
/// Bytes between two numbers of a uniform buffer that shaders are given one by one.
const STRIDE: u32 = 256;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuSplatError {
    /// A point or a parameter is at fault.
    #[error(transparent)]
    Splat(#[from] SplatError),
    /// There is no room on the device, or it is lost.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Points in the memory of a device, 12 bytes each and a bit for the answer.
pub struct GpuPoints {
    count: usize,
    chunks: Vec<Chunk>,
}

struct Chunk {
    count: usize,
    points: wgpu::Buffer,
    visible: wgpu::Buffer,
}

impl GpuPoints {
    /// Copies points to the device.
    ///
    /// # Errors
    ///
    /// A coordinate is not finite, or the device has no room.
    pub fn new(gpu: &Gpu, points: &[Vec3]) -> Result<Self, GpuSplatError> {
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(SplatError::PointNotFinite { index }.into());
        }
        let chunk = |points: &[Vec3]| {
            let flat: Vec<[f32; 3]> = points.iter().map(Vec3::to_array).collect();
            let visible = gpu.buffer(points.len().div_ceil(32) as u64 * 4, BufferUsages::STORAGE)?;
            Ok(Chunk { count: points.len(), points: filled(gpu, &flat)?, visible })
        };
        let chunks = points.chunks(CHUNK).map(chunk).collect::<Result<_, GpuError>>()?;
        Ok(Self { count: points.len(), chunks })
    }
}

/// A buffer with these contents.
fn filled<T: Pod>(gpu: &Gpu, contents: &[T]) -> Result<wgpu::Buffer, GpuError> {
    let bytes: &[u8] = bytemuck::cast_slice(contents);
    let buffer = gpu.buffer(bytes.len() as u64, BufferUsages::STORAGE)?;
    gpu.queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

/// The camera and the options as the shaders take them.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Lens {
    eye: [f32; 3],
    near: f32,
    right: [f32; 3],
    far: f32,
    down: [f32; 3],
    scale: f32,
    forward: [f32; 3],
    zero: u32,
    centre: [f32; 2],
    size: [i32; 2],
    bias: [f32; 3],
    window: u32,
    filtering: u32,
    each: u32,
    padding: [u32; 2],
    starts: [u32; 12],
}

impl Lens {
    fn new(camera: &Camera, options: &SplatOptions) -> Self {
        let [right, down, forward] = camera.axes().map(|axis| axis.to_array());
        let ((width, height), (near, far)) = (camera.size(), camera.depths());
        let scale = match options.radius {
            Radius::Same(radius) => radius * camera.pixels_per_tangent(),
            Radius::Each(_) => camera.pixels_per_tangent(),
        };
        let bias = match options.bias {
            Bias::World(length) => [length, 0.0, 0.0],
            Bias::Window(part) => [0.0, 1.0 - part, part / far],
        };
        let mut starts = [0; 12];
        for k in 0..LEVELS {
            starts[k + 1] = starts[k] + entries(camera.size(), k);
        }
        Self {
            eye: camera.eye().to_array(),
            near,
            right,
            far,
            down,
            scale,
            forward,
            zero: 0,
            centre: [width as f32 * 0.5, height as f32 * 0.5],
            size: [width as i32, height as i32],
            bias,
            window: u32::from(matches!(options.bias, Bias::Window(_))),
            filtering: match options.filter {
                Filter::None => 0,
                Filter::Max => 1,
                Filter::PlainMax => 2,
                Filter::Min => 3,
            },
            each: u32::from(matches!(options.radius, Radius::Each(_))),
            padding: [0; 2],
            starts,
        }
    }
}

/// The squares of a level that are in the picture at least in part.
fn entries((width, height): (u32, u32), k: usize) -> u32 {
    let border = if k == 0 { 0 } else { 1 << k };
    (width + border) * (height + border)
}

/// The shaders of the splat operator.
pub struct SplatOperator {
    picture: wgpu::BindGroupLayout,
    cloud: wgpu::BindGroupLayout,
    /// Numbers of levels.
    numbers: wgpu::Buffer,
    measure: wgpu::ComputePipeline,
    draw: wgpu::ComputePipeline,
    push: wgpu::ComputePipeline,
    limit: wgpu::ComputePipeline,
    test: wgpu::ComputePipeline,
}

impl SplatOperator {
    /// Compiles the shaders.
    pub fn new(gpu: &Gpu) -> Self {
        let device = &gpu.device;
        let uniform = |dynamic| (BufferBindingType::Uniform, dynamic);
        let storage = |read_only| (BufferBindingType::Storage { read_only }, false);
        let layout = |entries: &[(BufferBindingType, bool)]| {
            let entry = |(binding, &(ty, has_dynamic_offset))| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None },
                count: None,
            };
            let entries: Vec<_> = (0..).zip(entries).map(entry).collect();
            device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
        };
        let picture =
            layout(&[uniform(false), uniform(true), storage(false), storage(false), storage(false)]);
        let cloud = layout(&[storage(true), storage(true), storage(false)]);
        let shader = device.create_shader_module(wgpu::include_wgsl!("splat.wgsl"));
        let pipeline = |entry: &str, groups: &[Option<&wgpu::BindGroupLayout>]| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                bind_group_layouts: groups,
                ..Default::default()
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout),
                module: &shader,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        let [of_picture, of_cloud] = [&[Some(&picture)][..], &[Some(&picture), Some(&cloud)]];
        let mut numbers = vec![0_u32; LEVELS * STRIDE as usize / 4];
        (0..LEVELS).for_each(|k| numbers[k * STRIDE as usize / 4] = k as u32);
        Self {
            measure: pipeline("measure", of_cloud),
            draw: pipeline("draw", of_cloud),
            push: pipeline("push", of_picture),
            limit: pipeline("limit", of_picture),
            test: pipeline("test", of_cloud),
            numbers: uniforms(gpu, &numbers),
            picture,
            cloud,
        }
    }

    /// A bit for each point: whether the camera sees it, as
    /// [`splat::visible_points`](crate::splat::visible_points) finds it on the processor.
    ///
    /// The answers are the same, bit by bit, as long as no number is so small that it is subnormal, below 10^-38: devices may take those
    /// as 0. All else is arranged: products are not fused with sums, quotients are rounded by whole numbers.
    ///
    /// Costs a few operations for each point, whatever the radii, two waits for the device, and the answers' bits, which are copied back.
    /// A radius for each point is copied to the device in each call. The device needs room for a depth image for each doubling of the
    /// largest square's side.
    ///
    /// # Errors
    ///
    /// [`GpuSplatError`] names the parameter at fault, or what the device lacks.
    pub fn visible_points(
        &self,
        gpu: &Gpu,
        points: &GpuPoints,
        camera: &Camera,
        options: &SplatOptions,
    ) -> Result<BitVec, GpuSplatError> {
        check(points.count, options)?;
        let lens = Lens::new(camera, options);
        let radii: Vec<_> = match options.radius {
            Radius::Same(_) => points.chunks.iter().map(|chunk| chunk.points.clone()).collect(),
            Radius::Each(radii) => {
                radii.chunks(CHUNK).map(|radii| filled(gpu, radii)).collect::<Result<_, _>>()?
            }
        };
        let cloud = |(chunk, radii): (&Chunk, &wgpu::Buffer)| {
            bind(gpu, &self.cloud, &[whole(&chunk.points), whole(radii), whole(&chunk.visible)])
        };
        let clouds: Vec<_> = points.chunks.iter().zip(&radii).map(cloud).collect();
        let (lens_buffer, found) = (uniforms(gpu, &[lens]), gpu.buffer(4, BufferUsages::STORAGE)?);
        let limits = gpu.buffer(u64::from(entries(camera.size(), 0)) * 4, BufferUsages::STORAGE)?;
        let picture = |far_bits: &wgpu::Buffer| {
            let level =
                wgpu::BufferBinding { buffer: &self.numbers, offset: 0, size: std::num::NonZeroU64::new(4) };
            let buffers = [whole(&lens_buffer), level, whole(far_bits), whole(&limits), whole(&found)];
            bind(gpu, &self.picture, &buffers)
        };
        let job = Job { gpu, points, clouds: &clouds, size: camera.size() };
        // The first pass draws nothing.
        let nowhere = picture(&gpu.buffer(4, BufferUsages::STORAGE)?);
        job.run(&mut |pass| job.over_points(pass, &self.measure, &nowhere));
        let levels = gpu.read_buffer(&found)?.first().map_or(0, |&n| usize::from(n)).clamp(1, LEVELS);
        let far_bits = gpu.buffer(u64::from(lens.starts[levels]) * 4, BufferUsages::STORAGE)?;
        let picture = picture(&far_bits);
        job.run(&mut |pass| {
            job.over_points(pass, &self.draw, &picture);
            for k in (0..levels - 1).rev() {
                job.over_pixels(pass, &self.push, &picture, k);
            }
            job.over_pixels(pass, &self.limit, &picture, 0);
            job.over_points(pass, &self.test, &picture);
        });
        job.answers()
    }
}

/// A run of the operator.
struct Job<'a> {
    gpu: &'a Gpu,
    points: &'a GpuPoints,
    clouds: &'a [wgpu::BindGroup],
    size: (u32, u32),
}

impl Job<'_> {
    /// Hands passes to the device; all answers are "hidden" before.
    fn run(&self, passes: &mut dyn FnMut(&mut wgpu::ComputePass<'_>)) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.points.chunks.iter().for_each(|chunk| encoder.clear_buffer(&chunk.visible, 0, None));
        passes(&mut encoder.begin_compute_pass(&Default::default()));
        self.gpu.queue.submit([encoder.finish()]);
    }

    fn over_points(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        pipeline: &wgpu::ComputePipeline,
        picture: &wgpu::BindGroup,
    ) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, picture, &[0]);
        for (chunk, cloud) in self.points.chunks.iter().zip(self.clouds) {
            pass.set_bind_group(1, cloud, &[]);
            pass.dispatch_workgroups(chunk.count.div_ceil(256) as u32, 1, 1);
        }
    }

    fn over_pixels(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        pipeline: &wgpu::ComputePipeline,
        picture: &wgpu::BindGroup,
        k: usize,
    ) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, picture, &[k as u32 * STRIDE]);
        let groups = |side: u32| (side + (1 << k)).div_ceil(16);
        pass.dispatch_workgroups(groups(self.size.0), groups(self.size.1), 1);
    }

    fn answers(&self) -> Result<BitVec, GpuSplatError> {
        let mut words = Vec::new();
        for chunk in &self.points.chunks {
            let bytes = self.gpu.read_buffer(&chunk.visible)?;
            words.extend(
                bytes.chunks(size_of::<usize>()).map(|bytes| {
                    bytes.iter().rev().fold(0_usize, |word, &byte| word << 8 | usize::from(byte))
                }),
            );
        }
        let mut visible = BitVec::from_vec(words);
        visible.truncate(self.points.count);
        Ok(visible)
    }
}

fn uniforms<T: Pod>(gpu: &Gpu, contents: &[T]) -> wgpu::Buffer {
    let contents = bytemuck::cast_slice(contents);
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: None,
        contents,
        usage: BufferUsages::UNIFORM,
    })
}

fn whole(buffer: &wgpu::Buffer) -> wgpu::BufferBinding<'_> {
    buffer.as_entire_buffer_binding()
}

fn bind(gpu: &Gpu, layout: &wgpu::BindGroupLayout, buffers: &[wgpu::BufferBinding<'_>]) -> wgpu::BindGroup {
    let resources = buffers.iter().cloned().map(wgpu::BindingResource::Buffer);
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
