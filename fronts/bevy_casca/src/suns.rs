//! What casts shadows of directional lights.

use bevy_camera::primitives::CascadesFrusta;
use bevy_camera::visibility::{CascadesVisibleEntities, RenderLayers, ViewVisibility, VisibleMeshEntities};
use bevy_ecs::prelude::*;
use bevy_light::cascade::Cascade;
use bevy_light::{Cascades, DirectionalLight, SpotLight};
use bevy_math::Mat4;
use bevy_platform::time::Instant;
use casca::View;

use crate::casters::{Casters, LightView, Shine};
use crate::lights;
use crate::scene::CascaScene;
use crate::settings::{CascaSettings, NoOcclusionCulling};
use crate::{border, layers};

type Sun = (
    Entity,
    &'static DirectionalLight,
    &'static CascadesFrusta,
    Option<&'static Cascades>,
    &'static mut CascadesVisibleEntities,
    Option<&'static RenderLayers>,
    &'static ViewVisibility,
    Has<NoOcclusionCulling>,
);

/// Fills the lists of all cascades.
pub(crate) fn check_suns(
    mut casca: ResMut<CascaScene>,
    settings: Res<CascaSettings>,
    mut suns: Query<Sun, Without<SpotLight>>,
    mut casters: Casters,
) {
    let start = Instant::now();
    let casca = &mut *casca;
    let mut views = Vec::new();
    for (entity, light, _, cascades, _, layers, seen, opt_out) in &suns {
        if opt_out || !light.shadow_maps_enabled || !seen.get() {
            continue;
        }
        for (&camera, cascades) in cascades.iter().flat_map(|cascades| &cascades.cascades) {
            views.extend(cascades.iter().enumerate().filter_map(|(i, cascade)| {
                Some(((entity, camera, i), view(cascade, layers, casca.farthest)?))
            }));
        }
    }
    lights::run(casca.scene.as_ref(), &mut casca.suns, &settings, &views);
    for (entity, light, frusta, cascades, mut visible, layers, seen, _) in &mut suns {
        // If shadow maps are disabled, there must be no entities.
        if !light.shadow_maps_enabled || !seen.get() {
            visible.entities.clear();
            continue;
        }
        visible.entities.retain(|camera, _| frusta.frusta.contains_key(camera));
        for (&camera, frusta) in &frusta.frusta {
            // A cascade that does not belong to the frustum says nothing about it.
            let cascades = cascades.and_then(|cascades| cascades.cascades.get(&camera));
            let alike = cascades.is_some_and(|cascades| cascades.len() == frusta.len());
            let query = |i| casca.suns.get(&(entity, camera, i)).filter(|_| alike);
            let views = frusta.iter().enumerate().map(|(i, frustum)| LightView { frustum, query: query(i) });
            let views: Vec<LightView> = views.collect();
            let layers = layers.unwrap_or_default();
            // What lies before the near plane casts a shadow, too.
            let shine = Shine { layers, origin: Some(camera), sphere: None, near: false };
            let lists = casters.lists(casca.scene.as_ref(), &shine, &views);
            let out = visible.entities.entry(camera).or_default();
            out.resize_with(frusta.len(), VisibleMeshEntities::default);
            for (out, list) in out.iter_mut().zip(lists) {
                casca.counts.casters += list.len();
                lights::replace(out, list);
            }
        }
    }
    casca.counts.time += start.elapsed();
}

/// The view of a cascade, opened towards the light as far as entities may be.
fn view(cascade: &Cascade, layers: Option<&RenderLayers>, farthest: f32) -> Option<View> {
    let layers = layers::of_light(layers);
    let forward = -cascade.world_from_cascade.z_axis.truncate();
    let matrix = open(cascade.clip_from_world, farthest)?;
    let view = View::orthographic(border::vec3(forward), border::mat4(&matrix)).ok()?;
    (layers != 0).then(|| view.with_layers(layers))
}

/// An orthographic matrix with reversed depth, of which the near plane lies before all points whose
/// coordinates are no greater than `farthest`. Its far plane stays where it is.
fn open(mut matrix: Mat4, farthest: f32) -> Option<Mat4> {
    let depth = matrix.row(2);
    let most = depth.truncate().length() * farthest * 2.0 + depth.w.abs();
    let shrink = most.max(1.0).recip();
    if !(shrink.is_normal() && most.is_finite()) {
        return None;
    }
    for column in [&mut matrix.x_axis, &mut matrix.y_axis, &mut matrix.z_axis, &mut matrix.w_axis] {
        column.z *= shrink;
    }
    Some(matrix)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_math::Vec3;

    #[test]
    fn an_opened_cascade_keeps_its_sides_and_its_far_plane() {
        let cascade = bevy_math::proj::orthographic(-3.0, 5.0, -2.0, 6.0, 9.0, 1.0);
        let opened = open(cascade, 1000.0).unwrap();
        for p in [Vec3::new(-3.0, 6.0, -9.0), Vec3::new(1.0, 1.0, -4.0), Vec3::splat(999.0)] {
            let (old, new) = (cascade.project_point3(p), opened.project_point3(p));
            assert_eq!(old.truncate(), new.truncate());
            assert!(new.z <= 1.0 && (old.z > 0.0) == (new.z > 0.0), "{p}: {old} {new}");
        }
        assert_eq!(open(cascade, f32::INFINITY), None);
        assert_eq!(open(cascade, f32::NAN), None);
    }
}
