//! Pictures of light: the surface in each pixel, its light by the cache on the device, and the
//! colours of a screen.

use bytemuck::{Pod, Zeroable};
use casca_radiosity::gpu::{Answers, Gaps, Gloss, GpuCache, Mirrors, Shading, Surfaces};
use casca_radiosity::lit::{LitObject, LitScene, Material};
use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::gpu::{DEPTH, Gpu, GpuError};
use casca_stage::kernel::{Kernel, among, bind, filled};
use casca_stage::pass::{Draws, behind, over};
use casca_stage::timing::Clock;
use casca_stage::wgpu::{
    self, BindingResource, Buffer, BufferUsages, CommandEncoder, TextureFormat, TextureUsages, TextureView,
    vertex_attr_array,
};
use glam::Vec3;

use crate::common::Failed;
use crate::light::scene::texels_of;

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// All light.
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

/// The layers by their names on command lines and in file names, in their order above.
pub const LAYERS: [(&str, Layer); 6] = [
    ("picture", Layer::Picture),
    ("albedo", Layer::Albedo),
    ("normals", Layer::Normals),
    ("direct", Layer::Direct),
    ("indirect", Layer::Indirect),
    ("mirrored", Layer::Mirrored),
];

/// Rays of a pixel that mirrors, and of one that no state stands for.
const MIRROR_RAYS: u32 = 16;
const GAP_RAYS: u32 = 16;
/// The share of the way to the eye by which surfaces come nearer: more than single precision errs,
/// and less than a thousandth of a cell in a view of a whole grid.
const PULL: f32 = 1e-5;
/// Depth by which back sides stand behind fronts at the same place: some roundings of single
/// precision, and some millionths of the scene's length in its middle.
const BEHIND: f32 = 1e-6;
/// Texels that are looked at for each pixel along both axes.
const TEXELS: u32 = 4;
/// What the middle of a picture's light becomes: the grey that cards for cameras have.
const GREY: f32 = 0.18;

/// The camera as the shaders take it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Eye {
    to_clip: [[f32; 4]; 4],
    position: [f32; 3],
    layer: u32,
    sky: [f32; 3],
    exposure: f32,
    corner: [f32; 4],
    right: [f32; 4],
    down: [f32; 4],
}

/// The ray of the picture's corner at the left and the top, and how it changes from pixel to pixel
/// along both axes; for a size of 1 x 1, across the whole picture.
pub fn rays(camera: &Camera, (width, height): (u32, u32)) -> [Vec3; 3] {
    let row = |i| camera.view.row(i).truncate();
    let right = row(0) / camera.projection.x_axis.x;
    let down = -row(1) / camera.projection.y_axis.y;
    [-row(2) - right - down, right * (2.0 / width as f32), down * (2.0 / height as f32)]
}

/// A corner of a triangle knows all three. Which one it is, its number says.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Corner {
    corners: [[f32; 3]; 3],
    normal: [f32; 3],
    material: u32,
    uv: [[f32; 2]; 3],
}

/// Three corners for each triangle of a mesh, so that an object keeps its place when it moves. A
/// triangle that cannot be drawn is a point.
fn corners_of(object: &LitObject, materials: usize) -> Vec<Corner> {
    let mut all = Vec::with_capacity(3 * object.mesh.triangles.len());
    for (i, (triangle, &material)) in object.mesh.triangles.iter().zip(object.materials.iter()).enumerate() {
        let at = |v: &u32| object.mesh.positions.get(*v as usize).copied().unwrap_or(Vec3::NAN);
        let corners = triangle.each_ref().map(|v| object.transform.transform_point3(at(v)));
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize();
        match normal.filter(|_| (material as usize) < materials) {
            Some(normal) => {
                let corners = corners.map(|at| at.to_array());
                let uv = object.uv.get(i).copied().unwrap_or_default().map(|p| p.to_array());
                all.extend([Corner { corners, normal: normal.to_array(), material, uv }; 3]);
            }
            None => all.extend([Corner::zeroed(); 3]),
        }
    }
    all
}

/// The width of the lobe of GGX that a material mirrors by, if it does: that of as sharp a
/// highlight as Phong's (Walter et al. 2007, section 5.2).
pub fn roughness(material: &Material) -> Option<f32> {
    let mirrors = material.specular.max_element() > 0.0;
    mirrors.then(|| (2.0 / (material.exponent() + 2.0)).sqrt() as f32)
}

/// The format of places and light.
const FLOATS: TextureFormat = TextureFormat::Rgba32Float;
/// The formats of what is drawn of surfaces: 32 bytes in all, as many as any device takes.
const SURFACES: [TextureFormat; 3] = [FLOATS, TextureFormat::Rgba16Float, TextureFormat::Rg32Float];

/// Textures of one size.
struct Frame {
    size: (u32, u32),
    /// Places, normals, and roughness with the material.
    surfaces: [TextureView; 3],
    depth: TextureView,
    /// Irradiance with gaps, without, and of the rest.
    gapped: TextureView,
    lit: TextureView,
    rest: TextureView,
    mirrored: TextureView,
    light: TextureView,
}

impl Frame {
    /// Textures of a size, or as large as the device has them.
    fn new(gpu: &Gpu, size: (u32, u32)) -> Result<Self, GpuError> {
        let size = gpu.clamp(size);
        let texture = |format, usage| {
            let made = gpu.try_room(|| gpu.texture_for(size, format, usage));
            let bytes = 16 * u64::from(size.0) * u64::from(size.1);
            let most = gpu.device.limits().max_buffer_size;
            made.map(|t| t.create_view(&Default::default())).ok_or(GpuError::NoRoom { bytes, most })
        };
        let stored = || texture(FLOATS, TextureUsages::STORAGE_BINDING);
        let of_surface = |format| texture(format, TextureUsages::RENDER_ATTACHMENT);
        Ok(Self {
            size,
            surfaces: [of_surface(SURFACES[0])?, of_surface(SURFACES[1])?, of_surface(SURFACES[2])?],
            gapped: stored()?,
            lit: stored()?,
            rest: stored()?,
            mirrored: stored()?,
            depth: texture(DEPTH, TextureUsages::RENDER_ATTACHMENT)?,
            light: stored()?,
        })
    }

    /// What was drawn of surfaces, for the cache.
    fn drawn(&self) -> Surfaces<'_> {
        let [place, normals, _] = &self.surfaces;
        Surfaces { place, normals }
    }
}

/// Draws pictures of a scene.
pub struct Picture {
    surfaces: wgpu::RenderPipeline,
    /// None if nothing mirrors.
    mirrors: Option<Mirrors>,
    /// All light, and that of the sky and of bounces.
    shadings: [Shading; 2],
    gaps: Gaps,
    compose: Kernel,
    screen: wgpu::ShaderModule,
    /// For the format of the last target.
    shown: Option<(TextureFormat, wgpu::RenderPipeline)>,
    eye: Buffer,
    corners: Buffer,
    /// By object: its first corner; one more for the end.
    firsts: Vec<usize>,
    materials: Buffer,
    texels: Buffer,
    /// What the last picture was exposed by.
    exposed: Buffer,
    expose: Kernel,
    material_count: usize,
    /// The length of the scene; not 0.
    reach: f32,
    sky: Vec3,
    frame: Frame,
}

impl Picture {
    /// Pipelines, and the triangles of a scene.
    pub fn new(gpu: &Gpu, scene: &LitScene) -> Result<Self, GpuError> {
        let layers = LAYERS.map(|(name, l)| format!("const {}: u32 = {}u;\n", name.to_uppercase(), l as u32));
        let constants = format!(
            "const PI: f32 = {:?};\nconst PULL: f32 = {PULL:?};\nconst BEHIND: f32 = {BEHIND:?};\n\
             const TEXELS: u32 = {TEXELS}u;\nconst GREY: f32 = {GREY:?};\n{}{}",
            std::f32::consts::PI,
            layers.concat(),
            include_str!("eye.wgsl")
        );
        let module = |text: String| {
            let source = wgpu::ShaderSource::Wgsl(text.into());
            gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("light"), source })
        };
        let picture = module(constants.clone() + include_str!("picture.wgsl"));
        let screen = module(constants.clone() + include_str!("screen.wgsl"));
        let count = scene.materials.len();
        let (mut corners, mut firsts) = (Vec::new(), vec![0]);
        for object in &scene.objects {
            corners.extend(corners_of(object, count));
            firsts.push(corners.len());
        }
        let (min, max) = scene.bounds();
        let four = |v: Vec3| v.extend(0.0).to_array();
        let sound: Vec<Material> = scene.materials.iter().map(Material::sound).collect();
        let beside = |m: &Material| roughness(m).map_or(-1.0, |r| r);
        let painted = |m: &Material| m.emission.extend(m.texture.map_or(0.0, |t| t as f32 + 1.0)).to_array();
        let vectors = |m: &Material| [m.albedo.extend(beside(m)).to_array(), painted(m), four(m.specular)];
        let materials: Vec<[[f32; 4]; 3]> = sound.iter().map(vectors).collect();
        let has_mirrors = sound.iter().any(|m| roughness(m).is_some());
        Ok(Self {
            surfaces: surfaces(gpu, &picture),
            shadings: [Answers::All, Answers::Indirect].map(|answers| Shading::new(&gpu.device, answers)),
            gaps: Gaps::new(&gpu.device),
            mirrors: has_mirrors.then(|| Mirrors::new(&gpu.device)),
            compose: Kernel::new(gpu, &picture, "compose", &[0, 1, 2, 3, 4, 5, 6, 7, 8]),
            expose: Kernel::new(gpu, &screen, "expose", &[1, 2]),
            screen,
            shown: None,
            eye: filled(gpu, &[Eye::zeroed()], BufferUsages::UNIFORM)?,
            corners: filled(gpu, &corners, BufferUsages::VERTEX)?,
            firsts,
            materials: filled(gpu, &materials, BufferUsages::STORAGE)?,
            texels: filled(gpu, &texels_of(scene), BufferUsages::STORAGE)?,
            exposed: filled(gpu, &[1.0_f32], BufferUsages::STORAGE)?,
            material_count: count,
            reach: (max - min).length().max(f32::MIN_POSITIVE),
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
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        (target, cache): (&Target, &GpuCache),
        camera: &Camera,
        (layer, exposure): (Layer, Option<f32>),
        clock: &mut Clock,
    ) -> Result<(), Failed> {
        if gpu.clamp(target.size()) != self.frame.size {
            self.frame = Frame::new(gpu, target.size())?;
        }
        let [corner, right, down] = rays(camera, self.frame.size);
        let four = |v: Vec3| v.extend(0.0).to_array();
        let eye = Eye {
            to_clip: camera.view_projection().to_cols_array_2d(),
            position: camera.eye.to_array(),
            layer: layer as u32,
            sky: self.sky.to_array(),
            exposure: exposure.unwrap_or(0.0),
            corner: corner.extend(self.reach).to_array(),
            right: four(right),
            down: four(down),
        };
        gpu.queue.write_buffer(&self.eye, 0, bytemuck::bytes_of(&eye));
        clock.stage(gpu, "surfaces", |e| self.draw_surfaces(gpu, e))?;
        if matches!(layer, Layer::Picture | Layer::Mirrored) {
            self.mirror(gpu, cache, camera, clock)?;
        }
        self.light(gpu, cache, layer, clock)?;
        clock.stage(gpu, "compose", |e| self.compose(gpu, e))?;
        // Layers are shown as the picture is, so that they can be compared.
        if layer == Layer::Picture {
            clock.stage(gpu, "expose", |e| self.expose.run(gpu, e, [1, 1], &|place| self.shown_by(place)))?;
        }
        clock.stage(gpu, "show", |e| self.show(gpu, e, target))?;
        Ok(())
    }

    fn mirror(&self, gpu: &Gpu, cache: &GpuCache, camera: &Camera, clock: &mut Clock) -> Result<(), Failed> {
        let Some(mirrors) = &self.mirrors else { return Ok(()) };
        let kinds = &self.frame.surfaces[2];
        let gloss = Gloss { roughness: kinds, eye: camera.eye, rays: MIRROR_RAYS };
        let mut made = Ok(());
        clock.stage(gpu, "mirrors", |e| {
            made = cache.mirror(&gpu.device, e, mirrors, self.frame.drawn(), gloss, &self.frame.mirrored);
        })?;
        Ok(made?)
    }

    fn draw_surfaces(&self, gpu: &Gpu, encoder: &mut CommandEncoder) {
        let own = [(0, &self.eye), (1, &self.materials), (9, &self.texels)];
        let group = bind(gpu, &self.surfaces.get_bind_group_layout(0), &[0, 1, 9], &among(&own));
        let cleared = |view| over(view, Some(wgpu::Color::TRANSPARENT));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &self.frame.surfaces.each_ref().map(cleared),
            depth_stencil_attachment: behind(&self.frame.depth, 1.0),
            ..Default::default()
        });
        pass.set_pipeline(&self.surfaces);
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.draw(0..self.firsts.last().copied().unwrap_or(0) as u32, 0..1);
    }

    /// Irradiance of all pixels.
    fn light(&self, gpu: &Gpu, cache: &GpuCache, layer: Layer, clock: &mut Clock) -> Result<(), Failed> {
        let frame = &self.frame;
        let [all, indirect] = &self.shadings;
        let shading = match layer {
            Layer::Picture | Layer::Direct => all,
            Layer::Indirect => indirect,
            Layer::Albedo | Layer::Normals | Layer::Mirrored => return Ok(()),
        };
        self.irradiance(gpu, cache, (shading, &frame.lit), clock)?;
        if layer == Layer::Direct {
            self.irradiance(gpu, cache, (indirect, &frame.rest), clock)?;
        }
        Ok(())
    }

    /// A picture of irradiance without gaps.
    fn irradiance(
        &self,
        gpu: &Gpu,
        cache: &GpuCache,
        (shading, into): (&Shading, &TextureView),
        clock: &mut Clock,
    ) -> Result<(), Failed> {
        let (frame, how) = (&self.frame, (&self.gaps, GAP_RAYS));
        clock.stage(gpu, "light of pixels", |e| {
            cache.shade(&gpu.device, e, shading, frame.drawn(), &frame.gapped);
        })?;
        let mut filled = Ok(());
        clock.stage(gpu, "gaps", |e| {
            filled = cache.fill(&gpu.device, e, how, frame.drawn(), (&frame.gapped, into));
        })?;
        Ok(filled?)
    }

    fn compose(&self, gpu: &Gpu, encoder: &mut CommandEncoder) {
        let frame = &self.frame;
        let [places, normals, kinds] = frame.surfaces.each_ref().map(BindingResource::TextureView);
        let [lit, rest, mirrored, light] =
            [&frame.lit, &frame.rest, &frame.mirrored, &frame.light].map(BindingResource::TextureView);
        let (eye, materials) = (self.eye.as_entire_binding(), self.materials.as_entire_binding());
        let own = [eye, materials, kinds, places, lit, rest, mirrored, normals, light];
        self.compose.run_pixels(gpu, encoder, frame.size.into(), &|place| own.get(place as usize).cloned());
    }

    /// What light is shown by.
    fn shown_by(&self, place: u32) -> Option<BindingResource<'_>> {
        match place {
            0 => Some(self.eye.as_entire_binding()),
            1 => Some(BindingResource::TextureView(&self.frame.light)),
            _ => Some(self.exposed.as_entire_binding()),
        }
    }

    fn show(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder, target: &Target) {
        let format = target.colour.texture().format();
        if self.shown.as_ref().is_none_or(|(of, _)| *of != format) {
            let draws = Draws {
                module: &self.screen,
                layout: None,
                entries: ["corner", "colour"],
                buffers: &[],
                cull: None,
                depth: None,
                targets: &[Some(format.into())],
            };
            self.shown = Some((format, draws.pipeline(gpu)));
        }
        let Some((_, screen)) = &self.shown else { return };
        let group = bind(gpu, &screen.get_bind_group_layout(0), &[0, 1, 3], &|place| self.shown_by(place));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[over(&target.colour, Some(wgpu::Color::TRANSPARENT))],
            ..Default::default()
        });
        pass.set_pipeline(screen);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// The light of the last picture, row by row: red, green, blue, and 1 where there is a surface.
    #[cfg(test)]
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<[f32; 4]>, GpuError> {
        let bytes: Vec<u8> = gpu.read(self.frame.light.texture())?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}

fn surfaces(gpu: &Gpu, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
    let attributes = vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x3, 4 => Uint32,
            5 => Float32x2, 6 => Float32x2, 7 => Float32x2];
    let buffer = wgpu::VertexBufferLayout {
        array_stride: size_of::<Corner>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    Draws {
        module,
        layout: None,
        entries: ["corner", "surface"],
        buffers: &[Some(buffer)],
        cull: None,
        depth: Some((true, wgpu::CompareFunction::Less)),
        targets: &SURFACES.map(|format| Some(format.into())),
    }
    .pipeline(gpu)
}
