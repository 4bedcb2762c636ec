//! All that a document holds, as a test scene.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, DAffine3, Vec3};

use super::accessors::{Buffers, Components};
use super::animations::animate;
use super::document::{File, QUANTIZATION};
use super::error::Trouble;
use super::instances::instances_of;
use super::meshes::Meshes;
use super::nodes::{Nodes, check_rigid, nodes_of, role_of, wrong};
use super::origin::moved;
use super::path::{FilePath, Moving, camera_of};
use super::warnings::Warnings;
use crate::numeric::{GRID_ROOM, GRID_ROOM_FAR, LEAST_SIZE};
use crate::world::{FRAME_SECONDS, GridHint, Mesh, Motion, Object, Shape, Source, World};

/// Frames of a path that the file does not give.
const OWN_FRAMES: usize = 150;
/// Frames after the first of a path that the file gives.
const MOST_FRAMES: f64 = 99_999.0;
/// Bytes of the name of an instance that count as an element of a buffer.
const NAME_OF_AN_ELEMENT: usize = 16;
/// By triangle: a material, as [`Meshes::mesh`] numbers them.
pub(super) type Looks = Arc<[u32]>;

/// Cells along the longest axis of the grid that is asked for.
const CELLS: f32 = 128.0;

/// The objects of a file.
#[derive(Default)]
pub(super) struct Found {
    pub(super) objects: Vec<Object>,
    /// By object: where it is at rest, in the coordinates of the file.
    pub(super) places: Vec<DAffine3>,
    /// By object.
    materials: Vec<Looks>,
    pub(super) moving: Vec<Moving>,
}

/// The objects of all nodes with a mesh; `moves` tells which nodes move.
fn objects_of(
    document: &gltf::Document,
    buffers: &Buffers,
    reader: &mut Meshes,
    nodes: &Nodes,
    moves: &[bool],
    warnings: &Warnings,
) -> Result<Found, Trouble> {
    type Known = Option<(Arc<Mesh>, Looks)>;
    let mut meshes: HashMap<usize, Known> = HashMap::new();
    let globals = nodes.globals();
    let mut found = Found::default();
    for (place, item) in nodes.0.iter().enumerate() {
        let Some(node) = document.nodes().nth(item.index) else { continue };
        let Some(mesh) = node.mesh() else { continue };
        check_rigid(&node, &mesh, item.morphs)?;
        let (occludes, tested) = role_of(&node, warnings);
        let mesh = match meshes.get(&mesh.index()) {
            Some(known) => known.clone(),
            None => {
                let read = reader.mesh(&mesh)?.map(|(mesh, looks)| (Arc::new(mesh), looks.into()));
                meshes.insert(mesh.index(), read.clone());
                read
            }
        };
        let Some((mesh, looks)) = mesh else { continue };
        let name = node.name().unwrap_or("");
        let (transform, dynamic) = (globals[place], moves[place]);
        let mut add = |name: String, instance: Affine3A| {
            let instance = instance.as_daffine3();
            let at = transform * instance;
            if dynamic {
                found.moving.push(Moving {
                    object: found.objects.len(),
                    node: place,
                    place: instance,
                    mesh: mesh.clone(),
                });
            }
            found.places.push(at);
            found.materials.push(looks.clone());
            found.objects.push(Object {
                name,
                shape: Shape::Mesh { mesh: mesh.clone(), transform: at.as_affine3a() },
                motion: if dynamic { Motion::Dynamic { max_speed: 0.0 } } else { Motion::Static },
                occludes,
                tested,
            });
        };
        match instances_of(document, buffers, &node)? {
            None => add(name.to_owned(), Affine3A::IDENTITY),
            Some(places) => {
                // Each gets the name.
                if !buffers.spend(places.len().saturating_mul(1 + name.len() / NAME_OF_AN_ELEMENT)) {
                    return Err(wrong(&node, "has too many instances for its name"));
                }
                for (i, instance) in places.into_iter().enumerate() {
                    add(format!("{name}#{i}"), instance);
                }
            }
        }
    }
    if found.objects.is_empty() { Err(Trouble::NoTriangles) } else { Ok(found) }
}

/// The grid around a scene that reaches from `min` to `max`.
fn grid_of(min: Vec3, max: Vec3) -> Result<GridHint, Trouble> {
    let size = (max - min).max_element();
    let far = min.abs().max(max.abs()).max_element();
    let margin = (size.max(LEAST_SIZE) * GRID_ROOM).max(far * GRID_ROOM_FAR);
    let (min, max) = (min - margin, max + margin);
    let cell = (max - min).max_element() / CELLS;
    if !(min.is_finite() && max.is_finite() && cell.is_finite()) {
        return Err(Trouble::NotFinite("the size of the scene".to_owned()));
    }
    Ok(GridHint { min, max, cell })
}

/// The scene, and the materials of each object.
pub(super) fn contents(
    name: &str,
    file: &File,
    warnings: &Warnings,
) -> Result<(World, Vec<Looks>), Trouble> {
    let File { document, buffers, .. } = file;
    let mut nodes = nodes_of(file)?;
    let clip = animate(document, buffers, &mut nodes)?;
    let quantized =
        document.extensions_used().chain(document.extensions_required()).any(|e| e == QUANTIZATION);
    let mut reader = Meshes::new(buffers, if quantized { Components::Integers } else { Components::Floats });
    let moves = nodes.moving();
    let mut found =
        objects_of(document, buffers, &mut reader, &nodes, &moves, warnings)?;

    // Both ends of the clip are frames.
    let clip_frames = (f64::from(clip) / FRAME_SECONDS).round().clamp(0.0, MOST_FRAMES) as usize + 1;
    let camera = camera_of(document, &nodes, &moves, warnings);
    let frames = match &camera {
        Some(c) if moves[c.node] => clip_frames,
        _ => OWN_FRAMES,
    };
    let origin = moved(&mut found);
    let Found { mut objects, materials, moving, .. } = found;
    let mut animation = FilePath::new(nodes, moving, camera, frames, origin);
    let (min, max) = animation.settle(&mut objects, buffers.bytes(), warnings)?;
    let (grid, frames) = (grid_of(min, max)?, animation.frames());
    let source = Source { warnings: warnings.lines(), origin };
    let world =
        World { source, name: name.to_owned(), objects, grid, frames, animation: Box::new(animation) };
    Ok((world, materials))
}
