//! The system that makes coats and chooses their layers.

use std::collections::BTreeSet;

use bevy_asset::{AssetEvent, AssetId, Assets};
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{
    DynamicSkinnedMeshBounds, NoFrustumCulling, RenderLayers, ViewVisibility, Visibility,
};
use bevy_camera::{Camera, Camera3d, Projection};
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_light::{NotShadowCaster, NotShadowReceiver};
use bevy_log::{warn, warn_once};
use bevy_mesh::skinning::SkinnedMesh;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::MeshMaterial3d;
use bevy_transform::components::GlobalTransform;
use casca_fur::strands::Fur;
use casca_fur::visibility::{PlanOptions, Sight, plan_layers};

use crate::coat::{Coat, FurSettings, Made};
use crate::material::FurMaterial;
use crate::numeric::LADDER;
use crate::shells::Skin;
use crate::sights::{Ball, Eye};
use crate::store::Store;

/// An entity with fur.
#[derive(QueryData)]
pub(crate) struct Animal {
    entity: Entity,
    mesh: &'static Mesh3d,
    furry: &'static crate::Furry,
    place: &'static GlobalTransform,
    seen: Option<&'static ViewVisibility>,
    marks: Marks,
    skinned: Option<Ref<'static, SkinnedMesh>>,
}

/// What a coat takes over from its animal.
#[derive(QueryData)]
pub(crate) struct Marks {
    layers: Option<&'static RenderLayers>,
    casts_none: Has<NotShadowCaster>,
    receives_none: Has<NotShadowReceiver>,
    unculled: Has<NoFrustumCulling>,
}

/// The fur of an animal.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Fleece {
    entity: Entity,
    parent: Option<&'static ChildOf>,
    coat: &'static mut Coat,
    aabb: &'static mut Aabb,
    visibility: &'static mut Visibility,
    seen: &'static ViewVisibility,
    mesh: &'static mut Mesh3d,
    material: &'static mut MeshMaterial3d<FurMaterial>,
    marks: Marks,
    skinned: Has<SkinnedMesh>,
}

#[derive(SystemParam)]
pub(crate) struct Growing<'w, 's> {
    commands: Commands<'w, 's>,
    settings: Res<'w, FurSettings>,
    store: ResMut<'w, Store>,
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: Res<'w, Assets<FurMaterial>>,
    events: MessageReader<'w, 's, AssetEvent<Mesh>>,
    animals: Query<'w, 's, Animal, Without<Coat>>,
    fleeces: Query<'w, 's, Fleece>,
    cameras: Query<'w, 's, (&'static Camera, &'static Projection, &'static GlobalTransform), With<Camera3d>>,
    /// Materials that were warned of.
    refused: Local<'s, BTreeSet<AssetId<FurMaterial>>>,
}

/// The wish of an animal in this frame.
struct Wish {
    animal: Entity,
    fleece: Option<Entity>,
    aabb: Aabb,
    made: Made,
    /// The most layers that its mesh can have.
    most: u32,
    /// Whether its layers are planned anew: it was seen in the last frame, has none, or is new.
    planned: bool,
    vertices: u32,
    /// The height of the fur in the world.
    height: f32,
    /// The pixels of a world unit there, and of its diameter.
    sizes: (f32, f32),
    layers: u32,
}

/// Makes, changes and removes coats.
pub(crate) fn grow(growing: Growing) {
    let Growing { mut commands, settings, mut store, mut meshes, materials, .. } = growing;
    let Growing { mut events, animals, mut fleeces, cameras, mut refused, .. } = growing;
    store.begin(&mut events);
    let coats = coats(&mut commands, &animals, &fleeces);
    let eyes: Vec<Eye> = cameras.iter().filter_map(|(c, p, t)| Eye::of(c, p, t)).collect();
    let mut wishes = Vec::new();
    for animal in &animals {
        let fleece = coats.get(&animal.entity).and_then(|&coat| fleeces.get(coat).ok());
        let coat = fleece.as_ref().map(|fleece| fleece.entity);
        let material = materials.get(&animal.furry.0);
        let fur = material.map(|material| material.extension.strands);
        let skin = store.skin(animal.mesh.id(), &meshes);
        let fit = skin.zip(fur).and_then(|((skin, version), fur)| {
            if let Err(why) = fur.check(skin.magnitude()) {
                if refused.insert(animal.furry.0.id()) {
                    warn!("no fur with the material {}: {why}", animal.furry.0.id());
                }
                return None;
            }
            Some(wish(&animal, fleece.as_ref(), (skin, version), &fur, &eyes))
        });
        if let (None, Some(coat)) = (&fit, coat) {
            commands.entity(coat).try_despawn();
        }
        wishes.extend(fit);
    }
    plan(&mut wishes, &settings, &eyes);
    for wish in &wishes {
        let Ok(animal) = animals.get(wish.animal) else { continue };
        let fleece = wish.fleece.and_then(|coat| fleeces.get_mut(coat).ok());
        match fleece {
            Some(fleece) => change(&mut commands, wish, &animal, fleece, &mut store, &mut meshes),
            None => begin(&mut commands, wish, &animal, &mut store, &mut meshes),
        }
    }
}

/// The coat of each animal. Coats without one go, and second coats, which somebody copied.
fn coats(
    commands: &mut Commands,
    animals: &Query<Animal, Without<Coat>>,
    fleeces: &Query<Fleece>,
) -> EntityHashMap<Entity> {
    let mut coats = EntityHashMap::default();
    for fleece in fleeces {
        let parent = fleece.parent.map(ChildOf::parent);
        match parent.filter(|parent| animals.contains(*parent) && !coats.contains_key(parent)) {
            Some(parent) => _ = coats.insert(parent, fleece.entity),
            None => commands.entity(fleece.entity).try_despawn(),
        }
    }
    coats
}

fn wish(
    animal: &AnimalItem,
    fleece: Option<&FleeceReadOnlyItem>,
    (skin, version): (&Skin, u32),
    fur: &Fur,
    eyes: &[Eye],
) -> Wish {
    let reach = fur.reach(skin.magnitude());
    let aabb = skin.grown(reach);
    let ball = Ball::around(&aabb, animal.place.affine());
    // Hidden coats are in no list: those wake with their skin.
    let skin_seen = animal.seen.is_none_or(|seen| seen.get());
    let coat = fleece.map(|fleece| fleece.coat);
    // Nothing is known of a new animal yet.
    let wakes = fleece.is_none_or(|old| old.seen.get() || old.coat.layers == 0 && skin_seen);
    let made = Made {
        mesh: animal.mesh.id(),
        version,
        layers: coat.map_or(1, |coat| coat.made.layers),
        reach: if animal.skinned.is_some() { reach.to_bits() } else { 0 },
    };
    Wish {
        animal: animal.entity,
        fleece: fleece.map(|fleece| fleece.entity),
        aabb,
        made,
        most: skin.most_layers,
        planned: wakes && !eyes.is_empty(),
        vertices: skin.vertices,
        height: fur.height * ball.scale,
        sizes: ball.seen_by(eyes),
        layers: coat.map_or(1, |coat| coat.layers),
    }
}

/// Chooses the layers of all that are planned.
fn plan(wishes: &mut [Wish], settings: &FurSettings, eyes: &[Eye]) {
    let mut options = PlanOptions {
        // Distances are given for this one: those of several cameras differ.
        focal: 1.0,
        screen: eyes.iter().map(|eye| eye.screen).fold(0.0, f32::max),
        most_layers: settings.most_layers,
        budget: settings.budget,
        pixel_weight: settings.pixel_weight,
    };
    let mut planned: Vec<usize> = (0..wishes.len()).filter(|&i| wishes[i].planned).collect();
    // Nearest first; among equals by their entities, so that results do not depend on tables.
    planned.sort_by(|&a, &b| {
        let (a, b) = (&wishes[a], &wishes[b]);
        b.sizes.0.total_cmp(&a.sizes.0).then(a.animal.cmp(&b.animal))
    });
    let sight = |i: &usize| Sight {
        vertices: wishes[*i].vertices,
        height: wishes[*i].height,
        distance: 1.0 / wishes[*i].sizes.0,
        size: wishes[*i].sizes.1,
    };
    let sights: Vec<Sight> = planned.iter().map(sight).collect();
    let layers = plan_layers(&sights, &options).or_else(|why| {
        warn_once!("FurSettings are ignored: {why}");
        (options.budget, options.pixel_weight) = (f64::INFINITY, 1.0);
        plan_layers(&sights, &options)
    });
    for (i, layers) in planned.into_iter().zip(layers.unwrap_or_default()) {
        let wish = &mut wishes[i];
        wish.layers = rung(layers.min(wish.most), wish.most.min(settings.most_layers), options.budget);
        wish.made.layers = if wish.layers > 0 { wish.layers } else { wish.made.layers };
    }
}

/// The layers that a mesh is made with: at least those that are wanted, but no more than the most;
/// below a budget no more than those that are wanted.
fn rung(wanted: u32, most: u32, budget: f64) -> u32 {
    let below = LADDER.iter().rev().find(|&&rung| rung <= wanted).copied().unwrap_or(0);
    if budget.is_finite() || below == wanted {
        return below;
    }
    LADDER.into_iter().find(|&rung| rung >= wanted).unwrap_or(wanted).min(most)
}

/// Gives an animal its coat.
fn begin(
    commands: &mut Commands,
    wish: &Wish,
    animal: &AnimalItem,
    store: &mut Store,
    meshes: &mut ResMut<Assets<Mesh>>,
) {
    let Some(mesh) = store.shells(wish.made, meshes) else { return };
    let mut coat = commands.spawn((
        Coat { layers: wish.layers, made: wish.made },
        Mesh3d(mesh),
        MeshMaterial3d(animal.furry.0.clone()),
        wish.aabb,
        visibility(wish.layers),
        ChildOf(wish.animal),
    ));
    follow(&mut coat, animal, None, false);
}

/// Hidden coats cost nothing.
fn visibility(layers: u32) -> Visibility {
    if layers == 0 { Visibility::Hidden } else { Visibility::Inherited }
}

/// Gives a coat what its animal has, takes what that lacks, and leaves the rest.
fn follow(coat: &mut EntityCommands, animal: &AnimalItem, old: Option<&MarksItem>, skinned: bool) {
    match &animal.skinned {
        Some(bones) if bones.is_changed() || !skinned => {
            coat.try_insert((SkinnedMesh::clone(bones), DynamicSkinnedMeshBounds));
        }
        None if skinned => drop(coat.try_remove::<(SkinnedMesh, DynamicSkinnedMeshBounds)>()),
        _ => {}
    }
    let new = &animal.marks;
    if new.layers != old.and_then(|old| old.layers) {
        put(coat, new.layers.cloned());
    }
    let mut mark = |of: fn(&MarksItem) -> bool, put: fn(&mut EntityCommands, bool)| {
        if of(new) != old.is_some_and(of) {
            put(coat, of(new));
        }
    };
    mark(|marks| marks.casts_none, |coat, on| put(coat, on.then_some(NotShadowCaster)));
    mark(|marks| marks.receives_none, |coat, on| put(coat, on.then_some(NotShadowReceiver)));
    mark(|marks| marks.unculled, |coat, on| put(coat, on.then_some(NoFrustumCulling)));
}

/// Inserts a component, or removes it.
fn put<C: Component>(coat: &mut EntityCommands, component: Option<C>) {
    match component {
        Some(component) => coat.try_insert(component),
        None => coat.try_remove::<C>(),
    };
}

/// Brings a coat up to date. Nothing is marked changed that did not change.
fn change(
    commands: &mut Commands,
    wish: &Wish,
    animal: &AnimalItem,
    mut fleece: FleeceItem,
    store: &mut Store,
    meshes: &mut ResMut<Assets<Mesh>>,
) {
    let mut made = fleece.coat.made;
    if let Some(mesh) = store.shells(wish.made, meshes) {
        fleece.mesh.set_if_neq(Mesh3d(mesh));
        made = wish.made;
    }
    let layers = if wish.layers == 0 { 0 } else { made.layers };
    fleece.coat.set_if_neq(Coat { layers, made });
    fleece.visibility.set_if_neq(visibility(layers));
    fleece.material.set_if_neq(MeshMaterial3d(animal.furry.0.clone()));
    // Those of posed skins are Bevy's.
    if animal.skinned.is_none() {
        fleece.aabb.set_if_neq(wish.aabb);
    }
    follow(&mut commands.entity(fleece.entity), animal, Some(&fleece.marks), fleece.skinned);
}
