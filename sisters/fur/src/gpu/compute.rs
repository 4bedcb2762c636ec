//! Runs the functions of shaders alone, for tests that compare them with the processor's.

use casca_stage::gpu::Gpu;
use casca_stage::wgpu::{self, BufferUsages};

/// A buffer that a shader reads: its group, its binding and its contents.
pub(super) struct Given<'a> {
    pub(super) place: (u32, u32),
    pub(super) usage: BufferUsages,
    pub(super) bytes: &'a [u8],
}

/// The words that `threads` threads of a shader with one entry point, in groups of 64, write into
/// the `bytes` bytes of the buffer at `found` (group and binding).
pub(super) fn computed(
    gpu: &Gpu,
    source: String,
    given: &[Given],
    (found, bytes): ((u32, u32), usize),
    threads: usize,
) -> Vec<u8> {
    let device = &gpu.device;
    let written = gpu.buffer(bytes as u64, BufferUsages::STORAGE).unwrap();
    let filled = |given: &Given| {
        let buffer = gpu.buffer(given.bytes.len() as u64, given.usage).unwrap();
        gpu.queue.write_buffer(&buffer, 0, given.bytes);
        (given.place, buffer)
    };
    let mut buffers: Vec<_> = given.iter().map(filled).collect();
    buffers.push((found, written.clone()));
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        }),
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    for group in 0..=buffers.iter().map(|((group, _), _)| *group).max().unwrap_or(0) {
        let of = buffers.iter().filter(|((of, _), _)| *of == group);
        let entries: Vec<_> = of
            .map(|((_, binding), buffer)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let made = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(group),
            entries: &entries,
        });
        pass.set_bind_group(group, &made, &[]);
    }
    pass.dispatch_workgroups(threads.div_ceil(64) as u32, 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    gpu.read_buffer(&written).unwrap()
}
