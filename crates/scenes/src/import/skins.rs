//! Meshes with skins: skeletons, weights and clips, for animals that move.

use std::collections::HashMap;
use std::path::Path;

use casca_fur::skin::{
    Channel, Clip, Interpolation, Joint, Keyed, Local, PER_VERTEX, Skeleton, Track as SkinTrack, Weights,
};
use glam::{Affine3A, Mat4, Vec4};
use gltf::accessor::DataType;
use gltf::animation::{Interpolation as FileInterpolation, Property};

use super::accessors::{Buffers, Components, unfit};
use super::animations::{Keys, keys_of};
use super::document::{File, QUANTIZATION, parse};
use super::error::Trouble;
use super::meshes::Meshes;
use super::nodes::{Nodes, nodes_of, wrong};
use super::track::Track;
use super::warnings::Warnings;
use crate::numeric::AFFINE;
use crate::world::Mesh;

/// A mesh with a skin.
#[derive(Debug, Clone)]
pub struct Skinned {
    /// The mesh at rest.
    pub mesh: Mesh,
    /// The joints: those of the skin, and all nodes that they hang from.
    pub skeleton: Skeleton,
    /// The joints that vertices follow.
    pub weights: Weights,
    /// The animations that move a joint, with their names, which may be empty.
    pub clips: Vec<(String, Clip)>,
}

/// Reads the first mesh with a skin of a file; `None` if there is none. Poses of its skeleton take
/// the mesh into the space of the scene. Attributes `JOINTS_0` and `WEIGHTS_0` are read: four
/// joints a vertex.
///
/// # Errors
/// As [`load`](super::load), and: more than four joints a vertex, joints that the skin lacks,
/// weights that are negative or all zero, matrices of nodes that shear.
pub fn read_skinned(bytes: &[u8], folder: Option<&Path>) -> Result<Option<Skinned>, Trouble> {
    let file = parse(bytes, folder, &Warnings::default())?;
    let nodes = nodes_of(&file.document, &file.places)?;
    let File { document, buffers, .. } = &file;
    let all: Vec<gltf::Node> = document.nodes().collect();
    let skinned = nodes.0.iter().find_map(|item| {
        let node = all.get(item.index)?;
        Some((node.clone(), node.skin()?, node.mesh()?))
    });
    let Some((node, skin, mesh)) = skinned else { return Ok(None) };
    let quantized =
        document.extensions_used().chain(document.extensions_required()).any(|e| e == QUANTIZATION);
    let mut reader = Meshes::new(buffers, if quantized { Components::Integers } else { Components::Floats });
    let mut sources = Vec::new();
    let read = reader.mesh_from(&mesh, |primitive, vertex| sources.push((primitive, vertex as usize)))?;
    let Some((joined, _)) = read else { return Err(Trouble::NoTriangles) };

    let (skeleton, number_of) = skeleton_of(&all, buffers, &nodes, &skin)?;
    let of_skin: Vec<u32> = skin.joints().map(|joint| number_of[&joint.index()] as u32).collect();
    let rows = followers_of(&node, &mesh, buffers)?;
    let (mut joints, mut shares) = (Vec::new(), Vec::new());
    for source in sources {
        let (row, by) = follower(&node, &rows, &of_skin, source)?;
        joints.push(row);
        shares.push(by);
    }
    let weights = Weights::new(&joints, &shares, &skeleton)?;
    let clips = clips_of(document, buffers, &skeleton, &number_of)?;
    Ok(Some(Skinned { mesh: joined, skeleton, weights, clips }))
}

/// The joints that a vertex of a primitive follows, and their shares.
pub(super) fn follower(
    node: &gltf::Node,
    rows: &HashMap<usize, Rows>,
    of_skin: &[u32],
    (primitive, vertex): (usize, usize),
) -> Result<([u32; PER_VERTEX], [f32; PER_VERTEX]), Trouble> {
    let found = rows.get(&primitive).and_then(|rows| Some((rows.0.get(vertex)?, rows.1.get(vertex)?)));
    let Some((of, by)) = found else {
        return Err(wrong(node, "has a skin, but vertices without joints and weights"));
    };
    let mut row = [0; PER_VERTEX];
    for (slot, (&joint, &share)) in row.iter_mut().zip(of.iter().zip(by)) {
        // A joint without weight may be anything.
        *slot = match of_skin.get(joint as usize).copied() {
            Some(joint) => joint,
            None if share == 0.0 => 0,
            None => {
                let (joint, joints) = (joint as u32, of_skin.len());
                return Err(casca_fur::Error::Joint { vertex, joint, joints }.into());
            }
        };
    }
    Ok((row, *by))
}

/// The joints of a skin and the nodes that they hang from; and by node its number there.
pub(super) fn skeleton_of(
    all: &[gltf::Node],
    buffers: &Buffers,
    nodes: &Nodes,
    skin: &gltf::Skin,
) -> Result<(Skeleton, HashMap<usize, usize>), Trouble> {
    let mut inverse: HashMap<usize, Affine3A> = HashMap::new();
    let matrices = skin.inverse_bind_matrices().map(|accessor| {
        let what = "inverse bind matrices";
        let read = buffers.floats::<16>(&accessor, what, Components::Floats)?;
        if read.len() < skin.joints().count() {
            return Err(unfit(&accessor, what, "shorter than the joints"));
        }
        Ok((accessor, read))
    });
    let matrices = matrices.transpose()?;
    for (i, joint) in skin.joints().enumerate() {
        let matrix = match &matrices {
            None => Affine3A::IDENTITY,
            Some((accessor, read)) => {
                let matrix = Mat4::from_cols_array(&read[i]);
                if !matrix.row(3).abs_diff_eq(Vec4::W, AFFINE) {
                    return Err(unfit(accessor, "inverse bind matrices", "not affine"));
                }
                Affine3A::from_mat4(matrix)
            }
        };
        inverse.insert(joint.index(), matrix);
    }
    let mut needed = vec![false; nodes.0.len()];
    let mut found = 0;
    for (place, item) in nodes.0.iter().enumerate().filter(|(_, item)| inverse.contains_key(&item.index)) {
        found += 1;
        needed[place] = true;
        let mut at = item.parent;
        while let Some(parent) = at.filter(|&parent| !std::mem::replace(&mut needed[parent], true)) {
            at = nodes.0[parent].parent;
        }
    }
    if let Some(joint) = skin.joints().next().filter(|_| found < inverse.len()) {
        return Err(wrong(&joint, "is a joint of a skin with joints that are not in the scene"));
    }
    let (mut joints, mut number_of) = (Vec::new(), HashMap::new());
    for (place, item) in nodes.0.iter().enumerate().filter(|(place, _)| needed[*place]) {
        let (translation, rotation, scale) = item.rest;
        let (mut translation, mut rotation, mut scale) =
            (translation.as_vec3(), rotation.as_quat(), scale.as_vec3());
        if let Some(matrix) = item.matrix.map(|matrix| matrix.as_affine3a()) {
            (scale, rotation, translation) = matrix.to_scale_rotation_translation();
            let again = Affine3A::from_scale_rotation_translation(scale, rotation, translation);
            let size = matrix.to_cols_array().iter().fold(1.0, |most: f32, x| most.max(x.abs()));
            if !again.abs_diff_eq(matrix, AFFINE * size) {
                return Err(wrong(
                    &all[item.index],
                    "is part of a skeleton, but its matrix shears or flattens",
                ));
            }
        }
        let parent = item.parent.and_then(|parent| number_of.get(&nodes.0[parent].index).copied());
        let inverse_bind = inverse.get(&item.index).copied().unwrap_or(Affine3A::IDENTITY);
        number_of.insert(nodes.0[place].index, joints.len());
        joints.push(Joint { parent, rest: Local { translation, rotation, scale }, inverse_bind });
    }
    Ok((Skeleton::new(joints)?, number_of))
}

pub(super) type Rows = (Vec<[f32; PER_VERTEX]>, Vec<[f32; PER_VERTEX]>);

/// By primitive: joints and weights of its vertices.
pub(super) fn followers_of(
    node: &gltf::Node,
    mesh: &gltf::Mesh,
    buffers: &Buffers,
) -> Result<HashMap<usize, Rows>, Trouble> {
    let mut rows = HashMap::new();
    for primitive in mesh.primitives() {
        if primitive.get(&gltf::Semantic::Joints(1)).is_some() {
            return Err(wrong(node, "has a mesh with more than four joints a vertex, which is not read"));
        }
        let both = primitive.get(&gltf::Semantic::Joints(0)).zip(primitive.get(&gltf::Semantic::Weights(0)));
        let Some((joints, weights)) = both else { continue };
        if joints.normalized() || !matches!(joints.data_type(), DataType::U8 | DataType::U16) {
            return Err(unfit(&joints, "joints", "of a type that is not read"));
        }
        let joints = buffers.floats(&joints, "joints", Components::Integers)?;
        let weights = buffers.floats(&weights, "weights", Components::Normalized)?;
        rows.insert(primitive.index(), (joints, weights));
    }
    Ok(rows)
}

/// All animations, as far as they move joints.
pub(super) fn clips_of(
    document: &gltf::Document,
    buffers: &Buffers,
    skeleton: &Skeleton,
    number_of: &HashMap<usize, usize>,
) -> Result<Vec<(String, Clip)>, Trouble> {
    let mut clips = Vec::new();
    for animation in document.animations() {
        let mut channels = Vec::new();
        for channel in animation.channels() {
            let target = channel.target();
            let Some(&joint) = number_of.get(&target.node().index()) else { continue };
            if target.property() == Property::MorphTargetWeights {
                continue;
            }
            let keys = match keys_of(buffers, &channel)? {
                Keys::Translation(track) => Channel::Translation(skin_track(track)?),
                Keys::Rotation(track) => Channel::Rotation(skin_track(track)?),
                Keys::Scale(track) => Channel::Scale(skin_track(track)?),
            };
            channels.push((joint, keys));
        }
        if !channels.is_empty() {
            let name = animation.name().unwrap_or("").to_owned();
            clips.push((name, Clip::new(channels, skeleton)?));
        }
    }
    Ok(clips)
}

fn skin_track<T: Keyed>(track: Track<T>) -> Result<SkinTrack<T>, Trouble> {
    let interpolation = match track.interpolation {
        FileInterpolation::Step => Interpolation::Step,
        FileInterpolation::Linear => Interpolation::Linear,
        FileInterpolation::CubicSpline => Interpolation::CubicSpline,
    };
    Ok(SkinTrack::new(track.times, track.values, interpolation)?)
}
