//! Render passes, and the pipelines that draw in them.

use wgpu::{Color, CompareFunction, RenderPassColorAttachment, RenderPassDepthStencilAttachment};

use crate::gpu::{DEPTH, Gpu};

/// What differs between render pipelines: all draw triangles, one sample a pixel.
pub struct Draws<'a> {
    /// The shader.
    pub module: &'a wgpu::ShaderModule,
    /// What it is bound to; by default what its entries use.
    pub layout: Option<&'a wgpu::PipelineLayout>,
    /// The entries for corners and for pixels.
    pub entries: [&'a str; 2],
    /// What corners are made of.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// The side that is left out.
    pub cull: Option<wgpu::Face>,
    /// Whether depth is written, and what of it is in front.
    pub depth: Option<(bool, CompareFunction)>,
    /// What is drawn to.
    pub targets: &'a [Option<wgpu::ColorTargetState>],
}

impl Draws<'_> {
    /// The pipeline.
    pub fn pipeline(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let [vertex, fragment] = self.entries;
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: self.layout,
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState { cull_mode: self.cull, ..Default::default() },
            depth_stencil: self.depth.map(|(write, compare)| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(write),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: self.targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// A picture to draw into: cleared with a colour, or as it is.
pub fn over(view: &wgpu::TextureView, clear: Option<Color>) -> Option<RenderPassColorAttachment<'_>> {
    let load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    Some(RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}

/// Depths that are those of nothing at first, and not kept.
pub fn behind(view: &wgpu::TextureView, nothing: f32) -> Option<RenderPassDepthStencilAttachment<'_>> {
    let load = wgpu::LoadOp::Clear(nothing);
    let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Discard });
    Some(RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None })
}
