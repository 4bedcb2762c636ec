//! Brings the scene up to date with the entities.

use std::any::TypeId;
use std::sync::Arc;

use bevy_asset::{AssetEvent, Assets, RenderAssetUsages};
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{InheritedVisibility, RenderLayers, VisibilityClass};
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::entity_disabling::Disabled;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_light::NotShadowCaster;
use bevy_log::warn_once;
use bevy_math::Vec3;
use bevy_mesh::skinning::SkinnedMesh;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;

use casca::{ObjectDesc, Scene, TriMesh};

use crate::drawn::{Complete, Gone, Manageable};
use crate::materials::{Deferred, Judged};
use crate::occluders::{Key, Occluders};
use crate::scene::{CascaScene, InScene};
use crate::settings::{CascaSettings, NotOccluder, Occluder, Opaque};
use crate::{border, grid, layers};

/// After a move, an entity has to rest twice as long as before to count as still, up to this.
const MOST_PATIENCE: u32 = 1024;

/// A grid is kept for so many frames at least.
const GRID_FRAMES: u32 = 64;

/// Of the entities in the scene, so many tell whether the grid still suits them.
const GRID_SAMPLE: usize = 4096;

/// All that decides how an entity is in the scene.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Managed {
    entity: Entity,
    mesh: &'static Mesh3d,
    aabb: &'static Aabb,
    transform: &'static GlobalTransform,
    visible: &'static InheritedVisibility,
    layers: Option<&'static RenderLayers>,
    opaque: Option<&'static Opaque>,
    judged: Option<&'static Judged>,
    proxy: Option<&'static Occluder>,
    not_occluder: Has<NotOccluder>,
    not_caster: Has<NotShadowCaster>,
    skinned: Has<SkinnedMesh>,
    classes: Option<&'static VisibilityClass>,
    known: Option<&'static mut InScene>,
}

/// Entities that are not in the scene yet.
type New = (Complete, Manageable, Without<InScene>, Without<Refused>);

type Changes = Or<(
    Changed<GlobalTransform>,
    Changed<Aabb>,
    Changed<InheritedVisibility>,
    Changed<RenderLayers>,
    Changed<Mesh3d>,
    Changed<Opaque>,
    Changed<Judged>,
    Changed<VisibilityClass>,
    Changed<Occluder>,
    Added<NotOccluder>,
    Added<NotShadowCaster>,
)>;

/// On entities that casca refused, until they change.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Refused;

/// The entities whose state in the scene is to be looked at.
#[derive(SystemParam)]
pub(crate) struct Candidates<'w, 's> {
    new: Query<'w, 's, (Entity, &'static Aabb, &'static GlobalTransform), New>,
    gone: Query<'w, 's, (Entity, &'static InScene), Gone>,
    changed: Query<'w, 's, Entity, (With<InScene>, Changes)>,
    refused: Query<'w, 's, Entity, (With<Refused>, Changes)>,
    all: Query<'w, 's, Entity, With<InScene>>,
    no_layers: RemovedComponents<'w, 's, RenderLayers>,
    no_opaque: RemovedComponents<'w, 's, Opaque>,
    not_judged: RemovedComponents<'w, 's, Judged>,
    no_proxy: RemovedComponents<'w, 's, Occluder>,
    hides_again: RemovedComponents<'w, 's, NotOccluder>,
    casts_again: RemovedComponents<'w, 's, NotShadowCaster>,
}

/// The system of [`CascaSystems::Sync`](crate::CascaSystems::Sync).
pub(crate) fn sync(
    mut commands: Commands,
    mut casca: ResMut<CascaScene>,
    (settings, deferred): (Res<CascaSettings>, Option<Res<Deferred>>),
    meshes: Option<Res<Assets<Mesh>>>,
    mut events: Option<MessageReader<AssetEvent<Mesh>>>,
    mut candidates: Candidates,
    mut managed: Query<Managed, (Complete, Manageable, Without<Disabled>)>,
) {
    let Some(meshes) = meshes else { return };
    let start = Instant::now();
    let casca = &mut *casca;
    casca.frame = casca.frame.wrapping_add(1);
    casca.forget();
    for (entity, known) in &candidates.gone {
        // At once: it may not hide any more in this frame.
        let _ = casca.scene.as_mut().map(|scene| scene.remove(known.id));
        commands.entity(entity).try_remove::<InScene>();
    }
    if choose_grid(casca, &candidates) {
        // All are taken over anew, from the next frame on.
        candidates.all.iter().for_each(|entity| {
            commands.entity(entity).try_remove::<InScene>();
        });
        return;
    }
    let CascaScene { scene: Some(scene), occluders, movers, farthest, frame, shifted, counts, .. } = casca
    else {
        return;
    };
    // The clock only has to run.
    let _ = scene.begin_frame(f64::from(*frame) / 60.0);
    let mut look = Vec::new();
    let shifted = shifted.take().inspect(|_| look.extend(&candidates.all));
    // If it is refused, all have moved.
    let shifted = shifted.filter(|by| scene.shift_origin(border::vec3(*by)).is_ok());
    for event in events.iter_mut().flat_map(|events| events.read()) {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } = event {
            occluders.changed(*id, &mut look);
        }
    }
    if deferred.as_ref().is_some_and(DetectChanges::is_changed) {
        look.extend(&candidates.all);
    }
    let deferred = deferred.as_deref().copied().unwrap_or_default();
    occluders.poll(&mut look);
    occluders.store(&settings);
    look.extend(&candidates.changed);
    look.extend(&candidates.refused);
    candidates.extend_removed(&mut look);
    let rested = movers.iter().filter(|(_, at)| **at <= *frame).map(|(entity, _)| *entity);
    look.extend(rested.take(settings.most_new));
    look.extend(candidates.new.iter().map(|(entity, ..)| entity).take(settings.most_new));
    // Twice would be two objects.
    look.sort_unstable();
    look.dedup();
    let (frame, settings, meshes) = (*frame, &*settings, &*meshes);
    let mut sync = Sync { scene, occluders, movers, farthest, frame, shifted, settings, meshes, deferred };
    for &entity in &look {
        let Ok(mut item) = managed.get_mut(entity) else { continue };
        match sync.bring_up_to_date(&mut item) {
            Ok(None) => {}
            Ok(Some(known)) => _ = commands.entity(entity).try_insert(known).try_remove::<Refused>(),
            Err(refusal) => {
                if let Refusal::Of(error) = refusal {
                    warn_once!("{entity} is culled by frustum only: {error}");
                }
                commands.entity(entity).try_remove::<InScene>().try_insert(Refused);
            }
        }
    }
    counts.time += start.elapsed();
}

impl Candidates<'_, '_> {
    /// Appends entities that lost a component which counts.
    fn extend_removed(&mut self, out: &mut Vec<Entity>) {
        out.extend(self.no_layers.read());
        out.extend(self.no_opaque.read());
        out.extend(self.not_judged.read());
        out.extend(self.no_proxy.read());
        out.extend(self.hides_again.read());
        out.extend(self.casts_again.read());
    }
}

/// Makes a grid if there is none, or if the world has outgrown it: then says that the scene is
/// empty.
fn choose_grid(casca: &mut CascaScene, candidates: &Candidates) -> bool {
    let new = candidates.new.iter();
    let new = new.map(|(_, aabb, transform)| border::world_box(aabb, &transform.affine()));
    let make = |boxes: &[_]| grid::around(boxes).and_then(|spec| Scene::new(&spec).ok());
    let Some(scene) = &casca.scene else {
        let boxes: Vec<_> = new.collect();
        if !boxes.is_empty() {
            casca.scene = make(&boxes);
            casca.grid_made = casca.frame;
        }
        return false;
    };
    if casca.frame.wrapping_sub(casca.grid_made) < GRID_FRAMES {
        return false;
    }
    casca.grid_made = casca.frame;
    let step = (scene.len() / GRID_SAMPLE).max(1);
    let known = scene.iter().step_by(step).map(|(_, object)| border::back(&object.bounds().aabb()));
    let boxes: Vec<_> = known.chain(new).collect();
    let outside = boxes.iter().filter(|b| grid::is_outside(scene.grid(), **b)).count();
    // The estimate of cells is for a sample of them.
    let Some(scene) = make(&boxes).filter(|_| outside * 4 > boxes.len()) else { return false };
    casca.scene = Some(scene);
    casca.movers.clear();
    casca.cameras.clear();
    casca.suns.clear();
    casca.lamps.clear();
    true
}

/// Why an entity is not in the scene.
enum Refusal {
    /// It may be seen where its mesh is hidden.
    MayBeSeen,
    Of(casca::Error),
}

impl From<casca::Error> for Refusal {
    fn from(error: casca::Error) -> Self {
        Self::Of(error)
    }
}

struct Sync<'a> {
    scene: &'a mut Scene,
    occluders: &'a mut Occluders,
    movers: &'a mut EntityHashMap<u32>,
    farthest: &'a mut f32,
    frame: u32,
    shifted: Option<Vec3>,
    settings: &'a CascaSettings,
    meshes: &'a Assets<Mesh>,
    deferred: Deferred,
}

impl Sync<'_> {
    /// Puts an entity into the scene or changes it there. Returns the component that it needs.
    ///
    /// # Errors
    /// If it may not be hidden. It is not in the scene then.
    fn bring_up_to_date(&mut self, item: &mut ManagedItem) -> Result<Option<InScene>, Refusal> {
        let done = match item.known.as_deref() {
            _ if !may_be_hidden(item) => Err(Refusal::MayBeSeen),
            None => self.put(item, item.skinned, self.settings.still_after.max(1)).map(Some),
            Some(_) => self.change(item),
        };
        if done.is_ok() {
            let (min, max) = border::world_box(item.aabb, &item.transform.affine());
            *self.farthest = self.farthest.max(min.abs().max(max.abs()).max_element());
        }
        let Some(known) = item.known.as_deref_mut() else { return done };
        let leaves = match &done {
            Ok(None) => false,
            Ok(Some(new)) => new.key != known.key,
            Err(_) => true,
        };
        if let Some(key) = known.key.filter(|_| leaves) {
            self.occluders.leave(key, item.entity);
        }
        match done {
            Ok(new) => new.into_iter().for_each(|new| *known = new),
            Err(refusal) => {
                // Unless it was taken out already.
                let _ = self.scene.remove(known.id);
                return Err(refusal);
            }
        }
        Ok(None)
    }

    /// Changes an entity that is in the scene. Returns its state if that is another one now.
    fn change(&mut self, item: &ManagedItem) -> Result<Option<InScene>, Refusal> {
        let Some(known) = item.known.as_deref() else { return Ok(None) };
        let id = known.id;
        let transform = border::affine(&item.transform.affine());
        let before = self.scene.transform(id)?;
        let shifted =
            |before: &_| self.shifted.is_some_and(|shift| border::is_shifted(before, &transform, shift));
        let differs = before != Some(transform);
        let moved = differs && !before.as_ref().is_some_and(shifted);
        let rested = self.movers.get(&item.entity).is_none_or(|at| *at <= self.frame);
        let moves = moved || item.skinned || known.moves && !rested;
        let key = self.key(item, moves);
        let ready = key.and_then(|key| self.ask(key, item));
        let hides = self.scene.occluder(id)?.is_some();
        let other_box = known.aabb != *item.aabb;
        let keeps_occluder =
            key == known.key && (ready.is_some() == hides || known.refused && ready.is_some());
        if moves != known.moves || !keeps_occluder || other_box && !item.skinned {
            self.scene.remove(id)?;
            let patience = if moves && !known.moves { self.patience(known) } else { known.patience };
            return self.put(item, moves, patience).map(Some);
        }
        let layers = layers_of(item);
        if differs {
            self.scene.set_transform(id, transform)?;
        }
        if moved && !item.skinned {
            self.movers.insert(item.entity, self.frame.saturating_add(known.patience));
        }
        if other_box {
            self.scene.set_bounds(id, border::aabb(item.aabb))?;
        }
        self.scene.set_layers(id, layers)?;
        let changed = other_box || layers != known.layers;
        Ok(changed.then(|| InScene { layers, aabb: *item.aabb, ..known.copy() }))
    }

    /// For how many frames an entity has to rest that begins to move: who moves often for longer.
    fn patience(&self, known: &InScene) -> u32 {
        let first = self.settings.still_after.max(1);
        let rested = self.frame.saturating_sub(known.since);
        let again = known.patience.saturating_mul(2).min(MOST_PATIENCE).max(first);
        if known.is_new || rested > again.saturating_mul(4) { first } else { again }
    }

    /// Puts an entity into the scene.
    fn put(&mut self, item: &ManagedItem, moves: bool, patience: u32) -> Result<InScene, Refusal> {
        let (bounds, layers) = (border::aabb(item.aabb), layers_of(item));
        let desc = if moves { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
        let desc = desc
            .placed(border::affine(&item.transform.affine()))
            .layers(layers)
            .user_data(item.entity.to_bits());
        let key = self.key(item, moves);
        let mesh = key.and_then(|key| self.ask(key, item));
        // A mesh that reaches out of the box is drawn where that is not looked for.
        let fits = |mesh: &Arc<TriMesh>| border::holds(&bounds, &mesh.aabb());
        let hider = mesh.as_ref().filter(|mesh| fits(mesh));
        let placed = hider.and_then(|mesh| self.scene.insert(desc.clone().occluder(mesh.clone())).ok());
        let refused = mesh.is_some() && placed.is_none();
        let id = placed.map_or_else(|| self.scene.insert(desc), Ok)?;
        if moves && !item.skinned {
            self.movers.insert(item.entity, self.frame.saturating_add(patience));
        } else {
            self.movers.remove(&item.entity);
        }
        Ok(InScene {
            id,
            moves,
            key,
            refused,
            layers,
            aabb: *item.aabb,
            patience,
            since: self.frame,
            is_new: item.known.is_none(),
        })
    }

    /// The mesh that an entity hides with, if it does.
    fn key(&self, item: &ManagedItem, moves: bool) -> Option<Key> {
        let determinant = item.transform.affine().matrix3.determinant();
        let layers = layers_of(item);
        let for_renderer = |mesh: &Mesh| mesh.asset_usage.contains(RenderAssetUsages::RENDER_WORLD);
        let hides = !item.not_occluder
            && !item.skinned
            && layers::may_hide(layers)
            && determinant.is_finite()
            && determinant != 0.0
            && self.meshes.get(item.mesh.id()).is_some_and(for_renderer);
        if !hides {
            return None;
        }
        // Whatever is told of an entity: it hides nothing if its material is not drawn.
        let told = item.proxy.map(|_| Opaque::Both).or(item.opaque.copied());
        let sides = item.judged.map_or(told, |judged| judged.hides(told, &self.deferred, layers))?;
        match item.proxy {
            Some(Occluder(proxy)) => Some(Key { mesh: proxy.id(), sides }),
            None => Some(Key { mesh: item.mesh.id(), sides }).filter(|_| !moves),
        }
    }

    fn ask(&mut self, key: Key, item: &ManagedItem) -> Option<Arc<TriMesh>> {
        self.occluders.ask(key, item.entity, self.meshes, self.settings.most_triangles)
    }
}

/// Whether an entity cannot be seen where its mesh is hidden.
fn may_be_hidden(item: &ManagedItem) -> bool {
    let is_told = item.opaque.is_some() || item.proxy.is_some();
    // A lamp with a light in it goes on shining where nobody sees it. A class may be there twice.
    let mesh_alone = |classes: &VisibilityClass| {
        !classes.is_empty() && classes.iter().all(|class| *class == TypeId::of::<Mesh3d>())
    };
    item.classes.is_some_and(mesh_alone) && item.judged.is_none_or(|judged| judged.may_be_hidden(is_told))
}

fn layers_of(item: &ManagedItem) -> u64 {
    layers::of_entity(item.layers, !item.visible.get(), !item.not_caster)
}
