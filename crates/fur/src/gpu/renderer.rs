//! Draws furry meshes as shells, their skins, blocks, and the sun's shadow map.

use crate::mesh::Mesh;
use casca_stage::camera::Camera;
use casca_stage::canvas::Target;
use casca_stage::gpu::{DEPTH, Gpu, GpuError};
use casca_stage::wgpu::{
    self, BufferUsages, CompareFunction, ShaderStages, TextureFormat, VertexFormat, VertexStepMode,
    vertex_attr_array,
};

use crate::gpu::error::FurGpuError;
use crate::gpu::look::{Corner, Look, LookRecord, SKY, corners_of};
use crate::gpu::records::{Block, DrawList, Frame, SHADOW_SIZE, Sun};

/// The shaders, in the order in which they use each other.
pub(crate) const SHADERS: &str =
    concat!(include_str!("strands.wgsl"), include_str!("surroundings.wgsl"), include_str!("shells.wgsl"));
/// A buffer that grows.
struct Growing {
    buffer: wgpu::Buffer,
    usage: BufferUsages,
}

impl Growing {
    fn new(gpu: &Gpu, usage: BufferUsages) -> Result<Self, GpuError> {
        Ok(Self { buffer: gpu.buffer(1 << 12, usage)?, usage })
    }

    /// Writes data; whether the buffer is another one now.
    fn write(&mut self, gpu: &Gpu, data: &[u8]) -> Result<bool, GpuError> {
        let grows = data.len() as u64 > self.buffer.size();
        if grows {
            self.buffer = gpu.buffer((data.len() as u64).next_power_of_two(), self.usage)?;
        }
        gpu.queue.write_buffer(&self.buffer, 0, data);
        Ok(grows)
    }
}

/// A mesh on the device.
struct Buffers {
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

impl Buffers {
    fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Self, GpuError> {
        let filled = |data: &[u8], usage| {
            let buffer = gpu.buffer(data.len() as u64, usage)?;
            gpu.queue.write_buffer(&buffer, 0, data);
            Ok(buffer)
        };
        Ok(Self {
            corners: filled(bytemuck::cast_slice(&corners_of(mesh)), BufferUsages::VERTEX)?,
            indices: filled(bytemuck::cast_slice(mesh.triangles()), BufferUsages::INDEX)?,
            count: 3 * mesh.triangles().len() as u32,
        })
    }
}

/// Pipelines and buffers for some meshes and one format of pictures.
pub struct Renderer {
    format: TextureFormat,
    shells: wgpu::RenderPipeline,
    blocks: wgpu::RenderPipeline,
    shell_shadows: wgpu::RenderPipeline,
    block_shadows: wgpu::RenderPipeline,
    layouts: [wgpu::BindGroupLayout; 2],
    frame: wgpu::Buffer,
    look: wgpu::Buffer,
    map: wgpu::Texture,
    /// What the map holds: the side of its faces and their texels.
    faces: (u32, Vec<u8>),
    shadow: wgpu::TextureView,
    /// One of these reads the shadow map, the other draws it.
    frame_groups: [wgpu::BindGroup; 2],
    look_group: wgpu::BindGroup,
    meshes: Vec<Buffers>,
    records: Growing,
    instances: Growing,
    block_records: Growing,
    /// The share of the sky's colour that the air adds, for each unit of the way.
    pub haze: f32,
}

impl Renderer {
    /// A renderer for these meshes, with one look for all of them, and pictures of this format.
    ///
    /// # Errors
    /// A mesh does not fit into the memory of the device.
    pub fn new(gpu: &Gpu, format: TextureFormat, meshes: &[Mesh], look: &Look) -> Result<Self, FurGpuError> {
        let device = &gpu.device;
        let layouts = layouts(device);
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("fur"),
            source: wgpu::ShaderSource::Wgsl(SHADERS.into()),
        });
        let pipelines = Pipelines {
            device,
            shader: &shader,
            layout: &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&layouts[0]), Some(&layouts[1])],
                immediate_size: 0,
            }),
        };
        let frame = gpu.buffer(size_of::<Frame>() as u64, BufferUsages::UNIFORM)?;
        let records = Growing::new(gpu, BufferUsages::STORAGE)?;
        let shadow = depth_map(device, SHADOW_SIZE);
        let frame_groups =
            [&shadow, &depth_map(device, 1)].map(|map| frame_group(device, &layouts[0], &frame, map));
        let look_buffer = gpu.buffer(size_of::<LookRecord>() as u64, BufferUsages::UNIFORM)?;
        let faces = look.map_faces()?;
        let map = cube_map(gpu, &faces);
        let look_group = look_group(device, &layouts[1], &look_buffer, &records.buffer, &map);
        let mut renderer = Self {
            format,
            shells: pipelines.shells(Some(("shell_colour", format))),
            blocks: pipelines.blocks(Some(("block_colour", format))),
            shell_shadows: pipelines.shells(None),
            block_shadows: pipelines.blocks(None),
            layouts,
            frame,
            look: look_buffer,
            map,
            faces,
            shadow,
            frame_groups,
            look_group,
            meshes: meshes.iter().map(|mesh| Buffers::new(gpu, mesh)).collect::<Result<_, _>>()?,
            records,
            instances: Growing::new(gpu, BufferUsages::VERTEX)?,
            block_records: Growing::new(gpu, BufferUsages::VERTEX)?,
            haze: 0.0,
        };
        renderer.set_look(gpu, look)?;
        Ok(renderer)
    }

    /// The format of its pictures.
    pub fn format(&self) -> TextureFormat {
        self.format
    }

    /// Changes the look of all meshes.
    ///
    /// # Errors
    /// The fur map cannot hold as many hairs.
    pub fn set_look(&mut self, gpu: &Gpu, look: &Look) -> Result<(), FurGpuError> {
        gpu.queue.write_buffer(&self.look, 0, bytemuck::bytes_of(&look.record()));
        let map = look.map_faces()?;
        if self.faces != map {
            self.map = cube_map(gpu, &map);
            self.faces = map;
            self.group_look(gpu);
        }
        Ok(())
    }

    fn group_look(&mut self, gpu: &Gpu) {
        self.look_group =
            look_group(&gpu.device, &self.layouts[1], &self.look, &self.records.buffer, &self.map);
    }

    /// Draws the shadow map of a list. It holds until the next call: while neither the sun nor
    /// anything in its light moves, one is enough for all frames.
    ///
    /// # Errors
    /// The list does not fit into the memory of the device.
    pub fn cast_shadows(&mut self, gpu: &Gpu, list: &DrawList, sun: &Sun) -> Result<(), GpuError> {
        // The eye does not matter here.
        let eye = Camera::look_at(sun.center, sun.center + sun.direction(), 60.0, 1.0, 0.1, 1.0);
        self.draw_pass(gpu, list, &Frame::new(&eye, SHADOW_SIZE, sun, (SKY, 0.0)), None)
    }

    /// Draws a picture, with the shadows of the last [`Renderer::cast_shadows`].
    ///
    /// # Errors
    /// The list does not fit into the memory of the device.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        target: &Target,
        camera: &Camera,
        list: &DrawList,
        sun: &Sun,
    ) -> Result<(), GpuError> {
        let frame = Frame::new(camera, target.size().1, sun, (SKY, self.haze));
        self.draw_pass(gpu, list, &frame, Some(target))
    }

    /// Draws a picture, or the shadow map if there is no target.
    fn draw_pass(
        &mut self,
        gpu: &Gpu,
        list: &DrawList,
        frame: &Frame,
        target: Option<&Target>,
    ) -> Result<(), GpuError> {
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        if self.records.write(gpu, bytemuck::cast_slice(&list.records))? {
            self.group_look(gpu);
        }
        self.instances.write(gpu, bytemuck::cast_slice(&list.shells))?;
        self.block_records.write(gpu, bytemuck::cast_slice(&list.blocks))?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let sky = SKY.map(|c| f64::from(c.powf(1.0 / 2.2)));
        let colour = target.map(|target| wgpu::RenderPassColorAttachment {
            view: &target.colour,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color { r: sky[0], g: sky[1], b: sky[2], a: 1.0 }),
                store: wgpu::StoreOp::Store,
            },
        });
        let (depth, clear) = target.map_or((&self.shadow, 1.0), |target| (&target.depth, 0.0));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: if target.is_some() { std::slice::from_ref(&colour) } else { &[] },
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(clear),
                    store: if target.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.frame_groups[usize::from(target.is_none())], &[]);
        pass.set_bind_group(1, &self.look_group, &[]);
        let (blocks, shells) = match target {
            Some(_) => (&self.blocks, &self.shells),
            None => (&self.block_shadows, &self.shell_shadows),
        };
        if !list.blocks.is_empty() {
            pass.set_pipeline(blocks);
            pass.set_vertex_buffer(0, self.block_records.buffer.slice(..));
            pass.draw(0..36, 0..list.blocks.len() as u32);
        }
        pass.set_pipeline(shells);
        pass.set_vertex_buffer(0, self.instances.buffer.slice(..));
        for (mesh, run) in &list.runs {
            let Some(mesh) = self.meshes.get(*mesh).filter(|mesh| mesh.count > 0) else { continue };
            pass.set_vertex_buffer(1, mesh.corners.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.count, 0, run.clone());
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}

/// The layouts of two groups of bindings: those of a frame, and those of a look.
fn layouts(device: &wgpu::Device) -> [wgpu::BindGroupLayout; 2] {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
        sample_type,
        view_dimension,
        multisampled: false,
    };
    let sampler = |ty| wgpu::BindingType::Sampler(ty);
    let frame = [
        entry(0, buffer(wgpu::BufferBindingType::Uniform)),
        entry(1, texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2)),
        entry(2, sampler(wgpu::SamplerBindingType::Comparison)),
    ];
    let look = [
        entry(0, buffer(wgpu::BufferBindingType::Uniform)),
        entry(1, buffer(wgpu::BufferBindingType::Storage { read_only: true })),
        entry(
            2,
            texture(wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::Cube),
        ),
        entry(3, sampler(wgpu::SamplerBindingType::Filtering)),
    ];
    [&frame[..], &look[..]].map(|entries| {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries })
    })
}

fn depth_map(device: &wgpu::Device, side: u32) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadow map"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

/// Six faces of one size on the device, one byte a texel.
fn cube_map(gpu: &Gpu, (side, faces): &(u32, Vec<u8>)) -> wgpu::Texture {
    use wgpu::util::DeviceExt;
    gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("fur map"),
            size: wgpu::Extent3d { width: *side, height: *side, depth_or_array_layers: 6 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::R8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        faces,
    )
}

fn frame_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    frame: &wgpu::Buffer,
    shadow: &wgpu::TextureView,
) -> wgpu::BindGroup {
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(CompareFunction::LessEqual),
        ..Default::default()
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(shadow) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}

fn look_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    look: &wgpu::Buffer,
    records: &wgpu::Buffer,
    map: &wgpu::Texture,
) -> wgpu::BindGroup {
    let view = map.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    });
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: look.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: records.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}

/// Makes pipelines: for pictures, or for the shadow map if there is no fragment shader with
/// colours.
struct Pipelines<'a> {
    device: &'a wgpu::Device,
    shader: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
}

impl Pipelines<'_> {
    fn shells(&self, colours: Option<(&str, TextureFormat)>) -> wgpu::RenderPipeline {
        let shell = vertex_attr_array![0 => Uint32x2];
        let corner = vertex_attr_array![1 => Float32x3, 2 => Float32x3, 3 => Float32x4];
        let buffers = [
            Some(buffer::<[u32; 2]>(VertexStepMode::Instance, &shell)),
            Some(buffer::<Corner>(VertexStepMode::Vertex, &corner)),
        ];
        let vertex = if colours.is_some() { "shell_corner" } else { "shell_shadow_corner" };
        self.make(vertex, &buffers, colours, Some("shell_shadow"))
    }

    fn blocks(&self, colours: Option<(&str, TextureFormat)>) -> wgpu::RenderPipeline {
        let block = vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x3];
        debug_assert_eq!(block[2].offset, VertexFormat::Float32x3.size() + VertexFormat::Uint32.size());
        let buffers = [Some(buffer::<Block>(VertexStepMode::Instance, &block))];
        self.make(if colours.is_some() { "block_corner" } else { "block_shadow" }, &buffers, colours, None)
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
            module: self.shader,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets: &targets,
        });
        let compare = if colours.is_some() { CompareFunction::Greater } else { CompareFunction::Less };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.shader,
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
            multisample: Default::default(),
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
