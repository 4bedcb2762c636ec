//! What casts shadows of lights: of directional lights, cascade by cascade, of spot lights, and of
//! the six faces of point lights.

use std::any::TypeId;

use bevy_camera::primitives::{CascadesFrusta, CubemapFrusta, Frustum, Sphere};
use bevy_camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, RenderLayers, ViewVisibility, VisibleEntities,
    VisibleMeshEntities,
};
use bevy_camera::{Camera, RenderTarget, ShadowLodOrigin};
use bevy_ecs::entity::EntityHashSet;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_light::cascade::Cascade;
use bevy_light::cluster::ClusterVisibilityClass;
use bevy_light::{
    Cascades, DirectionalLight, PointLight, SpotLight, get_shadow_lod_origin, spot_light_clip_from_view,
    spot_light_world_from_view,
};
use bevy_math::{Mat3A, Mat4, Vec3, Vec3A};
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;
use casca::View;

use crate::beams::{Aim, Reach, shine};
use crate::border::{self, SLACK};
use crate::casters::{Casters, Shine};
use crate::layers;
use crate::scene::CascaScene;
use crate::settings::{CascaSettings, NoOcclusionCulling};

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
    eyes: Query<&GlobalTransform>,
    mut casters: Casters,
) {
    let start = Instant::now();
    let casca = &mut *casca;
    let mut beams = std::mem::take(&mut casca.suns);
    let mut aims = Vec::new();
    for (entity, light, frusta, cascades, _, layers, seen, opt_out) in &suns {
        if opt_out || !light.shadow_maps_enabled || !seen.get() {
            continue;
        }
        for (&camera, cascades) in cascades.iter().flat_map(|cascades| &cascades.cascades) {
            // A cascade that does not belong to the frustum says nothing about it.
            let alike = frusta.frusta.get(&camera).is_some_and(|frusta| frusta.len() == cascades.len());
            let Ok(eye) = eyes.get(camera) else { continue };
            let key = (entity, camera);
            let old = beams.get(&key).map(|beam| &beam.aim);
            let wanted = Shaft::around(cascades, eye.translation(), casca.farthest).filter(|_| alike);
            let aim = wanted.and_then(|shaft| shaft.aim(layers::of_light(layers), old));
            aims.extend(aim.map(|aim| (key, aim)));
        }
    }
    let now = (casca.scene.as_ref(), &casca.changes, casca.frame);
    shine(&mut beams, now, settings.options, aims, |entity| casters.moves(entity));
    for (entity, light, frusta, _, mut visible, layers, seen, _) in &mut suns {
        // If shadow maps are disabled, there must be no entities.
        if !light.shadow_maps_enabled || !seen.get() {
            visible.entities.clear();
            continue;
        }
        visible.entities.retain(|camera, _| frusta.frusta.contains_key(camera));
        for (&camera, frusta) in &frusta.frusta {
            let layers = layers.unwrap_or_default();
            // What lies before the near plane casts a shadow, too.
            let shine = Shine { layers, origin: Some(camera), sphere: None, near: false };
            let lit = beams.get(&(entity, camera)).and_then(|beam| beam.casters(&casca.movers));
            let lists = casters.lists(&shine, frusta, lit);
            let out = visible.entities.entry(camera).or_default();
            out.resize_with(frusta.len(), VisibleMeshEntities::default);
            for (out, list) in out.iter_mut().zip(lists) {
                casca.counts.casters += list.len();
                out.entities = list;
            }
        }
    }
    casca.suns = beams;
    casca.counts.time += start.elapsed();
}

/// A shaft of a sun's light is wider than needed by this: the camera moves on.
const ROOM: f32 = 1.25;

/// All that the cascades of a sun may hold, whichever way the camera turns.
struct Shaft {
    /// Across the light, and towards it.
    to_axes: Mat3A,
    middle: Vec3A,
    half: f32,
    /// How far along the light entities may be.
    farthest: f32,
    /// What the cascades hold now.
    min: Vec3A,
    max: Vec3A,
}

impl Shaft {
    /// `None` if the cascades look into different directions.
    fn around(cascades: &[Cascade], eye: Vec3, farthest: f32) -> Option<Self> {
        let from_axes = Mat3A::from_mat4(cascades.first()?.world_from_cascade);
        let to_axes = from_axes.transpose();
        let (mut min, mut max) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for cascade in cascades {
            if Mat3A::from_mat4(cascade.world_from_cascade) != from_axes {
                return None;
            }
            let middle = to_axes * Vec3A::from(cascade.world_from_cascade.w_axis.truncate());
            let clip = &cascade.clip_from_cascade;
            let half = Vec3A::new(clip.x_axis.x, clip.y_axis.y, clip.z_axis.z).recip().abs() * SLACK;
            min = min.min(middle - half);
            max = max.max(middle + half);
        }
        let middle = to_axes * Vec3A::from(eye);
        let half = (max - middle).abs().max((min - middle).abs()).truncate().max_element() * ROOM;
        let farthest = farthest.max(eye.abs().max_element());
        Some(Self { to_axes, middle, half, farthest, min, max })
    }

    /// The view of it: an earlier one, if that will do.
    fn aim(&self, layers: u64, old: Option<&Aim>) -> Option<Aim> {
        let Self { to_axes, middle, half, farthest, min, max } = *self;
        let holds = |aim: &&Aim| {
            let Reach { middle, half, .. } = aim.reach;
            let inside = (middle - half).cmple(min).all() && (middle + half).cmpge(max).all();
            inside && aim.reach.to_axes == to_axes && aim.view.layers() == layers && farthest <= half.z * 0.25
        };
        if let Some(old) = old.filter(holds) {
            return Some(old.clone());
        }
        // The corner of a cube is less than twice as far as a side.
        let depth = farthest.max(half) * 8.0;
        let half = Vec3A::new(half, half, depth);
        let middle = Vec3A::new(middle.x, middle.y, 0.0);
        let (scale, from_axes) = (half.recip() * Vec3A::new(1.0, 1.0, 0.5), to_axes.transpose());
        let column = |axis: Vec3A, w: f32| (to_axes * axis * scale).extend(w);
        let at = -middle * scale + Vec3A::new(0.0, 0.0, 0.5);
        let (x, y, z) = (column(Vec3A::X, 0.0), column(Vec3A::Y, 0.0), column(Vec3A::Z, 0.0));
        let matrix = Mat4::from_cols(x, y, z, at.extend(1.0));
        let view =
            View::orthographic(border::vec3((-from_axes.z_axis).into()), border::mat4(&matrix)).ok()?;
        let reach = Reach { to_axes, middle, half };
        (layers != 0).then(|| Aim { view: view.with_layers(layers), reach })
    }
}

/// A point light or a spot light, with the frusta of its shadow maps and their lists.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Lamp {
    entity: Entity,
    bulb: Option<(&'static PointLight, &'static CubemapFrusta, &'static mut CubemapVisibleEntities)>,
    spot: Option<(&'static SpotLight, &'static Frustum, &'static mut VisibleMeshEntities)>,
    transform: &'static GlobalTransform,
    layers: Option<&'static RenderLayers>,
    no_occlusion: Has<NoOcclusionCulling>,
}

type Lamps = Or<(With<PointLight>, With<SpotLight>)>;

/// Fills the lists of all point lights and spot lights that a camera sees.
#[expect(clippy::too_many_arguments, reason = "it asks for what Bevy's system asks for")]
pub(crate) fn check_lamps(
    mut casca: ResMut<CascaScene>,
    settings: Res<CascaSettings>,
    cameras: Query<&VisibleEntities>,
    mut lamps: Query<Lamp, Lamps>,
    mut casters: Casters,
    mut targets: Query<(Entity, &RenderTarget), With<Camera>>,
    mut origins: Query<Entity, With<ShadowLodOrigin>>,
    mut all: Query<Entity, Lamps>,
) {
    let start = Instant::now();
    let casca = &mut *casca;
    let class = TypeId::of::<ClusterVisibilityClass>();
    let lit: EntityHashSet = cameras.iter().flat_map(|seen| seen.get(class)).copied().collect();
    let mut beams = std::mem::take(&mut casca.lamps);
    let asked = lit.iter().filter_map(|lamp| lamps.get(*lamp).ok()).filter(|lamp| !lamp.no_occlusion);
    let aims = asked.filter_map(|lamp| Some(((lamp.entity, lamp.entity), lamp.aim()?))).collect();
    let now = (casca.scene.as_ref(), &casca.changes, casca.frame);
    shine(&mut beams, now, settings.options, aims, |entity| casters.moves(entity));
    let origin = get_shadow_lod_origin(
        targets.transmute_lens_filtered(),
        origins.transmute_lens_filtered(),
        all.transmute_lens_filtered(),
    );
    for entity in lit {
        let Ok(lamp) = lamps.get_mut(entity) else { continue };
        let (range, frusta, out): (f32, &[Frustum], Vec<_>) = match (lamp.bulb, lamp.spot) {
            (Some((bulb, frusta, lists)), _) if bulb.shadow_maps_enabled => {
                (bulb.range, &frusta.frusta, lists.into_inner().iter_mut().collect())
            }
            (_, Some((spot, frustum, list))) if spot.shadow_maps_enabled => {
                (spot.range, std::slice::from_ref(frustum), vec![list.into_inner()])
            }
            _ => continue,
        };
        let sphere = Sphere { center: lamp.transform.translation_vec3a(), radius: range };
        let layers = lamp.layers.unwrap_or_default();
        let shine = Shine { layers, origin, sphere: Some(sphere), near: true };
        let lit = beams.get(&(entity, entity)).and_then(|beam| beam.casters(&casca.movers));
        for (out, list) in out.into_iter().zip(casters.lists(&shine, frusta, lit)) {
            casca.counts.casters += list.len();
            out.entities = list;
        }
    }
    casca.lamps = beams;
    casca.counts.time += start.elapsed();
}

impl LampReadOnlyItem<'_, '_> {
    /// What it shines on; `None` if that is not to be known.
    fn aim(&self) -> Option<Aim> {
        let at = self.transform.translation();
        let (view, range) = match (self.bulb, self.spot) {
            (Some((bulb, ..)), _) if bulb.shadow_maps_enabled => (view_of_bulb(at, bulb)?, bulb.range),
            (_, Some((spot, ..))) if spot.shadow_maps_enabled => {
                let clip_from_view = spot_light_clip_from_view(spot.outer_angle, spot.shadow_map_near_z);
                let view = Mat4::from(spot_light_world_from_view(self.transform).inverse());
                let matrix = border::mat4(&(clip_from_view * view));
                (View::perspective(border::vec3(at), matrix).ok()?, spot.range)
            }
            _ => return None,
        };
        let reach = Reach { to_axes: Mat3A::IDENTITY, middle: at.into(), half: Vec3A::splat(range * SLACK) };
        let layers = layers::of_light(self.layers);
        (layers != 0).then(|| Aim { view: view.with_layers(layers), reach })
    }
}

/// What a point light shines on, in all directions. What its near planes cut casts no shadow, so
/// all that can be seen from as near as that lies in the light.
fn view_of_bulb(at: Vec3, light: &PointLight) -> Option<View> {
    let side =
        |axis: Vec3| casca::Plane { normal: border::vec3(axis), offset: light.range * SLACK - axis.dot(at) };
    let sides = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(side);
    let near = light.shadow_map_near_z * SLACK * 3.0_f32.sqrt();
    View::from_planes(border::vec3(at), &sides).and_then(|view| view.with_reach(near)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shaft(turn: f32, side: f32, farthest: f32) -> Shaft {
        let place =
            Mat4::from_rotation_translation(bevy_math::Quat::from_rotation_y(turn), Vec3::splat(side));
        let clip = bevy_math::proj::orthographic(-side, side, -side, side, 9.0, 0.0);
        let cascade = Cascade { world_from_cascade: place, clip_from_cascade: clip, ..Default::default() };
        Shaft::around(&[cascade], Vec3::ONE, farthest).unwrap()
    }

    #[test]
    fn a_shaft_is_kept_while_it_holds_the_cascades() {
        let aim = shaft(0.5, 8.0, 50.0).aim(1, None).unwrap();
        assert_eq!(shaft(0.5, 7.0, 50.0).aim(1, Some(&aim)).unwrap(), aim);
        assert_ne!(shaft(0.5, 8.0, 50.0).aim(2, Some(&aim)).unwrap(), aim, "other layers");
        for other in [shaft(0.6, 7.0, 50.0), shaft(0.5, 12.0, 50.0), shaft(0.5, 7.0, 1e4)] {
            assert_ne!(other.aim(1, Some(&aim)).unwrap(), aim);
        }
        assert_eq!(shaft(0.5, f32::NAN, 50.0).aim(1, None), None);
    }
}
