//! Meshes that hide others: prepared once in the background, and shared by all entities with them.

use std::ops::ControlFlow;
#[cfg(feature = "cache")]
use std::path::PathBuf;
use std::sync::Arc;

use bevy_asset::{AssetId, Assets, RenderAssetUsages};
use bevy_ecs::entity::{Entity, EntityHashSet};
use bevy_math::Vec3A;
use bevy_mesh::{Indices, Mesh, MeshAccessError, PrimitiveTopology, VertexAttributeValues};
use bevy_platform::collections::HashMap;
use bevy_tasks::futures::check_ready;
use bevy_tasks::{AsyncComputeTaskPool, Task};
use casca::glam::Vec3;
use casca::{Facing, MeshOptions, TriMesh};
#[cfg(feature = "cache")]
use casca_cache::MeshCache;

use crate::settings::{CascaSettings, Opaque};
use crate::why_not::WhyNot;

/// A mesh, and the sides from which it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Key {
    pub(crate) mesh: AssetId<Mesh>,
    pub(crate) sides: Opaque,
}

#[derive(Debug)]
struct Entry {
    /// The prepared mesh, or why it hides nothing.
    state: Result<Arc<TriMesh>, WhyNot>,
    /// Ends with the entry.
    task: Option<Task<Result<TriMesh, WhyNot>>>,
    /// The entities that asked for it.
    users: EntityHashSet,
}

/// All meshes that entities asked for.
#[derive(Debug, Default)]
pub(crate) struct Occluders {
    entries: HashMap<Key, Entry>,
    pub(crate) preparing: Vec<Key>,
    /// Of meshes that only the renderer keeps: they can be read when they come, and no more.
    kept: HashMap<AssetId<Mesh>, Triangles>,
    /// Where meshes are stored that are asked for from now on.
    pub(crate) stored: Stored,
}

impl Occluders {
    /// The prepared mesh, if it is ready. Else it is prepared, and [`Occluders::poll`] names the
    /// entity when it is.
    pub(crate) fn ask(
        &mut self,
        key: Key,
        entity: Entity,
        meshes: &Assets<Mesh>,
        most_triangles: usize,
    ) -> Option<Arc<TriMesh>> {
        let missing = || Entry { state: Err(WhyNot::NoMesh), task: None, users: EntityHashSet::default() };
        let entry = self.entries.entry(key).or_insert_with(missing);
        entry.users.insert(entity);
        if let (Err(WhyNot::NoMesh), Some(mesh)) = (&entry.state, meshes.get(key.mesh)) {
            let kept = self.kept.get(&key.mesh).cloned();
            let read = kept.map_or_else(|| triangles(mesh, most_triangles), Ok);
            entry.state = read.and_then(|triangles| {
                let pool = AsyncComputeTaskPool::get_or_init(Default::default);
                let stored = self.stored.clone();
                entry.task = Some(pool.spawn(async move { stored.prepare(triangles, key.sides) }));
                self.preparing.push(key);
                Err(WhyNot::Preparing)
            });
        }
        entry.state.clone().ok()
    }

    /// Why a mesh hides nothing that was asked for.
    pub(crate) fn why_not(&self, key: &Key) -> Result<(), WhyNot> {
        self.entries.get(key).map_or(Err(WhyNot::NoMesh), |entry| entry.state.clone().map(|_| ()))
    }

    /// An entity does not need the mesh any more.
    pub(crate) fn leave(&mut self, key: Key, entity: Entity) {
        if let Some(entry) = self.entries.get_mut(&key) {
            entry.users.remove(&entity);
        }
    }

    /// Takes over meshes that have become ready. Appends the entities that wait for them.
    pub(crate) fn poll(&mut self, out: &mut Vec<Entity>) {
        self.preparing.retain(|key| {
            let Some(entry) = self.entries.get_mut(key) else { return false };
            let Some(task) = &mut entry.task else { return false };
            let Some(done) = check_ready(task) else { return true };
            (entry.state, entry.task) = (done.map(Arc::new), None);
            out.extend(entry.users.iter());
            false
        });
    }

    /// A mesh came, changed or went. Forgets what was prepared of it, and appends its users.
    pub(crate) fn changed(
        &mut self,
        mesh: AssetId<Mesh>,
        meshes: &Assets<Mesh>,
        most_triangles: usize,
        out: &mut Vec<Entity>,
    ) {
        self.kept.remove(&mesh);
        let new = meshes.get(mesh).filter(|mesh| mesh.asset_usage == RenderAssetUsages::RENDER_WORLD);
        self.kept.extend(new.and_then(|new| Some((mesh, triangles(new, most_triangles).ok()?))));
        for sides in [Opaque::Front, Opaque::Both] {
            if let Some(entry) = self.entries.remove(&Key { mesh, sides }) {
                out.extend(entry.users.iter());
            }
        }
    }

    /// The number of meshes that are ready.
    pub(crate) fn ready(&self) -> usize {
        self.entries.values().filter(|entry| entry.state.is_ok()).count()
    }
}

type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// The triangles of a mesh, if it is made of them and they can be read.
fn triangles(mesh: &Mesh, most: usize) -> Result<Triangles, WhyNot> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return Err(WhyNot::NotTriangles);
    }
    let in_main_world = mesh.asset_usage.contains(RenderAssetUsages::MAIN_WORLD);
    let positions: Vec<Vec3> = match (mesh.try_attribute(Mesh::ATTRIBUTE_POSITION), mesh.final_aabb) {
        (Ok(VertexAttributeValues::Float32x3(positions)), _) => positions.iter().map(|&p| p.into()).collect(),
        // As shaders unpack them. Without a copy in the main world, Bevy loses the box on the way.
        (Ok(VertexAttributeValues::Snorm16x4(positions)), Some(b)) if in_main_world => {
            let (middle, half) = ((b.min + b.max) / 2.0, (b.max - b.min) / 2.0);
            let part = |p: i16| (f32::from(p) / f32::from(i16::MAX)).max(-1.0);
            let unpacked = |&[x, y, z, _]: &[i16; 4]| middle + half * Vec3A::from([x, y, z].map(part));
            positions.iter().map(|p| unpacked(p).to_array().into()).collect()
        }
        (Err(MeshAccessError::ExtractedToRenderWorld), _) => return Err(WhyNot::Unreadable),
        _ => return Err(WhyNot::Positions),
    };
    let indices = mesh.try_indices_option().map_err(|_| WhyNot::Unreadable)?;
    let count = indices.map_or(positions.len(), Indices::len) / 3;
    if count > most {
        return Err(WhyNot::Triangles(count));
    }
    let corners: Vec<u32> = match indices {
        Some(indices) => indices.iter().map(|i| i as u32).collect(),
        None => (0..positions.len() as u32).collect(),
    };
    Ok((positions, corners.as_chunks().0.to_vec()))
}

/// A folder of prepared meshes, or none.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stored {
    #[cfg(feature = "cache")]
    folder: Option<PathBuf>,
    /// `None` if the folder can be neither made nor read.
    #[cfg(feature = "cache")]
    cache: Option<Arc<MeshCache>>,
}

impl Stored {
    /// Opens the folder of the settings, if it is another one than before.
    #[cfg_attr(not(feature = "cache"), expect(unused_variables, clippy::unused_self))]
    pub(crate) fn follow(&mut self, settings: &CascaSettings) {
        #[cfg(feature = "cache")]
        if self.folder != settings.cache {
            self.folder.clone_from(&settings.cache);
            let open = |folder: &PathBuf| {
                let warn = |why: &std::io::Error| {
                    bevy_log::warn!("meshes are not stored in {}: {why}", folder.display())
                };
                MeshCache::new(folder).inspect_err(warn).ok()
            };
            self.cache = self.folder.as_ref().and_then(open).map(Arc::new);
        }
    }

    /// Prepares a mesh that is drawn from some sides, or reads it.
    fn prepare(&self, (positions, triangles): Triangles, sides: Opaque) -> Result<TriMesh, WhyNot> {
        let facing = match sides {
            Opaque::Front => Facing::Front,
            Opaque::Both => Facing::Both,
        };
        let how = MeshOptions::default().facing(facing);
        let progress = &mut |_| ControlFlow::Continue(());
        #[cfg(feature = "cache")]
        if let Some(cache) = &self.cache {
            return Ok(cache.prepare(positions, triangles, &how, progress)?);
        }
        Ok(TriMesh::prepare(positions, triangles, &how, progress)?)
    }
}
