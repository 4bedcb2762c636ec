//! Pictures of light: from positions or depths and normals, by a pass of ours; and the functions of
//! that pass for shaders of the application.

use std::f32::consts::PI;

use glam::Mat4;
use wgpu::util::DeviceExt;
use wgpu::{BindGroup, BufferUsages, CommandEncoder, ComputePipeline, Device, TextureView};

use super::data::LOW;
use super::{GpuCache, bind, number, pipeline};
use crate::numeric::{
    ABOVE, ANSWER_AREA, ANSWER_HEIGHT, ANSWER_NORMAL, ANSWER_REACH, FAR, LEAST_SHARE, LIFT, MOST_STEPS,
    MOST_WALK, NO_WAY,
};

/// Which light is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answers {
    /// Of the sky and of all bounces: for applications with shadows of their own.
    Indirect,
    /// Also that of lights and lamps, by rays against the triangles.
    All,
}

/// What a picture of light is made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// A picture of positions in metres, with a fourth component of 1 where there is a surface.
    Positions,
    /// A depth buffer.
    Depth,
}

/// A pass that makes pictures of light, of any cache.
#[derive(Debug)]
pub struct Shading {
    answers: Answers,
    input: Input,
    pipeline: ComputePipeline,
}

impl Shading {
    /// Compiles it.
    pub fn new(device: &Device, input: Input, answers: Answers) -> Self {
        let (place, at) = match input {
            Input::Positions => ("texture_2d<f32>", "at_position"),
            Input::Depth => ("texture_depth_2d", "at_depth"),
        };
        let answer = match answers {
            Answers::Indirect => "casca_irradiance",
            Answers::All => "casca_light_of",
        };
        // The function of the other input would not fit the texture.
        let other = if input == Input::Depth { "at_position" } else { "at_depth" };
        let source = include_str!("shade.wgsl").replace("PLACE", place);
        let start = source.find(&format!("fn {other}")).unwrap_or(0);
        let end = source[start..].find("\n}\n").map_or(start, |i| start + i + 3);
        let source = format!("{}{}", &source[..start], &source[end..]);
        let source = source.replace("AT(", &format!("{at}(")).replace("ANSWER(", &format!("{answer}("));
        let pipeline = pipeline(device, GpuCache::wgsl(1, answers) + &source, "shade");
        Self { answers, input, pipeline }
    }
}

/// What the application drew.
#[derive(Debug, Clone, Copy)]
pub struct Surfaces<'a> {
    /// Positions, or depths: as the [`Shading`] was made for.
    pub place: &'a TextureView,
    /// Normals, of any length but 0; 0 shows nothing.
    pub normals: &'a TextureView,
    /// From clip space into metres: the inverse of the product of projection and view. Read for
    /// depths only.
    pub inverse: Mat4,
    /// The depth that shows nothing: 0 where depths are reversed, else 1. Read for depths only.
    pub empty: f32,
}

impl GpuCache {
    /// WGSL with functions for a shader of the application, which is bound by
    /// [`Self::bind_group`] to a group:
    ///
    /// - `casca_irradiance(point: vec3f, normal: vec3f) -> vec4f`: the indirect irradiance of a
    ///   point
    ///   in metres with a unit normal, and 1 if states gave it;
    /// - with [`Answers::All`] also `casca_direct(point: vec3f, normal: vec3f) -> vec3f`, and
    ///   `casca_light_of` with the sum, as the first.
    ///
    /// All of its names start with `casca_` or `Casca`, or are constants in capitals.
    pub fn wgsl(group: u32, answers: Answers) -> String {
        let constants = [
            ("LIFT", LIFT),
            ("ABOVE", ABOVE),
            ("ANSWER_REACH", ANSWER_REACH),
            ("ANSWER_NORMAL", ANSWER_NORMAL),
            ("ANSWER_HEIGHT", ANSWER_HEIGHT),
            ("ANSWER_AREA", ANSWER_AREA),
            ("FAR", FAR),
            ("NO_WAY", f64::from(NO_WAY)),
            ("LEAST_SHARE", LEAST_SHARE),
            ("TURN", f64::from(2.0 * PI)),
        ];
        let constants = constants.map(|(name, value)| format!("const {name}: f32 = {value:?};\n")).concat();
        let direct = if answers == Answers::All { include_str!("direct.wgsl") } else { "" };
        let source = [include_str!("lookup.wgsl"), direct].concat().replace("GROUP", &group.to_string());
        format!(
            "{constants}const MOST_STEPS = {MOST_STEPS};\nconst MOST_WALK = {MOST_WALK};\nconst LOW = {LOW}u;\n{source}"
        )
    }

    /// The bind group of [`Self::wgsl`] for a pipeline's layout of that group. The layout must have
    /// all of its bindings: 0 to 6, and with [`Answers::All`] to 8.
    ///
    /// Ask for it anew after [`GpuCache::set_direct`], which may replace the list of lights, and
    /// after [`GpuCache::smooth`] and passes, which change the buffer of the light that is shown.
    pub fn bind_group(&self, device: &Device, layout: &wgpu::BindGroupLayout, answers: Answers) -> BindGroup {
        let mut all: Vec<_> = self.lookup.iter().chain([self.answers()]).collect();
        if answers == Answers::All {
            all.extend(&self.sources);
        }
        bind(device, layout, &number(&all))
    }

    /// Makes a picture of irradiance, `rgba32float` with `STORAGE_BINDING`, of the size of what the
    /// application drew. Its last component is 1 where states gave the indirect light, else 0.
    pub fn shade(
        &self,
        device: &Device,
        encoder: &mut CommandEncoder,
        shading: &Shading,
        surfaces: Surfaces,
        picture: &TextureView,
    ) {
        let [x, y, z, w] = surfaces.inverse.to_cols_array_2d();
        let view = [x, y, z, w, [surfaces.empty, 0.0, 0.0, 0.0]];
        let view = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("the view"),
            contents: bytemuck::cast_slice(&view),
            usage: BufferUsages::UNIFORM,
        });
        let texture = |(binding, view)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        };
        let mut entries: Vec<_> =
            [(0, surfaces.place), (1, surfaces.normals), (2, picture)].map(texture).into();
        if shading.input == Input::Depth {
            entries.push(wgpu::BindGroupEntry { binding: 3, resource: view.as_entire_binding() });
        }
        let layout = shading.pipeline.get_bind_group_layout(0);
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries };
        let group = device.create_bind_group(&descriptor);
        let layout = shading.pipeline.get_bind_group_layout(1);
        let of_cache = self.bind_group(device, &layout, shading.answers);
        let size = picture.texture().size();
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&shading.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_bind_group(1, &of_cache, &[]);
        pass.dispatch_workgroups(size.width.div_ceil(8), size.height.div_ceil(8), 1);
    }
}
