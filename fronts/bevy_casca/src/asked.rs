//! Answers why an entity hides nothing, without a trace in frames where nobody asks.

use bevy_asset::Assets;
use bevy_ecs::entity_disabling::DefaultQueryFilters;
use bevy_ecs::prelude::*;
use bevy_mesh::{Mesh, Mesh3d};

use crate::drawn;
use crate::materials::Deferred;
use crate::scene::{CascaScene, InScene};
use crate::settings::CascaSettings;
use crate::sync::{Managed, Refused};
use crate::why_not::WhyNot;

impl CascaScene {
    /// Tells a reason why an entity hides nothing; `None` if it hides what is behind it.
    ///
    /// It costs nothing unless it is called. Systems may have the world as a parameter: `&World`.
    pub fn why_not(world: &World, entity: Entity) -> Option<WhyNot> {
        let entity = world.get_entity(entity).map_err(|_| WhyNot::Lacks("Mesh3d"));
        entity.and_then(|entity| ask(world, entity)).err()
    }

    /// All entities with a mesh that hide nothing, and why. It looks at every entity of the world.
    pub fn all_why_not(world: &World) -> impl Iterator<Item = (Entity, WhyNot)> {
        let meshes = world.iter_entities().filter(|entity| entity.contains::<Mesh3d>());
        meshes.filter_map(|entity| Some((entity.id(), ask(world, entity).err()?)))
    }
}

fn ask(world: &World, entity: EntityRef) -> Result<(), WhyNot> {
    world.get_resource::<CascaSettings>().filter(|settings| settings.enabled).ok_or(WhyNot::Off)?;
    let casca = world.get_resource::<CascaScene>().ok_or(WhyNot::Off)?;
    let meshes = world.get_resource::<Assets<Mesh>>().ok_or(WhyNot::Off)?;
    let disabling = world.get_resource::<DefaultQueryFilters>();
    if disabling.is_some_and(|all| all.disabling_ids().any(|id| entity.contains_id(id))) {
        return Err(WhyNot::Disabled);
    }
    drawn::barring(entity).map_or(Ok(()), |name| Err(WhyNot::Has(name)))?;
    if entity.get::<Mesh3d>().is_some_and(|mesh| !meshes.contains(mesh.id())) {
        return Err(WhyNot::NoMesh);
    }
    drawn::lacking(entity).map_or(Ok(()), |name| Err(WhyNot::Lacks(name)))?;
    let item = entity.get_components::<Managed>().map_err(|_| WhyNot::Waits)?;
    if !item.visible.get() {
        return Err(WhyNot::Invisible);
    }
    item.may_be_hidden()?;
    let deferred = world.get_resource::<Deferred>().copied().unwrap_or_default();
    let key = item.key(false, meshes, &deferred)?;
    let Some(known) = entity.get::<InScene>() else {
        return Err(entity.get::<Refused>().map_or(WhyNot::Waits, |refused| refused.0));
    };
    if known.moves && item.proxy.is_none() {
        let rests = casca.movers.get(&item.entity).map_or(casca.frame, |mover| mover.rests);
        return Err(WhyNot::Moves(rests.saturating_sub(casca.frame)));
    }
    casca.occluders.why_not(&key)?;
    known.refused.as_deref().copied().map_or(Ok(()), Err)?;
    let hides = casca.scene.as_ref().is_some_and(|scene| matches!(scene.occluder(known.id), Ok(Some(_))));
    if hides { Ok(()) } else { Err(WhyNot::Waits) }
}
