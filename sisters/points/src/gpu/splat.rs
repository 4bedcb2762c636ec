//! The splat operator by compute shaders (Tavares 2009, chapter 5; there by geometry and fragment
//! shaders).
//!
//! Squares are drawn by atomic minima of depths, as in Schütz, Kerbl & Wimmer 2021, "Rendering
//! Point Clouds with Compute Shaders and Vertex Order Optimization". Their shaders pack the depth
//! with the index of a point, since a pixel shows one point. Here each point is tested against the
//! depths, so that these are enough, and any adapter has the 32-bit operations for them.

use std::num::NonZeroU64;

use bitvec::vec::BitVec;
use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::wgpu::util::{BufferInitDescriptor, DeviceExt};
use casca_stage::wgpu::{self, BufferUsages};
use glam::Vec3;

use crate::Camera;
use crate::splat::{Bias, Filter, Radius, SplatError, SplatOptions};

/// Points in a buffer: 50 MB, less than the least limit of any adapter.
const CHUNK: usize = 1 << 22;
/// Levels of squares; the largest has `2^(LEVELS - 1)` pixels on a side.
const LEVELS: usize = 11;
/// Bytes between two numbers of a uniform buffer that shaders are given one by one.
const STRIDE: u64 = 256;

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
    slopes: u32,
    padding: u32,
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
            slopes: u32::from(options.slopes),
            padding: 0,
            starts,
        }
    }
}

/// The squares of a level that are in the picture at least in part.
fn entries((width, height): (u32, u32), k: usize) -> u32 {
    let border = if k == 0 { 0 } else { 1 << k };
    (width + border) * (height + border)
}

/// The steps of the operator, and the bindings that each uses.
const STEPS: [(&str, &[u32]); 5] = [
    ("measure", &[0, 4, 5, 6]),
    ("draw", &[0, 2, 5, 6]),
    ("push", &[0, 1, 2]),
    ("limit", &[0, 2, 3]),
    ("test", &[0, 3, 5, 6, 7]),
];
const MEASURE: usize = 0;
const DRAW: usize = 1;
const PUSH: usize = 2;
const LIMIT: usize = 3;
const TEST: usize = 4;

/// The shaders of the splat operator.
pub struct SplatOperator {
    steps: [wgpu::ComputePipeline; 5],
    /// Numbers of levels.
    numbers: wgpu::Buffer,
}

impl SplatOperator {
    /// Compiles the shaders.
    pub fn new(gpu: &Gpu) -> Self {
        let shader = gpu.device.create_shader_module(wgpu::include_wgsl!("splat.wgsl"));
        let steps = STEPS.map(|(entry, _)| {
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: None,
                module: &shader,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        });
        let number = |k| std::iter::once(k as u32).chain([0; STRIDE as usize / 4 - 1]);
        let numbers: Vec<u32> = (0..LEVELS).flat_map(number).collect();
        Self { steps, numbers: uniforms(gpu, &numbers) }
    }

    /// A bit for each point: whether the camera sees it, as
    /// [`splat::visible_points`](crate::splat::visible_points) finds it on the processor.
    ///
    /// The answers are the same, bit by bit, as long as no number is so small that it is subnormal,
    /// below 10^-38: devices may take those as 0. The shaders keep products from being fused with
    /// sums, and round quotients by whole numbers.
    ///
    /// Costs a few operations for each point, whatever the radii, and two waits for the device; the
    /// bits of the answers are copied back. A radius for each point is copied to the device in each
    /// call. The device needs room for a depth image for each doubling of the largest square's
    /// side.
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
        options.check(points.count)?;
        let lens = Lens::new(camera, options);
        let radii = match options.radius {
            Radius::Same(_) => Vec::new(),
            Radius::Each(radii) => {
                radii.chunks(CHUNK).map(|radii| filled(gpu, radii)).collect::<Result<_, _>>()?
            }
        };
        let storage = |entries: u32| gpu.buffer(u64::from(entries) * 4, BufferUsages::STORAGE);
        let (found, nowhere) = (storage(1)?, storage(1)?);
        let mut run = Run {
            gpu,
            operator: self,
            points,
            size: camera.size(),
            lens: uniforms(gpu, &[lens]),
            far_bits: nowhere,
            limits: storage(entries(camera.size(), 0))?,
            found,
            radii,
        };
        run.submit(&|pass| run.over_points(pass, MEASURE));
        let levels = gpu.read_buffer(&run.found)?.first().map_or(0, |&n| usize::from(n)).clamp(1, LEVELS);
        run.far_bits = storage(lens.starts[levels])?;
        run.submit(&|pass| {
            run.over_points(pass, DRAW);
            (0..levels - 1).rev().for_each(|k| run.over_pixels(pass, PUSH, k));
            run.over_pixels(pass, LIMIT, 0);
            run.over_points(pass, TEST);
        });
        run.answers()
    }
}

/// A run of the operator.
struct Run<'a> {
    gpu: &'a Gpu,
    operator: &'a SplatOperator,
    points: &'a GpuPoints,
    size: (u32, u32),
    lens: wgpu::Buffer,
    far_bits: wgpu::Buffer,
    limits: wgpu::Buffer,
    /// The number of levels.
    found: wgpu::Buffer,
    /// For each chunk; empty if all points have the same radius.
    radii: Vec<wgpu::Buffer>,
}

impl Run<'_> {
    /// Hands steps to the device. Before them all points are hidden.
    fn submit(&self, steps: &dyn Fn(&mut wgpu::ComputePass<'_>)) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.points.chunks.iter().for_each(|chunk| encoder.clear_buffer(&chunk.visible, 0, None));
        steps(&mut encoder.begin_compute_pass(&Default::default()));
        self.gpu.queue.submit([encoder.finish()]);
    }

    fn over_points(&self, pass: &mut wgpu::ComputePass<'_>, step: usize) {
        for (i, chunk) in self.points.chunks.iter().enumerate() {
            let radii = self.radii.get(i).unwrap_or(&chunk.points);
            let of_chunk = [&chunk.points, radii, &chunk.visible].map(wgpu::Buffer::as_entire_binding);
            self.dispatch(pass, step, 0, &of_chunk, [chunk.count.div_ceil(256) as u32, 1]);
        }
    }

    /// Over the squares of level `k`.
    fn over_pixels(&self, pass: &mut wgpu::ComputePass<'_>, step: usize, k: usize) {
        let groups = |side: u32| (side + (1 << k)).div_ceil(16);
        self.dispatch(pass, step, k, &[], [groups(self.size.0), groups(self.size.1)]);
    }

    fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        step: usize,
        k: usize,
        of_chunk: &[wgpu::BindingResource<'_>],
        [x, y]: [u32; 2],
    ) {
        let level = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.operator.numbers,
            offset: k as u64 * STRIDE,
            size: NonZeroU64::new(4),
        });
        let [lens, far_bits, limits, found] =
            [&self.lens, &self.far_bits, &self.limits, &self.found].map(wgpu::Buffer::as_entire_binding);
        let all = [lens, level, far_bits, limits, found].into_iter().chain(of_chunk.iter().cloned());
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let is_used = |entry: &wgpu::BindGroupEntry<'_>| STEPS[step].1.contains(&entry.binding);
        let pipeline = &self.operator.steps[step];
        let group = self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &(0..).zip(all).map(entry).filter(is_used).collect::<Vec<_>>(),
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }

    fn answers(&self) -> Result<BitVec, GpuSplatError> {
        let mut words = Vec::new();
        for chunk in &self.points.chunks {
            let bytes = self.gpu.read_buffer(&chunk.visible)?;
            let word = |b: &[u8]| b.iter().rev().fold(0, |word: usize, &byte| word << 8 | usize::from(byte));
            words.extend(bytes.chunks(size_of::<usize>()).map(word));
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
