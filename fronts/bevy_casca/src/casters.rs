//! What may cast a shadow, and the test that Bevy makes of it.

use bevy_camera::primitives::{Aabb, Frustum, Sphere};
use bevy_camera::visibility::{
    InheritedVisibility, NoCpuCulling, NoFrustumCulling, RenderLayers, SetViewVisibility, ViewVisibility,
    VisibilityRange, VisibleEntityRanges,
};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_light::{DirectionalLight, NotShadowCaster};
use bevy_mesh::Mesh3d;
use bevy_transform::components::GlobalTransform;
use bevy_utils::Parallel;
use casca::Scene;

use crate::scene::InScene;

/// An entity that may cast a shadow.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Caster {
    entity: Entity,
    inherited: &'static InheritedVisibility,
    view_visibility: &'static mut ViewVisibility,
    layers: Option<&'static RenderLayers>,
    aabb: Option<&'static Aabb>,
    transform: Option<&'static GlobalTransform>,
    has_range: Has<VisibilityRange>,
    no_frustum_culling: Has<NoFrustumCulling>,
}

/// All entities that may cast shadows.
#[derive(SystemParam)]
pub(crate) struct Casters<'w, 's> {
    managed: Query<'w, 's, Caster, (CasterFilter, With<InScene>)>,
    unmanaged: Query<'w, 's, Caster, (CasterFilter, Without<InScene>)>,
    ranges: Option<Res<'w, VisibleEntityRanges>>,
    queues: Local<'s, Parallel<Vec<Vec<Entity>>>>,
}

type CasterFilter =
    (Without<NotShadowCaster>, Without<DirectionalLight>, Without<NoCpuCulling>, With<Mesh3d>);

/// A light, as far as the test asks.
pub(crate) struct Shine<'a> {
    pub(crate) layers: &'a RenderLayers,
    /// What ranges of visibility are measured from.
    pub(crate) origin: Option<Entity>,
    /// As far as it shines, if it ends.
    pub(crate) sphere: Option<Sphere>,
    /// Whether what lies before the near plane casts no shadow.
    pub(crate) near: bool,
}

/// One view of a light: a cascade, or a face of a cube.
pub(crate) struct LightView<'a> {
    pub(crate) frustum: &'a Frustum,
    /// What the light may see of managed entities; `None` if they are to be culled by frustum only.
    pub(crate) query: Option<&'a casca::Query>,
}

impl Casters<'_, '_> {
    /// The casters in each of some views of a light, in the order that renderers need. Marks them
    /// as visible.
    pub(crate) fn lists(
        &mut self,
        scene: Option<&Scene>,
        shine: &Shine,
        views: &[LightView],
    ) -> Vec<Vec<Entity>> {
        let ranges = self.ranges.as_deref();
        let note = |lists: &mut [Vec<Entity>], mut item: CasterItem, takes: &dyn Fn(usize) -> bool| {
            if !item.is_drawn(shine, ranges) {
                return;
            }
            for (i, (view, list)) in views.iter().zip(lists).enumerate() {
                if takes(i) && item.is_lit(shine, view.frustum) {
                    item.view_visibility.set_visible();
                    list.push(item.entity);
                }
            }
        };
        let queues = &*self.queues;
        let begin = || {
            let mut lists = queues.borrow_local_mut();
            let count = views.len().max(lists.len());
            lists.resize_with(count, Vec::new);
            lists
        };
        self.unmanaged.par_iter_mut().for_each_init(begin, |lists, item| note(lists, item, &|_| true));
        let by_frustum = |i: usize| scene.is_none() || views[i].query.is_none();
        if (0..views.len()).any(by_frustum) {
            self.managed.par_iter_mut().for_each_init(begin, |lists, item| note(lists, item, &by_frustum));
        }
        let mut out = vec![Vec::new(); views.len()];
        for lists in self.queues.iter_mut() {
            for (out, list) in out.iter_mut().zip(lists) {
                out.append(list);
            }
        }
        for (i, view) in views.iter().enumerate() {
            let Some((scene, query)) = scene.zip(view.query) else { continue };
            for &id in query.pvs().visible() {
                let entity = scene.user_data(id).ok().and_then(Entity::try_from_bits);
                if let Some(item) = entity.and_then(|entity| self.managed.get_mut(entity).ok()) {
                    note(&mut out, item, &|other| other == i);
                }
            }
        }
        out.iter_mut().for_each(|list| list.sort_unstable());
        out
    }
}

impl CasterItem<'_, '_> {
    fn is_drawn(&self, shine: &Shine, ranges: Option<&VisibleEntityRanges>) -> bool {
        let out_of_range = |ranges: &VisibleEntityRanges| {
            shine.origin.is_none_or(|origin| !ranges.entity_is_in_range_of_view(self.entity, origin))
        };
        self.inherited.get()
            && shine.layers.intersects(self.layers.unwrap_or_default())
            && !(self.has_range && ranges.is_some_and(out_of_range))
    }

    fn is_lit(&self, shine: &Shine, frustum: &Frustum) -> bool {
        let (Some(aabb), Some(transform)) = (self.aabb, self.transform) else { return true };
        let place = transform.affine();
        self.no_frustum_culling
            || shine.sphere.is_none_or(|sphere| sphere.intersects_obb(aabb, &place))
                && frustum.intersects_obb(aabb, &place, shine.near, true)
    }
}
