//! The nodes of the scene that is shown: what holds what, and where each is.

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};
use serde_json::Value;

use super::error::Trouble;
use super::track::{Track, Tracks};
use super::warnings::{Warnings, node_name};
use crate::numeric::{AFFINE, ROTATION_LENGTHS};

/// Translation, rotation and scale.
type Pose = (DVec3, DQuat, DVec3);

/// Where a node is, as exactly as the text of its file says it: the crate `gltf` rounds it to
/// single precision, which is three centimetres at 500 km.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// By a matrix.
    Matrix(DMat4),
    /// By translation, rotation and scale.
    Pose(Pose),
}

impl Place {
    /// That of a node; what has another form is refused elsewhere.
    pub fn of(node: &Value) -> Self {
        fn numbers<const N: usize>(node: &Value, member: &str) -> Option<[f64; N]> {
            let list = node.get(member)?.as_array()?;
            list.iter().map(Value::as_f64).collect::<Option<Vec<_>>>()?.try_into().ok()
        }
        match numbers(node, "matrix") {
            Some(matrix) => Self::Matrix(DMat4::from_cols_array(&matrix)),
            None => Self::Pose((
                numbers(node, "translation").map_or(DVec3::ZERO, DVec3::from_array),
                numbers(node, "rotation").map_or(DQuat::IDENTITY, DQuat::from_array),
                numbers(node, "scale").map_or(DVec3::ONE, DVec3::from_array),
            )),
        }
    }
}

/// A node: its rest pose, what moves it, and its parent, which comes before it.
#[derive(Debug, Clone)]
pub struct Node {
    /// Index in the file.
    pub index: usize,
    /// The place of its parent in the list.
    pub parent: Option<usize>,
    /// Where it is without animations, relative to its parent.
    pub rest: Pose,
    /// Where the file gives a matrix instead of a pose.
    pub matrix: Option<DAffine3>,
    /// What moves it.
    pub tracks: Tracks,
    /// Whether an animation moves it.
    pub moves: bool,
    /// Whether an animation deforms its mesh.
    pub morphs: bool,
}

impl Node {
    /// Where it is at a time, relative to its parent.
    pub fn local(&self, time: f32) -> DAffine3 {
        if let Some(matrix) = self.matrix {
            return matrix;
        }
        let at = |track: &Option<Track<DVec3>>, rest: DVec3| {
            track.as_ref().and_then(|t| t.at(time)).unwrap_or(rest)
        };
        let rotation = self.tracks.rotation.as_ref().and_then(|t| t.at(time)).unwrap_or(self.rest.1);
        DAffine3::from_scale_rotation_translation(
            at(&self.tracks.scale, self.rest.2),
            rotation.normalize(),
            at(&self.tracks.translation, self.rest.0),
        )
    }
}

/// All nodes, parents first.
#[derive(Debug, Clone)]
pub struct Nodes(pub Vec<Node>);

impl Nodes {
    /// Where a node is. Costs its depth.
    pub fn global(&self, node: usize, time: f32) -> DAffine3 {
        let mut way: Vec<usize> = self.way(node).collect();
        let root = way.pop().unwrap_or(node);
        way.iter().rev().fold(self.0[root].local(time), |at, &n| at * self.0[n].local(time))
    }

    /// A node, and those that it hangs from.
    pub fn way(&self, node: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(node), |&n| self.0[n].parent)
    }

    /// Where all nodes are at a time.
    pub fn globals(&self, time: f32) -> Vec<DAffine3> {
        self.inherited(|node, parent: Option<DAffine3>| {
            let local = node.local(time);
            parent.map_or(local, |parent| parent * local)
        })
    }

    /// Which nodes move, themselves or with what they hang from.
    pub fn moving(&self) -> Vec<bool> {
        self.inherited(|node, parent| node.moves || parent.unwrap_or(false))
    }

    /// What each node makes of itself and of what its parent made, if it has one.
    pub fn inherited<T: Copy>(&self, mut each: impl FnMut(&Node, Option<T>) -> T) -> Vec<T> {
        let mut all: Vec<T> = Vec::with_capacity(self.0.len());
        for node in &self.0 {
            let parent = node.parent.map(|parent| all[parent]);
            all.push(each(node, parent));
        }
        all
    }
}

/// The nodes of the scene that is shown: the default one, else the first; all nodes where there are
/// no scenes.
pub fn nodes_of(document: &gltf::Document, places: &[Place]) -> Result<Nodes, Trouble> {
    let all: Vec<gltf::Node> = document.nodes().collect();
    let mut parents = vec![None; all.len()];
    for node in &all {
        for child in node.children() {
            if parents[child.index()].replace(node.index()).is_some() {
                return Err(Trouble::NotATree(child.index()));
            }
        }
    }
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let roots: Vec<usize> = match &scene {
        Some(scene) => scene.nodes().map(|n| n.index()).collect(),
        None => (0..all.len()).filter(|&i| parents[i].is_none()).collect(),
    };
    // UniGLTF leaves parents of roots out of the scene. Programs agree on them only if they move nothing.
    let still = Place::Pose((DVec3::ZERO, DQuat::IDENTITY, DVec3::ONE));
    let is_held =
        |&&i: &&usize| parents[i].is_some_and(|p: usize| parents[p].is_some() || places[p] != still);
    if let Some(&child) = roots.iter().find(is_held) {
        return Err(wrong(&all[child], "is a root of the scene, but has a parent that is placed"));
    }
    let mut nodes = Vec::new();
    let mut seen = vec![false; all.len()];
    let mut todo: Vec<(usize, Option<usize>)> = roots.into_iter().rev().map(|i| (i, None)).collect();
    while let Some((index, parent)) = todo.pop() {
        if std::mem::replace(&mut seen[index], true) {
            return Err(Trouble::NotATree(index));
        }
        let node = &all[index];
        let (rest, matrix) = pose_of(node, places[index])?;
        let place = nodes.len();
        let tracks = Tracks::default();
        nodes.push(Node { index, parent, rest, matrix, tracks, moves: false, morphs: false });
        todo.extend(node.children().map(|c| (c.index(), Some(place))));
    }
    // Nodes in a ring hang from no root.
    match seen.iter().position(|seen| !seen) {
        Some(ring) if scene.is_none() => Err(Trouble::NotATree(ring)),
        _ => Ok(Nodes(nodes)),
    }
}

/// The pose of a node, and the matrix if that is what the file gives.
fn pose_of(node: &gltf::Node, place: Place) -> Result<(Pose, Option<DAffine3>), Trouble> {
    match place {
        Place::Matrix(matrix) => {
            if !matrix.as_mat4().is_finite() {
                return Err(Trouble::NotFinite(format!("the matrix of node {}", node.index())));
            }
            if !matrix.row(3).abs_diff_eq(DVec4::W, AFFINE.into()) {
                return Err(wrong(node, "has a matrix that is not affine"));
            }
            Ok(((DVec3::ZERO, DQuat::IDENTITY, DVec3::ONE), Some(DAffine3::from_mat4(matrix))))
        }
        Place::Pose((t, r, s)) => match unit(r) {
            Some(r) if t.as_vec3().is_finite() && s.as_vec3().is_finite() => Ok(((t, r, s), None)),
            _ => Err(Trouble::NotFinite(format!("the pose of node {}", node.index()))),
        },
    }
}

/// A rotation with length 1; `None` for what has no length to speak of.
pub(super) fn unit(rotation: DQuat) -> Option<DQuat> {
    let length = rotation.length();
    ROTATION_LENGTHS.contains(&length).then(|| rotation / length)
}

/// What is wrong with a node.
pub fn wrong(node: &gltf::Node, why: impl Into<String>) -> Trouble {
    Trouble::Part(format!("{} {}", node_name(node), why.into()))
}

/// Whether the object of a node hides others, and whether it is tested. Extras belong to everyone:
/// a role that is none of these is somebody else's.
pub(super) fn role_of(node: &gltf::Node, warnings: &Warnings) -> (bool, bool) {
    let extras = node.extras().as_ref().and_then(|text| serde_json::from_str::<Value>(text.get()).ok());
    let Some(role) = extras.as_ref().and_then(|extras| extras.get("role")) else { return (true, true) };
    match role.as_str() {
        Some("occluder") => return (true, false),
        Some("occludee") => return (false, true),
        Some("both") => {}
        _ => {
            let what = "has an extras.role that is not occluder, occludee or both, and counts as both";
            warnings.add(node_name(node), what);
        }
    }
    (true, true)
}

/// Whether a node shows its mesh in another form than its positions give; `morphs` says whether an
/// animation changes the weights of morph targets.
pub(super) fn is_deformed(node: &gltf::Node, mesh: &gltf::Mesh, morphs: bool) -> bool {
    let weights = node.weights().or(mesh.weights()).unwrap_or(&[]);
    let has_targets = mesh.primitives().any(|p| p.morph_targets().len() > 0);
    node.skin().is_some() || has_targets && (morphs || weights.iter().any(|&w| w != 0.0))
}

/// Refuses meshes that are drawn in another form than their positions give.
pub fn check_rigid(node: &gltf::Node, mesh: &gltf::Mesh, morphs: bool) -> Result<(), Trouble> {
    match is_deformed(node, mesh, morphs) {
        true if node.skin().is_some() => Err(wrong(node, "has a skin; deformed meshes are not read")),
        true => Err(wrong(node, "has a mesh with morph targets in use; deformed meshes are not read")),
        false => Ok(()),
    }
}
