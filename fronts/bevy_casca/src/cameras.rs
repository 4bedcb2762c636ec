//! What cameras see, and the test that Bevy makes of it.

use std::any::TypeId;

use bevy_camera::primitives::{Aabb, Frustum, Sphere};
use bevy_camera::visibility::{
    InheritedVisibility, NoCpuCulling, NoFrustumCulling, RenderLayers, SetViewVisibility, ViewVisibility,
    VisibilityClass, VisibilityRange, VisibleEntities, VisibleEntityRanges,
};
use bevy_camera::{Camera, Projection};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_light::cluster::{ClusterVisibilityClass, Clusters};
use bevy_math::{Mat4, Vec3};
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;
use bevy_utils::{Parallel, TypeIdHashMap};
use casca::{KeptOptions, KeptQuery, View};

use crate::drawn::{self, Drawn};
use crate::lamps::Lamps;
use crate::scene::{CascaScene, Eye, InScene};
use crate::settings::{CascaSettings, NoOcclusionCulling};
use crate::{beams, border, layers};

type Managed = (With<InScene>, With<GlobalTransform>, Without<NoCpuCulling>);
type Unmanaged = (Without<InScene>, With<GlobalTransform>, Without<NoCpuCulling>);

/// An entity that may be drawn, or cast a shadow.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Candidate {
    pub(crate) entity: Entity,
    inherited: &'static InheritedVisibility,
    pub(crate) view_visibility: &'static mut ViewVisibility,
    classes: Option<&'static VisibilityClass>,
    layers: Option<&'static RenderLayers>,
    pub(crate) aabb: Option<&'static Aabb>,
    sphere: Option<&'static Sphere>,
    pub(crate) transform: Option<&'static GlobalTransform>,
    pub(crate) no_frustum_culling: Has<NoFrustumCulling>,
    pub(crate) has_range: Has<VisibilityRange>,
}

/// A camera, as far as the test asks.
struct Viewer<'a> {
    entity: Entity,
    layers: &'a RenderLayers,
    ranges: Option<&'a VisibleEntityRanges>,
    /// `None` if nothing is culled by it.
    frustum: Option<&'a Frustum>,
}

impl CandidateItem<'_, '_> {
    pub(crate) fn is_drawn(&self, layers: &RenderLayers) -> bool {
        self.inherited.get() && layers.intersects(self.layers.unwrap_or_default())
    }

    /// Lists it if Bevy takes it to be visible.
    fn note(&mut self, viewer: &Viewer, queue: &mut Lists) -> bool {
        let seen = self.is_seen(viewer);
        if seen {
            self.view_visibility.set_visible();
            for class in self.classes.iter().flat_map(|classes| classes.iter()) {
                queue.entry(*class).or_default().push(self.entity);
            }
        }
        seen
    }

    /// Whether Bevy takes it to be visible.
    fn is_seen(&self, viewer: &Viewer) -> bool {
        let out_of_range =
            |ranges: &VisibleEntityRanges| !ranges.entity_is_in_range_of_view(self.entity, viewer.entity);
        if !self.is_drawn(viewer.layers) || self.has_range && viewer.ranges.is_some_and(out_of_range) {
            return false;
        }
        let Some(frustum) = viewer.frustum.filter(|_| !self.no_frustum_culling) else { return true };
        if let (Some(aabb), Some(transform)) = (self.aabb, self.transform) {
            let world_from_local = transform.affine();
            let around = Sphere {
                center: world_from_local.transform_point3a(aabb.center),
                radius: transform.radius_vec3a(aabb.half_extents),
            };
            frustum.intersects_sphere(&around, false)
                && frustum.intersects_obb(aabb, &world_from_local, true, false)
        } else {
            self.sphere.is_none_or(|sphere| frustum.intersects_sphere(sphere, false))
        }
    }
}

/// A camera with the list of entities that it sees.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Cameras {
    pub(crate) entity: Entity,
    pub(crate) visible: &'static mut VisibleEntities,
    frustum: &'static Frustum,
    layers: Option<&'static RenderLayers>,
    camera: &'static Camera,
    projection: Option<&'static Projection>,
    transform: Option<&'static GlobalTransform>,
    clusters: Option<&'static mut Clusters>,
    no_cpu_culling: Has<NoCpuCulling>,
    no_occlusion: Has<NoOcclusionCulling>,
}

/// Results are kept for ways no longer than this share of a cell, to both sides: from longer ones more can
/// be seen than pays.
const REACH: f64 = 0.25;

/// Entities by which the number in a frustum is estimated.
const SAMPLE: usize = 512;

/// With fewer entities in its frustum, no camera rests: a query costs little there.
const FEW: usize = 128;

/// A camera rests for a frame for each so many entities that its query found, since the next one takes as
/// long, but for no fewer frames and no more than these.
const FOUND_A_FRAME: usize = 4;
const REST: (usize, usize) = (32, 1024);

/// The lists of a camera, by classes.
type Lists = TypeIdHashMap<Vec<Entity>>;

/// Fills the lists of all active cameras.
#[expect(clippy::too_many_arguments, reason = "it asks for what Bevy's system asks for")]
pub(crate) fn check_cameras(
    mut queues: Local<Parallel<Lists>>,
    mut casca: ResMut<CascaScene>,
    (settings, ranges): (Res<CascaSettings>, Option<Res<VisibleEntityRanges>>),
    mut cameras: Query<Cameras>,
    mut managed: Query<Candidate, Managed>,
    mut unmanaged: Query<Candidate, Unmanaged>,
    lamps: Lamps,
    (drawn, mut commands): (Query<(Entity, &InScene), Drawn>, Commands),
) {
    let start = Instant::now();
    let casca = &mut *casca;
    casca.forget();
    // Whatever happened meanwhile: what is not drawn may not hide.
    let strays = drawn::strays(casca, &drawn, &mut commands);
    let mut old = std::mem::take(&mut casca.cameras);
    let (mut ran, frame) = (Vec::new(), casca.frame);
    if let Some(scene) = &casca.scene {
        let reach = KeptOptions::new().reach((REACH * scene.grid().cell_size()) as f32);
        let new = || {
            let mut query = KeptQuery::with_options(reach).ok()?;
            query.set_point_options(settings.options).ok().map(|()| Eye { query, until: 0 })
        };
        let active = cameras.iter().filter(|camera| camera.camera.is_active);
        let eyes: Vec<(Entity, Eye, View)> = active
            .filter_map(|camera| Some((camera.entity, camera.view()?)))
            .filter_map(|(key, view)| Some((key, old.remove(&key).or_else(new)?, view)))
            .collect();
        // Who rests, or has a result that holds, asks no task.
        let holds = |eye: &Eye, view: &View| eye.until > frame || eye.query.pvs().is_valid_for(scene, view);
        let (held, mut jobs): (Vec<_>, Vec<_>) =
            eyes.into_iter().partition(|(_, eye, view)| holds(eye, view));
        beams::each(&mut jobs, &|(_, eye, view)| {
            eye.query.run(scene, view);
        });
        ran.extend(jobs.iter().map(|(key, ..)| *key));
        casca.cameras.extend(held.into_iter().chain(jobs).map(|(key, eye, _)| (key, eye)));
    }
    let ranges = ranges.as_deref();
    // Lamps are decided after these lists are filled, by what of the visible entities they light.
    let later = lamps.with_shadows(&settings);
    let mut in_view = Vec::new();
    for mut camera in cameras.iter_mut().filter(|camera| camera.camera.is_active) {
        let viewer = Viewer {
            entity: camera.entity,
            layers: camera.layers.unwrap_or_default(),
            ranges,
            frustum: Some(camera.frustum).filter(|_| !camera.no_cpu_culling),
        };
        unmanaged.par_iter_mut().for_each_init(
            || queues.borrow_local_mut(),
            |queue, mut item| {
                if !later.contains_key(&item.entity) {
                    item.note(&viewer, queue);
                }
            },
        );
        let shines = |lamp: &Entity| unmanaged.get_mut(*lamp).is_ok_and(|item| item.is_seen(&viewer));
        let first = in_view.len();
        in_view.extend(later.keys().copied().filter(shines).map(|lamp| (lamp, camera.entity)));
        // Bevy lists lights as far away as those were that shone in an earlier frame, and loses others.
        if let (Some(clusters), Some(at)) = (&mut camera.clusters, camera.transform) {
            let depths = in_view[first..].iter().filter_map(|(lamp, _)| Some(later.get(lamp)?.depth(at)));
            let far = depths.fold(f32::NEG_INFINITY, f32::max);
            // A camera without a size has no depths.
            if far.is_finite() && clusters.last_frame_farthest_z.is_some_and(|known| known < far) {
                clusters.last_frame_farthest_z = Some(far);
            }
        }
        match (casca.camera(camera.entity).map(KeptQuery::pvs), &casca.scene) {
            (Some(pvs), Some(scene)) => {
                let mut queue = queues.borrow_local_mut();
                let mut seen = 0;
                let found = pvs.visible().iter().filter_map(|&id| scene.user_data(id).ok());
                for entity in found.filter_map(Entity::try_from_bits).chain(strays.iter().copied()) {
                    if let Ok(mut item) = managed.get_mut(entity) {
                        seen += usize::from(item.note(&viewer, &mut queue));
                    }
                }
                casca.counts.visible += seen;
                casca.counts.culled += scene.len().saturating_sub(seen);
                // Not while a level loads: less is hidden then than later.
                if ran.contains(&camera.entity) && !(casca.is_preparing() || casca.changes.everywhere) {
                    let step = scene.len() / SAMPLE + 1;
                    let in_frustum = managed.iter_mut().step_by(step).filter(|item| item.is_seen(&viewer));
                    let in_frustum = in_frustum.count() * step;
                    let vain =
                        in_frustum >= FEW && seen as f32 > in_frustum as f32 * (1.0 - settings.least_hidden);
                    if let Some(eye) = casca.cameras.get_mut(&camera.entity).filter(|_| vain) {
                        let frames = (seen / FOUND_A_FRAME).clamp(REST.0, REST.1);
                        eye.until = frame.saturating_add(frames as u32);
                    }
                }
            }
            _ => managed
                .par_iter_mut()
                .for_each_init(|| queues.borrow_local_mut(), |queue, mut item| _ = item.note(&viewer, queue)),
        }
        camera.visible.clear_all();
        for (class, entities) in queues.iter_mut().flatten() {
            camera.visible.get_mut(*class).append(entities);
        }
        // Renderers compare the lists of two frames in their order.
        camera.visible.entities.values_mut().for_each(|list| list.sort_unstable());
    }
    let mut dark = later;
    dark.retain(|lamp, _| in_view.iter().any(|(shines, _)| shines == lamp));
    let active = cameras.iter().filter(|camera| camera.camera.is_active);
    let active = active.map(|camera| (camera.entity, camera.visible));
    lamps.retain_unseen(&mut dark, casca, !strays.is_empty(), active);
    for (lamp, camera) in in_view.into_iter().filter(|(lamp, _)| !dark.contains_key(lamp)) {
        if let (Ok(mut item), Ok(mut camera)) = (unmanaged.get_mut(lamp), cameras.get_mut(camera)) {
            item.view_visibility.set_visible();
            let list = camera.visible.get_mut(TypeId::of::<ClusterVisibilityClass>());
            list.insert(list.partition_point(|other| *other < lamp), lamp);
        }
    }
    casca.counts.time += start.elapsed();
}

impl CamerasReadOnlyItem<'_, '_> {
    /// The view that is drawn; `None` if it is to be culled by frustum only.
    fn view(&self) -> Option<View> {
        let layers = layers::of_camera(self.layers);
        // Mirrors draw the back sides of meshes.
        if self.no_cpu_culling || self.no_occlusion || self.camera.invert_culling || layers == 0 {
            return None;
        }
        let (projection, transform) = (self.projection?, self.transform?);
        // Renderers draw with the matrix that was computed for the target, if there is one.
        let clip_from_view = match (&self.camera.computed.target_info, &self.camera.sub_camera_view) {
            (Some(_), _) => self.camera.computed.clip_from_view,
            (None, Some(sub)) => projection.get_clip_from_view_for_sub(sub),
            (None, None) => projection.get_clip_from_view(),
        };
        let matrix = clip_from_view * Mat4::from(transform.affine().inverse());
        // `GlobalTransform::forward` panics for transforms that have none.
        let forward = Vec3::from(-transform.affine().matrix3.z_axis);
        let [x, y, w] = [0, 1, 3].map(|row| matrix.row(row).truncate());
        let ahead = if w == Vec3::ZERO { forward } else { w };
        let matrix = border::mat4(&matrix);
        let view = View::perspective(border::vec3(transform.translation()), matrix)
            .or_else(|_| View::orthographic(border::vec3(forward), matrix));
        // Where left and right are exchanged, back sides are drawn.
        Some(view.ok().filter(|_| x.cross(y).dot(ahead) < 0.0)?.with_layers(layers))
    }
}

/// Ends the frame of the scene with the sets of all cameras.
pub(crate) fn end_frame(mut casca: ResMut<CascaScene>) {
    let start = Instant::now();
    let CascaScene { scene: Some(scene), cameras, counts, frame, .. } = &mut *casca else { return };
    let awake = cameras.values().filter(|eye| eye.until <= *frame);
    // Sets that are older still hold. Would one be refused, hidden entities only cost more.
    let _ = scene.end_frame(awake.map(|eye| eye.query.pvs()));
    counts.time += start.elapsed();
}
