//! Materials of Bevy's renderer for which there is no rule.

use std::any::TypeId;

use bevy_ecs::entity_disabling::Disabled;
use bevy_ecs::lifecycle::{InsertEvent, RemoveEvent};
use bevy_ecs::prelude::*;
use bevy_ecs::query::{Allow, QueryBuilder};
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};

use crate::materials::{Rules, Verdict, note};

/// The component that holds a material, as reflection names it: this crate does not depend on the
/// renderer.
const HOLDER: &str = "bevy_pbr::mesh_material::MeshMaterial3d<";

/// Notes who has such a material, now and later. If there is no rule at all, entities say by
/// themselves what hides.
pub(crate) fn watch(world: &mut World) {
    let (Some(rules), Some(registry)) =
        (world.get_resource::<Rules>(), world.get_resource::<AppTypeRegistry>())
    else {
        return;
    };
    let registry = registry.read();
    let holders = registry.iter().filter(|holder| {
        holder.type_info().type_path().starts_with(HOLDER) && !rules.0.contains(&holder.type_id())
    });
    let holders = holders.filter_map(|holder| Some((holder.type_id(), holder.data::<ReflectComponent>()?)));
    let holders: Vec<(TypeId, ReflectComponent)> =
        holders.map(|(by, component)| (by, component.clone())).collect();
    drop(registry);
    for (by, component) in holders {
        let id = component.register_component(world);
        let verdict = Verdict::without_rule(by);
        let mut there = QueryBuilder::<Entity, Allow<Disabled>>::new(world);
        let mut there = there.with_id(id).build();
        let there: Vec<Entity> = there.iter(world).collect();
        let mut commands = world.commands();
        there.into_iter().for_each(|entity| note(&mut commands, entity, by, Some(verdict)));
        let come = move |on: On<InsertEvent>, mut commands: Commands| {
            note(&mut commands, on.entity, by, Some(verdict));
        };
        let go = move |on: On<RemoveEvent>, mut commands: Commands| note(&mut commands, on.entity, by, None);
        world.spawn(Observer::new(come).with_component(id));
        world.spawn(Observer::new(go).with_component(id));
    }
    world.flush();
}
