//! Shaders and pipelines.

use casca_stage::gpu::DEPTH;
use casca_stage::wgpu::{
    self, CompareFunction, TextureFormat, VertexFormat, VertexStepMode, vertex_attr_array,
};

use crate::gpu::buffers::Follower;
use crate::gpu::look::Corner;
use crate::gpu::records::Block;

/// The shaders, in the order in which they use each other.
pub(super) const SHADERS: &str = concat!(
    include_str!("strands.wgsl"),
    include_str!("rays.wgsl"),
    include_str!("slab.wgsl"),
    include_str!("surroundings.wgsl"),
    include_str!("pose.wgsl"),
    include_str!("shells.wgsl"),
    include_str!("paint.wgsl")
);

/// Makes pipelines: for pictures, or for the shadow map if there is no fragment shader with
/// colours.
pub(super) struct Pipelines<'a> {
    pub(super) device: &'a wgpu::Device,
    pub(super) shaders: &'a wgpu::ShaderModule,
    pub(super) layout: &'a wgpu::PipelineLayout,
    /// Samples in a pixel of pictures; the shadow map has one.
    pub(super) samples: u32,
}

impl Pipelines<'_> {
    /// Shells of meshes with weights, if they are `posed`, or of others.
    pub(super) fn shells(&self, posed: bool, colours: Option<(&str, TextureFormat)>) -> wgpu::RenderPipeline {
        let shell = vertex_attr_array![0 => Uint32x2];
        let corner = vertex_attr_array![1 => Float32x3, 2 => Float32x3, 3 => Float32x4];
        let follower = vertex_attr_array![4 => Uint16x4, 5 => Float32x4];
        let buffers = [
            Some(buffer::<[u32; 2]>(VertexStepMode::Instance, &shell)),
            Some(buffer::<Corner>(VertexStepMode::Vertex, &corner)),
            Some(buffer::<Follower>(VertexStepMode::Vertex, &follower)),
        ];
        let vertex = match (posed, colours.is_some()) {
            (false, true) => "shell_corner",
            (false, false) => "shell_shadow_corner",
            (true, true) => "posed_shell_corner",
            (true, false) => "posed_shell_shadow_corner",
        };
        self.make(vertex, &buffers[..2 + usize::from(posed)], colours, Some("shell_shadow"))
    }

    pub(super) fn blocks(&self, colours: Option<(&str, TextureFormat)>) -> wgpu::RenderPipeline {
        let block = vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x3];
        debug_assert_eq!(block[2].offset, VertexFormat::Float32x3.size() + VertexFormat::Uint32.size());
        let buffers = [Some(buffer::<Block>(VertexStepMode::Instance, &block))];
        let vertex = if colours.is_some() { "block_corner" } else { "block_shadow" };
        self.make(vertex, &buffers, colours, None)
    }

    fn make(
        &self,
        vertex: &str,
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        colours: Option<(&str, TextureFormat)>,
        shadow: Option<&str>,
    ) -> wgpu::RenderPipeline {
        let targets: Vec<_> = colours.map(|(_, format)| Some(format.into())).into_iter().collect();
        let fragment = colours.map(|(entry, _)| entry).or(shadow).map(|entry| wgpu::FragmentState {
            module: self.shaders,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets: &targets,
        });
        let count = if colours.is_some() { self.samples } else { 1 };
        let compare = if colours.is_some() { CompareFunction::Greater } else { CompareFunction::Less };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.shaders,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers,
            },
            // Shells are seen from both sides: strands beyond the horizon stick out.
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count, ..Default::default() },
            fragment,
            multiview_mask: None,
            cache: None,
        })
    }
}

fn buffer<T>(
    step_mode: VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}
