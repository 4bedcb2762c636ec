//! What casts shadows of lights: of directional lights, cascade by cascade, of spot lights, and of
//! the six faces of point lights.

use std::any::TypeId;
use std::f32::consts::FRAC_PI_2;

use bevy_camera::primitives::{CUBE_MAP_FACES, CascadesFrusta, CubeMapFace, CubemapFrusta, Frustum, Sphere};
use bevy_camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, RenderLayers, ViewVisibility, VisibleEntities,
    VisibleMeshEntities,
};
use bevy_camera::{Camera, RenderTarget, ShadowLodOrigin};
use bevy_ecs::entity::EntityHashSet;
use bevy_ecs::prelude::*;
use bevy_light::cascade::Cascade;
use bevy_light::cluster::ClusterVisibilityClass;
use bevy_light::{
    Cascades, DirectionalLight, PointLight, SpotLight, get_shadow_lod_origin, spot_light_clip_from_view,
    spot_light_world_from_view,
};
use bevy_math::proj::perspective_infinite_reverse;
use bevy_math::{Affine3A, Mat4, Vec3A};
use bevy_platform::time::Instant;
use bevy_transform::components::{GlobalTransform, Transform};
use casca::View;

use crate::casters::{Casters, LightView, Shine};
use crate::run::{Queries, run_lights};
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
                Some(((entity, camera, i), view_of_cascade(cascade, layers, casca.farthest)?))
            }));
        }
    }
    run_lights(casca.scene.as_ref(), &mut casca.suns, &settings, &views);
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
                replace(out, list);
            }
        }
    }
    casca.counts.time += start.elapsed();
}

/// The view of a cascade, opened towards the light as far as entities may be.
fn view_of_cascade(cascade: &Cascade, layers: Option<&RenderLayers>, farthest: f32) -> Option<View> {
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

type Bulb = (
    &'static PointLight,
    &'static GlobalTransform,
    &'static CubemapFrusta,
    &'static mut CubemapVisibleEntities,
    Option<&'static RenderLayers>,
    Has<NoOcclusionCulling>,
);

type Spot = (
    &'static SpotLight,
    &'static GlobalTransform,
    &'static Frustum,
    &'static mut VisibleMeshEntities,
    Option<&'static RenderLayers>,
    Has<NoOcclusionCulling>,
);

type Lamps = Or<(With<PointLight>, With<SpotLight>)>;

/// Fills the lists of all point lights and spot lights that a camera sees.
#[expect(clippy::too_many_arguments, reason = "it asks for what Bevy's system asks for")]
pub(crate) fn check_lamps(
    mut casca: ResMut<CascaScene>,
    settings: Res<CascaSettings>,
    cameras: Query<&VisibleEntities>,
    mut bulbs: Query<Bulb>,
    mut spots: Query<Spot>,
    mut casters: Casters,
    mut targets: Query<(Entity, &RenderTarget), With<Camera>>,
    mut origins: Query<Entity, With<ShadowLodOrigin>>,
    mut all: Query<Entity, Lamps>,
) {
    let start = Instant::now();
    let casca = &mut *casca;
    let class = TypeId::of::<ClusterVisibilityClass>();
    let lit: EntityHashSet = cameras.iter().flat_map(|seen| seen.get(class)).copied().collect();
    let mut views = Vec::new();
    for &entity in &lit {
        if let Ok((light, transform, .., layers, false)) = bulbs.get(entity)
            && light.shadow_maps_enabled
        {
            let faces = (0..).zip(faces(light, transform));
            views.extend(
                faces.filter_map(|(i, face)| {
                    Some(((entity, entity, i), view_of_lamp(transform, face, layers)?))
                }),
            );
        }
        if let Ok((light, transform, .., layers, false)) = spots.get(entity)
            && light.shadow_maps_enabled
        {
            let clip_from_view = spot_light_clip_from_view(light.outer_angle, light.shadow_map_near_z);
            let matrix = clip_from_view * Mat4::from(spot_light_world_from_view(transform).inverse());
            views.extend(view_of_lamp(transform, matrix, layers).map(|view| ((entity, entity, SPOT), view)));
        }
    }
    run_lights(casca.scene.as_ref(), &mut casca.lamps, &settings, &views);
    let origin = get_shadow_lod_origin(
        targets.transmute_lens_filtered(),
        origins.transmute_lens_filtered(),
        all.transmute_lens_filtered(),
    );
    let CascaScene { scene, lamps: queries, counts, .. } = casca;
    let scene = scene.as_ref();
    for entity in lit {
        if let Ok((light, transform, frusta, mut visible, layers, _)) = bulbs.get_mut(entity)
            && light.shadow_maps_enabled
        {
            let views: Vec<LightView> = of_faces(queries, entity, frusta);
            let shine = shine(layers, origin, transform, light.range);
            for (out, list) in visible.iter_mut().zip(casters.lists(scene, &shine, &views)) {
                counts.casters += list.len();
                replace(out, list);
            }
        }
        if let Ok((light, transform, frustum, mut visible, layers, _)) = spots.get_mut(entity)
            && light.shadow_maps_enabled
        {
            let views = [LightView { frustum, query: queries.get(&(entity, entity, SPOT)) }];
            let shine = shine(layers, origin, transform, light.range);
            for list in casters.lists(scene, &shine, &views) {
                counts.casters += list.len();
                replace(&mut visible, list);
            }
        }
    }
    counts.time += start.elapsed();
}

/// The number of a spot light's view; point lights have views 0 to 5.
const SPOT: usize = 6;

fn of_faces<'a>(queries: &'a Queries, entity: Entity, frusta: &'a CubemapFrusta) -> Vec<LightView<'a>> {
    let view = |(i, frustum)| LightView { frustum, query: queries.get(&(entity, entity, i)) };
    frusta.iter().enumerate().map(view).collect()
}

fn shine<'a>(
    layers: Option<&'a RenderLayers>,
    origin: Option<Entity>,
    transform: &GlobalTransform,
    range: f32,
) -> Shine<'a> {
    let center = Vec3A::from(transform.translation());
    let sphere = Some(Sphere { center, radius: range });
    Shine { layers: layers.unwrap_or_default(), origin, sphere, near: true }
}

/// The matrices that the faces of a point light are drawn with.
fn faces(light: &PointLight, transform: &GlobalTransform) -> impl Iterator<Item = Mat4> {
    let clip_from_view = perspective_infinite_reverse(FRAC_PI_2, 1.0, light.shadow_map_near_z);
    let place = Transform::from_translation(transform.translation());
    CUBE_MAP_FACES.iter().map(move |CubeMapFace { target, up }| {
        let world_from_view: Transform = place * Transform::IDENTITY.looking_at(*target, *up);
        let view_from_world: Affine3A = world_from_view.compute_affine().inverse();
        clip_from_view * Mat4::from(view_from_world)
    })
}

fn view_of_lamp(transform: &GlobalTransform, matrix: Mat4, layers: Option<&RenderLayers>) -> Option<View> {
    let layers = layers::of_light(layers);
    let view = View::perspective(border::vec3(transform.translation()), border::mat4(&matrix)).ok()?;
    (layers != 0).then(|| view.with_layers(layers))
}

/// Puts another list in the place of one.
pub(crate) fn replace(out: &mut VisibleMeshEntities, mut list: Vec<Entity>) {
    out.entities.clear();
    out.entities.append(&mut list);
    out.shrink();
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
