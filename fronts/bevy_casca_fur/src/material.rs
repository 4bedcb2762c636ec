//! The material of fur: Bevy's standard one, on strands.

use bevy_asset::{Asset, Handle, uuid_handle};
use bevy_color::{ColorToComponents, LinearRgba};
use bevy_material::{AlphaMode, OpaqueRendererMethod};
use bevy_math::{UVec4, Vec4};
use bevy_mesh::{Mesh, MeshVertexBufferLayoutRef};
use bevy_pbr::{
    ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline, StandardMaterial,
};
use bevy_reflect::TypePath;
use bevy_render::render_resource::{
    AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError,
};
use bevy_shader::{Shader, ShaderRef};
use casca_fur::shader::{FINE, SLAB, STRANDS, WALK};
use casca_fur::strands::{Fur, MAX_PER_CELL};

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
#[derive(Asset, TypePath, AsBindGroup, Debug, Clone, PartialEq)]
#[uniform(100, FurUniform)]
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
#[derive(Debug, Clone, Copy, ShaderType)]
struct FurUniform {
    /// Bend and height.
    bend: Vec4,
    /// Spacing, radius, taper and variation.
    strands: Vec4,
    /// The width of a pixel from which strands give way to their mean, the light at roots, the
    /// variation of brightness.
    look: Vec4,
    root: Vec4,
    tip: Vec4,
    /// Points of a cell and seed.
    counts: UVec4,
}

impl From<&FurExtension> for FurUniform {
    fn from(of: &FurExtension) -> Self {
        let fur = &of.strands;
        let [x, y, z] = fur.bend.to_array();
        Self {
            bend: Vec4::new(x, y, z, fur.height),
            strands: Vec4::new(fur.spacing, fur.radius, fur.taper, fur.variation),
            look: Vec4::new(FINE * fur.spacing, of.dark, of.vary, 0.0),
            root: of.root.to_vec4(),
            tip: of.tip.to_vec4(),
            // Each point costs eight hashes a step.
            counts: UVec4::new(fur.per_cell.min(MAX_PER_CELL), fur.seed, 0, 0),
        }
    }
}

/// The shader, under a name of its own.
const SHADER: Handle<Shader> = uuid_handle!("7f0c2a54-4f4b-4f0e-9a43-5d0f3b7f8c11");

/// The shader: the rule of strands from casca-fur, and how Bevy draws it.
pub(crate) fn shader() -> (Handle<Shader>, Shader) {
    let text = [include_str!("fur.wesl"), STRANDS, WALK, SLAB].concat();
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
        let needed = |attribute: &bevy_mesh::MeshVertexAttribute| {
            layout.0.contains(attribute.id)
                || [Mesh::ATTRIBUTE_POSITION.id, Mesh::ATTRIBUTE_NORMAL.id, ATTRIBUTE_FUR_LAYER.id]
                    .contains(&attribute.id)
        };
        let places = all.into_iter().filter(|(attribute, _)| needed(attribute));
        let places: Vec<_> = places.map(|(attribute, place)| attribute.at_shader_location(place)).collect();
        // Strands beyond the outline stand on skin that faces away.
        descriptor.primitive.cull_mode = None;
        descriptor.vertex.buffers = vec![layout.0.get_layout(&places)?];
        Ok(())
    }
}
