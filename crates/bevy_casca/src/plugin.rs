//! The plugin: what it takes over, and in which order its systems run.

use bevy_app::{App, Plugin, PostUpdate, PreStartup};
use bevy_camera::visibility::{VisibilitySystems, check_visibility_cpu_culling, check_visibility_ranges};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleCleanupPolicy;
use bevy_light::SimulationLightSystems;
use bevy_log::warn;
use bevy_transform::TransformSystems;

use crate::scene::CascaScene;
use crate::settings::CascaSettings;
use crate::{cameras, sync};

/// Occlusion culling by casca. Add it beside Bevy's plugins, in any order; [`CascaSettings`] has
/// the choices.
#[derive(Debug, Default, Clone, Copy)]
pub struct CascaPlugin;

/// What the plugin does in [`PostUpdate`], in this order.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CascaSystems {
    /// Entities that came, moved, changed or went are brought up to date in the [`CascaScene`].
    Sync,
    /// Cameras find what they see. Part of [`VisibilitySystems::CheckVisibility`].
    Cameras,
    /// The frame ends: what nobody saw is put into volumes.
    End,
}

impl Plugin for CascaPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<CascaSettings>()
            .init_resource::<CascaScene>()
            .configure_sets(
                PostUpdate,
                (
                    CascaSystems::Sync
                        .after(TransformSystems::Propagate)
                        .after(VisibilitySystems::CalculateBounds)
                        .after(VisibilitySystems::VisibilityPropagate)
                        .before(CascaSystems::Cameras),
                    CascaSystems::Cameras
                        .in_set(VisibilitySystems::CheckVisibility)
                        .after(check_visibility_ranges)
                        .before(SimulationLightSystems::UpdateLightFrusta)
                        .before(SimulationLightSystems::AssignLightsToClusters),
                    CascaSystems::End
                        .after(CascaSystems::Cameras)
                        .after(SimulationLightSystems::CheckLightVisibility)
                        .before(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible),
                ),
            )
            .add_systems(PreStartup, take_over)
            .add_systems(
                PostUpdate,
                (
                    sync::sync.in_set(CascaSystems::Sync),
                    cameras::check_cameras.in_set(CascaSystems::Cameras),
                    cameras::end_frame.in_set(CascaSystems::End),
                ),
            );
    }
}

/// Takes Bevy's systems out whose work is done here. At start, when all plugins have been added.
fn take_over(world: &mut World) {
    let taken = world.try_schedule_scope(PostUpdate, |world, schedule| {
        let policy = ScheduleCleanupPolicy::RemoveSystemsOnly;
        schedule.remove_systems_in_set(check_visibility_cpu_culling, world, policy).is_ok()
    });
    if !taken.unwrap_or(false) {
        warn!("Bevy's own culling of cameras was not found: entities are culled by frustum only");
    }
}
