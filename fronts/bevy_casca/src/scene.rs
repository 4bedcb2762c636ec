//! The scene behind the entities, and the component of those that are in it.

use std::time::Duration;

use bevy_camera::primitives::Aabb;
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
use casca::{KeptQuery, ObjectId, PointOptions, Scene};

use crate::beams::{Beams, Changes, Mover};
use crate::border;
use crate::occluders::{Key, Occluders};
#[cfg(doc)]
use crate::settings::CascaSettings;
use crate::settings::Shadows;
use crate::why_not::WhyNot;

/// The entities as casca sees them: a [`casca::Scene`], and the queries of cameras.
///
/// An object's [user data](casca::Scene::user_data) are the bits of its entity.
#[derive(Resource, Default)]
pub struct CascaScene {
    pub(crate) scene: Option<Scene>,
    pub(crate) occluders: Occluders,
    pub(crate) cameras: EntityHashMap<Eye>,
    /// Those that the queries of cameras and lights were made with.
    pub(crate) options: PointOptions,
    /// Of directional lights.
    pub(crate) suns: Beams,
    /// Of point lights and spot lights.
    pub(crate) lamps: Beams,
    pub(crate) changes: Changes,
    /// No coordinate of an entity in the scene was greater.
    pub(crate) farthest: f32,
    /// Entities whose component went, with what it held.
    pub(crate) left: Vec<(Entity, ObjectId, Option<Key>)>,
    /// Entities that move.
    pub(crate) movers: EntityHashMap<Mover>,
    /// Which casters are left out in this frame; `None` while entities are not followed.
    pub(crate) culls: Option<Shadows>,
    pub(crate) counts: Counts,
    /// How far the origin was moved since the scene was brought up to date.
    pub(crate) shifted: Option<Vec3>,
    pub(crate) frame: u32,
    /// The frame in which the grid was made.
    pub(crate) grid_made: u32,
}

/// The query of a camera, which rests where it leaves out too little.
#[derive(Debug)]
pub(crate) struct Eye {
    pub(crate) query: KeptQuery,
    /// The frame until which it rests.
    pub(crate) until: u32,
}

/// What a frame came to: see [`CascaDiagnostics`](crate::CascaDiagnostics).
#[derive(Debug, Default)]
pub(crate) struct Counts {
    pub(crate) visible: usize,
    pub(crate) culled: usize,
    pub(crate) casters: usize,
    pub(crate) time: Duration,
}

impl CascaScene {
    /// The scene; `None` as long as no entity is in it.
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// The query of a camera. [`KeptQuery::pvs`] lists what the camera sees in this frame, and
    /// [`KeptQuery::sight`] answers questions about its view. `None` if it is culled by frustum only,
    /// as for some time where little is hidden: [`CascaSettings::least_hidden`].
    pub fn camera(&self, camera: Entity) -> Option<&KeptQuery> {
        self.cameras.get(&camera).filter(|eye| eye.until <= self.frame).map(|eye| &eye.query)
    }

    /// Takes out of the scene what is not in it any more.
    pub(crate) fn forget(&mut self) {
        for (entity, id, key) in self.left.drain(..) {
            self.movers.remove(&entity);
            key.iter().for_each(|key| self.occluders.leave(*key, entity));
            take_out(self.scene.as_mut(), &mut self.changes, id);
        }
    }

    /// Follows a program that moves the origin of its world to `offset`, as for worlds that are too
    /// large for single precision. Call it in the frame in which transforms change by `-offset`,
    /// before `PostUpdate`.
    ///
    /// Costs as taking all entities over again. What the call does not hold for counts as having
    /// moved: entities that stay where they were, all of them if the call is missing or too late,
    /// or if the offset is too large. They hide nothing for [`CascaSettings::still_after`] frames.
    pub fn shift_origin(&mut self, offset: Vec3) {
        self.shifted = Some(self.shifted.unwrap_or_default() + offset);
    }

    /// The number of meshes that are prepared to hide.
    pub fn occluders(&self) -> usize {
        self.occluders.ready()
    }

    /// Whether meshes are being prepared in the background.
    pub fn is_preparing(&self) -> bool {
        !self.occluders.preparing.is_empty()
    }
}

/// Takes an object out of the scene, if it is there: an id of an earlier grid names nothing.
pub(crate) fn take_out(scene: Option<&mut Scene>, changes: &mut Changes, id: ObjectId) {
    if let Some(scene) = scene
        && let Ok(bounds) = scene.bounds(id)
    {
        changes.note(border::back(&bounds.aabb()));
        let _ = scene.remove(id);
    }
}

/// On entities that are in the scene. Put there and taken away by the plugin.
#[derive(Component, Debug, Clone)]
#[component(clone_behavior = Ignore, on_remove = leave)]
pub struct InScene {
    pub(crate) id: ObjectId,
    /// Whether it is dynamic in the scene.
    pub(crate) moves: bool,
    /// Whether a box in world space stands for it: it moves, and hides nothing.
    pub(crate) boxed: bool,
    /// The mesh that it hides with, or will when that is ready.
    pub(crate) key: Option<Key>,
    /// Why that mesh was refused, if it was.
    pub(crate) refused: Option<Box<WhyNot>>,
    pub(crate) layers: u64,
    pub(crate) aabb: Aabb,
}

impl InScene {
    /// The object that stands for the entity. It changes when the entity begins or ends to move,
    /// or hides by another mesh.
    pub fn id(&self) -> ObjectId {
        self.id
    }

    /// Whether it counts as moving. Unless it hides, its object is a box along the world's axes then.
    pub fn moves(&self) -> bool {
        self.moves
    }
}

fn leave(mut world: DeferredWorld, HookContext { entity, .. }: HookContext) {
    let Some(&InScene { id, key, .. }) = world.get::<InScene>(entity) else { return };
    if let Some(mut casca) = world.get_resource_mut::<CascaScene>() {
        casca.left.push((entity, id, key));
    }
}
