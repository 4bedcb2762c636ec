//! Shaders and pipelines.

use casca_stage::gpu::DEPTH;
use casca_stage::wgpu::{
    self, CompareFunction, TextureFormat, VertexFormat, VertexStepMode, vertex_attr_array,
};

use crate::gpu::buffers::Follower;
use crate::gpu::look::Corner;
use crate::gpu::records::Block;

/// The shaders, in the order in which they use each other.
const SHADERS: &str = concat!(
    include_str!("strands.wgsl"),
    include_str!("rays.wgsl"),
    include_str!("slab.wgsl"),
    include_str!("surroundings.wgsl"),
    include_str!("pose.wgsl"),
    include_str!("shells.wgsl"),
    include_str!("paint.wgsl")
);

/// Lines of the shaders that end so are for meshes with images.
const OF_IMAGES: &str = "// images";

/// The shaders for meshes with images, or without: each place on an image that a vertex hands on
/// costs time, whether it is used or not.
pub(super) fn shaders(images: bool) -> String {
    let kept = SHADERS.lines().filter(|line| images || !line.ends_with(OF_IMAGES));
    kept.flat_map(|line| [line, "\n"]).collect()
}

/// Which shells a pipeline draws.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kind {
    /// Meshes with weights.
    pub(super) posed: bool,
    /// Meshes with images.
    pub(super) images: bool,
}

impl Kind {
    /// Its place in [`Kind::EVERY`].
    pub(super) fn number(self) -> usize {
        usize::from(self.posed) + 2 * usize::from(self.images)
    }

    pub(super) const EVERY: [Self; 4] = [
        Self { posed: false, images: false },
        Self { posed: true, images: false },
        Self { posed: false, images: true },
        Self { posed: true, images: true },
    ];
}

/// Makes pipelines: for pictures, or for the shadow map if there is no fragment shader with
/// colours.
pub(super) struct Pipelines<'a> {
    pub(super) device: &'a wgpu::Device,
    /// Without images, and with.
    pub(super) shaders: &'a [wgpu::ShaderModule; 2],
    pub(super) layout: &'a wgpu::PipelineLayout,
    /// Samples in a pixel of pictures; the shadow map has one.
    pub(super) samples: u32,
}

impl Pipelines<'_> {
    pub(super) fn shells(
        &self,
        Kind { posed, images }: Kind,
        colours: Option<(&str, TextureFormat)>,
    ) -> wgpu::RenderPipeline {
        let shell = vertex_attr_array![0 => Uint32x2];
        let corner = vertex_attr_array![
            1 => Float32x3, 2 => Float32x3, 3 => Float32x4, 6 => Float32x2, 7 => Uint32
        ];
        // The last two are of images.
        let corner = if images { &corner[..] } else { &corner[..3] };
        let follower = vertex_attr_array![4 => Uint16x4, 5 => Float32x4];
        let buffers = [
            Some(buffer::<[u32; 2]>(VertexStepMode::Instance, &shell)),
            Some(buffer::<Corner>(VertexStepMode::Vertex, corner)),
            Some(buffer::<Follower>(VertexStepMode::Vertex, &follower)),
        ];
        let vertex = match (posed, colours.is_some()) {
            (false, true) => "shell_corner",
            (false, false) => "shell_shadow_corner",
            (true, true) => "posed_shell_corner",
            (true, false) => "posed_shell_shadow_corner",
        };
        let module = &self.shaders[usize::from(images)];
        self.make((module, vertex), &buffers[..2 + usize::from(posed)], colours, Some("shell_shadow"))
    }

    pub(super) fn blocks(&self, colours: Option<(&str, TextureFormat)>) -> wgpu::RenderPipeline {
        let block = vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x3];
        debug_assert_eq!(block[2].offset, VertexFormat::Float32x3.size() + VertexFormat::Uint32.size());
        let buffers = [Some(buffer::<Block>(VertexStepMode::Instance, &block))];
        let vertex = if colours.is_some() { "block_corner" } else { "block_shadow" };
        self.make((&self.shaders[0], vertex), &buffers, colours, None)
    }

    fn make(
        &self,
        (module, vertex): (&wgpu::ShaderModule, &str),
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        colours: Option<(&str, TextureFormat)>,
        shadow: Option<&str>,
    ) -> wgpu::RenderPipeline {
        let targets: Vec<_> = colours.map(|(_, format)| Some(format.into())).into_iter().collect();
        let fragment = colours.map(|(entry, _)| entry).or(shadow).map(|entry| wgpu::FragmentState {
            module,
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
                module,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shaders_without_images_hand_on_no_places() {
        let [plain, full] = [false, true].map(shaders);
        for place in ["@location(6) tex", "@location(7) image", "@location(10)", "@location(11)"] {
            assert!(full.contains(place) && !plain.contains(place), "{place}");
        }
        assert_eq!(full.lines().count() - plain.lines().count(), 10);
        assert!(Kind::EVERY.iter().enumerate().all(|(i, kind)| kind.number() == i));
    }
}
