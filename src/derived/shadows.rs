//! Shadow casters of one directional light: the objects that may cast a shadow onto visible ones.
//!
//! Let `p` be a point that the receivers' view sees, of an object of their set, and let something block
//! the light to `p`. Let `q` be the first point of any object's geometry on the light's ray to `p`, and `A` its
//! object: all of them are closed and bounded, so there is a first. Then `A` is among the casters:
//!
//! 1. `p` lies in the bounds of a receiver and inside the receivers' view. Bounds are cut into *pieces*, and those
//!    kept that the view may see, rounded outwards: one of them contains `p`. A receiver whose motion goes unreported
//!    lies in its volume; where there is none, every place is taken for a receiver's.
//! 2. The light's view is bounded by a rectangle across the light around all pieces and by a plane behind
//!    the farthest, and open towards the light. So it contains `p` and all of the ray before it.
//! 3. Every occluder lies inside geometry. None lies on the ray before `q`, so the light sees `q`, and its
//!    query, being conservative, finds `A`. That is so whichever occluders it draws, for
//!    volumes of hidden objects (it finds the objects in them as if those were in sight) and for objects without occluders
//!    (their points are points of geometry). Rays start infinitely far away: outside of every occluder
//!    (so `eye_in_occluder` has no meaning here) and before every plane of the view. As no plane faces the
//!    light, no occluder loses its front to one and none is left out for that.
//! 4. A coarse depth buffer across the light stores the farthest depth of the pieces that touch each pixel.
//!    `p` and `q` project to one point, so `A` touches the pixel of `p`, and its nearest point is no deeper there
//!    than `p`.
//!
//! So on every ray the light stops at the same point if only casters are drawn: objects left out behind
//! that point are in shadow already. `A` can be the receiver's own object: an object in the light shadows itself.
//!
//! Rounding. All extents are widened by [`LIGHT_EXTENT`]. Pixels need no margin: their number never falls
//! as the coordinate grows, also as rounded, so extents that overlap share a pixel.

use std::collections::VecDeque;

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::error::{Error, finite3};
use crate::geometry::Block;
use crate::geometry::extent::Extent;
use crate::geometry::plane::HalfSpace;
use crate::id::ObjectId;
use crate::numeric::scene::{LEAST_LIGHT_WIDTH, LIGHT_EXTENT};
use crate::pvs::Pvs;
use crate::query::Query;
use crate::query::receivers::ReceiverScratch;
use crate::scene::{Object, Scene};
use crate::view::View;

/// Pixels along each side of the depth buffer.
const PIXELS: usize = 256;

/// The bounds of a receiver are cut into at most this many pieces, with at most this many cuts, none along edges
/// shorter than this many cells.
const MOST_PIECES: usize = 64;
const MOST_CUTS: usize = 512;
const SHORTEST: f64 = 2.0;

/// The light's frame. Boxes in it have z along the light.
struct Light {
    axes: [DVec3; 3],
}

impl Light {
    fn new(along: DVec3) -> Self {
        let (right, up) = along.any_orthonormal_pair();
        Self { axes: [right, up, along] }
    }

    /// An extent as a box in the light's frame, widened by [`LIGHT_EXTENT`].
    fn widened(&self, extent: Extent) -> Block {
        let reach = extent.half + LIGHT_EXTENT * extent.greatest;
        Block { min: extent.middle - reach, max: extent.middle + reach }
    }

    fn block(&self, b: &Block) -> Block {
        self.widened(b.extent(&self.axes))
    }

    /// Where an object is: `None` if it may be anywhere.
    fn object(&self, object: &Object) -> Option<Block> {
        match object.unreported_volume() {
            Some(volume) => Some(self.block(volume)),
            None => (!object.is_unlocated()).then(|| self.widened(object.bounds().kind().extent(&self.axes))),
        }
    }

    /// Parallel rays inside the rectangle of a box and no deeper than it.
    fn view(&self, reach: &Block) -> View {
        let [right, up, along] = self.axes;
        let sides = [
            (right, -reach.min.x),
            (-right, reach.max.x),
            (up, -reach.min.y),
            (-up, reach.max.y),
            (-along, reach.max.z),
        ];
        let planes = sides.into_iter().map(|(normal, offset)| HalfSpace { normal, offset }).collect();
        View::parallel(along, planes)
    }
}

/// The common part; `None` if there is none.
fn common_part(a: &Block, b: &Block) -> Option<Block> {
    let (min, max) = (a.min.max(b.min), a.max.min(b.max));
    // In doubt (NaN) there is one.
    (!min.cmpgt(max).any()).then_some(Block { min, max })
}

/// Cuts the part of a box that a view may see into pieces, and gives each to `out`.
fn cut(block: &Block, view: &View, shortest: f64, queue: &mut VecDeque<Block>, mut out: impl FnMut(&Block)) {
    queue.clear();
    queue.push_back(*block);
    let (mut whole, mut cuts) = (0, 0);
    while let Some(piece) = queue.pop_front() {
        if !view.may_see_volume(&piece) {
            continue;
        }
        let edges = piece.max - piece.min;
        let axis = edges.max_position();
        let enough = whole + queue.len() + 1 >= MOST_PIECES || cuts >= MOST_CUTS;
        if enough || edges[axis] <= shortest {
            whole += 1;
            out(&piece);
            continue;
        }
        cuts += 1;
        let middle = (piece.min[axis] + piece.max[axis]) * 0.5;
        let (mut low, mut high) = (piece, piece);
        (low.max[axis], high.min[axis]) = (middle, middle);
        queue.extend([low, high]);
    }
}

/// The farthest depths of receivers, across the light.
struct DepthBuffer<'a> {
    depths: &'a mut Vec<f64>,
    reach: Block,
    per_unit: [f64; 2],
}

impl<'a> DepthBuffer<'a> {
    fn new(depths: &'a mut Vec<f64>, reach: Block) -> Self {
        depths.clear();
        depths.resize(PIXELS * PIXELS, f64::NEG_INFINITY);
        // Of a rectangle without width all is one pixel.
        let per_unit = [0, 1].map(|i| PIXELS as f64 / (reach.max[i] - reach.min[i]).max(LEAST_LIGHT_WIDTH));
        Self { depths, reach, per_unit }
    }

    /// The pixels that an extent touches, both ends included.
    fn pixels(&self, b: &Block, axis: usize) -> (usize, usize) {
        // Never falls as the coordinate grows, whatever is rounded. NaN becomes 0.
        let pixel =
            |v: f64| ((v - self.reach.min[axis]) * self.per_unit[axis]).min(PIXELS as f64 - 1.0) as usize;
        (pixel(b.min[axis]), pixel(b.max[axis]))
    }

    fn rows(&self, b: &Block) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
        let ((x0, x1), (y0, y1)) = (self.pixels(b, 0), self.pixels(b, 1));
        (y0..=y1).map(move |y| y * PIXELS + x0..y * PIXELS + x1 + 1)
    }

    /// Something that receives reaches as deep as a box wherever that is.
    fn receive(&mut self, b: &Block) {
        for row in self.rows(b) {
            self.depths[row].iter_mut().for_each(|d| *d = d.max(b.max.z));
        }
    }

    /// Whether something in a box may come before a receiver.
    fn may_shade(&self, b: &Block) -> bool {
        common_part(b, &Block { min: self.reach.min.with_z(f64::NEG_INFINITY), ..self.reach }).is_some()
            && self.rows(b).any(|row| self.depths[row].iter().any(|&d| d >= b.min.z))
    }
}

impl Query {
    /// Finds the objects that may cast a shadow of a directional light onto visible ones: those to draw into its shadow
    /// map. Conservative: with these casters alone, every point of `receivers` that their view sees is in the shadow
    /// of something if and only if it is with all objects.
    ///
    /// `light` is the direction in which light travels, of any length. `receivers` is the PVS of the camera, just found
    /// on `scene`, by any method: objects that a method shows in vain may add casters. Only what lies inside its view
    /// receives. `out` is emptied first; casters come roughly as the light reaches them, as in [`Pvs::visible`].
    ///
    /// This is a query of its own, the light's: [`Query::pvs`] then is the set of objects before receivers that
    /// the light sees, and its method and options are those of that view (with [`crate::Method::Frustum`] and
    /// [`crate::Method::Cell`] casters in the shadow of others are kept). Give that PVS to [`Scene::end_frame`], too, if
    /// casters should count as seen: each frame costs less if dynamic ones that the camera does not see stay out of
    /// temporal bounding volumes. Call this before `end_frame`.
    ///
    /// - Every occluder is taken to cast a shadow. An object that hides but is not drawn into the shadow map must
    ///   have no occluder.
    /// - Casters may lie far before the objects that they shade: clamp depths to the near plane of the shadow map.
    /// - A receiver that the light reaches is a caster, too: it shadows itself.
    /// - Objects that go unreported while hidden ([`crate::Reports::OnExpiry`]) may be casters: their places are
    ///   then needed. If one of unknown place is a receiver, all objects that the light reaches are casters.
    /// - A renderer whose light runs in another direction by rounding to single precision sees shadows
    ///   shifted by about 1e-7 of the distance between caster and receiver; so may be the edges of the shadows of objects left out.
    /// - After an aggressive query ([`Query::run_aggressive`]), the objects that it lost get no shadows; all others do.
    ///
    /// Costs a query of the light's view, up to 64 boxes for each receiver, and the pixels of a buffer of 256x256
    /// that they cover.
    ///
    /// ```
    /// use casca::{Aabb, GridSpec, ObjectDesc, Query, Scene, View};
    /// use glam::camera::rh::{proj::directx::perspective, view::look_to_mat4};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(64) })?;
    /// let mut solid = |min, max| {
    ///     let b = Aabb::new(min, max);
    ///     scene.insert(ObjectDesc::fixed(b).occluder(b))
    /// };
    /// let ground = solid(Vec3::ZERO, Vec3::new(64.0, 1.0, 64.0))?;
    /// let tower = solid(Vec3::new(28.0, 1.0, 58.0), Vec3::new(36.0, 30.0, 60.0))?;
    /// let eye = Vec3::new(32.0, 3.0, 50.0);
    /// let matrix = perspective(1.0, 1.5, 0.1, 200.0) * look_to_mat4(eye, Vec3::NEG_Z, Vec3::Y);
    /// let (mut camera, mut sun) = (Query::new(), Query::new());
    /// let pvs = camera.run(&scene, &View::perspective(eye, matrix)?);
    /// assert!(pvs.contains(ground) && !pvs.contains(tower), "it stands behind the camera");
    /// let mut casters = Vec::new();
    /// sun.shadow_casters(&scene, pvs, Vec3::new(0.0, -1.0, -1.0), &mut casters)?;
    /// assert!(casters.contains(&tower), "its shadow falls before the camera");
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses a direction that is zero or not finite, and a PVS of another scene. The query and `out` are then left
    /// as they were.
    pub fn shadow_casters(
        &mut self,
        scene: &Scene,
        receivers: &Pvs,
        light: Vec3,
        out: &mut Vec<ObjectId>,
    ) -> Result<(), Error> {
        const WHAT: &str = "the direction of the light";
        finite3(WHAT, light)?;
        let along = light.as_dvec3().try_normalize().ok_or(Error::NoDirection { what: WHAT })?;
        if receivers.scene != scene.tag() {
            return Err(Error::ForeignPvs);
        }
        let light = Light::new(along);
        out.clear();
        let mut scratch = std::mem::take(&mut self.shadows);
        let known = find_pieces(scene, receivers, &light, &mut scratch);
        let reach = scratch
            .pieces
            .iter()
            .copied()
            .reduce(|a, b| Block { min: a.min.min(b.min), max: a.max.max(b.max) });
        match (known, reach) {
            (false, _) => {
                out.extend_from_slice(self.run(scene, &View::parallel(along, SmallVec::new())).visible());
            }
            (true, None) => self.run_nothing(scene),
            (true, Some(reach)) => {
                let mut buffer = DepthBuffer::new(&mut scratch.depths, reach);
                scratch.pieces.iter().for_each(|piece| buffer.receive(piece));
                let found = self.run(scene, &light.view(&reach)).visible();
                let may_shade = |id: &ObjectId| {
                    light.object(scene.object(id.slot)).is_none_or(|extent| buffer.may_shade(&extent))
                };
                out.extend(found.iter().filter(|id| may_shade(id)));
            }
        }
        self.shadows = scratch;
        Ok(())
    }
}

/// Finds the extents of all pieces of receivers; false if a receiver may be anywhere.
fn find_pieces(scene: &Scene, receivers: &Pvs, light: &Light, scratch: &mut ReceiverScratch) -> bool {
    scratch.pieces.clear();
    let Some(view) = &receivers.view else { return true };
    let shortest = SHORTEST * scene.grid().cell_size();
    for &id in receivers.visible() {
        let Ok(object) = scene.find(id) else { continue };
        let Some(whole) = light.object(object) else { return false };
        let block = object.unreported_volume().copied().unwrap_or_else(|| object.bounds().block());
        let pieces = &mut scratch.pieces;
        cut(&block, view, shortest, &mut scratch.cutting, |piece| {
            // Points of the object lie in both extents.
            pieces.extend(common_part(&light.block(piece), &whole));
        });
    }
    true
}
