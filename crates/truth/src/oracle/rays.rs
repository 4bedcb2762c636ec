//! Exact visibility along rays.

use glam::{BVec3, DVec3, Vec3};
use rayon::prelude::*;

use super::frustum::{Frustum, Viewpoint};
use super::geometry::{MeshCache, sides_of};
use super::sample::Sampler;
use super::tree::{Part, Trees};
use crate::numeric::oracle::{END, PAST_END};
use casca_scenes::random::{generator, spread};
use casca_scenes::world::{Object, Shape, Sides};

/// A point of an object that is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// The object.
    pub object: usize,
    /// Where the ray to it starts.
    pub origin: DVec3,
    /// The point that is seen.
    pub target: DVec3,
}

/// What [`RayOracle::probe`] found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ProbeReport {
    /// Rays shot.
    pub rays: u64,
    /// For each object that is seen, one point of it; in the order of the
    /// candidates.
    pub seen: Vec<Sighting>,
}

/// Whether anything hides one point from another, by exact primitives in f64.
///
/// Only objects that occlude are held, and of their meshes what hides: a ray goes on through a
/// triangle that does not hide from where it comes. Solids hide only where a ray enters
/// them, so one that holds the start of a ray does not hide along it. The
/// boxes of the hierarchy are f32 and widened, so that rounding loses no hit.
pub struct RayOracle {
    pub(super) trees: Trees,
    pub(super) meshes: MeshCache,
}

/// How strictly a segment is tested.
struct Segment {
    origin: DVec3,
    step: DVec3,
    /// The object the target is on.
    own: u32,
    /// Occluders are grown, see [`RayOracle::probe`].
    grown: bool,
    /// Hits of other objects from here on do not hide.
    end: f64,
    /// Hits of the own object from here on do not hide.
    own_end: f64,
}

impl Segment {
    #[inline]
    fn hidden_by(&self, part: &Part) -> bool {
        let end = if part.object == self.own { self.own_end } else { self.end };
        end > 0.0 && part.enter(self.origin, self.step, self.grown).is_some_and(|t| t < end)
    }
}

impl RayOracle {
    /// Builds the hierarchies over all objects that occlude.
    pub fn new(objects: &[Object]) -> Self {
        let mut meshes = MeshCache::default();
        meshes.learn(objects);
        let stops = |object: &Object, primitive: u32| {
            Some(sides_of(&object.shape, primitive)).filter(|s| object.occludes && *s != Sides::Neither)
        };
        Self { trees: Trees::new(objects, stops), meshes }
    }

    /// Takes up the new shapes of the objects `moved`. When a static object
    /// moved, or objects came, went or changed their kind, all is built anew.
    pub fn update(&mut self, objects: &[Object], moved: &[usize]) {
        if self.trees.update(objects, moved) {
            self.meshes.learn(objects);
        } else {
            self.meshes.learn(moved.iter().map(|&i| &objects[i]));
        }
    }

    /// Whether an occluder other than `ignore` lies strictly between two
    /// points. A hit in the last 1e-6 of the way does not count.
    pub fn occluded(&self, origin: DVec3, target: DVec3, ignore: usize) -> bool {
        let segment = Segment {
            origin,
            step: target - origin,
            own: u32::try_from(ignore).unwrap_or(u32::MAX),
            grown: false,
            end: 1.0 - END,
            own_end: 0.0,
        };
        self.blocker(&segment).is_some()
    }

    /// The nearest object a ray enters from outside, and the distance in
    /// units of `direction`; the lower index at equal distance.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<(usize, f64)> {
        self.trees.first(origin, direction, &mut None).map(|(object, t)| (object as usize, t))
    }

    /// Whether one of nine rays, to the corners and the centre of a box, reaches its end: how games
    /// usually ask whether a box is in sight. A box of which only other points are in sight is lost.
    pub fn nine_rays(&self, eye: Vec3, min: Vec3, max: Vec3) -> bool {
        let corner = |i: u32| Vec3::select(BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min);
        let mut ends = (0..8).map(corner).chain([(min + max) * 0.5]);
        ends.any(|end| !self.occluded(eye.as_dvec3(), end.as_dvec3(), usize::MAX))
    }

    /// A part that hides the end of the segment.
    fn blocker(&self, segment: &Segment) -> Option<(bool, u32)> {
        let end = segment.end.max(segment.own_end);
        self.trees.any(segment.origin, segment.step, end, |part| segment.hidden_by(part))
    }

    /// Whether a point of an object is seen from `origin` beyond doubt: no
    /// grown occluder hides it.
    pub(super) fn surely_sees(&self, origin: DVec3, target: DVec3, own: usize, own_is_mesh: bool) -> bool {
        self.blocker(&sure_segment(origin, target, own, own_is_mesh)).is_none()
    }

    /// Looks from `origin` at points on the surface of each candidate, up to
    /// `samples_per_object`, until one is seen.
    ///
    /// - Points are random on the visible side, and near the silhouette,
    ///   edges and corners, where a culler errs most. Only points that
    ///   `in_frustum` accepts are looked at.
    /// - A sighting is beyond the doubt of rounding: spheres and boxes that
    ///   may hide are grown by 1e-7 of their size plus 1e-9 of their
    ///   distance, triangles by 1e-7 in barycentric coordinates, and what
    ///   coincides with the target hides it. A solid is not hidden by itself;
    ///   a mesh is, except in the last 1e-6 of the way.
    /// - A solid that holds `origin` has no visible side and gives no
    ///   sighting.
    ///
    /// The result depends on `seed`, not on the number of threads.
    pub fn probe(
        &self,
        objects: &[Object],
        origin: DVec3,
        candidates: &[usize],
        samples_per_object: usize,
        seed: u64,
        in_frustum: impl Fn(DVec3) -> bool + Sync,
    ) -> ProbeReport {
        self.probe_with(objects, Viewpoint::Eye(origin), candidates, samples_per_object, seed, |target| {
            in_frustum(target).then_some(origin)
        })
    }

    /// [`Self::probe`] for a camera, perspective or orthographic: only points
    /// surely in its clip volume, along rays that start at the near plane.
    pub fn probe_camera(
        &self,
        objects: &[Object],
        frustum: &Frustum,
        candidates: &[usize],
        samples_per_object: usize,
        seed: u64,
    ) -> ProbeReport {
        self.probe_with(objects, frustum.viewpoint(), candidates, samples_per_object, seed, |target| {
            frustum.surely_contains(target).then(|| frustum.start(target))
        })
    }

    fn probe_with(
        &self,
        objects: &[Object],
        viewpoint: Viewpoint,
        candidates: &[usize],
        samples: usize,
        seed: u64,
        start: impl Fn(DVec3) -> Option<DVec3> + Sync,
    ) -> ProbeReport {
        let look_at = |&object: &usize| -> (u64, Option<Sighting>) {
            let shape = &objects[object].shape;
            let Some(mut sampler) = Sampler::new(shape, viewpoint, &self.meshes) else { return (0, None) };
            let mixed = (seed ^ spread(object as u64)).wrapping_add(object as u64);
            let mut random = generator(mixed, 0);
            let is_mesh = matches!(shape, Shape::Mesh { .. });
            // What hid the last point often hides the next.
            let mut last: Option<(bool, u32)> = None;
            let mut rays = 0;
            // Points out of the frustum are replaced, within reason.
            for attempt in 0..samples * 4 {
                if rays == samples as u64 {
                    break;
                }
                let Some(target) = sampler.point(attempt, &mut random) else { continue };
                let Some(origin) = start(target) else { continue };
                rays += 1;
                let segment = sure_segment(origin, target, object, is_mesh);
                if last.is_some_and(|place| segment.hidden_by(self.trees.part(place))) {
                    continue;
                }
                last = self.blocker(&segment);
                if last.is_none() {
                    return (rays, Some(Sighting { object, origin, target }));
                }
            }
            (rays, None)
        };
        let results: Vec<_> = candidates.par_iter().map(look_at).collect();
        ProbeReport {
            rays: results.iter().map(|(rays, _)| rays).sum(),
            seen: results.into_iter().filter_map(|(_, seen)| seen).collect(),
        }
    }
}

fn sure_segment(origin: DVec3, target: DVec3, own: usize, own_is_mesh: bool) -> Segment {
    Segment {
        origin,
        step: target - origin,
        own: own as u32,
        grown: true,
        end: 1.0 + PAST_END,
        own_end: if own_is_mesh { 1.0 - END } else { 0.0 },
    }
}
