//! Shadow casters of one light: the objects that may cast a shadow onto visible ones.
//!
//! A *ray* of the light ends at a point and starts infinitely far away (directional), at the light,
//! or where it enters the half-spaces of the light's view (spot), whose near plane may lie before
//! the light. Let `p` be a point that the camera sees, of an object of its set, inside the range or
//! the view of the light, and let something on the light's layers block the ray to `p`. Let `q` be
//! the first point of geometry of such objects on that ray, and `A` its object: all of them are
//! closed and bounded, so there is a first. Then `A` is among the casters:
//!
//! 1. **`p` lies in a piece.** The box around a receiver contains `p`; a receiver whose motion goes
//!    unreported lies in its volume, and where there is none, every place is taken for a
//!    receiver's. Where bounds and occluder are the same box, all of it is solid. If no ray of the
//!    camera starts in it, the ray to `p` enters it at `p`, by a side that is turned to the ray:
//!    such sides stand for the box. Boxes are cut into *pieces* that share their cuts, so that one
//!    of two halves contains `p`. Four tests drop pieces; none drops one that contains `p`:
//!    - the half-spaces of the camera's view contain `p`, and are tested outwards;
//!    - so is the range of the light, or its view;
//!    - the receiver's bounds contain `p`, and are tested outwards;
//!    - *the camera's occlusion buffers.* A box is dropped if it is hidden: every pixel that it may
//!      touch is covered at a nearness no less than its own. The pixel of `p` is one of them. Were
//!      it covered, then by an occluder of which each ray of that pixel meets the front no deeper
//!      than the nearness noted, or by the outside of the view. `p` is inside of the view. The
//!      camera's ray to `p` meets that front, and not before `p`, as `p` is seen; at `p` it may,
//!      since `p` may lie on its own object's occluder. So the nearness noted is at most that of
//!      `p`, less the rounding away from the eye; and that of the box is at least that of `p`, plus
//!      the rounding towards the eye. Both roundings ([`above`](crate::numeric::occlusion::above)
//!      and [`below`](crate::numeric::occlusion::below)) exceed the error of the depths, so the box
//!      is not hidden. This holds for any box around `p` and whichever occluders were drawn.
//!
//!    The buffers are those of the camera's last run. They count only while its set is valid for
//!    the camera's own view: no occluder that was drawn has moved. A volume that was hidden then
//!    was drawn by nothing, whatever moves in it.
//! 2. **The light's query asks for `A`.** Its view contains all rays to points of pieces: a
//!    rectangle across the light around all pieces with a plane behind the farthest, open towards
//!    the light; or the box around the light and all pieces; or the view of a spot light as it is.
//! 3. **It finds `A`.** Every occluder lies inside geometry. None lies on the ray before `q`, so
//!    the light sees `q`, and its query, being conservative, finds `A`. That is so whichever
//!    occluders it draws, for volumes of hidden objects (it finds the objects in them as if those
//!    were in sight) and for objects without occluders (their points are points of geometry).
//!    Parallel rays of a directional light start outside of every occluder and before every plane
//!    of the view. Other rays may start inside an occluder, as in a lamp: such occluders hide
//!    nothing from that query.
//! 4. **The mask leaves `A` in.** The light's buffers start with all pixels covered that no piece
//!    touches, rounded outwards, and each tile covered beyond the farthest piece in it, rounded
//!    away from the light. `p` and `q` share a pixel, since they lie on one ray; a piece touches
//!    it, and `q` is no deeper than `p`. So a box around `q` is not hidden by that, by the argument
//!    of point 1. Where the light is known to within a small box only (a spot light's view from its
//!    matrix alone), boxes of pieces and targets both are grown by that, so that they contain `p`
//!    and `q` as each such light sees them. Where it is not known at which end rays start, nothing
//!    is covered beyond pieces.
//!
//! So on every ray the light stops at the same point if only casters are drawn: objects left out
//! behind that point are in shadow already. `A` can be the receiver's own object: an object in the
//! light shadows itself.
//!
//! Rounding. The rectangle across a directional light and the range of a point light are widened by
//! [`LIGHT_EXTENT`](crate::numeric::scene::LIGHT_EXTENT); all else is rounded as targets of
//! occlusion buffers are.

pub(crate) mod light;
mod pieces;

pub use light::Light;

use casca_slots::Slot;

use crate::derived::shadows::light::Lamp;
use crate::derived::shadows::pieces::find_pieces;
use crate::error::Error;
use crate::geometry::Block;
use crate::id::ObjectId;
use crate::method::{Method, PointOptions};
use crate::occlusion::buffers::{OcclusionBuffers, Verdict};
use crate::occlusion::target::{FaceTarget, Target};
use crate::query::point::run::pitch;
use crate::query::{CameraQuery, Extras, Query};
use crate::scene::Scene;
use crate::view::View;

impl Query {
    /// Finds the objects that may cast a shadow of a light onto visible ones: those to draw into
    /// its shadow map. Conservative: with these casters alone, every point that the camera sees of
    /// the objects in its set is in the shadow of something if and only if it is with all objects.
    ///
    /// `camera` is the query of the camera, just run on `scene`: a [`Query`] of any method, or a
    /// [`crate::KeptQuery`]. Only what lies inside its view and what the light reaches receives
    /// shadows. Where it was run by [`Method::Point`] and the scene has not changed since, its
    /// occlusion buffers tell which parts of large objects are hidden, so that a ground does not
    /// make everything on it a caster. `out` is emptied first; casters come roughly as the light
    /// reaches them, as in [`crate::Pvs::visible`].
    ///
    /// This is a query of its own, the light's. With [`Method::Point`], [`Query::pvs`] then is the
    /// set of casters. With [`Method::Frustum`] and [`Method::Cell`] it contains all objects of the
    /// light's view, and casters in the shadow of others are kept. Give that set to
    /// [`Scene::end_frame`], too, if casters should count as seen: each frame costs less if dynamic
    /// ones that the camera does not see stay out of temporal bounding volumes. Call this before
    /// `end_frame`.
    ///
    /// - Every occluder is taken to cast a shadow. An object that hides but is not drawn into the
    ///   shadow map must have no occluder: so must the shade of a lamp that light is to pass.
    /// - A light inside an occluder shines out of it: that occluder hides nothing. Its object is a
    ///   caster, as its surface may lie between the light and all else. The triangles of a mesh
    ///   around the light do hide what lies beyond.
    /// - Casters of a directional light may lie far before the objects that they shade: clamp
    ///   depths to the near plane of the shadow map.
    /// - A receiver that the light reaches is a caster, too: it shadows itself.
    /// - Objects that go unreported while hidden ([`crate::Reports::OnExpiry`]) may be casters:
    ///   their places are then needed. If one of unknown place is a receiver, all objects that the
    ///   light reaches are casters.
    /// - A renderer whose light differs by rounding to single precision sees shadows shifted by
    ///   about 1e-7 of the distance between caster and receiver; so may be the edges of the shadows
    ///   of objects left out.
    ///
    /// Costs a query of the light's view, in which everything without receivers behind it counts as
    /// hidden, and a test of each receiver and of up to 4,096 parts of large ones against the
    /// camera's buffers.
    ///
    /// ```
    /// use casca::glam::{Mat4, UVec3, Vec3, Vec4};
    /// use casca::{Aabb, Light, ObjectDesc, Query, Scene, View};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let mut solid = |min, max| {
    ///     let b = Aabb::new(min, max);
    ///     scene.insert(ObjectDesc::fixed(b).occluder(b))
    /// };
    /// let ground = solid(Vec3::ZERO, Vec3::new(64.0, 1.0, 64.0))?;
    /// let tower = solid(Vec3::new(28.0, 1.0, 58.0), Vec3::new(36.0, 30.0, 60.0))?;
    /// let eye = Vec3::new(32.0, 3.0, 50.0);
    /// // It looks along -z: 60 degrees high, 3:2, with reversed depth from 0.1 on.
    /// let projection = Mat4::from_cols(Vec4::X * 1.155, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
    /// let matrix = projection * Mat4::from_translation(-eye);
    /// let (mut camera, mut sun) = (Query::new(), Query::new());
    /// let pvs = camera.run(&scene, &View::perspective(eye, matrix)?);
    /// assert!(pvs.contains(ground) && !pvs.contains(tower), "it stands behind the camera");
    /// let mut casters = Vec::new();
    /// let light = Light::directional(Vec3::new(0.0, -1.0, -1.0));
    /// sun.shadow_casters(&scene, &camera, &light, &mut casters)?;
    /// assert!(casters.contains(&tower), "its shadow falls before the camera");
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses a direction that is zero or not finite, a position that is not finite, a range that
    /// is negative or not a number, and with [`Error::ForeignPvs`] a camera that was run last on
    /// another scene, or never. The query and `out` are then left as they were.
    pub fn shadow_casters(
        &mut self,
        scene: &Scene,
        camera: &impl CameraQuery,
        light: &Light,
        out: &mut Vec<ObjectId>,
    ) -> Result<(), Error> {
        let lamp = Lamp::new(light)?;
        if camera.pvs().scene != scene.tag() {
            return Err(Error::ForeignPvs);
        }
        let lamp = [lamp];
        self.shadows.pieces.clear();
        let known = find_pieces(scene, camera.pvs(), camera.sight(scene), &lamp, &mut self.shadows);
        self.cast(scene, &lamp[0], known, out);
        Ok(())
    }

    /// As [`Query::shadow_casters`], for several views of lights and the receivers of several
    /// cameras at once: the cascades of a sun, the six faces of a point light, all lights of a
    /// frame. The receivers are found and cut into parts once for all of them.
    ///
    /// The query at each index finds the casters of the light at the same index, for the receivers
    /// of all cameras; they come in `out` at that index. If the slices differ in length, the rest
    /// of the longer one is ignored. `out` gets as many lists as there are pairs.
    ///
    /// Give the view of each cascade, or of each face, as a [`Light::spot`]: its rays then start at
    /// the near plane of that view. Casters before it are missing, so make the near planes of
    /// cascades start outside of the scene, or give [`Light::directional`] where one list for all
    /// cascades will do.
    ///
    /// Costs a test of each receiver of each camera, of up to 4,096 parts of large ones for each
    /// camera, one comparison of each part with each light, and a query for each light.
    ///
    /// ```
    /// use casca::{Aabb, Light, ObjectDesc, Query, Scene, View};
    /// use glam::camera::rh::{proj::directx::perspective, view::look_to_mat4};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let ground = Aabb::new(Vec3::ZERO, Vec3::new(64.0, 1.0, 64.0));
    /// scene.insert(ObjectDesc::fixed(ground).occluder(ground))?;
    /// let mut camera = Query::new();
    /// camera.run(&scene, &View::omnidirectional(Vec3::new(32.0, 3.0, 50.0))?);
    ///
    /// // The faces of a cube around a lamp.
    /// let lamp = Vec3::new(30.0, 9.0, 40.0);
    /// let faces = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|forward| {
    ///     let up = if forward.y == 0.0 { Vec3::Y } else { Vec3::Z };
    ///     let right_angle = std::f32::consts::FRAC_PI_2;
    ///     let matrix = perspective(right_angle, 1.0, 0.05, 100.0) * look_to_mat4(lamp, forward, up);
    ///     Ok(Light::spot(View::perspective(lamp, matrix)?))
    /// });
    /// let faces = faces.into_iter().collect::<Result<Vec<Light>, casca::Error>>()?;
    /// let (mut queries, mut casters) = (vec![Query::new(); 6], Vec::new());
    /// Query::shadow_casters_of_all(&mut queries, &scene, &[&camera], &faces, &mut casters)?;
    /// assert!(casters[3].len() == 1 && casters[2].is_empty(), "the ground is below");
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Query::shadow_casters`], for any of the lights and cameras. Nothing is changed then.
    pub fn shadow_casters_of_all(
        queries: &mut [Self],
        scene: &Scene,
        cameras: &[&dyn CameraQuery],
        lights: &[Light],
        out: &mut Vec<Vec<ObjectId>>,
    ) -> Result<(), Error> {
        let count = queries.len().min(lights.len());
        let lamps = lights[..count].iter().map(Lamp::new).collect::<Result<Vec<Lamp>, Error>>()?;
        if cameras.iter().any(|camera| camera.pvs().scene != scene.tag()) {
            return Err(Error::ForeignPvs);
        }
        out.resize_with(count, Vec::new);
        let Some(first) = queries.first_mut() else { return Ok(()) };
        let mut shared = std::mem::take(&mut first.shadows);
        shared.pieces.clear();
        let mut known = true;
        for camera in cameras {
            known &= find_pieces(scene, camera.pvs(), camera.sight(scene), &lamps, &mut shared);
        }
        let pieces = std::mem::take(&mut shared.pieces);
        first.shadows = shared;
        for ((query, lamp), out) in queries.iter_mut().zip(&lamps).zip(out) {
            query.shadows.pieces.clear();
            query.shadows.pieces.extend(pieces.iter().filter_map(|piece| lamp.lit(piece)));
            query.cast(scene, lamp, known, out);
        }
        Ok(())
    }

    /// Finds the casters of a light onto the pieces in the scratch memory, or onto anything if
    /// those are not `known`.
    fn cast(&mut self, scene: &Scene, lamp: &Lamp, known: bool, out: &mut Vec<ObjectId>) {
        out.clear();
        let mut scratch = std::mem::take(&mut self.shadows);
        let pieces = &scratch.pieces;
        match (known, lamp.view_of(pieces)) {
            (false, _) => out.extend_from_slice(self.run(scene, &lamp.whole_view()).visible()),
            (true, None) => self.run_nothing(scene),
            (true, Some(view)) if matches!(self.method(), Method::Point(_)) => {
                let extras = Extras { receivers: Some(pieces), ..Extras::default() };
                out.extend_from_slice(self.run_with(scene, &view, extras).visible());
            }
            (true, Some(view)) => {
                mask(scene, &view, pieces, &mut scratch.mask);
                let found = self.run(scene, &view).visible();
                out.extend(found.iter().filter(|id| may_shade(&scratch.mask, scene, id.slot())));
            }
        }
        self.shadows = scratch;
    }
}

/// Buffers of a light's view that hide all that lies before no piece.
fn mask(scene: &Scene, view: &View, pieces: &[Block], buffers: &mut OcclusionBuffers) {
    buffers.begin(view, &pitch(scene, &PointOptions::default()));
    buffers.keep_before(pieces, view.is_ordered());
}

/// Whether an object may come before a piece.
fn may_shade(mask: &OcclusionBuffers, scene: &Scene, slot: Slot) -> bool {
    let object = scene.object(slot);
    if let Some(volume) = object.unreported_volume() {
        return !mask.hides(&mask.relative(volume));
    }
    let body = object.bounds().kind().outer(mask.origin(), mask.uncertainty());
    let target = Target::new(&body, mask.direction());
    scene.is_unlocated(slot) || mask.test(&target, &mut FaceTarget::default()) == Verdict::Visible
}
