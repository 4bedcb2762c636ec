//! Pictures of light: from positions or depths and normals, by a pass of ours; and the functions of
//! that pass for shaders of the application.

use std::f32::consts::PI;

use glam::Mat4;
use wgpu::util::DeviceExt;
use wgpu::{
    BindGroup, BindGroupEntry, BindingResource, BufferUsages, CommandEncoder, ComputePipeline, Device,
    TextureView,
};

use super::data::LOW;
use super::{GpuCache, bind, number, pipeline};
use crate::numeric::{
    ABOVE, ANSWER_AREA, ANSWER_HEIGHT, ANSWER_NORMAL, ANSWER_REACH, BOX, FAR, GROW, LEAST_SHARE, LEAVES,
    LIFT, NO_WAY,
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
        let answer = match answers {
            Answers::Indirect => "casca_irradiance",
            Answers::All => "casca_light_of",
        };
        let source = include_str!("shade.wgsl").replace("ANSWER(", &format!("{answer}("));
        let pipeline = pipeline(device, placed(input, &(GpuCache::wgsl(1, answers) + &source)), "shade");
        Self { answers, input, pipeline }
    }
}

/// A shader that reads what the application drew.
pub(super) fn placed(input: Input, source: &str) -> String {
    let (place, at, other) = match input {
        Input::Positions => ("texture_2d<f32>", "at_position", "at_depth"),
        Input::Depth => ("texture_depth_2d", "at_depth", "at_position"),
    };
    let place = include_str!("place.wgsl").replace("PLACE", place);
    // The function of the other input would not fit the texture.
    let start = place.find(&format!("fn {other}")).unwrap_or(0);
    let end = place[start..].find("\n}\n").map_or(start, |i| start + i + 3);
    let source = source.replace("AT(", &format!("{at}("));
    [&place[..start], &place[end..], &source].concat()
}

/// What the application drew.
#[derive(Debug, Clone, Copy)]
pub struct Surfaces<'a> {
    /// Positions, or depths: as the [`Shading`] or [`super::Mirrors`] was made for.
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
        let lookup = include_str!("lookup.wgsl");
        let [walk, answer] = [include_str!("walk.wgsl"), include_str!("answer.wgsl")];
        match answers {
            Answers::Indirect => with_parts(group, &[lookup, walk, answer]),
            Answers::All => {
                let [spread, direct] = [include_str!("spread.wgsl"), include_str!("direct.wgsl")];
                with_parts(group, &[lookup, walk, answer, spread, direct])
            }
        }
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
        let group = drawn(device, &shading.pipeline, shading.input, surfaces, picture, &[]);
        let layout = shading.pipeline.get_bind_group_layout(1);
        let of_cache = self.bind_group(device, &layout, shading.answers);
        draw(encoder, &shading.pipeline, [&group, &of_cache], picture, [8, 8]);
    }
}

/// The shader of a cache that is bound to a group: the constants, and parts of it.
pub(super) fn with_parts(group: u32, parts: &[&str]) -> String {
    let constants = [
        ("LIFT", LIFT),
        ("GROW", GROW),
        ("BOX", BOX),
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
    let source = parts.concat().replace("GROUP", &group.to_string());
    format!(
        "{constants}const LEAVES = {LEAVES}u;\n\
         const LOW = {LOW}u;\n{source}"
    )
}

/// The bind group of what the application drew, of the picture and of more.
pub(super) fn drawn(
    device: &Device,
    pipeline: &ComputePipeline,
    input: Input,
    surfaces: Surfaces,
    picture: &TextureView,
    more: &[BindGroupEntry],
) -> BindGroup {
    let [x, y, z, w] = surfaces.inverse.to_cols_array_2d();
    let view = [x, y, z, w, [surfaces.empty, 0.0, 0.0, 0.0]];
    let view = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("the view"),
        contents: bytemuck::cast_slice(&view),
        usage: BufferUsages::UNIFORM,
    });
    let texture = |(binding, view)| BindGroupEntry { binding, resource: BindingResource::TextureView(view) };
    let mut entries: Vec<_> = [(0, surfaces.place), (1, surfaces.normals), (2, picture)].map(texture).into();
    if input == Input::Depth {
        entries.push(BindGroupEntry { binding: 3, resource: view.as_entire_binding() });
    }
    entries.extend(more.iter().cloned());
    let layout = pipeline.get_bind_group_layout(0);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries })
}

/// Runs a pass for all pixels of a picture, so many along both axes in each workgroup.
pub(super) fn draw(
    encoder: &mut CommandEncoder,
    pipeline: &ComputePipeline,
    groups: [&BindGroup; 2],
    picture: &TextureView,
    tile: [u32; 2],
) {
    let size = picture.texture().size();
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(pipeline);
    (0..).zip(groups).for_each(|(at, group)| pass.set_bind_group(at, group, &[]));
    pass.dispatch_workgroups(size.width.div_ceil(tile[0]), size.height.div_ceil(tile[1]), 1);
}
