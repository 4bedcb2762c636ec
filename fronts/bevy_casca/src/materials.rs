//! What materials say about the entities that have them.

use std::marker::PhantomData;

use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::{AsAssetId, AssetEvent, AssetEventSystems, Assets, prelude::AssetChanged};
use bevy_ecs::prelude::*;
use bevy_platform::collections::HashSet;

use crate::settings::Opaque;
use crate::systems::CascaSystems;

/// What a material says about how entities with it are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Surface {
    /// One may see through it, or it is not known whether: it hides nothing.
    #[default]
    Unknown,
    /// One cannot see through it, and its depth is that of the mesh: it hides entities behind it.
    /// It also casts the shadow of the mesh, or none.
    Opaque(Opaque),
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
        app.insert_resource(Rule::<C>(self.rule))
            .add_systems(PostUpdate, judge::<C>.after(AssetEventSystems).in_set(CascaSystems::Materials));
    }
}

/// The [`MaterialsPlugin`] for Bevy's `StandardMaterial`, by the path of the module that has it. A
/// macro, because this crate does not depend on `bevy_pbr`.
///
/// Entities with materials whose `alpha_mode` is `Opaque` and that let no light through
/// (`specular_transmission`) hide others: from their front if back faces are culled, as by default,
/// from both sides if no face is. Nothing hides those with a `depth_bias`.
///
/// ```ignore
/// App::new().add_plugins((DefaultPlugins, CascaPlugin, standard_materials!(bevy::pbr)));
/// ```
#[macro_export]
macro_rules! standard_materials {
    ($($pbr:ident)::+) => {
        $crate::MaterialsPlugin::<$($pbr)::+::MeshMaterial3d<$($pbr)::+::StandardMaterial>>::new(|material| {
            // By default it is opaque, and its back faces are culled.
            let plain = <$($pbr)::+::StandardMaterial as ::core::default::Default>::default();
            if material.depth_bias != 0.0 {
                $crate::Surface::InFront
            } else if material.alpha_mode != plain.alpha_mode || material.specular_transmission != 0.0 {
                $crate::Surface::Unknown
            } else if material.cull_mode.is_none() {
                $crate::Surface::Opaque($crate::Opaque::Both)
            } else if material.cull_mode == plain.cull_mode {
                $crate::Surface::Opaque($crate::Opaque::Front)
            } else {
                $crate::Surface::Unknown
            }
        })
    };
}

#[derive(Resource)]
struct Rule<C: AsAssetId>(fn(&C::Asset) -> Surface);

/// On an entity with a material that was judged.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Hides(pub(crate) Opaque);

/// On an entity with a material that nothing hides.
#[derive(Component, Debug, Clone, Copy)]
pub(crate) struct InFront;

/// Of entities whose material is another one, or another than before.
type OtherMaterial<C> = Or<(Changed<C>, AssetChanged<C>)>;

fn judge<C: Component + AsAssetId>(
    mut commands: Commands,
    rule: Res<Rule<C>>,
    assets: Option<Res<Assets<C::Asset>>>,
    changed: Query<(Entity, &C), OtherMaterial<C>>,
    all: Query<(Entity, &C)>,
    mut gone: RemovedComponents<C>,
    mut events: Option<MessageReader<AssetEvent<C::Asset>>>,
) {
    let Some(assets) = assets else { return };
    for entity in gone.read().filter(|entity| !all.contains(*entity)) {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.try_remove::<(Hides, InFront)>();
        }
    }
    let removed = events.iter_mut().flat_map(|events| events.read()).filter_map(|event| match event {
        AssetEvent::Removed { id } => Some(*id),
        _ => None,
    });
    let removed: HashSet<_> = removed.collect();
    // Nobody is looked at if none is gone.
    let users = (!removed.is_empty()).then(|| all.iter()).into_iter().flatten();
    let without = users.filter(|(_, material)| removed.contains(&material.as_asset_id()));
    for (entity, material) in changed.iter().chain(without) {
        let surface = assets.get(material.as_asset_id()).map_or(Surface::Unknown, rule.0);
        let mut entity = commands.entity(entity);
        match surface {
            Surface::Unknown => entity.try_remove::<(Hides, InFront)>(),
            Surface::Opaque(sides) => entity.try_remove::<InFront>().try_insert(Hides(sides)),
            Surface::InFront => entity.try_remove::<Hides>().try_insert(InFront),
        };
    }
}
