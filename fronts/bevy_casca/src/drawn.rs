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

/// Components of which casca manages no entity, whatever else it has.
type Excluded = Or<(
    With<NoFrustumCulling>,
    With<NoCpuCulling>,
    With<NoOcclusionCulling>,
    With<VisibilityRange>,
    With<MorphWeights>,
    With<MeshMorphWeights>,
    (With<SkinnedMesh>, Without<DynamicSkinnedMeshBounds>),
)>;

/// The opposite.
pub(crate) type Manageable = (Bounded, Without<VisibilityRange>);

/// What lies in its box, if it has one.
pub(crate) type Bounded = (
    Without<NoFrustumCulling>,
    Without<NoCpuCulling>,
    Without<NoOcclusionCulling>,
    Without<MorphWeights>,
    Without<MeshMorphWeights>,
    Or<(Without<SkinnedMesh>, With<DynamicSkinnedMeshBounds>)>,
);

/// With or without each component that Bevy needs to draw a mesh and to know where it is.
macro_rules! each {
    ($has:ident) => {
        ($has<Mesh3d>, $has<Aabb>, $has<GlobalTransform>, $has<Visibility>, $has<InheritedVisibility>,
            $has<ViewVisibility>, $has<VisibilityClass>)
    };
}

pub(crate) type Complete = each!(With);

/// The opposite.
type Incomplete = Or<each!(Without)>;

/// Entities in the scene that have no place there any more, as far as that is found without a look
/// at each.
pub(crate) type Gone = (With<InScene>, Or<(Excluded, Incomplete, With<Disabled>)>);

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
    let owner = |object: casca::ObjectRef| Entity::try_from_bits(object.user_data());
    let has_place = |id, entity| drawn.get(entity).is_ok_and(|(_, known)| known.id == id);
    let objects = scene.iter().map(|(id, object)| (id, owner(object)));
    let gone = objects.filter(|&(id, entity)| !entity.is_some_and(|entity| has_place(id, entity)));
    let gone: Vec<_> = gone.collect();
    let mut strays = Vec::with_capacity(gone.len());
    for (id, entity) in gone {
        take_out(Some(&mut *scene), changes, id);
        strays.extend(entity);
    }
    strays.extend(drawn.iter().filter(|(_, known)| !scene.contains(known.id)).map(|(entity, _)| entity));
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
