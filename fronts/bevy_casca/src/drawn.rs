//! Which entities are in the scene: those that match the query under which Bevy draws meshes.

use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{
    DynamicSkinnedMeshBounds, InheritedVisibility, NoCpuCulling, NoFrustumCulling, ViewVisibility,
    Visibility, VisibilityClass, VisibilityRange,
};
use bevy_ecs::entity_disabling::Disabled;
use bevy_ecs::prelude::*;
use bevy_mesh::Mesh3d;
use bevy_mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy_mesh::skinning::SkinnedMesh;
use bevy_transform::components::GlobalTransform;

use crate::materials;
use crate::scene::{CascaScene, InScene, take_out};
use crate::settings::NoOcclusionCulling;

/// Makes queries of the components that an entity has to have and of those that it may not have,
/// whatever else it has, and functions that name the first one that is amiss.
macro_rules! rules {
    (needs: $($need:ident)*; bars: $($bar:ident)*) => {
        pub(crate) type Complete = ($(With<$need>,)*);

        /// What lies in its box, if it has one.
        pub(crate) type Bounded = ($(Without<$bar>,)* Or<(Without<SkinnedMesh>, With<DynamicSkinnedMeshBounds>)>);

        type Unbounded = Or<($(With<$bar>,)* (With<SkinnedMesh>, Without<DynamicSkinnedMeshBounds>))>;

        type Incomplete = Or<($(Without<$need>,)*)>;

        pub(crate) fn lacking(entity: EntityRef) -> Option<&'static str> {
            $(if !entity.contains::<$need>() { return Some(stringify!($need)); })*
            None
        }

        pub(crate) fn barring(entity: EntityRef) -> Option<&'static str> {
            $(if entity.contains::<$bar>() { return Some(stringify!($bar)); })*
            entity.contains::<VisibilityRange>().then_some("VisibilityRange")
        }
    };
}

rules! {
    needs: Mesh3d Aabb GlobalTransform Visibility InheritedVisibility ViewVisibility VisibilityClass;
    bars: NoOcclusionCulling NoFrustumCulling NoCpuCulling MorphWeights MeshMorphWeights
}

pub(crate) type Manageable = (Bounded, Without<VisibilityRange>);

/// Entities in the scene that have no place there any more, as far as that is found without a look
/// at each.
pub(crate) type Gone = (With<InScene>, Or<(Unbounded, With<VisibilityRange>, Incomplete, With<Disabled>)>);

/// Entities in the scene that have their place there. As any query it finds no entity with a
/// component that disables, whoever registered that.
pub(crate) type Drawn = (With<InScene>, Complete, Manageable);

/// Takes all out of the scene that is not drawn, whatever the reason: counts tell whether there is
/// any. Returns these entities, and those that are drawn without being in the scene.
pub(crate) fn strays(
    casca: &mut CascaScene,
    drawn: &Query<(Entity, &InScene), Drawn>,
    commands: &mut Commands,
) -> Vec<Entity> {
    let CascaScene { scene: Some(scene), changes, movers, .. } = casca else { return Vec::new() };
    if scene.len() == drawn.iter().len() {
        return Vec::new();
    }
    let stays = |id, entity| drawn.get(entity).is_ok_and(|(_, known)| known.id == id);
    let objects = scene.iter().map(|(id, object)| (id, Entity::try_from_bits(object.user_data())));
    let gone = objects.filter(|&(id, entity)| !entity.is_some_and(|entity| stays(id, entity)));
    let gone: Vec<_> = gone.collect();
    gone.iter().for_each(|(id, _)| take_out(Some(&mut *scene), changes, *id));
    let lost = drawn.iter().filter(|(_, known)| !scene.contains(known.id)).map(|(entity, _)| entity);
    let strays: Vec<_> = gone.into_iter().filter_map(|(_, entity)| entity).chain(lost).collect();
    for &entity in &strays {
        movers.remove(&entity);
        if let Ok(mut known) = commands.get_entity(entity) {
            known.try_remove::<InScene>();
            // What its material becomes meanwhile is not seen.
            materials::forget(commands, entity);
        }
    }
    strays
}
