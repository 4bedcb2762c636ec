//! All layers of a mesh as one mesh.

use std::sync::Arc;

use bevy_asset::RenderAssetUsages;
use bevy_camera::primitives::Aabb;
use bevy_math::Vec3;
use bevy_mesh::skinning::SkinnedMeshBounds;
use bevy_mesh::{Indices, Mesh, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues, VertexFormat};

use crate::numeric::{MOST_TRIANGLES, MOST_VERTICES, NO_NORMAL};

/// The length of the coat at a vertex of a mesh, as a share of the full length: 0 for bald skin.
/// Optional; without it all skin has the full length. The format is `Float32`.
pub const ATTRIBUTE_FUR_LENGTH: MeshVertexAttribute =
    MeshVertexAttribute::new("Fur_Length", 0x6361_7363_6166_7572, VertexFormat::Float32);

/// In a mesh of layers: the layer of a vertex, how many there are, and the length there.
pub const ATTRIBUTE_FUR_LAYER: MeshVertexAttribute =
    MeshVertexAttribute::new("Fur_Layer", 0x6361_7363_6166_7573, VertexFormat::Float32x3);

/// Said of meshes that only the graphics processor has.
const UNREADABLE: &str = "only the graphics processor has a copy of the mesh";
/// Said of meshes without normals that can be used.
const NORMALS: &str = "the mesh has no normals of three floats for its vertices";
const EMPTY: &str = "the mesh has no triangles";
const LARGE: &str = "the mesh is too large for fur";

/// A mesh for coats, checked.
#[derive(Debug, Clone)]
pub(crate) struct Skin {
    /// The box of the positions.
    pub low: Vec3,
    pub high: Vec3,
    pub vertices: u32,
    /// The most layers that are within the limits.
    pub most_layers: u32,
    pub indices: Arc<[u32]>,
}

impl Skin {
    /// Checks a mesh, or says why it gets no fur.
    pub fn of(mesh: &Mesh) -> Result<Self, &'static str> {
        if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
            return Err("the mesh is no triangle list");
        }
        if mesh.try_attributes().is_err() {
            return Err(UNREADABLE);
        }
        let positions =
            floats(mesh, Mesh::ATTRIBUTE_POSITION).ok_or("the mesh has no positions of three floats")?;
        let normals = floats(mesh, Mesh::ATTRIBUTE_NORMAL).ok_or(NORMALS)?;
        if positions.is_empty() {
            return Err(EMPTY);
        }
        if normals.len() != positions.len() {
            return Err(NORMALS);
        }
        let finite = |values: &[[f32; 3]]| values.iter().flatten().all(|v| v.is_finite());
        let lengths = lengths(mesh, positions.len())?;
        if !finite(positions) || !finite(normals) || !lengths.is_none_or(|l| l.iter().all(|v| v.is_finite()))
        {
            return Err("the mesh has numbers that are not finite");
        }
        let indices = indices_of(mesh, positions.len())?;
        let (vertices, triangles) = (positions.len(), indices.len() / 3);
        let most = (MOST_VERTICES / vertices).min(MOST_TRIANGLES / triangles);
        if most == 0 {
            return Err(LARGE);
        }
        let corners = positions.iter().map(|&p| Vec3::from_array(p));
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = corners.fold(none, |(low, high), p| (low.min(p), high.max(p)));
        Ok(Self { low, high, vertices: vertices as u32, most_layers: most.min(256) as u32, indices })
    }

    /// The greatest absolute coordinate.
    pub fn magnitude(&self) -> f32 {
        self.low.abs().max(self.high.abs()).max_element()
    }

    /// A box that contains all layers of fur with a reach.
    pub fn grown(&self, reach: f32) -> Aabb {
        Aabb::from_min_max(self.low - reach, self.high + reach)
    }
}

/// An attribute of three floats.
fn floats(mesh: &Mesh, attribute: MeshVertexAttribute) -> Option<&[[f32; 3]]> {
    match mesh.try_attribute(attribute).ok()? {
        VertexAttributeValues::Float32x3(values) => Some(values),
        _ => None,
    }
}

/// The lengths of the coat, if the mesh has some.
fn lengths(mesh: &Mesh, vertices: usize) -> Result<Option<&[f32]>, &'static str> {
    match mesh.try_attribute_option(ATTRIBUTE_FUR_LENGTH).map_err(|_| UNREADABLE)? {
        None => Ok(None),
        Some(VertexAttributeValues::Float32(values)) if values.len() == vertices => Ok(Some(values)),
        Some(_) => Err("the lengths of the coat are not a float for each vertex"),
    }
}

/// Whole triangles, as 32-bit indices; without indices three vertices are one.
fn indices_of(mesh: &Mesh, vertices: usize) -> Result<Arc<[u32]>, &'static str> {
    let count = u32::try_from(vertices).map_err(|_| LARGE)?;
    let mut all: Vec<u32> = match mesh.try_indices_option().map_err(|_| UNREADABLE)? {
        Some(Indices::U16(indices)) => indices.iter().map(|&i| i.into()).collect(),
        Some(Indices::U32(indices)) => indices.clone(),
        None => (0..count).collect(),
    };
    all.truncate(all.len() / 3 * 3);
    match all.iter().max() {
        None => Err(EMPTY),
        Some(&most) if most >= count => Err("a triangle of the mesh has a vertex that is not there"),
        Some(_) => Ok(all.into()),
    }
}

/// All layers of a checked mesh above its skin, as one mesh for a [`crate::FurMaterial`]: the
/// outermost first, so that what lies below is found to be hidden. Positions are those of the skin;
/// the shader moves them. The mesh keeps texture coordinates, colours, joints and weights, and is
/// gone from the main world once it is on the graphics processor. `layers` counts as 1 to 256, fewer
/// for large meshes. With a reach, the bounds of joints contain all layers. Costs time and memory as
/// `layers` times the mesh.
pub(crate) fn shells(mesh: &Mesh, skin: &Skin, layers: u32, reach: Option<f32>) -> Mesh {
    let layers = layers.clamp(1, skin.most_layers);
    let (vertices, times) = (skin.vertices, layers as usize);
    let mut all = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD);
    let kept = [
        Mesh::ATTRIBUTE_POSITION,
        Mesh::ATTRIBUTE_UV_0,
        Mesh::ATTRIBUTE_UV_1,
        Mesh::ATTRIBUTE_COLOR,
        Mesh::ATTRIBUTE_JOINT_INDEX,
        Mesh::ATTRIBUTE_JOINT_WEIGHT,
    ];
    for attribute in kept {
        let values = mesh.try_attribute_option(attribute).ok().flatten();
        if let Some(values) = values.and_then(|values| repeated(values, vertices as usize, times)) {
            let format = VertexFormat::from(&values);
            all.insert_attribute(MeshVertexAttribute { format, ..attribute }, values);
        }
    }
    let normals = floats(mesh, Mesh::ATTRIBUTE_NORMAL).unwrap_or_default();
    let unit = |&n: &[f32; 3]| Some(Vec3::from_array(n)).filter(|n| n.length() > NO_NORMAL)?.try_normalize();
    let ups: Vec<Option<Vec3>> = normals.iter().map(unit).collect();
    let lengths = lengths(mesh, vertices as usize).ok().flatten();
    // Where there is no normal, there is no fur.
    let full = |i: usize| lengths.map_or(1.0, |lengths| lengths[i].clamp(0.0, 1.0));
    let long: Vec<f32> = (0..ups.len()).map(|i| ups[i].map_or(0.0, |_| full(i))).collect();
    let layer = |k: u32| long.iter().map(move |&length| [k as f32, layers as f32, length]);
    let tips_first: Vec<[f32; 3]> = (1..=layers).rev().flat_map(layer).collect();
    all.insert_attribute(ATTRIBUTE_FUR_LAYER, tips_first);
    let ups: Vec<[f32; 3]> = ups.iter().map(|up| up.unwrap_or(Vec3::Y).to_array()).collect();
    all.insert_attribute(Mesh::ATTRIBUTE_NORMAL, ups.repeat(times));
    let of_layer = |k: u32| skin.indices.iter().map(move |i| i + k * vertices);
    all.insert_indices(Indices::U32((0..layers).flat_map(of_layer).collect()));
    if let (Some(reach), Ok(mut bounds)) = (reach, SkinnedMeshBounds::from_mesh(mesh)) {
        bounds.aabbs.iter_mut().for_each(|joint| joint.half_size += reach);
        all.set_skinned_mesh_bounds(Some(bounds));
    }
    all
}

/// The values of an attribute, one after the other for each layer; none if they are not one for
/// each vertex, or in a format that shaders of this crate do not take.
fn repeated(values: &VertexAttributeValues, vertices: usize, times: usize) -> Option<VertexAttributeValues> {
    use VertexAttributeValues::{Float32x2, Float32x3, Float32x4, Uint8x4, Uint16x4, Unorm8x4, Unorm16x4};
    if values.len() != vertices {
        return None;
    }
    Some(match values {
        Float32x2(v) => Float32x2(v.repeat(times)),
        Float32x3(v) => Float32x3(v.repeat(times)),
        Float32x4(v) => Float32x4(v.repeat(times)),
        Uint16x4(v) => Uint16x4(v.repeat(times)),
        Uint8x4(v) => Uint8x4(v.repeat(times)),
        Unorm8x4(v) => Unorm8x4(v.repeat(times)),
        Unorm16x4(v) => Unorm16x4(v.repeat(times)),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use bevy_mesh::Meshable;
    use bevy_shape::{Cuboid, Sphere};

    use super::*;

    fn layered(mesh: &Mesh, layers: u32) -> Mesh {
        shells(mesh, &Skin::of(mesh).unwrap(), layers, None)
    }

    #[test]
    fn all_kinds_of_indices_give_the_same_layers_outermost_first() {
        let mesh = Sphere::new(1.0).mesh().uv(6, 4);
        let vertices = mesh.count_vertices();
        let short = match mesh.indices() {
            Some(Indices::U32(long)) => long.iter().map(|&i| i as u16).collect(),
            Some(Indices::U16(short)) => short.clone(),
            None => panic!("no indices"),
        };
        let long: Vec<u32> = short.iter().map(|&i| i.into()).collect();
        let of = |mesh: &Mesh| -> (Vec<[f32; 3]>, Vec<usize>) {
            (floats(mesh, ATTRIBUTE_FUR_LAYER).unwrap().to_vec(), mesh.indices().unwrap().iter().collect())
        };
        let (marks, indices) = of(&layered(&mesh.clone().with_inserted_indices(Indices::U16(short)), 5));
        let same = of(&layered(&mesh.clone().with_inserted_indices(Indices::U32(long)), 5));
        assert_eq!((&marks, &indices), (&same.0, &same.1));
        assert_eq!((marks.len(), indices.len()), (5 * vertices, 5 * mesh.indices().unwrap().len()));
        assert!(indices.iter().all(|&i| i < 5 * vertices));
        assert!(
            marks
                .chunks(vertices)
                .zip((1..=5).rev())
                .all(|(c, k)| c.iter().all(|m| *m == [k as f32, 5.0, 1.0]))
        );
        // The triangles of a layer keep to their layer, tips first.
        let layers: Vec<usize> = indices.chunks(3).map(|t| t[0] / vertices).collect();
        assert!(
            layers.is_sorted()
                && indices.chunks(3).all(|t| t.iter().all(|i| i / vertices == t[0] / vertices))
        );
        // Without indices: three vertices are a triangle.
        let loose = mesh.clone().with_duplicated_vertices();
        let (marks, indices) = of(&layered(&loose, 2));
        assert_eq!(
            (marks.len(), indices),
            (2 * loose.count_vertices(), (0..marks.len()).collect::<Vec<_>>())
        );
        // None is one layer, and too many are 256.
        assert_eq!(of(&layered(&loose, 0)).0.len(), loose.count_vertices());
        assert_eq!(of(&layered(&loose, u32::MAX)).0.len(), 256 * loose.count_vertices());
    }

    #[test]
    fn bald_skin_and_vertices_without_normals_have_no_length() {
        let mut lengths = vec![2.0f32; 24];
        (lengths[0], lengths[1], lengths[2]) = (0.0, 0.25, -3.0);
        let mut normals = vec![[0.0, 3.0, 0.0]; 24];
        normals[3] = [0.0; 3];
        let mesh = Mesh::from(Cuboid::new(1.0, 1.0, 1.0))
            .with_inserted_attribute(ATTRIBUTE_FUR_LENGTH, lengths)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
        let all = layered(&mesh, 3);
        let found: Vec<f32> =
            floats(&all, ATTRIBUTE_FUR_LAYER).unwrap()[..6].iter().map(|mark| mark[2]).collect();
        assert_eq!(found, [0.0, 0.25, 0.0, 0.0, 1.0, 1.0]);
        let normals = floats(&all, Mesh::ATTRIBUTE_NORMAL).unwrap();
        assert!(normals.iter().all(|n| *n == [0.0, 1.0, 0.0]), "normals are of unit length");
    }
}
