//! Compute passes and what they are bound to.

use bytemuck::Pod;
use wgpu::{BindingResource, BufferUsages};

use crate::gpu::{Gpu, GpuError};

/// Groups along x of a dispatch; others follow along y. Adapters take 65,535.
const GROUPS: u32 = 32_768;

/// Gives the resource of a binding by its number. The device refuses commands that lack one.
pub type Lookup<'a, 'b> = &'b dyn Fn(u32) -> Option<BindingResource<'a>>;

/// A buffer under its binding.
pub type Bound<'a> = (u32, &'a wgpu::Buffer);

/// Looks bindings up in a list of buffers.
pub fn among<'a>(buffers: &[Bound<'a>]) -> impl Fn(u32) -> Option<BindingResource<'a>> {
    move |binding| {
        let found = buffers.iter().find(|(number, _)| *number == binding);
        found.map(|(_, buffer)| buffer.as_entire_binding())
    }
}

/// The bind group of these bindings for a pipeline's layout.
pub fn bind(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    bindings: &[u32],
    lookup: Lookup<'_, '_>,
) -> wgpu::BindGroup {
    let entry = |&binding| Some(wgpu::BindGroupEntry { binding, resource: lookup(binding)? });
    let entries: Vec<_> = bindings.iter().filter_map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// A compute pass.
pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
    bindings: Vec<u32>,
    name: &'static str,
}

impl Kernel {
    /// The entry `name` of a shader, which uses just these bindings.
    pub fn new(gpu: &Gpu, module: &wgpu::ShaderModule, name: &'static str, bindings: &[u32]) -> Self {
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module,
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        Self { pipeline, bindings: bindings.to_vec(), name }
    }

    /// Runs it once, in so many groups along x and y.
    pub fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        [x, y]: [u32; 2],
        lookup: Lookup<'_, '_>,
    ) {
        if x > 0 && y > 0 {
            self.pass(gpu, encoder, lookup, |pass| pass.dispatch_workgroups(x, y, 1));
        }
    }

    /// Runs it in as many groups along x, y and z as the first three numbers of a buffer say, which
    /// it is not bound to.
    pub fn run_counted(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        groups: &wgpu::Buffer,
        lookup: Lookup<'_, '_>,
    ) {
        self.pass(gpu, encoder, lookup, |pass| pass.dispatch_workgroups_indirect(groups, 0));
    }

    fn pass(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lookup: Lookup<'_, '_>,
        dispatch: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        let group = bind(gpu, &self.pipeline.get_bind_group_layout(0), &self.bindings, lookup);
        let descriptor = wgpu::ComputePassDescriptor { label: Some(self.name), timestamp_writes: None };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        dispatch(&mut pass);
    }

    /// Runs it in so many groups. The shader numbers them: `x + y * 32768`; those of the last row
    /// may be too many.
    pub fn run_groups(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        groups: usize,
        lookup: Lookup<'_, '_>,
    ) {
        let groups = groups as u32;
        self.run(gpu, encoder, [groups.min(GROUPS), groups.div_ceil(GROUPS)], lookup);
    }

    /// Runs it once for each 8 x 8 pixels.
    pub fn run_pixels(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        size: [u32; 2],
        lookup: Lookup<'_, '_>,
    ) {
        self.run(gpu, encoder, size.map(|s| s.div_ceil(8)), lookup);
    }
}

/// A buffer with these contents; an empty one holds a zero of 16 bytes, since none of size 0 can be
/// bound.
///
/// # Errors
/// It is larger than the adapter's limits, or than its memory.
pub fn filled<T: Pod>(gpu: &Gpu, contents: &[T], usage: BufferUsages) -> Result<wgpu::Buffer, GpuError> {
    let bytes: &[u8] = bytemuck::cast_slice(contents);
    let buffer = gpu.buffer((bytes.len() as u64).max(16), usage)?;
    if !bytes.is_empty() {
        gpu.write(&buffer, bytes)?;
    }
    Ok(buffer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timing::Clock;

    const SHADER: &str = "
        @group(0) @binding(3) var<storage, read> given: array<u32>;
        @group(0) @binding(5) var<storage, read_write> made: array<u32>;
        @compute @workgroup_size(1) fn doubled(@builtin(workgroup_id) group: vec3u) {
            made[group.x] = 2u * given[group.x];
        }";

    #[test]
    fn a_kernel_runs_over_its_buffers_and_one_that_is_missing_is_refused() {
        let Some(gpu) = Gpu::for_tests() else { return };
        let source = wgpu::ShaderSource::Wgsl(SHADER.into());
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let kernel = Kernel::new(&gpu, &module, "doubled", &[3, 5]);
        let given = filled(&gpu, &[1_u32, 2, 3, 4], BufferUsages::STORAGE).unwrap();
        let made = filled::<u32>(&gpu, &[], BufferUsages::STORAGE).unwrap();
        let bound = [(5, &made), (3, &given), (9, &given)];
        let mut clock = Clock::on();
        clock.stage(&gpu, "double", |e| kernel.run_groups(&gpu, e, 4, &among(&bound))).unwrap();
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&made).unwrap());
        assert_eq!((words, clock.stages().len()), (vec![2, 4, 6, 8], 1));
        // As many groups as a buffer says: the last two stay as they were.
        let groups = filled(&gpu, &[2_u32, 1, 1], BufferUsages::INDIRECT).unwrap();
        let again = [(5, &given), (3, &made)];
        clock.stage(&gpu, "twice", |e| kernel.run_counted(&gpu, e, &groups, &among(&again))).unwrap();
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&given).unwrap());
        assert_eq!(words, [4, 8, 3, 4]);
        let refused = clock.stage(&gpu, "double", |e| kernel.run(&gpu, e, [1, 1], &among(&bound[..1])));
        let said = refused.unwrap_err().to_string();
        assert!(said.contains("double"), "{said}");
    }
}
