//! Boxes around meshes that skins or morph targets deform, in all frames.

use std::collections::HashMap;

use glam::{Affine3A, Mat4, Vec3, Vec4};
use gltf::Semantic;
use gltf::animation::{Interpolation, Property};

use super::accessors::{Buffers, Components};
use super::error::Trouble;
use super::meshes::Meshes;
use super::nodes::Nodes;
use super::path::time_of;
use crate::numeric::{AFFINE, POSED};
use crate::world::{Bounds, around, box_corners};

/// By joint of a skin, the box of the points that follow it; and the least and the greatest sum of
/// their weights.
type Followed = (HashMap<usize, Bounds>, [f32; 2]);

/// The meshes of a file, and how they are deformed in a number of frames.
pub(super) struct Deformed<'a> {
    pub(super) document: &'a gltf::Document,
    pub(super) buffers: &'a Buffers,
    pub(super) nodes: &'a Nodes,
    pub(super) frames: usize,
}

impl Deformed<'_> {
    /// The box of a mesh in the space of its node or, if it has a skin, of the scene; `None` if it
    /// cannot be told.
    pub(super) fn bounds(
        &self,
        reader: &mut Meshes,
        node: &gltf::Node,
        mesh: &gltf::Mesh,
        moved: &[bool],
    ) -> Result<Option<Bounds>, Trouble> {
        let are_few = self.buffers.spend(mesh.primitives().len());
        let Some(weights) = self.weights(node, mesh)?.filter(|_| are_few) else { return Ok(None) };
        let Some(skin) = node.skin() else {
            let mut corners = Vec::new();
            for primitive in mesh.primitives() {
                let Some(accessor) = primitive.get(&Semantic::Positions) else { continue };
                let (rest, (low, high)) =
                    (reader.around(&accessor)?, self.offsets(reader, &primitive, &weights)?);
                corners.extend([rest.0 + low, rest.1 + high]);
            }
            return Ok(Some(around(corners)).filter(is_sound));
        };
        let Some(joints) = self.boxes_of_joints(reader, mesh, &weights)? else { return Ok(None) };
        self.posed(&skin, &joints, moved)
    }

    /// By morph target of a node, the least and the greatest weight; `None` if splines may go
    /// beyond their keys.
    fn weights(&self, node: &gltf::Node, mesh: &gltf::Mesh) -> Result<Option<Vec<[f32; 2]>>, Trouble> {
        let rest = node.weights().or(mesh.weights()).unwrap_or(&[]);
        let count = mesh.primitives().map(|p| p.morph_targets().len()).max().unwrap_or(0);
        let mut weights: Vec<[f32; 2]> =
            (0..count).map(|i| [rest.get(i).copied().unwrap_or(0.0); 2]).collect();
        let clips = self.document.animations().filter(|_| count > 0);
        for channel in clips.flat_map(|clip| clip.channels().collect::<Vec<_>>()) {
            let target = channel.target();
            if target.node().index() != node.index() || target.property() != Property::MorphTargetWeights {
                continue;
            }
            if channel.sampler().interpolation() == Interpolation::CubicSpline {
                return Ok(None);
            }
            let output = channel.sampler().output();
            let keys = self.buffers.floats::<1>(&output, "morph weights", Components::Normalized)?;
            if keys.iter().flatten().any(|key| !key.is_finite()) {
                return Ok(None);
            }
            for (i, [key]) in keys.into_iter().enumerate() {
                let [low, high] = &mut weights[i % count];
                (*low, *high) = (low.min(key), high.max(key));
            }
        }
        Ok(Some(weights))
    }

    /// How far morph targets take the points of a primitive.
    fn offsets(
        &self,
        reader: &mut Meshes,
        primitive: &gltf::Primitive,
        weights: &[[f32; 2]],
    ) -> Result<Bounds, Trouble> {
        let mut sum = (Vec3::ZERO, Vec3::ZERO);
        for (target, &[least, most]) in primitive.morph_targets().zip(weights) {
            let Some(accessor) = target.positions() else { continue };
            let (low, high) = reader.around(&accessor)?;
            let (low, high) = around([low * least, low * most, high * least, high * most]);
            sum = (sum.0 + low, sum.1 + high);
        }
        Ok(sum)
    }

    /// By joint, the box of the points that follow it, in the space of the mesh; and the least and
    /// the greatest sum of the weights of a point. `None` if weights are none.
    fn boxes_of_joints(
        &self,
        reader: &mut Meshes,
        mesh: &gltf::Mesh,
        weights: &[[f32; 2]],
    ) -> Result<Option<Followed>, Trouble> {
        let mut boxes: HashMap<usize, Bounds> = HashMap::new();
        let mut range = [f32::INFINITY, 0.0f32];
        for primitive in mesh.primitives() {
            let Some(accessor) = primitive.get(&Semantic::Positions) else { continue };
            let points = reader.points(&accessor, mesh.index())?;
            let (low, high) = self.offsets(reader, &primitive, weights)?;
            let mut sums = vec![0.0f32; points.len()];
            for set in 0.. {
                let Some(joints) = primitive.get(&Semantic::Joints(set)) else { break };
                let Some(shares) = primitive.get(&Semantic::Weights(set)) else { break };
                let joints = self.buffers.floats::<4>(&joints, "joints", Components::Integers)?;
                let shares = self.buffers.floats::<4>(&shares, "weights", Components::Normalized)?;
                for (vertex, (joints, shares)) in joints.into_iter().zip(shares).enumerate() {
                    let Some(&p) = points.get(vertex) else { break };
                    for (joint, share) in joints.into_iter().zip(shares).filter(|(_, share)| *share != 0.0) {
                        if share.is_nan() || share < 0.0 {
                            return Ok(None);
                        }
                        sums[vertex] += share;
                        let own = boxes.entry(joint as usize).or_insert((p + low, p + high));
                        *own = around([own.0, own.1, p + low, p + high]);
                    }
                }
            }
            range = sums.into_iter().fold(range, |[low, high], sum| [low.min(sum), high.max(sum)]);
        }
        Ok((range[0] > 0.0 && range[1].is_finite()).then_some((boxes, range)))
    }

    /// The box around what follows joints, in all frames. A point is a mean of where the joints
    /// that it follows take it, so that it lies in the box of these.
    fn posed(
        &self,
        skin: &gltf::Skin,
        (boxes, sums): &Followed,
        moved: &[bool],
    ) -> Result<Option<Bounds>, Trouble> {
        let place_of: HashMap<usize, usize> =
            self.nodes.0.iter().enumerate().map(|(place, node)| (node.index, place)).collect();
        let joints: Vec<Option<usize>> = skin.joints().map(|j| place_of.get(&j.index()).copied()).collect();
        let inverse = skin.inverse_bind_matrices().map(|accessor| {
            self.buffers.floats::<16>(&accessor, "inverse bind matrices", Components::Floats)
        });
        let inverse = inverse.transpose()?;
        let mut corners: Vec<(usize, [Vec3; 8])> = Vec::new();
        for (&joint, &(low, high)) in boxes {
            let Some(Some(place)) = joints.get(joint).copied() else { return Ok(None) };
            let bind = match &inverse {
                None => Mat4::IDENTITY,
                Some(all) => {
                    let Some(matrix) = all.get(joint) else { return Ok(None) };
                    Mat4::from_cols_array(matrix)
                }
            };
            if moved[place] || !bind.row(3).abs_diff_eq(Vec4::W, AFFINE) {
                return Ok(None);
            }
            let bind = Affine3A::from_mat4(bind);
            corners.push((place, box_corners(low, high).map(|p| bind.transform_point3(p))));
        }
        if !self.buffers.spend(self.frames.saturating_mul(self.nodes.0.len() + corners.len())) {
            return Ok(None);
        }
        let all = around((0..self.frames).flat_map(|frame| {
            let globals = self.nodes.globals(time_of(frame));
            let at = |place: usize, p: Vec3| globals[place].transform_point3(p.as_dvec3()).as_vec3();
            corners.iter().flat_map(|(place, corners)| corners.map(|p| at(*place, p))).collect::<Vec<_>>()
        }));
        // Weights that are not 1 in sum are made so by some programs, and are factors in others.
        let all = around([1.0, sums[0], sums[1]].into_iter().flat_map(|sum| [all.0 * sum, all.1 * sum]));
        let room = POSED * all.0.abs().max(all.1.abs());
        Ok(Some((all.0 - room, all.1 + room)).filter(is_sound))
    }
}

fn is_sound((low, high): &Bounds) -> bool {
    low.is_finite() && high.is_finite() && low.cmple(*high).all()
}
