//! The plugin: what it takes over, and in which order its systems run.

use bevy_app::{App, Plugin, PostUpdate, PreStartup};
use bevy_camera::visibility::{VisibilitySystems, check_visibility_cpu_culling, check_visibility_ranges};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleCleanupPolicy;
use bevy_light::{
    SimulationLightSystems, check_dir_light_mesh_visibility, check_point_light_mesh_visibility,
};
use bevy_log::warn;

use crate::scene::CascaScene;
use crate::settings::{CascaSettings, CascaSystems, Shadows};
use crate::{cameras, diagnostics, lights, materials, sync};

/// Occlusion culling by casca. Add it beside Bevy's plugins, in any order; [`CascaSettings`] has
/// the choices.
#[derive(Debug, Default, Clone, Copy)]
pub struct CascaPlugin;

impl Plugin for CascaPlugin {
    fn build(&self, app: &mut App) {
        diagnostics::register(app);
        app.init_resource::<CascaSettings>()
            .init_resource::<CascaScene>()
            .configure_sets(
                PostUpdate,
                (
                    // As late as Bevy looks: systems before that set may change what they want.
                    (CascaSystems::Materials, CascaSystems::Sync, CascaSystems::Cameras)
                        .chain()
                        .in_set(VisibilitySystems::CheckVisibility),
                    CascaSystems::Cameras
                        .after(check_visibility_ranges)
                        .before(SimulationLightSystems::UpdateLightFrusta)
                        .before(SimulationLightSystems::AssignLightsToClusters),
                    CascaSystems::Lights
                        .in_set(SimulationLightSystems::CheckLightVisibility)
                        .after(VisibilitySystems::CheckVisibility)
                        .after(SimulationLightSystems::UpdateLightFrusta),
                    CascaSystems::End
                        .after(SimulationLightSystems::CheckLightVisibility)
                        .before(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible),
                ),
            )
            .add_systems(PreStartup, take_over)
            .add_systems(
                PostUpdate,
                (
                    sync::sync.in_set(CascaSystems::Sync),
                    cameras::check_cameras.in_set(CascaSystems::Cameras).run_if(culls_for_cameras),
                    (lights::check_suns, lights::check_lamps)
                        .chain()
                        .in_set(CascaSystems::Lights)
                        .run_if(culls_for_lights),
                    (cameras::end_frame, diagnostics::measure)
                        .chain()
                        .in_set(CascaSystems::End)
                        .run_if(culls_for_cameras),
                ),
            );
    }
}

/// Settings that changed since the scene was brought up to date count from the next frame on.
fn culls_for_cameras(casca: Res<CascaScene>) -> bool {
    casca.culls.is_some()
}

fn culls_for_lights(casca: Res<CascaScene>) -> bool {
    casca.culls == Some(Shadows::Lit)
}

/// Takes Bevy's systems out whose work is done here, and puts them back for when it is not. At
/// start, when all plugins have been added.
fn take_over(world: &mut World) {
    materials::watch_unruled(world);
    let taken = world.try_schedule_scope(PostUpdate, |world, schedule| {
        let how = ScheduleCleanupPolicy::RemoveSystemsOnly;
        [
            schedule.remove_systems_in_set(check_visibility_cpu_culling, world, how),
            schedule.remove_systems_in_set(check_dir_light_mesh_visibility, world, how),
            schedule.remove_systems_in_set(check_point_light_mesh_visibility, world, how),
        ]
        .into_iter()
        .all(|done| done.is_ok_and(|systems| systems == 1))
        .then(|| {
            schedule.add_systems((
                check_visibility_cpu_culling.in_set(CascaSystems::Cameras).run_if(not(culls_for_cameras)),
                (check_dir_light_mesh_visibility, check_point_light_mesh_visibility)
                    .in_set(CascaSystems::Lights)
                    .run_if(not(culls_for_lights)),
            ));
        })
    });
    if !matches!(taken, Ok(Some(()))) {
        warn!("a system that culls in Bevy was not found: it may show what casca hides");
    }
}
