//! Meshes for fur: their colours, lengths and images, and the skin that moves them.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::mesh::Coat;
use crate::skin::{Clip, Skeleton, Weights};
use glam::Affine3A;

use casca_scenes::import::Trouble;
use casca_scenes::import::parts::{
    Components, File, Nodes, QUANTIZATION, Warnings, check_rigid, nodes_of, parse,
};
use join::Join;
pub(super) use skins::refused;
use skins::{clips_of, follower, followers_of, skeleton_of};

mod join;
mod skins;

use casca_scenes::world::Mesh;

/// A mesh of a file that can grow fur; all lists are by vertex but `materials`.
#[derive(Debug, Clone)]
pub struct Coated {
    /// The mesh at rest. Vertices are those of primitives: parts with different materials share
    /// none.
    pub mesh: Mesh,
    /// Colours, and lengths as shares of the greatest.
    pub coats: Vec<Coat>,
    /// The material of each triangle, of `names`.
    pub materials: Vec<u32>,
    /// The names of all materials of the file; "" for those without a name. The last one stands for
    /// no material.
    pub names: Vec<String>,
    /// The skeleton and clips that move it.
    pub rig: Option<Rig>,
}

/// A skeleton, and how a mesh follows it.
#[derive(Debug, Clone)]
pub struct Rig {
    /// The joints: those of the skin, and all nodes that they hang from.
    pub skeleton: Skeleton,
    /// The joints that vertices follow.
    pub weights: Weights,
    /// The animations that move a joint, with their names, which may be empty.
    pub clips: Vec<(String, Clip)>,
}

/// Reads what can grow fur: all meshes with the first skin of the file and those that hang from its
/// joints, or all meshes where there is no skin.
///
/// - **Colour**: `COLOR_0` (floats, or integers of 8 or 16 bits; three or four components; linear)
///   times the base colour of the material times its base colour texture (PNG or JPEG, sRGB) at
///   the vertex. Brown where a part has neither `COLOR_0` nor a material.
/// - **Length**: the attribute `_FURLENGTH` (a number of 0 to 1), else the alpha of `COLOR_0`, else
///   1.
///
/// Colours and lengths outside of 0 to 1 are moved there.
///
/// # Errors
/// As [`casca_scenes::import::load`]; more than four joints a vertex, joints that the skin lacks,
/// weights that are negative or all zero, matrices of nodes that shear; images that are damaged or
/// too large (in all 64 Mi texels), and colours that are not finite.
pub fn read_coated(bytes: &[u8], folder: Option<&Path>) -> Result<Coated, Trouble> {
    let file = parse(bytes, folder, &Warnings::default())?;
    let nodes = nodes_of(&file.document, &file.places)?;
    let File { document, buffers, .. } = &file;
    let all: Vec<gltf::Node> = document.nodes().collect();
    let quantized =
        document.extensions_used().chain(document.extensions_required()).any(|e| e == QUANTIZATION);
    let skin = nodes.0.iter().find_map(|item| {
        let node = all.get(item.index)?;
        node.mesh().and(node.skin())
    });
    let rig = match skin {
        Some(skin) => Some((skeleton_of(&all, buffers, &nodes, &skin)?, skin)),
        None => None,
    };
    let positions = if quantized { Components::Integers } else { Components::Floats };
    let mut join = Join::new(document, buffers, positions, folder);
    let globals: Vec<Affine3A> = nodes.globals(0.0).iter().map(|at| at.as_affine3a()).collect();
    let above = rig.as_ref().map(|((_, number_of), skin)| joints_above(&nodes, skin, number_of));
    let above = above.unwrap_or_default();
    for (place, item) in nodes.0.iter().enumerate() {
        let Some(node) = all.get(item.index) else { continue };
        let Some(mesh) = node.mesh() else { continue };
        match &rig {
            None => {
                check_rigid(node, &mesh, item.morphs)?;
                join.add(&mesh, globals[place], &|_| Ok(None))?;
            }
            Some(((skeleton, number_of), skin)) => match node.skin() {
                Some(own) if own.index() == skin.index() => {
                    let of_skin: Vec<u32> =
                        skin.joints().map(|joint| number_of[&joint.index()] as u32).collect();
                    let rows = followers_of(node, &mesh, buffers)?;
                    let follows = |source| follower(node, &rows, &of_skin, source).map(Some);
                    join.add(&mesh, Affine3A::IDENTITY, &follows)?;
                }
                Some(_) => {}
                None => {
                    let Some((joint, hook)) = above[place] else { continue };
                    check_rigid(node, &mesh, item.morphs)?;
                    // Where the mesh of the skin has what moves with the joint.
                    let bind = skeleton.joints()[joint].inverse_bind.inverse();
                    let at = bind * globals[hook].inverse() * globals[place];
                    let follows = ([joint as u32, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]);
                    join.add(&mesh, at, &|_| Ok(Some(follows)))?;
                }
            },
        }
    }
    let made = join.done();
    if made.mesh.triangles.is_empty() {
        return Err(Trouble::NoTriangles);
    }
    let rig = match rig {
        None => None,
        Some(((skeleton, number_of), _)) => {
            let (joints, shares): (Vec<_>, Vec<_>) = made.followers.into_iter().unzip();
            let weights = Weights::new(&joints, &shares, &skeleton).map_err(refused)?;
            let clips = clips_of(document, buffers, &skeleton, &number_of)?;
            Some(Rig { skeleton, weights, clips })
        }
    };
    let names =
        document.materials().filter(|m| m.index().is_some()).map(|m| m.name().unwrap_or("").to_owned());
    Ok(Coated {
        mesh: made.mesh,
        coats: made.coats,
        materials: made.materials,
        names: names.chain([String::new()]).collect(),
        rig,
    })
}

/// For each node the joint of the skin that it hangs from or is, by its number, and the place of
/// the joint's node.
fn joints_above(
    nodes: &Nodes,
    skin: &gltf::Skin,
    number_of: &HashMap<usize, usize>,
) -> Vec<Option<(usize, usize)>> {
    let of_skin: HashSet<usize> = skin.joints().map(|joint| joint.index()).collect();
    let mut above: Vec<Option<(usize, usize)>> = Vec::with_capacity(nodes.0.len());
    for (place, node) in nodes.0.iter().enumerate() {
        let own = number_of.get(&node.index).filter(|_| of_skin.contains(&node.index));
        // Parents come first.
        let found = own.map(|&number| (number, place)).or_else(|| above[node.parent?]);
        above.push(found);
    }
    above
}
