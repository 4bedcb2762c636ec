//! Drawing surfaces of triangles: winding numbers of outlines, less the pixels that outlines touch.
//!
//! If no edge of a patch's outline touches a pixel, the patch has one winding number there, that of
//! the pixel's middle: if it is not zero, the patch covers all of the pixel, at the depth of the
//! far side of its slab. Patches are drawn in batches, and on each face as components of patches
//! that share sides. Pixels that only shared sides (seams) touch are covered if the winding numbers
//! of the component's patches do not sum to zero at their middles, at the depth of the farthest
//! patch there. The sign of a patch's winding numbers is free: turning all patches to the eye keeps
//! folds from cancelling.
//!
//! If the eye may go some way (a reach), the sides of a component that no two of its patches share
//! are its rim. Pixels with rays within the reach of the rim stay open, and are marked before the
//! component covers any ([`rim`]). Only patches that are wholly turned to the eye are joined then.
//!
//! A query draws in two passes. A [`drawable`] is a patch to be drawn; [`projector`] puts its sides
//! on the face, once: [`kept`] keeps them. In the first pass, [`components`] draws the patches of a
//! batch in the pixels of the face. In the second one, [`local`] draws those that reach into 4x4
//! pixels which leave objects undecided, eight times as fine, from the edges that come [`near`]. In
//! both, patches are [`joined`], [`raster`] finds the pixels, and [`sheet`] covers them at the
//! depth that [`back`] gives.
//!
//! Edges are widened by [`EDGE`](crate::numeric::occlusion::EDGE) pixels, by their rounding, and by
//! the slack of the outline.

pub(crate) mod back;
pub(crate) mod batch;
pub(crate) mod by_patch;
pub(crate) mod components;
pub(crate) mod deep;
pub(crate) mod drawable;
mod joined;
pub(crate) mod kept;
pub(crate) mod local;
pub(crate) mod near;
pub(crate) mod projector;
pub(crate) mod raster;
mod rim;
pub(crate) mod scratch;
pub(crate) mod sheet;
mod sides;

use smallvec::SmallVec;

use crate::numeric::occlusion::{CLEARANCE, REACH_CLEARANCE};
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::surface::batch::Batch;
use crate::occlusion::surface::components::draw_surfaces;
use crate::occlusion::surface::projector::Viewpoint;
use crate::occlusion::surface::scratch::{FaceScratch, SurfaceScratch};
use crate::simd::vectorized;

/// Fewer patches, counted on each face that sees them, are drawn faster than another thread awakes.
const WORTH_SHARING: usize = 64;

/// A face and the memory to draw on it.
type OnFace<'a> = (&'a mut FaceBuffer, &'a mut FaceScratch);

/// Draws a batch on all faces by several threads. This one begins with the face that sees most.
#[cfg(feature = "rayon")]
fn on_each_face(
    batch: &Batch,
    faces: SmallVec<[OnFace; 6]>,
    draw: &(impl Fn(usize, &mut FaceBuffer, &mut FaceScratch) + Sync),
) {
    let mut counts = [0; 6];
    batch.sights.iter().for_each(|sight| counts[sight.face as usize % 6] += 1);
    let mut faces: SmallVec<[(usize, OnFace); 6]> = faces.into_iter().enumerate().collect();
    faces.sort_by_key(|&(face, _)| std::cmp::Reverse(counts[face % 6]));
    rayon::in_place_scope(|scope| {
        let mut faces = faces.into_iter();
        let first = faces.next();
        for (face, (buffer, scratch)) in faces {
            scope.spawn(move |_| draw(face, buffer, scratch));
        }
        if let Some((face, (buffer, scratch))) = first {
            draw(face, buffer, scratch);
        }
    });
}

/// Draws a batch on all faces.
#[cfg(not(feature = "rayon"))]
fn on_each_face(
    _: &Batch,
    faces: SmallVec<[OnFace; 6]>,
    draw: &impl Fn(usize, &mut FaceBuffer, &mut FaceScratch),
) {
    faces.into_iter().enumerate().for_each(|(face, (buffer, scratch))| draw(face, buffer, scratch));
}

impl OcclusionBuffers {
    /// Draws patches together: outlines that two of them share leave no seam. `patches` is greater
    /// than all their numbers; `listed` tells whether they are listed by place, `shared` whether
    /// several threads may draw. [`OcclusionBuffers::useful_patches`] then tells which hide more
    /// than before. Returns the blocks of pixels that it went through.
    pub(crate) fn draw_surfaces(&mut self, batch: &Batch, patches: usize, listed: bool, shared: bool) -> u64 {
        let viewpoint = self.viewpoint();
        let (buffers, SurfaceScratch { ids, faces, useful }) = self.surfaces_mut();
        for d in &batch.drawables {
            ids.set(d.numbers(), d.id, patches);
        }
        let mut buffers: SmallVec<[&mut FaceBuffer; 6]> = buffers.collect();
        faces.resize_with(buffers.len().max(faces.len()), FaceScratch::default);
        let ids = &*ids;
        let draw = |face: usize, buffer: &mut FaceBuffer, scratch: &mut FaceScratch| {
            let sights = batch.sights.iter().filter(|sight| sight.face as usize == face).copied();
            let drawables = &batch.drawables;
            let memory = (ids, scratch);
            vectorized!(simd => draw_surfaces(simd, buffer, drawables, sights, viewpoint, listed, memory));
        };
        let on_faces = buffers.iter_mut().map(|buffer| &mut **buffer).zip(faces.iter_mut());
        if shared && batch.sights.len() >= WORTH_SHARING {
            on_each_face(batch, on_faces.collect(), &draw);
        } else {
            on_faces.enumerate().for_each(|(face, (buffer, scratch))| draw(face, buffer, scratch));
        }
        useful.clear();
        faces[..buffers.len()].iter().for_each(|face| useful.extend(&face.useful));
        faces[..buffers.len()].iter().map(|face| face.blocks).sum()
    }

    /// Forgets the patches of the last query: the numbers of first drawing begin anew.
    pub(crate) fn begin_patches(&mut self) {
        self.surfaces_mut().1.begin_query();
    }

    /// The indices of the patches of the last batch that hid more than before. Some may be named
    /// twice.
    pub(crate) fn useful_patches(&self) -> &[u32] {
        &self.surfaces().useful
    }

    /// How far a patch must be from the eye to be drawn, if its points are known to `slack`.
    ///
    /// Farther patches are neither cut at the near limit nor widened without bound: where a
    /// straight edge is less deep than twice the slack, neither it nor the chain that it replaces
    /// reaches into the face.
    pub(crate) fn clearance(&self, slack: f64) -> f64 {
        let Viewpoint { limit, room, .. } = self.viewpoint();
        CLEARANCE * (limit + slack) + REACH_CLEARANCE * room.radius()
    }
}
