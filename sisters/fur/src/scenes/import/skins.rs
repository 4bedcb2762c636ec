//! Meshes with skins: skeletons, weights and clips, for animals that move.

use std::collections::HashMap;

use crate::skin::{
    Channel, Clip, Interpolation, Joint, Keyed, Local, PER_VERTEX, Skeleton, Track as SkinTrack,
};
use glam::{Affine3A, Mat4, Vec4};
use gltf::accessor::DataType;
use gltf::animation::{Interpolation as FileInterpolation, Property};

use casca_scenes::import::Trouble;
use casca_scenes::import::parts::{AFFINE, Buffers, Components, Keys, Nodes, Track, keys_of, unfit, wrong};

/// What the reader says of fur that is refused.
pub(in crate::scenes) fn refused(error: crate::Error) -> Trouble {
    Trouble::Part(format!("has fur or a skin that is refused: {error}"))
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
                return Err(refused(crate::Error::follows(vertex, joint as usize, of_skin.len())));
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
    Ok((Skeleton::new(joints).map_err(refused)?, number_of))
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
            clips.push((name, Clip::new(channels, skeleton).map_err(refused)?));
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
    SkinTrack::new(track.times, track.values, interpolation).map_err(refused)
}
