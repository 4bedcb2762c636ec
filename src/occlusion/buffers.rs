//! The occlusion buffers of one view.

use std::f64::consts::FRAC_PI_2;

use casca_slots::Slot;
use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::body::Body;
use crate::geometry::polytope::Part;
use crate::geometry::{Block, Room};
use crate::grid::side::Side;
use crate::numeric::occlusion::{MIDDLE_DEPTH, NEAREST_IN_REACHES};
use crate::occlusion::face::{Face, Rect};
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pitch::Pitch;
use crate::occlusion::solid::Solid;
use crate::occlusion::surface::projector::Viewpoint;
use crate::occlusion::surface::scratch::SurfaceScratch;
use crate::occlusion::target::{FaceTarget, Target};
use crate::view::{Origin, View};

/// A side of a view across parallel rays whose cosine with them is less than this serves as the
/// first axis of the plane.
const ACROSS: f64 = 1e-3;

/// The answer to a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Hidden,
    Visible,
}

/// The number in [`Side::ALL`] of the side of a cube around the origin that the ray to a point
/// passes.
#[inline]
fn side_through(point: DVec3) -> usize {
    let size = point.abs();
    let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
    2 * axis + usize::from(point[axis] < 0.0)
}

/// The buffers of one view: the sides of a cube around the eye, or one plane for parallel rays.
///
/// [`OcclusionBuffers::begin`] clears them for a view. Occluders are then drawn and targets tested
/// in any order: drawing only ever hides more. All coordinates are relative to
/// [`OcclusionBuffers::origin`].
#[derive(Debug, Clone, Default)]
pub(crate) struct OcclusionBuffers {
    faces: Vec<FaceBuffer>,
    /// Memory for the one that is drawn.
    solid: Solid,
    surfaces: SurfaceScratch,
    origin: DVec3,
    error: f64,
    room: Room,
    direction: Option<DVec3>,
    nearest: f64,
    /// Surfaces are cut at this depth: nothing nearer is drawn.
    limit: f64,
    /// Along each face.
    pixels: i64,
}

impl OcclusionBuffers {
    /// Clears the windows that a view looks through.
    pub(crate) fn begin(&mut self, view: &View, pitch: &Pitch) {
        self.room = if view.eye().is_some() { *view.room() } else { Room::NONE };
        self.limit = pitch.nearest * 0.5;
        // Without planes the windows are wide enough for every target.
        let reaches = if view.planes.is_empty() { 0.0 } else { NEAREST_IN_REACHES };
        self.nearest = pitch.nearest.max(reaches * self.reach());
        let pitch = &Pitch { nearest: self.nearest, ..*pitch };
        let wanted = self.set_origin(view, pitch);
        self.faces.truncate(wanted.len());
        for (i, face) in wanted.into_iter().enumerate() {
            match self.faces.get_mut(i) {
                Some(buffer) => buffer.set_face(face),
                None => self.faces.push(FaceBuffer::new(face)),
            }
        }
        let origin = self.origin;
        let windows: SmallVec<[Option<Rect>; 6]> =
            self.faces.iter_mut().map(|b| b.set_frustum(view, origin, pitch)).collect();
        let widest = windows.iter().flatten().fold(0f64, |w, r| w.max(r.u1 - r.u0).max(r.v1 - r.v0));
        let pixels = pitch.pixels_of_face(widest, self.direction.is_some());
        for (buffer, window) in self.faces.iter_mut().zip(windows) {
            buffer.clear(window, pixels);
        }
        self.pixels = pixels;
    }

    /// Takes over what other buffers hide. They may be drawn to, but tests find no single occluders
    /// in them: refinement and tests of single points need the buffers themselves.
    pub(crate) fn copy_coverage(&mut self, from: &Self) {
        (self.origin, self.error, self.room) = (from.origin, from.error, from.room);
        (self.direction, self.nearest, self.limit) = (from.direction, from.nearest, from.limit);
        self.pixels = from.pixels;
        self.faces.truncate(from.faces.len());
        for (i, face) in from.faces.iter().enumerate() {
            if self.faces.len() == i {
                self.faces.push(FaceBuffer::new(*face.face()));
            }
            self.faces[i].copy_coverage(face);
        }
    }

    /// The average angle of a pixel, around an eye. Narrow views have finer pixels than the options
    /// ask for.
    pub(crate) fn pixel_angle(&self) -> f64 {
        FRAC_PI_2 / self.pixels as f64
    }

    /// Puts the origin where the rays of a view start. Returns the faces that they pass.
    fn set_origin(&mut self, view: &View, pitch: &Pitch) -> SmallVec<[Face; 6]> {
        match view.origin {
            Origin::Eye { at, error } => {
                (self.origin, self.error, self.direction) = (at, error, None);
                Side::ALL.iter().map(Face::side).collect()
            }
            Origin::Direction(d) => {
                (self.origin, self.error, self.direction) =
                    (pitch.middle - d * (MIDDLE_DEPTH * pitch.radius), 0.0, Some(d));
                // Across the rays, along one of the view's own sides.
                let side = view.planes.iter().map(|p| p.normal).find(|n| n.dot(d).abs() < ACROSS);
                let right =
                    side.map_or_else(|| d.any_orthonormal_vector(), |n| (n - d * n.dot(d)).normalize());
                SmallVec::from_iter([Face::across(d, right, pitch.radius)])
            }
        }
    }

    /// The faces that the view looks through.
    #[inline]
    pub(crate) fn faces(&self) -> impl Iterator<Item = &FaceBuffer> {
        self.faces.iter().filter(|b| b.is_active())
    }

    /// The origin of the rays: the eye, or a point before the scene.
    pub(crate) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The direction of parallel rays.
    pub(crate) fn direction(&self) -> Option<DVec3> {
        self.direction
    }

    /// The eye may lie this far from the origin, in any direction.
    pub(crate) fn uncertainty(&self) -> f64 {
        self.error * 3f64.sqrt()
    }

    /// The eye may go this far from its place.
    pub(crate) fn reach(&self) -> f64 {
        self.room.radius()
    }

    /// Where the eye may go, around its place.
    pub(crate) fn room(&self) -> &Room {
        &self.room
    }

    /// How surfaces are seen.
    pub(crate) fn viewpoint(&self) -> Viewpoint {
        Viewpoint { origin: self.origin, limit: self.limit, room: self.room }
    }

    /// The faces that the view looks through, and the memory for drawing surfaces.
    pub(crate) fn surfaces_mut(&mut self) -> (impl Iterator<Item = &mut FaceBuffer>, &mut SurfaceScratch) {
        (self.faces.iter_mut().filter(|b| b.is_active()), &mut self.surfaces)
    }

    /// The memory for drawing surfaces.
    pub(crate) fn surfaces(&self) -> &SurfaceScratch {
        &self.surfaces
    }

    /// A box in world units as every eye sees it that may be the view's: relative to the origin.
    pub(crate) fn relative(&self, block: &Block) -> Block {
        let grow = self.uncertainty();
        Block { min: block.min - self.origin - grow, max: block.max - self.origin + grow }
    }

    /// A box around all places from which an eye that goes as far as the reach would see a box, in
    /// space that stays: rays that miss it keep farther than the reach from the box. Both are
    /// relative to the origin.
    pub(crate) fn within_reach(&self, block: &Block) -> Block {
        let half = self.room.half();
        Block { min: block.min - half, max: block.max + half }
    }

    /// Hides everything that no ray of the view passes on its way to one of some boxes, given in
    /// world units: what lies beside all of them, and what lies beyond.
    pub(crate) fn keep_before(&mut self, receivers: &[Block], ordered: bool) {
        let mut faces = std::mem::take(&mut self.faces);
        for face in faces.iter_mut().filter(|face| face.is_active()) {
            face.keep_before(receivers.iter().map(|block| self.relative(block)), ordered);
        }
        self.faces = faces;
    }

    /// Draws a convex occluder. Returns whether it hides more than before; `None` if the eye is in
    /// it or too close to tell.
    ///
    /// `owner` is the object that it belongs to: refinement never lets an object be hidden by its
    /// own occluder.
    pub(crate) fn draw_body(&mut self, body: &Body, owner: Slot) -> Option<bool> {
        self.solid.set_body(body, self.direction, &self.room).then(|| self.draw_solid(owner))
    }

    /// As [`OcclusionBuffers::draw_body`], for a solid inside a shell ([`Solid::set_shell`]).
    pub(crate) fn draw_shell(&mut self, part: &Part, beyond: f64, owner: Slot) -> Option<bool> {
        self.solid.set_shell(part, beyond, self.direction, &self.room).then(|| self.draw_solid(owner))
    }

    fn draw_solid(&mut self, owner: Slot) -> bool {
        let mut changed = false;
        for buffer in self.faces.iter_mut().filter(|b| b.is_active()) {
            changed |= buffer.draw(&self.solid, owner);
        }
        changed
    }

    /// Whether every pixel of the rectangles around a box is covered nearer than it.
    pub(crate) fn hides(&self, block: &Block) -> bool {
        !self.is_close(block) && self.faces().all(|b| b.hides_block(block))
    }

    /// Whether every pixel that a target may touch is covered nearer than it.
    ///
    /// `on_face` is memory for the target as each face sees it.
    pub(crate) fn test(&self, target: &Target, on_face: &mut FaceTarget) -> Verdict {
        if self.is_close(target.bounds()) {
            return Verdict::Visible;
        }
        let seen = self.faces().any(|b| target.on_face(b.face(), on_face) && b.sees(on_face));
        if seen { Verdict::Visible } else { Verdict::Hidden }
    }

    /// Whether a point lies in a pixel that does not hide it: then no target that contains it is
    /// hidden.
    pub(crate) fn leaves_open(&self, point: DVec3) -> bool {
        self.faces().any(|b| b.leaves_open(b.face().local(point)))
    }

    /// Whether a point of a target lies in an open pixel inside the frustum, before all patches that
    /// may hide it and all convex occluders but those of its owner: then any examination finds it.
    pub(crate) fn shows(&self, point: DVec3, owner: Slot) -> bool {
        let shows = |b: &FaceBuffer| b.is_active() && b.shows(b.face().local(point), owner);
        if self.direction.is_some() {
            return self.faces.iter().any(shows);
        }
        self.faces.get(side_through(point)).is_some_and(shows)
    }

    /// Notes around which directions nothing was drawn so far. Costs the tiles.
    pub(crate) fn note_untouched(&mut self) {
        self.faces.iter_mut().filter(|face| face.is_active()).for_each(FaceBuffer::note_untouched);
    }

    /// Whether nothing was drawn around the directions to a box in world units when that was noted: it
    /// lies before all occluders.
    pub(crate) fn is_untouched(&self, block: &Block) -> bool {
        let relative = self.relative(block);
        !self.is_close(&relative) && self.faces().all(|b| b.is_untouched(&relative))
    }

    /// Whether that holds for a point, relative to the eye. No point along parallel rays is found so.
    #[inline]
    pub(crate) fn is_untouched_at(&self, point: DVec3) -> bool {
        let is_untouched = |b: &FaceBuffer| b.is_active() && b.is_untouched_at(b.face().local(point));
        self.direction.is_none() && self.faces.get(side_through(point)).is_some_and(is_untouched)
    }

    /// Whether the buffers say nothing about a box: it reaches so close to the eye that directions
    /// to it are not told apart, or, along parallel rays, beyond the plane around the scene.
    pub(crate) fn is_close(&self, block: &Block) -> bool {
        if self.direction.is_some() {
            return self.faces.first().is_none_or(|buffer| buffer.face().leaves(block));
        }
        let distance = block.min.max(-block.max).max_element();
        // A distance that is not a number is close.
        distance.is_nan() || distance <= self.nearest
    }

    /// Whether all pixels are covered for targets farther than `distance` along some axis.
    pub(crate) fn closed(&self, distance: f64) -> bool {
        let distance = distance - self.uncertainty();
        // Nearer targets may be in sight beside the windows.
        if distance.is_nan() || distance <= self.nearest {
            return false;
        }
        self.faces().all(|b| b.is_closed(distance))
    }

    /// Number of pixels of all windows.
    pub(crate) fn pixels(&self) -> u64 {
        self.faces().map(FaceBuffer::pixel_count).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn pitch(pixels: f64) -> Pitch {
        Pitch { pixels, least: 0.0, nearest: 1e-3, radius: 40.0, middle: DVec3::ZERO }
    }

    #[test]
    fn before_all_that_was_drawn_lies_what_is_shown() {
        let (mut random, mut buffers) = (Random::new(5), OcclusionBuffers::default());
        buffers.begin(&View::omnidirectional(glam::Vec3::ZERO).unwrap(), &pitch(128.0));
        let wall = Block { min: DVec3::new(3.0, -4.0, -1.5), max: DVec3::new(4.0, 1.0, 2.0) };
        buffers.draw_body(&Body::Block(wall), Slot::new(0)).unwrap();
        buffers.note_untouched();
        let mut found = [0; 3];
        for _ in 0..20_000 {
            let (p, half) = (random.point(20.0), random.point(2.0).abs());
            let (of_box, at) =
                (buffers.is_untouched(&Block { min: p - half, max: p + half }), buffers.is_untouched_at(p));
            let shown = buffers.shows(p, Slot::new(1));
            assert!(shown || !at && !of_box, "{p} {half}");
            found = [found[0] + u32::from(of_box), found[1] + u32::from(at), found[2] + u32::from(shown)];
        }
        assert!(
            found[0] > 12_000 && found[1] > 15_000 && (found[1]..19_900).contains(&found[2]),
            "{found:?}"
        );
    }
}
