//! The pass that paints lines and context.

use casca_stage::canvas::Target;
use casca_stage::gpu::Gpu;
use casca_stage::kernel::{Lookup, bind};
use casca_stage::wgpu::{self, TextureFormat};
use glam::Vec3;

use crate::gpu::lens::shader;

const BINDINGS: [&[u32]; 2] = [&[0, 9, 10, 12, 13, 17, 18, 23], &[0, 9, 10, 12, 13, 17, 18, 23, 28]];

/// Paints pictures.
pub(super) struct Picture {
    /// Without and with samples.
    pipelines: [wgpu::RenderPipeline; 2],
}

impl Picture {
    /// Of a format.
    pub(super) fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let module = shader(gpu, "picture", include_str!("shaders/picture.wgsl"));
        let pipeline = |entry| {
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("picture"),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("whole"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    targets: &[Some(format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self { pipelines: ["paint", "paint_samples"].map(pipeline) }
    }

    /// Paints the buffers of a frame, with or without samples, or the background alone if there is
    /// none.
    pub(super) fn paint(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (target, background): (&Target, Vec3),
        frame: Option<(Lookup<'_, '_>, bool)>,
    ) {
        let [r, g, b] = background.to_array().map(f64::from);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        let Some((lookup, has_samples)) = frame else { return };
        let which = usize::from(has_samples);
        let pipeline = &self.pipelines[which];
        let group = bind(gpu, &pipeline.get_bind_group_layout(0), BINDINGS[which], lookup);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
