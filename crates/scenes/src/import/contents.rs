//! All that a document holds, as a test scene.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use glam::{Affine3A, DAffine3, Vec3};

use super::accessors::Components;
use super::animations::animate;
use super::deformed::Deformed;
use super::document::{File, QUANTIZATION};
use super::error::Trouble;
use super::hides::{Changes, has_splats, levels_of};
use super::instances::{INSTANCING, instances_of};
use super::meshes::{Meshes, is_loose};
use super::nodes::{Nodes, Place, is_deformed, nodes_of, role_of, wrong};
use super::origin::{Found, moved};
use super::path::{FilePath, Moving, camera_of};
use super::warnings::{Warnings, node_name};
use crate::numeric::{GRID_ROOM, GRID_ROOM_FAR, LEAST_SIZE};
use crate::world::{
    Bounds, FRAME_SECONDS, FilePart, GridHint, Mesh, Motion, Object, Shape, Sides, Source, World, turn_of,
};

/// Frames of a path that the file does not give.
const OWN_FRAMES: usize = 150;
/// Frames after the first of a path that the file gives.
const MOST_FRAMES: f64 = 99_999.0;
/// Bytes of the name of an instance that count as an element of a buffer.
const NAME_OF_AN_ELEMENT: usize = 16;
/// Cells along the longest axis of the grid that is asked for.
const CELLS: f32 = 128.0;

/// A mesh, and by triangle its primitive.
type Known = Option<(Arc<Mesh>, Arc<[u32]>)>;

/// What becomes objects.
struct Reader<'a> {
    document: &'a gltf::Document,
    /// By node: where the file puts it.
    places: &'a [Place],
    /// Nodes that animations move or deform.
    animated: HashSet<usize>,
    /// For each node, by its place: whether an extension that is not read moves it.
    unread: Vec<bool>,
    changes: &'a Changes,
    warnings: &'a Warnings,
    meshes: Meshes<'a>,
    known: HashMap<usize, Known>,
    deformed: Deformed<'a>,
}

impl Reader<'_> {
    /// The mesh of nodes that do not deform it.
    fn rigid(&mut self, mesh: &gltf::Mesh) -> Result<Known, Trouble> {
        if let Some(known) = self.known.get(&mesh.index()) {
            return Ok(known.clone());
        }
        let read = self.meshes.mesh(mesh)?.map(|(mut read, primitives)| {
            let sides: Vec<Sides> = mesh
                .primitives()
                .map(|p| match is_loose(p.mode()) {
                    true => Sides::Neither,
                    false => self.changes.sides_of(self.document, &p, self.warnings),
                })
                .collect();
            if sides.iter().any(|&s| s != Sides::Both) {
                read.sides = primitives.iter().map(|&p| sides[p as usize]).collect();
            }
            (Arc::new(read), primitives.into())
        });
        self.known.insert(mesh.index(), read.clone());
        Ok(read)
    }

    /// What a node shows if its mesh does not tell that: a box around it in all frames and levels of
    /// detail, in the space of the scene if it has a skin. `None` if it is left out.
    fn boxed(&mut self, node: &gltf::Node, mesh: &gltf::Mesh) -> Known {
        let why = match self.bounds(node, mesh) {
            Ok(Some((low, high))) => {
                let what = "has a skin, morph targets or levels of detail: it hides nothing, and counts as \
                            the box of all its forms in all frames";
                self.warnings.add(node_name(node), what);
                let mut mesh = Mesh::cuboid(low, high);
                mesh.sides = vec![Sides::Neither; mesh.triangles.len()];
                return Some((Arc::new(mesh), Arc::default()));
            }
            Ok(None) => String::new(),
            Err(why) => format!(" ({why})"),
        };
        let what = "has a skin, morph targets, levels of detail or splats, and its bounds cannot be told";
        self.leave_out(node, &format!("{what}{why}"));
        None
    }

    fn bounds(&mut self, node: &gltf::Node, mesh: &gltf::Mesh) -> Result<Option<Bounds>, Trouble> {
        let levels: Vec<_> = levels_of(self.document, node).collect();
        let is_placed = node.extension_value(INSTANCING).is_some();
        if has_splats(mesh) || is_placed && (node.skin().is_some() || !levels.is_empty()) {
            return Ok(None);
        }
        let mut all = self.deformed.bounds(&mut self.meshes, node, mesh, &self.unread)?;
        for level in levels {
            let level = level.filter(|level| self.is_beside(node, level));
            let Some((mesh, level)) = level.and_then(|level| Some((level.mesh()?, level))) else {
                return Ok(None);
            };
            let own = self.deformed.bounds(&mut self.meshes, &level, &mesh, &self.unread)?;
            let (Some(a), Some(b)) = (all, own) else { return Ok(None) };
            all = Some((a.0.min(b.0), a.1.max(b.1)));
        }
        Ok(all)
    }

    /// Whether a level of detail of a node is a still mesh in its place, and no more.
    fn is_beside(&self, node: &gltf::Node, level: &gltf::Node) -> bool {
        let moves = |node: &gltf::Node| self.animated.contains(&node.index()) || self.changes.moves(node);
        let is_alone = level.children().len() == 0 && level.skin().is_none() && node.skin().is_none();
        let is_one = levels_of(self.document, level).next().is_none()
            && level.extension_value(INSTANCING).is_none()
            && !level.mesh().is_some_and(|mesh| has_splats(&mesh));
        let is_still = self.places[level.index()] == self.places[node.index()];
        is_alone && is_one && is_still && !moves(node) && !moves(level)
    }

    fn leave_out(&self, node: &gltf::Node, why: &str) {
        self.warnings.add(node_name(node), &format!("{why}: it is left out; always draw it"));
    }

    /// Of each node, with what it hangs from: whether it is surely drawn, `None` if it is hidden;
    /// and whether it is moved by what is not read.
    fn states(&self, nodes: &Nodes, all: &[gltf::Node]) -> (Vec<Option<bool>>, Vec<bool>) {
        let levels = all.iter().flat_map(|node| levels_of(self.document, node)).flatten();
        let levels: HashSet<usize> = levels.map(|level| level.index()).collect();
        let drawn = nodes.inherited(|node, parent: Option<Option<bool>>| {
            let own = self.changes.draws(&all[node.index])? && !levels.contains(&node.index);
            Some(own & parent.unwrap_or(Some(true))?)
        });
        let moved =
            nodes.inherited(|node, parent| self.changes.moves(&all[node.index]) || parent.unwrap_or(false));
        (drawn, moved)
    }

    /// The objects of all nodes with a mesh; `moves` tells which nodes move.
    fn objects(&mut self, nodes: &Nodes, moves: &[bool]) -> Result<Found, Trouble> {
        let globals = nodes.globals(0.0);
        let all: Vec<gltf::Node> = self.document.nodes().collect();
        let drawn;
        (drawn, self.unread) = self.states(nodes, &all);
        let mut found = Found::default();
        for (place, item) in nodes.0.iter().enumerate() {
            let node = &all[item.index];
            let (Some(mesh), Some(is_sure)) = (node.mesh(), drawn[place]) else { continue };
            let (occludes, tested) = role_of(node, self.warnings);
            if self.unread[place] {
                self.leave_out(node, "is moved by KHR_animation_pointer or physics, which are not read");
                continue;
            }
            let is_deformed = is_deformed(node, &mesh, item.morphs);
            let has_skin = node.skin().is_some();
            let has_levels = levels_of(self.document, node).next().is_some();
            let known = match is_deformed || has_levels || has_splats(&mesh) {
                true => self.boxed(node, &mesh),
                false => self.rigid(&mesh)?,
            };
            let Some((mesh, primitives)) = known else { continue };
            let dynamic = moves[place] && !has_skin;
            let name = node.name().unwrap_or("");
            let transform = if has_skin { DAffine3::IDENTITY } else { globals[place] };
            let hides = occludes && is_sure && mesh.hiding().is_some();
            let mut add = |name: String, instance: Affine3A| {
                let (own, object, mesh) = (instance.as_daffine3(), found.objects.len(), mesh.clone());
                if dynamic {
                    found.moving.push(Moving { object, node: place, place: own, mesh: mesh.clone() });
                }
                // Programs differ in which side of a mirrored instance they draw.
                let has_side = mesh.sides.is_empty() || turn_of(&instance) > 0.0;
                found.places.push(transform * own);
                found.parts.push(FilePart { node: item.index, primitives: primitives.clone() });
                let shape = match has_skin {
                    true => Shape::Box { min: mesh.positions[0], max: mesh.positions[7] },
                    false => Shape::Mesh { mesh, transform: (transform * own).as_affine3a() },
                };
                let motion = match dynamic || is_deformed {
                    true => Motion::Dynamic { max_speed: 0.0 },
                    false => Motion::Static,
                };
                found.objects.push(Object { name, shape, motion, occludes: hides && has_side, tested });
            };
            let instances = match has_skin {
                true => None,
                false => instances_of(self.document, self.deformed.buffers, node)?,
            };
            match instances {
                None => add(name.to_owned(), Affine3A::IDENTITY),
                Some(places) => {
                    // Each gets the name.
                    let names = places.len().saturating_mul(1 + name.len() / NAME_OF_AN_ELEMENT);
                    if !self.deformed.buffers.spend(names) {
                        return Err(wrong(node, "has too many instances for its name"));
                    }
                    for (i, instance) in places.into_iter().enumerate() {
                        add(format!("{name}#{i}"), instance);
                    }
                }
            }
        }
        if found.objects.is_empty() { Err(Trouble::NoTriangles) } else { Ok(found) }
    }
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

/// The scene; warnings may be there already.
pub fn contents(name: &str, file: &File, warnings: &Warnings) -> Result<World, Trouble> {
    let File { document, buffers, json, .. } = file;
    let mut nodes = nodes_of(&file.document, &file.places)?;
    let clip = animate(document, buffers, &mut nodes)?;
    let quantized =
        document.extensions_used().chain(document.extensions_required()).any(|e| e == QUANTIZATION);
    let meshes = Meshes::new(buffers, if quantized { Components::Integers } else { Components::Floats });
    let moves = nodes.moving();
    // Both ends of the clip are frames.
    let clip_frames = (f64::from(clip) / FRAME_SECONDS).round().clamp(0.0, MOST_FRAMES) as usize + 1;
    let camera = camera_of(document, &nodes, &moves, warnings);
    let frames = match &camera {
        Some(c) if moves[c.node] => clip_frames,
        _ => OWN_FRAMES,
    };
    let changes = Changes::of(json);
    let deformed = Deformed { document, buffers, nodes: &nodes, frames };
    let known = HashMap::new();
    let channels = document.animations().flat_map(|clip| clip.channels().collect::<Vec<_>>());
    let animated = channels.map(|channel| channel.target().node().index()).collect();
    let (places, changes, unread) = (&file.places[..], &changes, Vec::new());
    let mut reader =
        Reader { document, places, animated, unread, changes, warnings, meshes, known, deformed };
    let mut found = reader.objects(&nodes, &moves)?;

    let origin = moved(&mut found);
    let Found { mut objects, parts, moving, .. } = found;
    let mut animation = FilePath::new(nodes, moving, camera, frames, origin);
    let (min, max) = animation.settle(&mut objects, buffers.bytes(), warnings)?;
    let (grid, frames) = (grid_of(min, max)?, animation.frames);
    let source = Source { warnings: warnings.lines(), origin, document: (*json).into(), parts };
    Ok(World { source, name: name.to_owned(), objects, grid, frames, animation: Box::new(animation) })
}
