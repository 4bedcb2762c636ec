//! What materials say about the entities that have them.

use std::any::TypeId;
use std::marker::PhantomData;

use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::{
    AsAssetId, AssetEvent, AssetId, AssetServer, Assets, VisitAssetDependencies, prelude::AssetChanged,
};
use bevy_camera::visibility::RenderLayers;
use bevy_camera::{Camera, Camera3d};
use bevy_ecs::component::ComponentId;
use bevy_ecs::entity_disabling::Disabled;
use bevy_ecs::lifecycle::{InsertEvent, RemoveEvent};
use bevy_ecs::prelude::*;
use bevy_ecs::query::{Allow, QueryBuilder};
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_platform::collections::HashSet;

use crate::layers;
use crate::settings::{CascaSystems, Opaque};
use crate::told::{Images, Told, follow_images, hear};
use crate::why_not::WhyNot;

/// What a material says about how entities with it are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Surface {
    /// One may see through it, or it is not known whether: it hides nothing. What is nearer is
    /// drawn over it.
    #[default]
    Unknown,
    /// One cannot see through it, and its depth is that of the mesh: it hides entities behind it.
    /// It also casts the shadow of the mesh; entities with materials that cast none need
    /// [`NotShadowCaster`](bevy_light::NotShadowCaster).
    Opaque(Opaque),
    /// The same, but only cameras with a deferred prepass draw it.
    Deferred(Opaque),
    /// One of the two: the app's default says which.
    ByDefault(Opaque),
    /// It is drawn before things that are nearer, as with a depth bias: nothing hides it.
    InFront,
}

/// Lets the entities with materials of a kind hide others, and knows which ones nothing hides.
///
/// `C` is the component that holds the material: with Bevy's own
/// `MeshMaterial3d<StandardMaterial>`. The rule is called for each material of an entity, and
/// again when the material changes. [`standard_materials!`](crate::standard_materials) has the
/// rule for Bevy's standard material.
///
/// A material hides nothing until all assets that it depends on (its fields with `#[dependency]`)
/// are loaded: Bevy does not draw it before. Nothing hides entities with a `MeshMaterial3d` for
/// which there is no rule: they may be drawn before nearer things.
///
/// ```ignore
/// // Opaque, and drawn from its front only: see the pipeline of the material.
/// app.add_plugins(MaterialsPlugin::<MeshMaterial3d<Rock>>::new(|_| Surface::Opaque(Opaque::Front)));
/// ```
pub struct MaterialsPlugin<C: Component + AsAssetId> {
    rule: fn(&C::Asset) -> Surface,
    of: PhantomData<fn(C)>,
}

impl<C: Component + AsAssetId> MaterialsPlugin<C> {
    /// Judges materials by a rule.
    pub fn new(rule: fn(&C::Asset) -> Surface) -> Self {
        Self { rule, of: PhantomData }
    }
}

impl<C: Component + AsAssetId> Plugin for MaterialsPlugin<C> {
    fn build(&self, app: &mut App) {
        if app.world().get_resource::<Images>().is_none() {
            app.init_resource::<Images>()
                .add_systems(PostUpdate, follow_images.in_set(CascaSystems::Materials));
        }
        app.world_mut().get_resource_or_init::<Rules>().0.insert(TypeId::of::<C>());
        app.insert_resource(Rule::<C>(self.rule))
            .add_systems(PostUpdate, judge::<C>.after(follow_images).in_set(CascaSystems::Materials));
    }
}

/// A plugin: nothing hides entities with the component `C`, which are drawn before things that are
/// nearer.
pub fn never_hidden<C: Component>(app: &mut App) {
    let (id, by) = (app.world_mut().register_component::<C>(), TypeId::of::<C>());
    watch(app.world_mut(), id, Verdict { by, said: Ok(Surface::InFront), ready: true, watched: true });
}

/// A camera, and the layers that it draws.
type Looks = (&'static Camera, Option<&'static RenderLayers>);

/// A plugin that knows which cameras draw materials of the deferred method: those with the component
/// `D`.
///
/// `R` is the resource with the app's default method, and the function tells whether that is the
/// deferred one.
pub fn deferred_by<D: Component, R: Resource>(is_deferred: fn(&R) -> bool) -> impl Plugin {
    let follow = move |mut deferred: ResMut<Deferred>,
                       default: Option<Res<R>>,
                       forward: Query<Looks, (With<Camera3d>, Without<D>)>| {
        let active = forward.iter().filter(|(camera, _)| camera.is_active);
        let forward = active.fold(0, |all, (_, layers)| all | layers::of_camera(layers));
        // Materials that were prepared under an earlier default keep it.
        let by_default = deferred.by_default || default.is_some_and(|default| is_deferred(&default));
        deferred.set_if_neq(Deferred { forward, by_default });
    };
    move |app: &mut App| {
        app.init_resource::<Deferred>().add_systems(PostUpdate, follow.in_set(CascaSystems::Materials));
    }
}

/// A component that no entity has: no camera draws materials of the deferred method.
#[derive(Component, Debug)]
pub enum NoDeferredPrepass {}

/// The plugins for Bevy's own materials, by the path of the module that has them. A macro, because
/// this crate does not depend on `bevy_pbr`.
///
/// Entities with a `StandardMaterial` whose `alpha_mode` is `Opaque` and that lets no light through
/// (`specular_transmission`) hide others: from their front if back faces are culled, as by default,
/// from both sides if no face is. Those of the deferred method hide where all cameras have a
/// `DeferredPrepass`. Nothing hides those with a `depth_bias`, forward decals and wireframes.
///
/// ```ignore
/// App::new().add_plugins((DefaultPlugins, CascaPlugin, standard_materials!(bevy::pbr)));
/// // Without the crate `bevy`; the second path is needed for deferred rendering only.
/// standard_materials!(bevy_pbr, bevy_core_pipeline::prepass::DeferredPrepass)
/// ```
#[macro_export]
macro_rules! standard_materials {
    (bevy::pbr) => {
        $crate::standard_materials!(bevy::pbr, bevy::core_pipeline::prepass::DeferredPrepass)
    };
    ($($pbr:ident)::+) => {
        $crate::standard_materials!($($pbr)::+, $crate::NoDeferredPrepass)
    };
    ($($pbr:ident)::+, $deferred:path) => {{
        use $($pbr)::+ as pbr;
        (
            $crate::MaterialsPlugin::<pbr::MeshMaterial3d<pbr::StandardMaterial>>::new(|material| {
                // By default it is opaque, without back faces, and the app says how it is drawn.
                let plain = <pbr::StandardMaterial as ::core::default::Default>::default();
                let sides = if material.cull_mode.is_none() {
                    $crate::Opaque::Both
                } else {
                    $crate::Opaque::Front
                };
                if material.depth_bias != 0.0 {
                    $crate::Surface::InFront
                } else if material.alpha_mode != plain.alpha_mode
                    || material.specular_transmission != 0.0
                    || material.cull_mode.is_some() && material.cull_mode != plain.cull_mode
                {
                    $crate::Surface::Unknown
                } else if material.opaque_render_method == plain.opaque_render_method {
                    $crate::Surface::ByDefault(sides)
                } else if material.opaque_render_method == ::core::default::Default::default() {
                    $crate::Surface::Opaque(sides)
                } else {
                    $crate::Surface::Deferred(sides)
                }
            }),
            $crate::MaterialsPlugin::<
                pbr::MeshMaterial3d<pbr::decal::ForwardDecalMaterial<pbr::StandardMaterial>>,
            >::new(|_| $crate::Surface::InFront),
            $crate::never_hidden::<pbr::decal::ForwardDecal>,
            $crate::never_hidden::<pbr::wireframe::Wireframe>,
            $crate::never_hidden::<pbr::wireframe::Mesh3dWireframe>,
            $crate::deferred_by::<$deferred, pbr::DefaultOpaqueRendererMethod>(|method| {
                // It tells nothing else of itself.
                let deferred = pbr::DefaultOpaqueRendererMethod::deferred();
                ::std::format!("{method:?}") == ::std::format!("{deferred:?}")
            }),
        )
    }};
}

/// The components that hold materials for which there is a rule.
#[derive(Resource, Default)]
struct Rules(HashSet<TypeId>);

#[derive(Resource)]
struct Rule<C: AsAssetId>(fn(&C::Asset) -> Surface);

/// Who draws materials of the deferred method.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Deferred {
    /// The layers, as cameras see them, of the cameras that do not.
    forward: u64,
    /// Whether the app's default is or was that method.
    by_default: bool,
}

impl Default for Deferred {
    /// No camera is known to draw them.
    fn default() -> Self {
        Self { forward: u64::MAX, by_default: false }
    }
}

/// On an entity with materials that were judged, by the components that hold them. Empty if it has
/// them no more.
#[derive(Component, Debug, Clone, PartialEq, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Judged(Vec<Verdict>);

#[derive(Debug, Clone, Copy, PartialEq)]
struct Verdict {
    by: TypeId,
    /// What the rule says, or why it says nothing.
    said: Result<Surface, WhyNot>,
    /// Whether the renderer can draw with it.
    ready: bool,
    /// Whether observers tell of it, at once.
    watched: bool,
}

impl Judged {
    /// Whether things that are nearer are drawn over the entity. Where there is no rule, its own
    /// components have to say so.
    pub(crate) fn may_be_hidden(&self, is_told: bool) -> Result<(), WhyNot> {
        self.0.iter().try_for_each(|verdict| match verdict.said {
            Ok(Surface::InFront) => Err(WhyNot::InFront),
            Err(WhyNot::NoRule) if is_told => Ok(()),
            said => said.map(|_| ()),
        })
    }

    /// From which sides the entity hides others; `told` is what its own component says of that.
    pub(crate) fn hides(
        &self,
        told: Option<Opaque>,
        deferred: &Deferred,
        layers: u64,
    ) -> Result<Opaque, WhyNot> {
        let mut found = Err(WhyNot::NoMaterial);
        for verdict in &self.0 {
            let (by_material, is_deferred) = match verdict.said {
                Ok(Surface::Opaque(sides)) => (Some(sides), false),
                Ok(Surface::Deferred(sides)) => (Some(sides), true),
                Ok(Surface::ByDefault(sides)) => (Some(sides), deferred.by_default),
                Ok(_) | Err(WhyNot::NoRule) => (None, false),
                Err(why) => return Err(why),
            };
            let sides = told.or(by_material).ok_or(WhyNot::NotOpaque)?;
            found = match found {
                // Of several, Bevy draws one.
                Ok(other) if other != sides => return Err(WhyNot::Sides),
                _ if !verdict.ready => return Err(WhyNot::Textures),
                _ if is_deferred && deferred.forward & layers != 0 => return Err(WhyNot::Deferred),
                _ => Ok(sides),
            };
        }
        found
    }
}

/// Forgets what was found of an entity in time, so that it is judged anew.
pub(crate) fn forget(commands: &mut Commands, entity: Entity) {
    keep(commands, entity, |verdict| verdict.watched);
}

/// Keeps some verdicts on an entity. Without any it counts as never judged.
fn keep(commands: &mut Commands, entity: Entity, which: impl Fn(&Verdict) -> bool + Send + 'static) {
    let Ok(mut entity) = commands.get_entity(entity) else { return };
    entity.queue_silenced(move |mut entity: EntityWorldMut| {
        let Some(mut judged) = entity.get_mut::<Judged>() else { return };
        judged.0.retain(which);
        if judged.0.is_empty() {
            entity.remove::<Judged>();
        }
    });
}

/// Puts a verdict on an entity in the place of the one by the same component, or takes it away.
fn note(commands: &mut Commands, entity: Entity, by: TypeId, verdict: Option<Verdict>) {
    let Ok(mut entity) = commands.get_entity(entity) else { return };
    entity.queue_silenced(move |mut entity: EntityWorldMut| match entity.get_mut::<Judged>() {
        Some(mut judged) => {
            let others = judged.0.iter().filter(|verdict| verdict.by != by);
            let all = others.copied().chain(verdict).collect();
            _ = judged.set_if_neq(Judged(all));
        }
        None => _ = entity.insert(Judged(verdict.into_iter().collect())),
    });
}

/// Of entities whose material is another one, or another than before.
type OtherMaterial<C> = (Or<(Changed<C>, AssetChanged<C>, Without<Judged>)>, Allow<Disabled>);

#[expect(clippy::too_many_arguments, reason = "it reads three kinds of assets")]
fn judge<C: Component + AsAssetId>(
    mut commands: Commands,
    rule: Res<Rule<C>>,
    assets: Option<Res<Assets<C::Asset>>>,
    changed: Query<(Entity, &C), OtherMaterial<C>>,
    all: Query<(Entity, &C), Allow<Disabled>>,
    mut gone: RemovedComponents<C>,
    events: Option<MessageReader<AssetEvent<C::Asset>>>,
    (images, server): (Res<Images>, Option<Res<AssetServer>>),
    mut told: Local<Told<C::Asset>>,
    mut waiting: Local<HashSet<AssetId<C::Asset>>>,
) {
    let Some(assets) = assets else { return };
    let (by, server) = (TypeId::of::<C>(), server.as_deref());
    for entity in gone.read().filter(|entity| !all.contains(*entity)) {
        note(&mut commands, entity, by, None);
    }
    let mut other: HashSet<AssetId<C::Asset>> = HashSet::default();
    hear(&mut told, events, images.frame, |_| true, |id| _ = other.insert(id));
    let is_ready = |id: AssetId<C::Asset>| {
        let mut ready = told.contains_key(&id);
        assets.get(id).inspect(|material| {
            material.visit_dependencies(&mut |asset| ready = ready && images.has(asset, server));
        });
        ready
    };
    waiting.retain(|&id| {
        let waits = assets.contains(id) && !is_ready(id);
        if !waits {
            other.insert(id);
        }
        waits
    });
    // Nobody is looked at if nothing is gone and nothing has come.
    let asked = !other.is_empty() || images.lost;
    let users = asked.then(|| all.iter()).into_iter().flatten();
    let users = users.filter(|(_, material)| images.lost || other.contains(&material.as_asset_id()));
    for (entity, material) in changed.iter().chain(users) {
        let id = material.as_asset_id();
        let said = assets.get(id).map(|material| rule.0(material)).ok_or(WhyNot::NoMaterial);
        let ready = is_ready(id);
        if !ready {
            waiting.insert(id);
        }
        note(&mut commands, entity, by, Some(Verdict { by, said, ready, watched: false }));
    }
}

/// The component that holds a material, as reflection names it: this crate does not depend on the
/// renderer.
const HOLDER: &str = "bevy_pbr::mesh_material::MeshMaterial3d<";

/// Notes which entities have a material without a rule, now and later. If there is no rule at all,
/// their components say whether they hide.
pub(crate) fn watch_unruled(world: &mut World) {
    let Some(rules) = world.get_resource::<Rules>() else { return };
    let Some(registry) = world.get_resource::<AppTypeRegistry>() else { return };
    let registry = registry.read();
    let unruled = registry.iter().filter(|holder| {
        holder.type_info().type_path().starts_with(HOLDER) && !rules.0.contains(&holder.type_id())
    });
    let holders = unruled.filter_map(|holder| Some((holder.type_id(), holder.data()?)));
    let holders: Vec<_> =
        holders.map(|(by, component): (_, &ReflectComponent)| (by, component.clone())).collect();
    drop(registry);
    for (by, component) in holders {
        let id = component.register_component(world);
        watch(world, id, Verdict { by, said: Err(WhyNot::NoRule), ready: true, watched: true });
    }
    world.flush();
}

/// Puts a verdict on all entities with a component, now and later.
fn watch(world: &mut World, id: ComponentId, verdict: Verdict) {
    let mut there = QueryBuilder::<Entity, Allow<Disabled>>::new(world);
    let mut there = there.with_id(id).build();
    let there: Vec<Entity> = there.iter(world).collect();
    let mut commands = world.commands();
    there.into_iter().for_each(|entity| note(&mut commands, entity, verdict.by, Some(verdict)));
    let come = move |on: On<InsertEvent>, mut commands: Commands| {
        note(&mut commands, on.entity, verdict.by, Some(verdict));
    };
    let go = move |on: On<RemoveEvent>, mut commands: Commands| match verdict.said {
        // What is no material says nothing about materials.
        Ok(_) => keep(&mut commands, on.entity, move |other| other.by != verdict.by),
        Err(_) => note(&mut commands, on.entity, verdict.by, None),
    };
    world.spawn(Observer::new(come).with_component(id));
    world.spawn(Observer::new(go).with_component(id));
}
