//! Lamps with shadows whose light falls on nothing that a camera sees: they count as not seen. So
//! Bevy makes no views for them.

use std::any::TypeId;

use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{NoCpuCulling, NoFrustumCulling, VisibilityClass, VisibleEntities};
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_light::cluster::ClusterVisibilityClass;
use bevy_light::{FogVolume, PointLight, RectLight, SpotLight, VolumetricLight};
use bevy_math::Vec3A;
use bevy_transform::components::GlobalTransform;
use casca::Sight;

use crate::border;
use crate::drawn::Bounded;
use crate::scene::{CascaScene, InScene};
use crate::settings::{CascaSettings, NoOcclusionCulling, Shadows};

/// A cone of light is wider than its angle tells by this share of the range: shaders find one
/// coordinate of its direction from the other two.
const BLUR: f32 = 0.01;

type Lamp = (
    Entity,
    &'static GlobalTransform,
    Option<&'static PointLight>,
    Option<&'static SpotLight>,
    &'static VisibilityClass,
);

/// Lamps that nothing else needs: fog reads the shadow maps of volumetric lights alone.
type Plain = (
    Or<(With<PointLight>, With<SpotLight>)>,
    Without<NoCpuCulling>,
    Without<NoFrustumCulling>,
    Without<NoOcclusionCulling>,
    Without<VolumetricLight>,
    Without<FogVolume>,
    Without<RectLight>,
);

type Part = (&'static Aabb, &'static GlobalTransform, Has<InScene>);

#[derive(SystemParam)]
pub(crate) struct Lamps<'w, 's> {
    lamps: Query<'w, 's, Lamp, Plain>,
    /// What light may fall on, if its place is known.
    parts: Query<'w, 's, Part, Bounded>,
    /// They are in no list of a camera, and drawn all the same.
    unlisted: Query<'w, 's, (), (With<NoCpuCulling>, With<VisibilityClass>)>,
}

impl Lamps<'_, '_> {
    /// The lamps that may be switched off.
    pub(crate) fn with_shadows(&self, settings: &CascaSettings) -> EntityHashMap<Glow> {
        let mut out = EntityHashMap::default();
        if settings.shadows == Shadows::All || !self.unlisted.is_empty() {
            return out;
        }
        for (entity, at, bulb, spot, classes) in &self.lamps {
            let bulb = bulb.filter(|bulb| bulb.shadow_maps_enabled).map(|bulb| Glow::around(at, bulb.range));
            let spot = spot.filter(|spot| spot.shadow_maps_enabled).map(|spot| Glow::cone(at, spot));
            // What is of two kinds may be needed for the other.
            let alone = classes.as_slice() == [TypeId::of::<ClusterVisibilityClass>()];
            out.extend(bulb.or(spot).filter(|_| alone).map(|glow| (entity, glow)));
        }
        out
    }

    /// Leaves those lamps whose light falls on nothing that a camera sees. With `strays`, there are
    /// things that casca does not place.
    pub(crate) fn retain_unseen<'a>(
        &self,
        lamps: &mut EntityHashMap<Glow>,
        casca: &CascaScene,
        strays: bool,
        cameras: impl Iterator<Item = (Entity, &'a VisibleEntities)>,
    ) {
        for (camera, visible) in cameras {
            if lamps.is_empty() {
                return;
            }
            let query = casca.camera(camera).filter(|_| !strays);
            let sight = query.zip(casca.scene.as_ref()).and_then(|(query, scene)| query.sight(scene));
            for glow in lamps.values_mut() {
                glow.in_sight = sight.as_ref().is_none_or(|sight| glow.may_be_seen(sight));
            }
            let lists = visible
                .entities
                .iter()
                .filter(|(class, _)| **class != TypeId::of::<ClusterVisibilityClass>());
            for &entity in lists.flat_map(|(_, list)| list) {
                // What has no place may be anywhere.
                let Ok((aabb, at, known)) = self.parts.get(entity) else { return lamps.clear() };
                let around = border::world_box(aabb, &at.affine());
                // The sight of a camera tells only of things that are in the scene.
                lamps.retain(|_, glow| known && !glow.in_sight || !glow.reaches(around));
                if lamps.is_empty() {
                    return;
                }
            }
        }
    }
}

/// Where a lamp shines: in a ball, and in a box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Glow {
    middle: Vec3A,
    range: f32,
    min: Vec3A,
    max: Vec3A,
    /// Whether the camera that is asked may see a point of the box.
    in_sight: bool,
}

impl Glow {
    fn around(at: &GlobalTransform, range: f32) -> Self {
        let middle = at.translation_vec3a();
        let range = range * border::SLACK + border::rounding(middle);
        Self { middle, range, min: middle - range, max: middle + range, in_sight: true }
    }

    fn cone(at: &GlobalTransform, spot: &SpotLight) -> Self {
        let ball = Self::around(at, spot.range);
        let along = -at.affine().matrix3.z_axis.normalize();
        let (sin, cos) = spot.outer_angle.sin_cos();
        if !(along.is_finite() && sin >= 0.0 && cos >= 0.0) {
            return ball;
        }
        // How far light goes towards an axis of which the cosine of the angle to it is known.
        let far = |along: f32| {
            if along >= cos { 1.0 } else { along * cos + (1.0 - along * along).max(0.0).sqrt() * sin }
        };
        let far = |along: Vec3A| Vec3A::from(along.to_array().map(|along| far(along).max(0.0))) + BLUR;
        let [low, high] = [-along, along].map(|to| far(to) * ball.range);
        Self { min: ball.middle - low, max: ball.middle + high, ..ball }
    }

    /// Whether light may fall on something in a box; in doubt, yes.
    fn reaches(&self, (min, max): (Vec3A, Vec3A)) -> bool {
        let room = border::rounding(min.abs().max(max.abs()));
        let (min, max) = (min - room, max + room);
        let apart = (min - self.middle).max(self.middle - max).max(Vec3A::ZERO);
        let beside = min.cmpgt(self.max).any() || max.cmplt(self.min).any();
        !(beside || apart.length_squared() > self.range * self.range)
    }

    /// How far it shines along the view of a camera.
    pub(crate) fn depth(&self, camera: &GlobalTransform) -> f32 {
        let from_camera = camera.affine().inverse().transform_point3a(self.middle);
        self.range / camera.scale().z.abs() - from_camera.z
    }

    fn may_be_seen(&self, sight: &Sight) -> bool {
        let (min, max) = (border::vec3(self.min.into()), border::vec3(self.max.into()));
        sight.may_see_box(&casca::Aabb::new(min, max))
    }
}

#[cfg(test)]
mod tests {
    use bevy_math::Quat;
    use bevy_transform::components::Transform;

    use super::*;

    #[test]
    fn all_that_a_cone_of_light_holds_is_reached() {
        let number = |i: u32| (i.wrapping_mul(0x9e37_79b9) >> 8) as f32 / (1 << 24) as f32;
        for i in 0..50_000 {
            let turn = Quat::from_euler(Default::default(), 6.3 * number(i), 3.2 * number(i + 1), 0.0);
            let at = Transform::from_xyz(1e3 * number(i + 2), -7.0, 2.0).with_rotation(turn).into();
            let spot = SpotLight { range: 9.0, outer_angle: 1.57 * number(i + 3), ..Default::default() };
            let (round, (sin, cos)) =
                (6.3 * number(i + 4), (spot.outer_angle * number(i + 5).sqrt()).sin_cos());
            let [lit, dark] = [Vec3A::new(round.cos() * sin, round.sin() * sin, -cos), Vec3A::Z]
                .map(|to| GlobalTransform::affine(&at).transform_point3a(to * spot.range));
            let cone = Glow::cone(&at, &spot);
            assert!(spot.outer_angle > 0.5 || !cone.reaches((dark, dark)), "it shines behind");
            assert!(cone.reaches((lit, lit)), "{at:?} {spot:?} {lit}");
        }
    }
}
