//! What casts shadows of lights: of directional lights, cascade by cascade, of spot lights, and of
//! the six faces of point lights.

use std::any::TypeId;

use bevy_camera::primitives::{CascadesFrusta, CubemapFrusta, Frustum, Sphere};
use bevy_camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, RenderLayers, ViewVisibility, VisibleEntities,
    VisibleMeshEntities,
};
use bevy_camera::{Camera, RenderTarget, ShadowLodOrigin};
use bevy_ecs::entity::{EntityHashMap, EntityHashSet};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_light::cascade::Cascade;
use bevy_light::cluster::ClusterVisibilityClass;
use bevy_light::{
    Cascades, DirectionalLight, PointLight, SpotLight, get_shadow_lod_origin, spot_light_clip_from_view,
    spot_light_world_from_view,
};
use bevy_math::{IVec2, Mat3A, Mat4, Vec2, Vec3, Vec3A};
use bevy_platform::collections::HashMap;
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;
use casca::View;

use crate::beams::{Aim, Reach};
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
    let mut shafts = HashMap::<(Entity, Entity), Shaft>::default();
    for (entity, light, frusta, cascades, _, layers, seen, opt_out) in &suns {
        if opt_out || !light.shadow_maps_enabled || !seen.get() {
            continue;
        }
        for (&camera, cascades) in cascades.iter().flat_map(|cascades| &cascades.cascades) {
            // A cascade that does not belong to the frustum says nothing about it.
            let alike = frusta.frusta.get(&camera).is_some_and(|frusta| frusta.len() == cascades.len());
            let Ok(eye) = eyes.get(camera) else { continue };
            let layers = layers::of_light(layers);
            let shaft = Shaft::around(cascades, eye.translation(), casca.farthest, layers);
            shafts.extend(shaft.filter(|_| alike).map(|shaft| ((entity, camera), shaft)));
        }
    }
    let mut wanted = Vec::new();
    for (&(sun, camera), shaft) in &shafts {
        let tiles = shaft.tiles().map(|tile| ((sun, camera, tile), shaft.aim(tile), !shaft.holds(tile)));
        wanted.extend(tiles.filter_map(|(key, aim, later)| Some((later, casca.suns.ran(&key), key, aim?))));
    }
    // Tiles that cascades hold now come first; among these, the one whose last query is longest ago.
    wanted.sort_by_key(|&(later, ran, ..)| (later, ran));
    let wanted = wanted.into_iter().map(|(.., key, aim)| (key, aim)).collect();
    let now = (casca.scene.as_ref(), &casca.changes, casca.frame);
    casca.suns.shine(now, settings.options, wanted, TILES_A_FRAME, &casca.movers);
    for (entity, light, frusta, _, mut visible, layers, seen, _) in &mut suns {
        // If shadow maps are disabled, there must be no entities.
        if !light.shadow_maps_enabled || !seen.get() {
            visible.entities.clear();
            continue;
        }
        visible.entities.retain(|camera, _| frusta.frusta.contains_key(camera));
        for (&camera, frusta) in &frusta.frusta {
            let layers = layers.unwrap_or_default();
            let shine = Shine { layers, origin: Some(camera), sphere: None };
            let lit = shafts.get(&(entity, camera)).and_then(|shaft| {
                let now = shaft.tiles().filter(|tile| shaft.holds(*tile));
                let now: Vec<_> = now.map(|tile| (entity, camera, tile)).collect();
                casca.suns.casters(&now, &shaft.reach, &casca.movers)
            });
            let lists = casters.lists(&shine, frusta, lit);
            let out = visible.entities.entry(camera).or_default();
            out.resize_with(frusta.len(), VisibleMeshEntities::default);
            for (out, list) in out.iter_mut().zip(lists) {
                casca.counts.casters += list.len();
                out.entities = list;
            }
        }
    }
    casca.counts.time += start.elapsed();
}

/// Tiles of a sun's light that are asked in a frame.
const TILES_A_FRAME: usize = 2;

/// The edge of a tile, at least, over half of the largest cascade, which is the same wherever the camera
/// looks, and over how far all reach from the eye. Smaller ones take longer together.
const TILE: (f32, f32) = (1.0, 0.3);

/// A shaft of a sun's light is wider than the cascades by this: the camera moves on.
const ROOM: f32 = 1.25;

/// Beyond this many tiles from the origin, rounding is more than a tile's slack.
const FARTHEST_TILE: f32 = 1000.0;

/// All that the cascades of a sun may hold, whichever way the camera turns, in tiles of the plane across
/// the light. They stay where they are, so that no frame has to ask for all of it.
struct Shaft {
    /// What the cascades hold now.
    reach: Reach,
    edge: f32,
    depth: f32,
    min: IVec2,
    max: IVec2,
    layers: u64,
}

impl Shaft {
    /// `None` if the cascades look into different directions, or on no layer that is known.
    fn around(cascades: &[Cascade], eye: Vec3, farthest: f32, layers: u64) -> Option<Self> {
        let from_axes = Mat3A::from_mat4(cascades.first()?.world_from_cascade);
        let to_axes = from_axes.transpose();
        let (mut min, mut max, mut largest) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY, 0.0_f32);
        for cascade in cascades {
            if Mat3A::from_mat4(cascade.world_from_cascade) != from_axes {
                return None;
            }
            let middle = to_axes * Vec3A::from(cascade.world_from_cascade.w_axis.truncate());
            let clip = &cascade.clip_from_cascade;
            let half = Vec3A::new(clip.x_axis.x, clip.y_axis.y, clip.z_axis.z).recip().abs() * SLACK;
            min = min.min(middle - half);
            max = max.max(middle + half);
            largest = largest.max(half.truncate().max_element());
        }
        let middle = (to_axes * Vec3A::from(eye)).truncate();
        let far = (max.truncate() - middle).abs().max((min.truncate() - middle).abs()).max_element();
        // Powers of two, so that tiles stay the same while cascades change a little.
        let up = |x: f32| x.log2().ceil().exp2();
        let edge = up((largest * TILE.0).max(far * TILE.1));
        let depth = up(farthest.max(eye.abs().max_element()).max(far)) * 8.0;
        let [low, high] = [middle - far * ROOM, middle + far * ROOM].map(|corner| (corner / edge).floor());
        let is_exact = |tile: Vec2| tile.abs().cmple(Vec2::splat(FARTHEST_TILE)).all();
        let is_known = depth.is_finite() && (max - min).is_finite() && is_exact(low) && is_exact(high);
        let reach = Reach { to_axes, middle: (min + max) * 0.5, half: ((max - min) * 0.5).with_z(depth) };
        let (min, max) = (low.as_ivec2(), high.as_ivec2());
        (is_known && layers != 0).then_some(Self { reach, edge, depth, min, max, layers })
    }

    fn tiles(&self) -> impl Iterator<Item = IVec2> {
        let (min, max) = (self.min, self.max);
        (min.y..=max.y).flat_map(move |y| (min.x..=max.x).map(move |x| IVec2::new(x, y)))
    }

    /// Across the light, with room for rounding: of its own place, and of what lies far along the light.
    fn tile(&self, tile: IVec2) -> (Vec2, f32) {
        let half = self.edge * 0.5 * SLACK + border::rounding(Vec3A::splat(self.depth));
        ((tile.as_vec2() + 0.5) * self.edge, half)
    }

    /// Whether the cascades hold something of a tile now.
    fn holds(&self, tile: IVec2) -> bool {
        let (middle, half) = self.tile(tile);
        let apart = (middle - self.reach.middle.truncate()).abs();
        apart.cmple(self.reach.half.truncate() + half).all()
    }

    /// The view of a tile.
    fn aim(&self, tile: IVec2) -> Option<Aim> {
        let to_axes = self.reach.to_axes;
        let (middle, half) = self.tile(tile);
        let (middle, half) = (Vec3A::from(middle.extend(0.0)), Vec3A::new(half, half, self.depth));
        let (scale, from_axes) = (half.recip() * Vec3A::new(1.0, 1.0, 0.5), to_axes.transpose());
        let column = |axis: Vec3A, w: f32| (to_axes * axis * scale).extend(w);
        let at = -middle * scale + Vec3A::new(0.0, 0.0, 0.5);
        let (x, y, z) = (column(Vec3A::X, 0.0), column(Vec3A::Y, 0.0), column(Vec3A::Z, 0.0));
        let matrix = Mat4::from_cols(x, y, z, at.extend(1.0));
        let view =
            View::orthographic(border::vec3((-from_axes.z_axis).into()), border::mat4(&matrix)).ok()?;
        let reach = Reach { to_axes, middle, half };
        Some(Aim { view: view.with_layers(self.layers), reach })
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
    let asked = lit.iter().filter_map(|lamp| lamps.get(*lamp).ok()).filter(|lamp| !lamp.no_occlusion);
    let wanted: EntityHashMap<Aim> = asked.filter_map(|lamp| Some((lamp.entity, lamp.aim()?))).collect();
    let aims = wanted.iter().map(|(lamp, aim)| ((*lamp, *lamp, IVec2::ZERO), aim.clone())).collect();
    let now = (casca.scene.as_ref(), &casca.changes, casca.frame);
    casca.lamps.shine(now, settings.options, aims, usize::MAX, &casca.movers);
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
        let shine = Shine { layers, origin, sphere: Some(sphere) };
        let key = (entity, entity, IVec2::ZERO);
        let lit = wanted.get(&entity);
        let lit = lit.and_then(|aim| casca.lamps.casters(&[key], &aim.reach, &casca.movers));
        for (out, list) in out.into_iter().zip(casters.lists(&shine, frusta, lit)) {
            casca.counts.casters += list.len();
            out.entities = list;
        }
    }
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

    fn shaft(turn: f32, side: f32, farthest: f32) -> Option<Shaft> {
        let turn = bevy_math::Quat::from_rotation_y(turn);
        let place = Mat4::from_rotation_translation(turn, Vec3::new(side, side, side.max(farthest)));
        let clip = bevy_math::proj::orthographic(-side, side, -side, side, 9.0, 0.0);
        let cascade = Cascade { world_from_cascade: place, clip_from_cascade: clip, ..Default::default() };
        Shaft::around(&[cascade], place.w_axis.truncate() + 1.0, farthest, 1)
    }

    #[test]
    fn tiles_stay_where_they_are_and_hold_the_cascades() {
        let first = shaft(0.5, 7.0, 50.0).unwrap();
        assert!((9..40).contains(&first.tiles().count()));
        let common = |turn, side, farthest| {
            let other = shaft(turn, side, farthest).unwrap();
            other.tiles().filter(|tile| other.aim(*tile) == first.aim(*tile)).count()
        };
        assert_eq!(common(0.5, 5.0, 60.0), shaft(0.5, 5.0, 60.0).unwrap().tiles().count());
        for (turn, side, farthest) in [(0.6, 7.0, 50.0), (0.5, 90.0, 50.0), (0.5, 7.0, 1e4)] {
            assert_eq!(common(turn, side, farthest), 0);
        }
        let Reach { middle, half, .. } = first.reach;
        for (x, y) in (0..=20).flat_map(|x| (0..=20).map(move |y| (x as f32, y as f32))) {
            let at = middle + half * (Vec3A::new(x, y, 10.0) * 0.1 - 1.0);
            let holds = |reach: Reach| {
                ((at - reach.middle).abs().truncate() - reach.half.truncate()).max_element() <= 0.0
            };
            let mut now = first.tiles().filter(|tile| first.holds(*tile));
            assert!(now.any(|tile| holds(first.aim(tile).unwrap().reach)), "{at}");
        }
        for nowhere in [shaft(0.5, f32::NAN, 50.0), shaft(0.5, 7.0, 1e5), shaft(0.5, 8.0, f32::INFINITY)] {
            assert!(nowhere.is_none());
        }
    }
}
