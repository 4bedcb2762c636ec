//! Brings the scene up to date with the entities.

use std::any::TypeId;
use std::sync::Arc;

use bevy_asset::{AssetEvent, AssetId, Assets, RenderAssetUsages};
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{InheritedVisibility, RenderLayers, VisibilityClass};
use bevy_ecs::change_detection::{ContiguousRef, Tick};
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::entity_disabling::Disabled;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_light::NotShadowCaster;
use bevy_log::warn_once;
use bevy_math::{Vec3, Vec3A};
use bevy_mesh::skinning::SkinnedMesh;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_platform::collections::HashSet;
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;

use casca::{ObjectDesc, Scene, TriMesh};

use crate::beams::{Changes, Mover};
use crate::drawn::{Complete, Gone, Manageable};
use crate::materials::{Deferred, Judged};
use crate::occluders::{Key, Occluders};
use crate::scene::{CascaScene, InScene, take_out};
use crate::settings::{CascaSettings, NotOccluder, Occluder, Opaque};
use crate::why_not::WhyNot;
use crate::{border, grid, layers};

/// All that decides how an entity is in the scene.
#[derive(QueryData)]
pub(crate) struct Managed {
    pub(crate) entity: Entity,
    mesh: &'static Mesh3d,
    aabb: &'static Aabb,
    transform: &'static GlobalTransform,
    pub(crate) visible: &'static InheritedVisibility,
    layers: Option<&'static RenderLayers>,
    opaque: Option<&'static Opaque>,
    judged: Option<&'static Judged>,
    pub(crate) proxy: Option<&'static Occluder>,
    not_occluder: Has<NotOccluder>,
    not_caster: Has<NotShadowCaster>,
    skinned: Has<SkinnedMesh>,
    classes: Option<&'static VisibilityClass>,
}

impl ManagedItem<'_, '_> {
    fn layers(&self) -> u64 {
        layers::of_entity(self.layers, !self.visible.get(), !self.not_caster)
    }

    /// Whether it cannot be seen where its mesh is hidden.
    pub(crate) fn may_be_hidden(&self) -> Result<(), WhyNot> {
        let is_told = self.opaque.is_some() || self.proxy.is_some();
        // A lamp with a light in it goes on shining where nobody sees it. A class may be there twice.
        let mesh_alone = |classes: &&VisibilityClass| {
            !classes.is_empty() && classes.iter().all(|class| *class == TypeId::of::<Mesh3d>())
        };
        self.classes.filter(mesh_alone).ok_or(WhyNot::InFront)?;
        self.judged.map_or(Ok(()), |judged| judged.may_be_hidden(is_told))
    }

    /// The mesh that it hides with, if it does.
    pub(crate) fn key(&self, moves: bool, meshes: &Assets<Mesh>, deferred: &Deferred) -> Result<Key, WhyNot> {
        if moves && self.proxy.is_none() {
            return Err(WhyNot::Moves(0));
        }
        if self.not_occluder || self.skinned {
            return Err(WhyNot::Has(if self.skinned { "SkinnedMesh" } else { "NotOccluder" }));
        }
        let layers = self.layers();
        if !layers::may_hide(layers) {
            return Err(WhyNot::Layer);
        }
        let determinant = self.transform.affine().matrix3.determinant();
        if !determinant.is_finite() || determinant == 0.0 {
            return Err(WhyNot::Flat);
        }
        let mesh = meshes.get(self.mesh.id()).ok_or(WhyNot::NoMesh)?;
        if !mesh.asset_usage.contains(RenderAssetUsages::RENDER_WORLD) {
            return Err(WhyNot::NotRendered);
        }
        // Whatever is told of an entity: it hides nothing if its material is not drawn.
        let told = self.proxy.map(|_| Opaque::Both).or(self.opaque.copied());
        let sides = match self.judged {
            Some(judged) => judged.hides(told, deferred, layers)?,
            None => told.ok_or(WhyNot::NotOpaque)?,
        };
        if determinant < 0.0 && sides == Opaque::Front {
            return Err(WhyNot::Mirrored);
        }
        Ok(Key { mesh: self.proxy.map_or(self.mesh.id(), |Occluder(proxy)| proxy.id()), sides })
    }
}

/// Entities that are not in the scene yet.
type New = (Complete, Manageable, Without<InScene>, Without<Refused>);

/// Entities that may be in the scene.
type Present = (Complete, Manageable, Without<Disabled>);

/// Entities that are looked at when they change.
type Watched = Or<(With<InScene>, With<Refused>)>;

/// So many entities are looked at together.
const ROWS: usize = 64;

/// On entities that casca refused, until they change.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Refused(pub(crate) WhyNot);

/// A component whose change may leave no other trace.
#[derive(SystemParam)]
pub(crate) struct Part<'w, 's, C: Component> {
    there: Query<'w, 's, (Entity, Ref<'static, C>), Watched>,
    gone: RemovedComponents<'w, 's, C>,
}

impl<C: Component> Part<'_, '_, C> {
    /// Appends entities of which it changed or went.
    fn note(&mut self, all: &Query<Entity, Watched>, out: &mut Vec<Entity>) {
        out.extend(self.gone.read().filter(|entity| all.contains(*entity)));
        let Ok(tables) = self.there.contiguous_iter() else { return out.extend(all) };
        for (entities, part) in tables {
            let (last_run, this_run) = (part.last_run_tick(), part.this_run_tick());
            let is_new = |tick: &Tick| tick.is_newer_than(last_run, this_run);
            let ticks = ContiguousRef::split(part).1.changed();
            for (entities, ticks) in entities.chunks(ROWS).zip(ticks.chunks(ROWS)) {
                // Mostly nothing did: that is found without a branch for each.
                if ticks.iter().fold(false, |any, tick| any | is_new(tick)) {
                    let changed = entities.iter().zip(ticks).filter(|(_, tick)| is_new(tick));
                    out.extend(changed.map(|(entity, _)| *entity));
                }
            }
        }
    }
}

macro_rules! parts {
    ($($name:ident: $part:ty),*) => {
        #[derive(SystemParam)]
        pub(crate) struct Parts<'w, 's> { $($name: Part<'w, 's, $part>),* }

        impl Parts<'_, '_> {
            fn note(&mut self, all: &Query<Entity, Watched>, out: &mut Vec<Entity>) {
                $(self.$name.note(all, out);)*
            }
        }
    };
}

parts!(place: GlobalTransform, aabb: Aabb, visible: InheritedVisibility, mesh: Mesh3d,
    classes: VisibilityClass, layers: RenderLayers, opaque: Opaque, judged: Judged, proxy: Occluder,
    not_occluder: NotOccluder, not_caster: NotShadowCaster, skin: SkinnedMesh);

/// The system of [`CascaSystems::Sync`](crate::CascaSystems::Sync).
#[expect(clippy::too_many_arguments, reason = "entities come, change and go in many ways")]
pub(crate) fn sync(
    mut commands: Commands,
    mut casca: ResMut<CascaScene>,
    (settings, deferred): (Res<CascaSettings>, Option<Res<Deferred>>),
    meshes: Option<Res<Assets<Mesh>>>,
    mut events: Option<MessageReader<AssetEvent<Mesh>>>,
    new: Query<(Entity, &Aabb, &GlobalTransform), New>,
    gone: Query<(Entity, &InScene), Gone>,
    (all, mut parts): (Query<Entity, Watched>, Parts),
    proxied: Query<(Entity, &Mesh3d), (With<Occluder>, Watched)>,
    mut managed: Query<(Managed, Option<&mut InScene>), Present>,
) {
    let was_off = casca.culls.take().is_none();
    let Some(meshes) = meshes else { return };
    let start = Instant::now();
    let casca = &mut *casca;
    let (mut look, mut other) = (Vec::new(), HashSet::<AssetId<Mesh>>::default());
    for event in events.iter_mut().flat_map(|events| events.read()) {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } = event {
            casca.occluders.changed(*id, &meshes, settings.most_triangles, &mut look);
            other.insert(*id);
        }
    }
    // What hides in the place of a mesh goes with it.
    look.extend(proxied.iter().filter(|(_, mesh)| other.contains(&mesh.id())).map(|(entity, _)| entity));
    let has_others = std::mem::replace(&mut casca.options, settings.options) != settings.options;
    if has_others || !settings.enabled {
        casca.cameras.clear();
        casca.suns.clear();
        casca.lamps.clear();
    }
    if !settings.enabled {
        return;
    }
    casca.culls = Some(settings.shadows);
    casca.frame = casca.frame.wrapping_add(1);
    casca.changes = Changes::default();
    casca.forget();
    for (entity, known) in &gone {
        // At once: it may not hide any more in this frame.
        take_out(casca.scene.as_mut(), &mut casca.changes, known.id);
        commands.entity(entity).try_remove::<InScene>();
    }
    let boxes = new.iter().map(|(_, aabb, transform)| border::world_box(aabb, &transform.affine()));
    if grid::choose(casca, boxes) {
        // All are taken over anew, from the next frame on.
        all.iter().for_each(|entity| _ = commands.entity(entity).try_remove::<InScene>());
        return;
    }
    let CascaScene { scene: Some(scene), occluders, movers, changes, farthest, frame, shifted, .. } = casca
    else {
        return;
    };
    // The clock only has to run.
    let _ = scene.begin_frame(f64::from(*frame) / 60.0);
    let shifted = shifted.take();
    let is_other = deferred.as_ref().is_some_and(DetectChanges::is_changed);
    if was_off || is_other || shifted.is_some() {
        // What changed meanwhile is not known.
        look.extend(&all);
    }
    let shifted =
        shifted.filter(|by| scene.set_origin(scene.origin() + border::vec3(*by).as_dvec3()).is_ok());
    // Lights keep what lies in their reach, and that is elsewhere now.
    changes.everywhere |= shifted.is_some();
    if let Some(by) = shifted.map(Vec3A::from) {
        for Mover { at, around, .. } in movers.values_mut() {
            at.translation -= by;
            // Its corners were rounded where it was.
            let room = border::rounding(around.0.abs().max(around.1.abs()) + by.abs());
            *around = (around.0 - by - room, around.1 - by + room);
        }
    }
    let deferred = deferred.as_deref().copied().unwrap_or_default();
    occluders.poll(&mut look);
    occluders.stored.follow(&settings);
    parts.note(&all, &mut look);
    let rested = movers.iter().filter(|(_, mover)| mover.rests <= *frame).map(|(entity, _)| *entity);
    look.extend(rested.take(settings.most_new));
    look.extend(new.iter().map(|(entity, ..)| entity).take(settings.most_new));
    // Twice would be two objects.
    look.sort_unstable();
    look.dedup();
    let (frame, settings, meshes) = (*frame, &*settings, &*meshes);
    let mut sync =
        Sync { scene, occluders, movers, changes, farthest, frame, shifted, settings, meshes, deferred };
    for &entity in &look {
        let Ok((item, known)) = managed.get_mut(entity) else { continue };
        match sync.bring_up_to_date(&item, known) {
            Ok(None) => {}
            Ok(Some(known)) => _ = commands.entity(entity).try_insert(known).try_remove::<Refused>(),
            Err(why) => {
                if let WhyNot::Refused(error) = why {
                    warn_once!("{entity} is culled by frustum only: {error}");
                }
                commands.entity(entity).try_remove::<InScene>().try_insert(Refused(why));
            }
        }
    }
    casca.counts.time += start.elapsed();
}

struct Sync<'a> {
    scene: &'a mut Scene,
    occluders: &'a mut Occluders,
    movers: &'a mut EntityHashMap<Mover>,
    changes: &'a mut Changes,
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
    fn bring_up_to_date(
        &mut self,
        item: &ManagedItem,
        known: Option<Mut<InScene>>,
    ) -> Result<Option<InScene>, WhyNot> {
        let around = border::world_box(item.aabb, &item.transform.affine());
        let done = item.may_be_hidden().and_then(|()| match &known {
            None => self.put(item, around, item.skinned).map(Some),
            Some(known) => self.change(item, known, around),
        });
        if done.is_ok() {
            *self.farthest = self.farthest.max(around.0.abs().max(around.1.abs()).max_element());
        }
        let Some(mut known) = known else { return done };
        match done {
            Ok(Some(new)) => {
                if let Some(key) = known.key.filter(|_| new.key != known.key) {
                    self.occluders.leave(key, item.entity);
                }
                *known = new;
            }
            Ok(None) => {}
            Err(refusal) => {
                // Unless it was taken out already.
                take_out(Some(&mut *self.scene), self.changes, known.id);
                return Err(refusal);
            }
        }
        Ok(None)
    }

    /// Changes an entity that is in the scene. Returns its state if that is another one now.
    fn change(
        &mut self,
        item: &ManagedItem,
        known: &InScene,
        around: (Vec3A, Vec3A),
    ) -> Result<Option<InScene>, WhyNot> {
        let id = known.id;
        let transform = border::affine(&item.transform.affine());
        let before = match known.boxed {
            true => self.movers.get(&item.entity).map(|mover| border::affine(&mover.at)),
            false => self.scene.transform(id)?,
        };
        // What hides is moved where it is; the rest is cheaper as a box.
        let may_hide = || item.key(false, self.meshes, &self.deferred).is_ok();
        let stays = |before: &_| {
            border::trembles(before, &transform, item.aabb) && may_hide()
                || self.shifted.is_some_and(|shift| border::is_shifted(before, &transform, shift))
        };
        let differs = before != Some(transform);
        let moved = differs && !before.as_ref().is_some_and(stays);
        let moves = moved || item.skinned || known.moves && !self.has_rested(item.entity);
        let key = item.key(moves, self.meshes, &self.deferred).ok();
        let ready = key.and_then(|key| self.ask(key, item));
        let hides = !known.boxed && self.scene.occluder(id)?.is_some();
        let other_box = known.aabb != *item.aabb;
        let keeps_occluder =
            key == known.key && (ready.is_some() == hides || known.refused.is_some() && ready.is_some());
        if moves != known.moves || !keeps_occluder || other_box && !item.skinned {
            take_out(Some(&mut *self.scene), self.changes, id);
            return self.put(item, around, moves).map(Some);
        }
        let layers = item.layers();
        let changed = other_box || layers != known.layers;
        if (changed || differs) && (hides || !moves) {
            self.changes.note(border::back(&self.scene.bounds(id)?.aabb()));
            self.changes.note(around);
        }
        if known.boxed && (differs || other_box) {
            self.scene.update(id, border::placed(item.aabb, &item.transform.affine()), None)?;
        } else if differs {
            self.scene.set_transform(id, transform)?;
        }
        if moves && (moved || differs || other_box) {
            let rests = self.movers.get(&item.entity).filter(|_| !moved).map(|mover| mover.rests);
            self.note_mover(item, around, rests);
        }
        if layers != known.layers {
            self.scene.set_layers(id, layers)?;
        }
        Ok(changed.then(|| InScene { layers, aabb: *item.aabb, ..known.clone() }))
    }

    /// Whether a mover has not moved for long enough.
    fn has_rested(&self, entity: Entity) -> bool {
        self.movers.get(&entity).is_none_or(|mover| mover.rests <= self.frame)
    }

    /// Notes where an entity is, and from which frame on it counts as still: by default as if it had
    /// moved now.
    fn note_mover(&mut self, item: &ManagedItem, around: (Vec3A, Vec3A), rests: Option<u32>) {
        // What has a skin never does.
        let pause = if item.skinned { u32::MAX } else { self.settings.still_after };
        let rests = rests.filter(|_| !item.skinned).unwrap_or(self.frame.saturating_add(pause));
        self.movers.insert(item.entity, Mover { rests, around, at: item.transform.affine() });
    }

    /// Puts an entity into the scene.
    fn put(&mut self, item: &ManagedItem, around: (Vec3A, Vec3A), moves: bool) -> Result<InScene, WhyNot> {
        let (bounds, layers, at) = (border::aabb(item.aabb), item.layers(), item.transform.affine());
        let desc = if moves { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
        let desc = desc.placed(border::affine(&at));
        // A box along the axes of the world is moved in a third of the time.
        let boxed = ObjectDesc::dynamic(border::placed(item.aabb, &at));
        let common = |desc: ObjectDesc| desc.layers(layers).user_data(item.entity.to_bits());
        let key = item.key(moves, self.meshes, &self.deferred).ok();
        let mesh = key.and_then(|key| self.ask(key, item));
        // A mesh that reaches out of the box is drawn where that is not looked for.
        let placed = mesh.map(|mesh| match border::holds(&bounds, &mesh.aabb()) {
            true => self.scene.insert(common(desc.clone()).occluder(mesh)).map_err(WhyNot::from),
            false => Err(WhyNot::OutOfBox),
        });
        let placed = placed.transpose();
        let refused = placed.err().map(Box::new);
        let placed = placed.ok().flatten();
        let is_boxed = moves && placed.is_none();
        let plain = if is_boxed { boxed } else { desc };
        let id = placed.map_or_else(|| self.scene.insert(common(plain)), Ok)?;
        if moves {
            self.note_mover(item, around, None);
        } else {
            self.movers.remove(&item.entity);
        }
        if !is_boxed {
            self.changes.note(around);
        }
        Ok(InScene { id, moves, boxed: is_boxed, key, refused, layers, aabb: *item.aabb })
    }

    fn ask(&mut self, key: Key, item: &ManagedItem) -> Option<Arc<TriMesh>> {
        self.occluders.ask(key, item.entity, self.meshes, self.settings.most_triangles)
    }
}
