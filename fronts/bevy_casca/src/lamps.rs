//! What casts shadows of point lights and spot lights.

use std::any::TypeId;
use std::f32::consts::FRAC_PI_2;

use bevy_camera::primitives::{CUBE_MAP_FACES, CubeMapFace, CubemapFrusta, Frustum, Sphere};
use bevy_camera::visibility::{CubemapVisibleEntities, RenderLayers, VisibleEntities, VisibleMeshEntities};
use bevy_camera::{Camera, RenderTarget, ShadowLodOrigin};
use bevy_ecs::entity::EntityHashSet;
use bevy_ecs::prelude::*;
use bevy_light::cluster::ClusterVisibilityClass;
use bevy_light::{
    PointLight, SpotLight, get_shadow_lod_origin, spot_light_clip_from_view, spot_light_world_from_view,
};
use bevy_math::proj::perspective_infinite_reverse;
use bevy_math::{Affine3A, Mat4, Vec3A};
use bevy_platform::time::Instant;
use bevy_transform::components::{GlobalTransform, Transform};
use casca::View;

use crate::casters::{Casters, LightView, Shine};
use crate::lights::{self, Queries};
use crate::scene::CascaScene;
use crate::settings::{CascaSettings, NoOcclusionCulling};
use crate::{border, layers};

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
                faces.filter_map(|(i, face)| Some(((entity, entity, i), view(transform, face, layers)?))),
            );
        }
        if let Ok((light, transform, .., layers, false)) = spots.get(entity)
            && light.shadow_maps_enabled
        {
            let clip_from_view = spot_light_clip_from_view(light.outer_angle, light.shadow_map_near_z);
            let matrix = clip_from_view * Mat4::from(spot_light_world_from_view(transform).inverse());
            views.extend(view(transform, matrix, layers).map(|view| ((entity, entity, SPOT), view)));
        }
    }
    lights::run(casca.scene.as_ref(), &mut casca.lamps, &settings, &views);
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
                lights::replace(out, list);
            }
        }
        if let Ok((light, transform, frustum, mut visible, layers, _)) = spots.get_mut(entity)
            && light.shadow_maps_enabled
        {
            let views = [LightView { frustum, query: queries.get(&(entity, entity, SPOT)) }];
            let shine = shine(layers, origin, transform, light.range);
            for list in casters.lists(scene, &shine, &views) {
                counts.casters += list.len();
                lights::replace(&mut visible, list);
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

fn view(transform: &GlobalTransform, matrix: Mat4, layers: Option<&RenderLayers>) -> Option<View> {
    let layers = layers::of_light(layers);
    let view = View::perspective(border::vec3(transform.translation()), border::mat4(&matrix)).ok()?;
    (layers != 0).then(|| view.with_layers(layers))
}
