//! What may cast a shadow, and the test that Bevy makes of it.

use bevy_camera::primitives::{Aabb, Frustum, Sphere};
use bevy_camera::visibility::{NoCpuCulling, RenderLayers, SetViewVisibility, VisibleEntityRanges};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_light::{DirectionalLight, NotShadowCaster};
use bevy_math::Affine3A;
use bevy_mesh::Mesh3d;
use bevy_utils::Parallel;

use crate::cameras::{Candidate, CandidateItem};
use crate::scene::InScene;

/// All entities that may cast shadows.
#[derive(SystemParam)]
pub(crate) struct Casters<'w, 's> {
    managed: Query<'w, 's, Candidate, (CasterFilter, With<InScene>)>,
    unmanaged: Query<'w, 's, Candidate, (CasterFilter, Without<InScene>)>,
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
    /// As far as it shines, if it ends. Of others, what lies before the near plane casts a shadow, too.
    pub(crate) sphere: Option<Sphere>,
}

impl Casters<'_, '_> {
    /// The casters in each of some views of a light, in the order that renderers need: of managed
    /// entities only those given, if any are. Marks them as visible.
    pub(crate) fn lists(
        &mut self,
        shine: &Shine,
        frusta: &[Frustum],
        managed: Option<Vec<Entity>>,
    ) -> Vec<Vec<Entity>> {
        let (ranges, near) = (self.ranges.as_deref(), shine.sphere.is_some());
        let note = |lists: &mut [Vec<Entity>], mut item: CandidateItem| {
            if !item.casts(shine, ranges) {
                return;
            }
            for (frustum, list) in frusta.iter().zip(lists) {
                if item.reaches(|aabb, place| frustum.intersects_obb(aabb, place, near, true)) {
                    item.view_visibility.set_visible();
                    list.push(item.entity);
                }
            }
        };
        let queues = &*self.queues;
        let begin = || {
            let mut lists = queues.borrow_local_mut();
            let count = frusta.len().max(lists.len());
            lists.resize_with(count, Vec::new);
            lists
        };
        self.unmanaged.par_iter_mut().for_each_init(begin, |lists, item| note(lists, item));
        if let Some(managed) = managed {
            let mut lists = begin();
            for entity in managed {
                if let Ok(item) = self.managed.get_mut(entity) {
                    note(&mut lists, item);
                }
            }
        } else {
            self.managed.par_iter_mut().for_each_init(begin, |lists, item| note(lists, item));
        }
        let mut out = vec![Vec::new(); frusta.len()];
        for lists in self.queues.iter_mut() {
            for (out, list) in out.iter_mut().zip(lists) {
                out.append(list);
            }
        }
        out.iter_mut().for_each(|list| list.sort_unstable());
        out
    }
}

impl CandidateItem<'_, '_> {
    fn casts(&self, shine: &Shine, ranges: Option<&VisibleEntityRanges>) -> bool {
        let out_of_range = |ranges: &VisibleEntityRanges| {
            shine.origin.is_none_or(|origin| !ranges.entity_is_in_range_of_view(self.entity, origin))
        };
        self.is_drawn(shine.layers)
            && !(self.has_range && ranges.is_some_and(out_of_range))
            && self.reaches(|aabb, place| shine.sphere.is_none_or(|range| range.intersects_obb(aabb, place)))
    }

    /// Whether it passes a test of its box, if it is to be tested.
    fn reaches(&self, test: impl Fn(&Aabb, &Affine3A) -> bool) -> bool {
        let (Some(aabb), Some(transform)) = (self.aabb, self.transform) else { return true };
        self.no_frustum_culling || test(aabb, &transform.affine())
    }
}
