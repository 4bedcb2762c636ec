//! The nodes of the scene that is shown: what holds what, and where each is.

use glam::{Affine3A, Mat4, Quat, Vec3};

use super::Trouble;
use super::tracks::{Track, Tracks};

/// A node: its rest pose, what moves it, and its parent, which comes before it.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) parent: Option<usize>,
    pub(super) rest: (Vec3, Quat, Vec3),
    /// Where the file gives a matrix instead of a pose.
    pub(super) matrix: Option<Mat4>,
    pub(super) tracks: Tracks,
    pub(super) moves: bool,
}

impl Node {
    pub(super) fn local(&self, time: f32) -> Affine3A {
        if let Some(matrix) = self.matrix.filter(|_| !self.moves) {
            return Affine3A::from_mat4(matrix);
        }
        let at =
            |track: &Option<Track<Vec3>>, rest: Vec3| track.as_ref().and_then(|t| t.at(time)).unwrap_or(rest);
        let rotation = self.tracks.rotation.as_ref().and_then(|t| t.at(time)).unwrap_or(self.rest.1);
        Affine3A::from_scale_rotation_translation(
            at(&self.tracks.scale, self.rest.2),
            rotation.normalize(),
            at(&self.tracks.translation, self.rest.0),
        )
    }
}

/// All nodes, parents first.
#[derive(Debug, Clone)]
pub(super) struct Nodes(pub(super) Vec<Node>);

impl Nodes {
    pub(super) fn global(&self, node: usize, time: f32) -> Affine3A {
        let mut transform = self.0[node].local(time);
        let mut at = self.0[node].parent;
        while let Some(parent) = at {
            transform = self.0[parent].local(time) * transform;
            at = self.0[parent].parent;
        }
        transform
    }

    pub(super) fn moves(&self, node: usize) -> bool {
        std::iter::successors(Some(node), |&n| self.0[n].parent).any(|n| self.0[n].moves)
    }
}

/// The nodes of the file, parents first, and the index of each in the file.
pub(super) fn nodes_of(document: &gltf::Document) -> Result<(Vec<Node>, Vec<usize>), Trouble> {
    let all: Vec<gltf::Node> = document.nodes().collect();
    let mut is_child = vec![false; all.len()];
    for node in &all {
        for child in node.children() {
            if std::mem::replace(&mut is_child[child.index()], true) {
                return Err(Trouble::NotATree(child.index()));
            }
        }
    }
    // With a default scene only its nodes count.
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let roots: Vec<usize> = match scene {
        Some(scene) => scene.nodes().map(|n| n.index()).collect(),
        None => (0..all.len()).filter(|&i| !is_child[i]).collect(),
    };
    let mut nodes = Vec::new();
    let mut order = Vec::new();
    let mut seen = vec![false; all.len()];
    let mut todo: Vec<(usize, Option<usize>)> = roots.into_iter().rev().map(|i| (i, None)).collect();
    while let Some((index, parent)) = todo.pop() {
        if std::mem::replace(&mut seen[index], true) {
            return Err(Trouble::NotATree(index));
        }
        let node = &all[index];
        let matrix = match node.transform() {
            gltf::scene::Transform::Matrix { matrix } => Some(Mat4::from_cols_array_2d(&matrix)),
            gltf::scene::Transform::Decomposed { .. } => None,
        };
        if matrix.is_some_and(|m| !m.is_finite()) {
            return Err(Trouble::NotFinite(format!("the matrix of node {index}")));
        }
        let (t, r, s) = match matrix {
            Some(m) => {
                let (s, r, t) = m.to_scale_rotation_translation();
                (t, r, s)
            }
            None => {
                let (t, r, s) = node.transform().decomposed();
                (Vec3::from_array(t), Quat::from_array(r), Vec3::from_array(s))
            }
        };
        if matrix.is_none() && !(t.is_finite() && r.is_finite() && s.is_finite() && r.length() > 1e-6) {
            return Err(Trouble::NotFinite(format!("the pose of node {index}")));
        }
        let place = nodes.len();
        nodes.push(Node { parent, rest: (t, r, s), matrix, tracks: Tracks::default(), moves: false });
        order.push(index);
        todo.extend(node.children().map(|c| (c.index(), Some(place))));
    }
    Ok((nodes, order))
}

pub(super) fn role_of(node: &gltf::Node) -> Option<String> {
    let extras = node.extras().as_ref()?;
    let value: serde_json::Value = serde_json::from_str(extras.get()).ok()?;
    value.get("role")?.as_str().map(str::to_owned)
}
