//! Pictures of light, from positions and normals.

use wgpu::{
    BindGroup, BindGroupEntry, BindingResource, CommandEncoder, ComputePipeline, Device, TextureView,
};

use super::data::LOW;
use super::{GpuCache, bind, pipeline};
use crate::numeric::{
    ABOVE, ANSWER_AREA, ANSWER_HEIGHT, ANSWER_NORMAL, ANSWER_REACH, BOX, COVER, FAR, GROW, LEAST_SHARE,
    LEAVES, LIFT, NO_WAY,
};

/// Which light is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answers {
    /// Of the sky and of all bounces: for applications with shadows of their own.
    Indirect,
    /// Also that of lights and lamps, by rays against the triangles.
    All,
}

/// A pass that makes pictures of light, of any cache.
#[derive(Debug)]
pub struct Shading {
    answers: Answers,
    pipeline: ComputePipeline,
}

impl Shading {
    /// Compiles it.
    pub fn new(device: &Device, answers: Answers) -> Self {
        let [walk, answer] = [include_str!("walk.wgsl"), include_str!("answer.wgsl")];
        let (of_answer, more) = match answers {
            Answers::Indirect => ("casca_irradiance(", ["", ""]),
            Answers::All => ("casca_light_of(", [include_str!("spread.wgsl"), include_str!("direct.wgsl")]),
        };
        let main = include_str!("shade.wgsl").replace("ANSWER(", of_answer);
        let source = shader(&[walk, answer, more[0], more[1], &main]);
        Self { answers, pipeline: pipeline(device, source, "shade") }
    }
}

/// What the application drew.
#[derive(Debug, Clone, Copy)]
pub struct Surfaces<'a> {
    /// Positions in metres, with a fourth component of 1 or more where there is a surface.
    pub place: &'a TextureView,
    /// Normals, of any length but 0; 0 shows nothing.
    pub normals: &'a TextureView,
}

impl GpuCache {
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
        let group = drawn(device, &shading.pipeline, surfaces, picture, &[]);
        let sources = (7..).zip(&self.sources).filter(|_| shading.answers == Answers::All);
        let of_cache = bind(device, &shading.pipeline, self.tables().chain(sources));
        draw(encoder, &shading.pipeline, [&group, &of_cache], picture, [8, 8]);
    }
}

/// A shader of what the application drew and of a cache: the constants, what all have, and parts of
/// its own.
pub(super) fn shader(parts: &[&str]) -> String {
    let constants = [
        ("LIFT", LIFT),
        ("GROW", GROW),
        ("BOX", BOX),
        ("ABOVE", ABOVE),
        ("COVER", COVER),
        ("ANSWER_REACH", ANSWER_REACH),
        ("ANSWER_NORMAL", ANSWER_NORMAL),
        ("ANSWER_HEIGHT", ANSWER_HEIGHT),
        ("ANSWER_AREA", ANSWER_AREA),
        ("FAR", FAR),
        ("NO_WAY", f64::from(NO_WAY)),
        ("LEAST_SHARE", LEAST_SHARE),
        ("TURN", f64::from(std::f32::consts::TAU)),
    ];
    let constants = constants.map(|(name, value)| format!("const {name}: f32 = {value:?};\n")).concat();
    let common = [include_str!("place.wgsl"), include_str!("lookup.wgsl")].concat();
    format!("{constants}const LEAVES = {LEAVES}u;\nconst LOW = {LOW}u;\n{common}{}", parts.concat())
}

/// The bind group of what the application drew, of the picture and of more.
pub(super) fn drawn(
    device: &Device,
    pipeline: &ComputePipeline,
    surfaces: Surfaces,
    picture: &TextureView,
    more: &[BindGroupEntry],
) -> BindGroup {
    let texture = |(binding, view)| BindGroupEntry { binding, resource: BindingResource::TextureView(view) };
    let mut entries: Vec<_> = [(0, surfaces.place), (1, surfaces.normals), (2, picture)].map(texture).into();
    entries.extend(more.iter().cloned());
    let layout = &pipeline.get_bind_group_layout(0);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
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
