//! The material of fur: Bevy's standard one, on strands.

use std::collections::{BTreeMap, BTreeSet};

use bevy_asset::uuid::Uuid;
use bevy_asset::{Asset, Assets, Handle, RenderAssetUsages, uuid_handle};
use bevy_color::{ColorToComponents, LinearRgba};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParamItem;
use bevy_image::Image;
use bevy_material::{AlphaMode, OpaqueRendererMethod};
use bevy_math::{UVec4, Vec4};
use bevy_mesh::{Mesh, MeshVertexBufferLayoutRef};
use bevy_pbr::{
    ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline, StandardMaterial,
};
use bevy_reflect::TypePath;
use bevy_render::render_resource::{
    AsBindGroup, AsBindGroupError, BindGroupBuilder, BindGroupLayout, BindGroupLayoutEntry, Extent3d,
    RenderPipelineDescriptor, SpecializedMeshPipelineError, TextureDimension, TextureFormat,
};
use bevy_render::renderer::RenderDevice;
use bevy_shader::{Shader, ShaderRef};
use casca_fur::shader::{LOOKUP, SLAB, STRANDS, look};
use casca_fur::shading::Material;
use casca_fur::strands::{Fur, MAX_PER_CELL, PERIOD, TEXELS};

use crate::shells::ATTRIBUTE_FUR_LAYER;

/// A standard material whose surface is fur: base colour and its texture are taken at the root of
/// each strand; lights, shadows and fog are Bevy's.
pub type FurMaterial = ExtendedMaterial<StandardMaterial, FurExtension>;

/// A [`FurMaterial`], drawn forward: deferred rendering is not supported. Normal maps and parallax
/// have no effect.
pub fn fur_material(base: StandardMaterial, extension: FurExtension) -> FurMaterial {
    let base = StandardMaterial { opaque_render_method: OpaqueRendererMethod::Forward, ..base };
    ExtendedMaterial { base, extension }
}

/// The strands of a [`FurMaterial`], and their colours.
#[derive(Asset, TypePath, Debug, Clone, PartialEq)]
pub struct FurExtension {
    /// Where strands stand, in the space of the mesh: see [`Fur`].
    pub strands: Fur,
    /// The colour of roots, by which the base colour is multiplied. White by default.
    pub root: LinearRgba,
    /// The colour of tips, by which the base colour is multiplied. White by default.
    pub tip: LinearRgba,
    /// The share of light that reaches the roots between the strands, 0 to 1; it grows to 1 at the
    /// tips. 0.3 by default.
    pub dark: f32,
    /// How much strands differ in brightness, 0 to 1. 0.22 by default.
    pub vary: f32,
}

impl FurExtension {
    /// Strands in the colour of the base material, a little different from each other, dark at
    /// their roots.
    pub fn new(strands: Fur) -> Self {
        Self { strands, root: LinearRgba::WHITE, tip: LinearRgba::WHITE, dark: 0.3, vary: 0.22 }
    }
}

/// A [`FurExtension`] as `fur.wesl` takes it.
#[derive(AsBindGroup)]
pub struct Bound {
    #[uniform(100)]
    look: [UVec4; 5],
    #[uniform(101)]
    ends: [Vec4; 2],
    #[texture(102, dimension = "3d", sample_type = "u_int")]
    table: Handle<Image>,
}

impl AsBindGroup for FurExtension {
    type Data = ();
    type Param = <Bound as AsBindGroup>::Param;

    fn label() -> &'static str {
        "fur"
    }

    fn bind_group_data(&self) {}

    fn build_bind_group(
        &self,
        layout: &BindGroupLayout,
        device: &RenderDevice,
        param: &mut SystemParamItem<Self::Param>,
        no_bindless: bool,
        output: &mut BindGroupBuilder,
    ) -> Result<(), AsBindGroupError> {
        // Bevy lights it: of casca-fur's light only the dark at roots is used.
        let words = look(&self.strands, &Material { root: self.dark, ..Material::default() }, self.vary);
        let bound = Bound {
            look: std::array::from_fn(|i| UVec4::from_slice(&words[4 * i..])),
            ends: [self.root.to_vec4(), self.tip.to_vec4()],
            table: table_of(&self.strands).into(),
        };
        bound.build_bind_group(layout, device, param, no_bindless, output)
    }

    fn bind_group_layout_entries(device: &RenderDevice, no_bindless: bool) -> Vec<BindGroupLayoutEntry> {
        Bound::bind_group_layout_entries(device, no_bindless)
    }
}

/// The first half of the names of tables.
const TABLES: u64 = 0x6361_7363_6166_7574;

/// The name of the table of some strands, which furs may share.
fn table_of(fur: &Fur) -> Uuid {
    Uuid::from_u64_pair(TABLES, u64::from(fur.seed) << 32 | u64::from(fur.per_cell.min(MAX_PER_CELL)))
}

/// Makes the tables that materials need, and drops those that none needs any more.
pub(crate) fn make_tables(
    materials: Res<Assets<FurMaterial>>,
    mut images: ResMut<Assets<Image>>,
    mut made: Local<BTreeSet<Uuid>>,
) {
    if !materials.is_changed() {
        return;
    }
    let furs = materials.iter().map(|(_, material)| material.extension.strands);
    let needed: BTreeMap<Uuid, Fur> = furs.map(|fur| (table_of(&fur), fur)).collect();
    for old in made.extract_if(.., |table| !needed.contains_key(table)) {
        images.remove(&Handle::from(old));
    }
    for (table, fur) in needed {
        if made.insert(table) {
            let bytes = fur.table().into_iter().flat_map(u32::to_le_bytes).collect();
            let side = PERIOD * TEXELS;
            let size = Extent3d { width: side, height: side, depth_or_array_layers: side };
            let (format, usage) = (TextureFormat::R32Uint, RenderAssetUsages::RENDER_WORLD);
            let image = Image::new(size, TextureDimension::D3, bytes, format, usage);
            // Such names are never refused.
            let _ = images.insert(&Handle::from(table), image);
        }
    }
}

/// The shader, under a name of its own.
const SHADER: Handle<Shader> = uuid_handle!("7f0c2a54-4f4b-4f0e-9a43-5d0f3b7f8c11");

/// The shader: the rule of strands from casca-fur, and how Bevy draws it.
pub(crate) fn shader() -> (Handle<Shader>, Shader) {
    let text = [include_str!("fur.wesl"), STRANDS, LOOKUP, SLAB].concat();
    (SHADER, Shader::from_wesl(text, "embedded://bevy_casca_fur/fur.wesl"))
}

impl MaterialExtension for FurExtension {
    fn vertex_shader() -> ShaderRef {
        SHADER.into()
    }

    fn fragment_shader() -> ShaderRef {
        SHADER.into()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        SHADER.into()
    }

    fn prepass_fragment_shader() -> ShaderRef {
        SHADER.into()
    }

    /// Between strands fragments are discarded.
    fn alpha_mode() -> Option<AlphaMode> {
        Some(AlphaMode::Mask(0.5))
    }

    /// Vertices have the same places in all passes: shadows need normals and layers, too.
    fn specialize(
        _: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        _: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let all = [
            (Mesh::ATTRIBUTE_POSITION, 0),
            (Mesh::ATTRIBUTE_NORMAL, 1),
            (Mesh::ATTRIBUTE_UV_0, 2),
            (Mesh::ATTRIBUTE_UV_1, 3),
            (Mesh::ATTRIBUTE_COLOR, 4),
            (Mesh::ATTRIBUTE_JOINT_INDEX, 5),
            (Mesh::ATTRIBUTE_JOINT_WEIGHT, 6),
            (ATTRIBUTE_FUR_LAYER, 7),
        ];
        let needed = [Mesh::ATTRIBUTE_POSITION.id, Mesh::ATTRIBUTE_NORMAL.id, ATTRIBUTE_FUR_LAYER.id];
        let is_there = |id| layout.0.contains(id) || needed.contains(&id);
        let places = all.into_iter().filter(|(attribute, _)| is_there(attribute.id));
        let places: Vec<_> = places.map(|(attribute, place)| attribute.at_shader_location(place)).collect();
        // Strands beyond the outline stand on skin that faces away.
        descriptor.primitive.cull_mode = None;
        descriptor.vertex.buffers = vec![layout.0.get_layout(&places)?];
        Ok(())
    }
}
