//! Instances of a node's mesh: the extension EXT_mesh_gpu_instancing.

use glam::{Affine3A, Quat, Vec3};
use serde_json::Value;

use super::accessors::{Buffers, Components, unfit};
use super::error::Trouble;
use super::nodes::{unit, wrong};

pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";
const WHAT: &str = "instances";

/// Where the instances of a node are, seen from the node; `None` if it has no list of them.
pub(super) fn instances_of(
    document: &gltf::Document,
    buffers: &Buffers,
    node: &gltf::Node,
) -> Result<Option<Vec<Affine3A>>, Trouble> {
    let Some(extension) = node.extension_value(INSTANCING) else { return Ok(None) };
    let attributes = extension.get("attributes").and_then(Value::as_object);
    let attributes = attributes.ok_or_else(|| wrong(node, "has instances without attributes"))?;
    let mut count = None;
    let (mut translations, mut rotations, mut scales) = (None, None, None);
    for (name, index) in attributes {
        let index = index.as_u64().and_then(|i| usize::try_from(i).ok());
        let accessor = index.and_then(|i| document.accessors().nth(i));
        let accessor = accessor
            .ok_or_else(|| wrong(node, format!("has instances whose {name} is no accessor of the file")))?;
        if *count.get_or_insert(accessor.count()) != accessor.count() {
            return Err(wrong(node, "has instances with attributes of different lengths"));
        }
        match name.as_str() {
            "TRANSLATION" => translations = Some(buffers.vectors(&accessor, WHAT)?),
            "SCALE" => scales = Some(buffers.vectors(&accessor, WHAT)?),
            "ROTATION" => {
                let values = buffers.floats(&accessor, WHAT, Components::Normalized)?;
                let values: Option<Vec<Quat>> = values
                    .into_iter()
                    .map(|q| Some(unit(Quat::from_array(q).as_dquat())?.as_quat()))
                    .collect();
                let values = values.ok_or_else(|| {
                    unfit(&accessor, WHAT, "with a rotation that is not finite or of no or great length")
                })?;
                rotations = Some(values);
            }
            // Others say nothing about where instances are; but they must be there, for their
            // number to count.
            _ => buffers.check(&accessor, WHAT)?,
        }
    }
    let count = count.ok_or_else(|| wrong(node, "has instances without attributes"))?;
    let vector = |list: &Option<Vec<Vec3>>, i: usize, default: Vec3| {
        list.as_ref().and_then(|list| list.get(i)).copied().unwrap_or(default)
    };
    let place = |i| {
        let rotation = rotations.as_ref().and_then(|list| list.get(i)).copied().unwrap_or_default();
        Affine3A::from_scale_rotation_translation(
            vector(&scales, i, Vec3::ONE),
            rotation,
            vector(&translations, i, Vec3::ZERO),
        )
    };
    Ok(Some((0..count).map(place).collect()))
}
