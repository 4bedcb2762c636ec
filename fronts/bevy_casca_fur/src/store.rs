//! The meshes of layers, made once for all coats that share them.

use std::collections::BTreeMap;

use bevy_asset::{AssetEvent, AssetId, Assets, Handle};
use bevy_ecs::prelude::*;
use bevy_log::warn;
use bevy_mesh::Mesh;

use crate::coat::Made;
use crate::numeric::KEPT_FRAMES;
use crate::shells::{Skin, shells};

/// A mesh with fur, and its layers.
struct Known {
    /// Or why it gets no fur.
    skin: Result<Skin, &'static str>,
    version: u32,
    /// By the layers and the bits of the reach, with the frame of the last use.
    made: BTreeMap<(u32, u32), (Handle<Mesh>, u32)>,
    used: u32,
}

/// All meshes with fur.
#[derive(Resource, Default)]
pub(crate) struct Store {
    known: BTreeMap<AssetId<Mesh>, Known>,
    versions: u32,
    frame: u32,
}

impl Store {
    /// Starts a frame: forgets meshes that changed or went, and layers that nobody uses.
    pub fn begin(&mut self, events: &mut MessageReader<'_, '_, AssetEvent<Mesh>>) {
        self.frame = self.frame.wrapping_add(1);
        for event in events.read() {
            if let AssetEvent::Modified { id } | AssetEvent::Removed { id } = event {
                self.known.remove(id);
            }
        }
        let frame = self.frame;
        let fresh = |used: u32| frame.wrapping_sub(used) <= KEPT_FRAMES;
        for known in self.known.values_mut() {
            known.made.retain(|_, (_, used)| fresh(*used));
        }
        self.known.retain(|_, known| fresh(known.used));
    }

    /// The checked mesh, and the number of its version; none if the mesh is not there.
    pub fn skin(&mut self, id: AssetId<Mesh>, meshes: &Assets<Mesh>) -> Option<(&Skin, u32)> {
        let mesh = meshes.get(id);
        if mesh.is_none() {
            self.known.remove(&id);
        }
        let mesh = mesh?;
        let (frame, versions) = (self.frame, &mut self.versions);
        let known = self.known.entry(id).or_insert_with(|| {
            *versions = versions.wrapping_add(1);
            let skin = Skin::of(mesh);
            if let Err(why) = &skin {
                warn!("no fur on the mesh {id}: {why}");
            }
            Known { skin, version: *versions, made: BTreeMap::new(), used: frame }
        });
        known.used = frame;
        Some((known.skin.as_ref().ok()?, known.version))
    }

    /// The mesh with layers, which is in use now, made if it is not there yet. None if the mesh
    /// below cannot be read any more.
    pub fn shells(&mut self, of: Made, meshes: &mut ResMut<'_, Assets<Mesh>>) -> Option<Handle<Mesh>> {
        let known = self.known.get_mut(&of.mesh)?;
        let key = (of.layers, of.reach);
        if let Some((handle, used)) = known.made.get_mut(&key) {
            *used = self.frame;
            return Some(handle.clone());
        }
        let mesh = meshes.get(of.mesh).filter(|mesh| mesh.try_attributes().is_ok())?;
        let reach = (of.reach != 0).then_some(f32::from_bits(of.reach));
        let shells = shells(mesh, known.skin.as_ref().ok()?, of.layers, reach);
        let handle = meshes.add(shells);
        known.made.insert(key, (handle.clone(), self.frame));
        Some(handle)
    }
}
