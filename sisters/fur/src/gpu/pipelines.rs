//! Shaders and pipelines.

use casca_stage::gpu::DEPTH;
use casca_stage::wgpu::{
    self, CompareFunction, TextureFormat, VertexFormat, VertexStepMode, vertex_attr_array,
};

use crate::gpu::buffers::Follower;
use crate::gpu::look::Corner;
use crate::gpu::records::Block;
use crate::shader::{LOOKUP, SLAB, STRANDS};

/// In the place of [`LOOKUP`], for studies: a fragment walks along its ray from cell to cell.
pub(super) const WALK: &str = include_str!("walk.wgsl");

/// The shaders: fragments look one strand up, or walk along their rays for studies.
pub(super) fn shaders(walked: bool) -> String {
    [
        STRANDS,
        if walked { WALK } else { LOOKUP },
        SLAB,
        include_str!("surroundings.wgsl"),
        include_str!("pose.wgsl"),
        include_str!("shells.wgsl"),
    ]
    .concat()
}

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
    /// Skins or shells of meshes with weights, if they are `posed`, or of others.
    pub(super) fn mesh(
        &self,
        posed: bool,
        skin: bool,
        colours: Option<TextureFormat>,
    ) -> wgpu::RenderPipeline {
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
        let fragment = match (skin, colours.is_some()) {
            (true, true) => Some("skin_colour"),
            (true, false) => None,
            (false, true) => Some("shell_colour"),
            (false, false) => Some("shell_shadow"),
        };
        self.make(vertex, &buffers[..2 + usize::from(posed)], fragment, colours)
    }

    pub(super) fn blocks(&self, colours: Option<TextureFormat>) -> wgpu::RenderPipeline {
        let block = vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x3];
        debug_assert_eq!(block[2].offset, VertexFormat::Float32x3.size() + VertexFormat::Uint32.size());
        let buffers = [Some(buffer::<Block>(VertexStepMode::Instance, &block))];
        let vertex = if colours.is_some() { "block_corner" } else { "block_shadow" };
        self.make(vertex, &buffers, colours.map(|_| "block_colour"), colours)
    }

    fn make(
        &self,
        vertex: &str,
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        fragment: Option<&str>,
        colours: Option<TextureFormat>,
    ) -> wgpu::RenderPipeline {
        let targets: Vec<_> = colours.map(|format| Some(format.into())).into_iter().collect();
        let fragment = fragment.map(|entry| wgpu::FragmentState {
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
