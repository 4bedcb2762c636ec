//! Pictures of light: the surface in each pixel, its light by the cache on the device, and the
//! colours of a screen.

use bytemuck::{Pod, Zeroable};
use casca_radiosity::gpu::{Answers, Gloss, GpuCache, Input, Mirrors, Surfaces};
use casca_scenes::lit::{LitObject, LitScene, Material};
use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::gpu::{DEPTH, Gpu, GpuError};
use casca_stage::kernel::filled;
use casca_stage::timing::Clock;
use casca_stage::wgpu::{
    self, BindingResource, Buffer, BufferUsages, CommandEncoder, TextureFormat, TextureUsages, TextureView,
    VertexFormat,
};
use glam::{Mat4, Vec3};

use crate::common::Failed;

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layer {
    /// All light.
    #[default]
    Picture,
    /// What surfaces scatter of light.
    Albedo,
    /// Normals, from -1 to 1 as 0 to 1.
    Normals,
    /// Emission, and light straight from lights and lamps.
    Direct,
    /// Light of the sky and of all bounces.
    Indirect,
    /// What surfaces mirror.
    Mirrored,
}

impl Layer {
    /// All of them.
    pub const EVERY: [Self; 6] =
        [Self::Picture, Self::Albedo, Self::Normals, Self::Direct, Self::Indirect, Self::Mirrored];

    /// Its name on command lines and in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Albedo => "albedo",
            Self::Normals => "normals",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Mirrored => "mirrored",
        }
    }
}

/// The format of places and light.
const FLOATS: TextureFormat = TextureFormat::Rgba32Float;
/// The formats of what is drawn of surfaces: 32 bytes in all, as many as any device takes.
const SURFACES: [TextureFormat; 3] = [FLOATS, TextureFormat::Rgba16Float, TextureFormat::Rg32Float];
/// Rays of a pixel that mirrors.
const MIRROR_RAYS: u32 = 16;

/// The camera as the shaders take it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Eye {
    to_clip: [[f32; 4]; 4],
    position: [f32; 3],
    layer: u32,
    sky: [f32; 3],
    exposure: f32,
}

/// A corner of a triangle.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Corner {
    at: [f32; 3],
    first: [f32; 3],
    normal: [f32; 3],
    material: u32,
}

/// Three corners for each triangle of a mesh, so that an object keeps its place when it moves. A
/// triangle that cannot be drawn is a point.
fn corners_of(object: &LitObject, materials: usize) -> Vec<Corner> {
    let mut all = Vec::with_capacity(3 * object.mesh.triangles.len());
    for (triangle, &material) in object.mesh.triangles.iter().zip(object.materials.iter()) {
        let at = |v: &u32| object.mesh.positions.get(*v as usize).copied().unwrap_or(Vec3::NAN);
        let corners = triangle.each_ref().map(|v| object.transform.transform_point3(at(v)));
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize();
        match normal.filter(|_| (material as usize) < materials) {
            Some(normal) => all.extend(corners.map(|at| Corner {
                at: at.to_array(),
                first: corners[0].to_array(),
                normal: normal.to_array(),
                material,
            })),
            None => all.extend([Corner::zeroed(); 3]),
        }
    }
    all
}

/// The width of the lobe of GGX that a material mirrors by, if it does: that of as sharp a highlight
/// as Phong's (Walter et al. 2007, section 5.2).
pub fn roughness(material: &Material) -> Option<f32> {
    let mirrors = material.specular.max_element() > 0.0;
    mirrors.then(|| (2.0 / (material.exponent() + 2.0)).sqrt() as f32)
}

/// Textures of one size.
struct Frame {
    size: (u32, u32),
    /// Places, normals, and roughness with the material.
    surfaces: [TextureView; 3],
    depth: TextureView,
    mirrored: TextureView,
    light: TextureView,
}

impl Frame {
    fn new(gpu: &Gpu, size: (u32, u32)) -> Result<Self, GpuError> {
        let size = gpu.clamp(size);
        let texture = |format, usage| {
            let made = gpu.try_room(|| {
                gpu.device.create_texture(&wgpu::TextureDescriptor {
                    label: Some("light"),
                    size: wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: usage | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
                    view_formats: &[],
                })
            });
            let bytes = 16 * u64::from(size.0) * u64::from(size.1);
            let most = gpu.device.limits().max_buffer_size;
            made.map(|t| t.create_view(&Default::default())).ok_or(GpuError::NoRoom { bytes, most })
        };
        let of_surface = |format| texture(format, TextureUsages::RENDER_ATTACHMENT);
        Ok(Self {
            size,
            surfaces: [of_surface(SURFACES[0])?, of_surface(SURFACES[1])?, of_surface(SURFACES[2])?],
            mirrored: texture(FLOATS, TextureUsages::STORAGE_BINDING)?,
            depth: texture(DEPTH, TextureUsages::RENDER_ATTACHMENT)?,
            light: texture(FLOATS, TextureUsages::STORAGE_BINDING)?,
        })
    }
}

/// Draws pictures of a scene.
pub struct Picture {
    surfaces: wgpu::RenderPipeline,
    /// None if nothing mirrors.
    mirrors: Option<Mirrors>,
    compose: wgpu::ComputePipeline,
    screen: wgpu::ShaderModule,
    /// For the format of the last target.
    shown: Option<(TextureFormat, wgpu::RenderPipeline)>,
    eye: Buffer,
    corners: Buffer,
    /// By object: its first corner; one more for the end.
    firsts: Vec<usize>,
    materials: Buffer,
    material_count: usize,
    sky: Vec3,
    frame: Frame,
}

impl Picture {
    /// Pipelines, and the triangles of a scene.
    ///
    /// # Errors
    /// The adapter has no buffers as large.
    pub fn new(gpu: &Gpu, scene: &LitScene) -> Result<Self, GpuError> {
        let layers =
            Layer::EVERY.map(|l| format!("const {}: u32 = {}u;\n", l.name().to_uppercase(), l as u32));
        let constants = format!("const PI: f32 = {:?};\n{}", std::f32::consts::PI, layers.concat());
        let module = |text: String| {
            let source = wgpu::ShaderSource::Wgsl(text.into());
            gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("light"), source })
        };
        let picture = module(GpuCache::wgsl(1, Answers::All) + &constants + include_str!("picture.wgsl"));
        let screen = module(constants.clone() + include_str!("screen.wgsl"));
        let count = scene.materials.len();
        let (mut corners, mut firsts) = (Vec::new(), vec![0]);
        for object in &scene.objects {
            corners.extend(corners_of(object, count));
            firsts.push(corners.len());
        }
        let four = |v: Vec3| v.extend(0.0).to_array();
        let sound: Vec<Material> = scene.materials.iter().map(Material::sound).collect();
        let beside = |m: &Material| roughness(m).map_or(-1.0, |r| r);
        let vectors =
            |m: &Material| [m.albedo.extend(beside(m)).to_array(), four(m.emission), four(m.specular)];
        let materials: Vec<[[f32; 4]; 3]> = sound.iter().map(vectors).collect();
        let has_mirrors = sound.iter().any(|m| roughness(m).is_some());
        Ok(Self {
            surfaces: surfaces(gpu, &picture),
            mirrors: has_mirrors.then(|| Mirrors::new(&gpu.device, Input::Positions)),
            compose: gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("compose"),
                layout: None,
                module: &picture,
                entry_point: Some("compose"),
                compilation_options: Default::default(),
                cache: None,
            }),
            screen,
            shown: None,
            eye: filled(gpu, &[Eye::zeroed()], BufferUsages::UNIFORM)?,
            corners: filled(gpu, &corners, BufferUsages::VERTEX)?,
            firsts,
            materials: filled(gpu, &materials, BufferUsages::STORAGE)?,
            material_count: count,
            sky: scene.sky,
            frame: Frame::new(gpu, (1, 1))?,
        })
    }

    /// Draws an object elsewhere.
    pub fn move_object(&self, gpu: &Gpu, number: usize, object: &LitObject) {
        let corners = corners_of(object, self.material_count);
        let at = self.firsts[number] * size_of::<Corner>();
        gpu.queue.write_buffer(&self.corners, at as u64, bytemuck::cast_slice(&corners));
    }

    /// Draws a layer, as large as the target.
    ///
    /// # Errors
    /// The adapter has no textures as large; the device is lost.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        (target, cache): (&Target, &GpuCache),
        camera: &Camera,
        (layer, exposure): (Layer, f32),
        clock: &mut Clock,
    ) -> Result<(), Failed> {
        if gpu.clamp(target.size()) != self.frame.size {
            self.frame = Frame::new(gpu, target.size())?;
        }
        let eye = Eye {
            to_clip: camera.view_projection().to_cols_array_2d(),
            position: camera.eye.to_array(),
            layer: layer as u32,
            sky: self.sky.to_array(),
            exposure,
        };
        gpu.queue.write_buffer(&self.eye, 0, bytemuck::bytes_of(&eye));
        clock.stage(gpu, "surfaces", |e| self.draw_surfaces(gpu, e))?;
        if matches!(layer, Layer::Picture | Layer::Mirrored) {
            self.mirror(gpu, cache, camera, clock)?;
        }
        clock.stage(gpu, "light of pixels", |e| self.light(gpu, e, cache))?;
        clock.stage(gpu, "show", |e| self.show(gpu, e, target))?;
        Ok(())
    }

    fn mirror(&self, gpu: &Gpu, cache: &GpuCache, camera: &Camera, clock: &mut Clock) -> Result<(), Failed> {
        let Some(mirrors) = &self.mirrors else { return Ok(()) };
        let [place, normals, kinds] = &self.frame.surfaces;
        let surfaces = Surfaces { place, normals, inverse: Mat4::IDENTITY, empty: 1.0 };
        let gloss = Gloss { roughness: kinds, eye: camera.eye, rays: MIRROR_RAYS };
        let mut made = Ok(());
        clock.stage(gpu, "mirrors", |e| {
            made = cache.mirror(&gpu.device, e, mirrors, surfaces, gloss, &self.frame.mirrored);
        })?;
        Ok(made?)
    }

    fn draw_surfaces(&self, gpu: &Gpu, encoder: &mut CommandEncoder) {
        let own = [self.eye.as_entire_binding(), self.materials.as_entire_binding()];
        let group = bound(gpu, &self.surfaces.get_bind_group_layout(0), &own);
        let cleared = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &self.frame.surfaces.each_ref().map(cleared),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.frame.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.surfaces);
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.draw(0..self.firsts.last().copied().unwrap_or(0) as u32, 0..1);
    }

    fn light(&self, gpu: &Gpu, encoder: &mut CommandEncoder, cache: &GpuCache) {
        let [places, normals, kinds] = self.frame.surfaces.each_ref().map(BindingResource::TextureView);
        let own = [
            self.eye.as_entire_binding(),
            self.materials.as_entire_binding(),
            places,
            normals,
            kinds,
            BindingResource::TextureView(&self.frame.mirrored),
            BindingResource::TextureView(&self.frame.light),
        ];
        let group = bound(gpu, &self.compose.get_bind_group_layout(0), &own);
        let layout = self.compose.get_bind_group_layout(1);
        let of_cache = cache.bind_group(&gpu.device, &layout, Answers::All);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.compose);
        pass.set_bind_group(0, &group, &[]);
        pass.set_bind_group(1, &of_cache, &[]);
        let (x, y) = self.frame.size;
        pass.dispatch_workgroups(x.div_ceil(8), y.div_ceil(8), 1);
    }

    fn show(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder, target: &Target) {
        let format = target.colour.texture().format();
        if self.shown.as_ref().is_none_or(|(of, _)| *of != format) {
            self.shown = Some((format, screen(gpu, &self.screen, format)));
        }
        let Some((_, screen)) = &self.shown else { return };
        let own = [self.eye.as_entire_binding(), BindingResource::TextureView(&self.frame.light)];
        let group = bound(gpu, &screen.get_bind_group_layout(0), &own);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            ..Default::default()
        });
        pass.set_pipeline(screen);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// The light of the last picture, row by row: red, green, blue, and 1 where there is a surface.
    ///
    /// # Errors
    /// The device is lost.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<[f32; 4]>, GpuError> {
        let bytes: Vec<u8> = gpu.read(self.frame.light.texture())?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}

/// A bind group of resources in the order of their bindings.
fn bound(gpu: &Gpu, layout: &wgpu::BindGroupLayout, all: &[BindingResource<'_>]) -> wgpu::BindGroup {
    let mut entries = Vec::new();
    for (binding, resource) in (0..).zip(all) {
        entries.push(wgpu::BindGroupEntry { binding, resource: resource.clone() });
    }
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

fn surfaces(gpu: &Gpu, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
    let floats = VertexFormat::Float32x3;
    let at = |shader_location, offset, format| wgpu::VertexAttribute { format, offset, shader_location };
    let attributes =
        [at(0, 0, floats), at(1, 12, floats), at(2, 24, floats), at(3, 36, VertexFormat::Uint32)];
    let buffer = wgpu::VertexBufferLayout {
        array_stride: size_of::<Corner>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("surfaces"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[Some(buffer)],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("surface"),
            compilation_options: Default::default(),
            targets: &SURFACES.map(|format| Some(format.into())),
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn screen(gpu: &Gpu, module: &wgpu::ShaderModule, format: TextureFormat) -> wgpu::RenderPipeline {
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("screen"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("colour"),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
