//! Drawing surfaces of triangles, patch by patch.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::mesh::surface::{Patch, Surface};
use crate::numeric::query::{CUT_REGION, FRONT_SINE, SLAB};
use crate::occlusion::surface::drawable::Drawable;
use crate::query::point::Walk;
use crate::query::point::scratch::DrawnPatch;
use crate::walk::Shells;

/// Patches and groups are drawn from this radius on, in pixels. Smaller ones hide next to nothing: the pixels that
/// their outlines touch do not count.
const SMALLEST_PATCH: f64 = 4.0;

/// A group is drawn as one if its slab is at most this share as thick as the eye is away from it, or all of it that
/// share as large as its distance.
const THIN: f64 = 0.35;

/// A box around a box as it is placed.
fn placed_block(block: &Block, placement: Option<&Placement>) -> Block {
    let Some(p) = placement else { return *block };
    let (center, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
    let m = p.affine.matrix3;
    let reach = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z + p.error;
    let center = p.affine.transform_point3(center);
    Block { min: center - reach, max: center + reach }
}

/// The slab of a patch in world units.
struct Slab {
    normal: DVec3,
    lo: f64,
    hi: f64,
    /// Points may be off by this much, for the eye and for the placement.
    error: f64,
    /// How far the triangles may be from the outline.
    slack: f64,
}

impl<'a> Walk<'a> {
    /// Lists an object's surface for drawing, by the shell that it begins in.
    pub(super) fn list_surface(&mut self, slot: u32, surface: &Surface, placement: Option<&Placement>) {
        if let Some(whole) = surface.patches.first() {
            let shell = self.shell_of(&placed_block(&whole.block(), placement));
            self.wait(shell, slot, 0);
        }
    }

    /// Lists a patch for drawing, or for drawing in parts, once shell `shell` is reached.
    fn wait(&mut self, shell: usize, slot: u32, patch: u32) {
        let waiting = &mut self.scratch.waiting;
        if waiting.len() <= shell {
            waiting.resize_with(shell + 1, Vec::new);
        }
        waiting[shell].push((slot, patch));
    }

    /// The shell of bricks around the eye that a box begins in.
    fn shell_of(&self, block: &Block) -> usize {
        let Some(&Shells { cell: brick, farthest, .. }) = self.around.as_ref() else { return 0 };
        let (lo, hi) = self.grid.cover(block.min, block.max);
        (lo - brick).max(brick - hi).max_element().clamp(0, farthest.max(0)) as usize
    }

    /// Whether a box is smaller than some pixels.
    pub(super) fn is_small(&self, b: &Block, pixels: f64) -> bool {
        let buffers = &self.scratch.buffers;
        let (eye, pixel) = (buffers.origin(), f64::from(self.options.pixel_degrees).to_radians());
        let distance = (b.min - eye).max(eye - b.max).max(DVec3::ZERO).length();
        buffers.direction().is_none() && (b.max - b.min).length() * 0.5 < pixel * pixels * distance
    }

    /// Draws the visible parts of surfaces that begin up to shell `m`, together.
    pub(super) fn draw_patches(&mut self, m: i32) {
        let mut batch: Vec<Drawable> = Vec::new();
        self.scratch.batches += 1;
        let last = self.scratch.waiting.len().min(m.max(0) as usize + 1);
        for shell in 0..last {
            // Parts of those listed begin in the same shell or later.
            let mut at = 0;
            while let Some(&(slot, patch)) = self.scratch.waiting[shell].get(at) {
                at += 1;
                self.collect(slot, patch, last - 1, &mut batch);
            }
            self.scratch.waiting[shell].clear();
        }
        if batch.is_empty() {
            return;
        }
        self.collect_neighbours(&mut batch);
        self.stats.patches_drawn += batch.len() as u32;
        let changed = self.scratch.buffers.draw_surfaces(&batch, self.scene.seams().patches());
        self.stats.occluders_useful += u32::from(changed);
    }

    /// Appends a patch to a batch, as one or in parts, unless it is small or hidden. Parts that begin beyond shell
    /// `m` wait.
    fn collect(&mut self, slot: u32, whole: u32, m: usize, batch: &mut Vec<Drawable<'a>>) {
        let scene = self.scene;
        let Some(occluder) = scene.object(slot).occluder() else { return };
        let Some(surface) = occluder.surface() else { return };
        let placement = occluder.placement();
        let mut open: SmallVec<[u32; 64]> = SmallVec::from_slice(&[whole]);
        while let Some(number) = open.pop() {
            let patch = &surface.patches[number as usize];
            let around = placed_block(&patch.block(), placement);
            let has_parts = patch.next > number + 1;
            if self.is_small(&around, SMALLEST_PATCH) {
                continue;
            }
            if number != whole {
                let shell = self.shell_of(&around);
                if shell > m {
                    self.wait(shell, slot, number);
                    continue;
                }
            }
            if has_parts && (!self.view.may_see_block(&around) || self.hides(&around)) {
                continue;
            }
            if patch.has_outline()
                && let Some(mut drawable) = self.drawable(slot, number)
                && (!has_parts || self.is_thin(&drawable))
            {
                drawable.id = self.scratch.patches.len() as u32;
                self.scratch.patches.push((slot, number));
                let epoch = self.marks.epoch();
                let drawn = DrawnPatch { epoch, batch: self.scratch.batches, whole: number };
                let numbers = drawable.numbers();
                self.scratch.drawn.fill(numbers, drawn);
                batch.push(drawable);
            } else if has_parts {
                open.extend(surface.parts(number));
            }
        }
    }

    /// Whether a group hides about as much as its parts do: its slab, or the whole of it, is thin compared to its
    /// distance.
    fn is_thin(&self, d: &Drawable) -> bool {
        let (lo, hi) = d.slab;
        let (thickness, height) = (hi - lo, lo.max(-hi));
        let across = (d.block.max - d.block.min).length();
        let distance = match self.scratch.buffers.direction() {
            Some(_) => self.grid.cell_size(),
            None => d.block.min.max(-d.block.max).max(DVec3::ZERO).length(),
        };
        thickness <= THIN * height || across <= THIN * distance
    }

    /// Appends the neighbours of a batch that were drawn before, so that no seam stays between batches.
    fn collect_neighbours(&mut self, batch: &mut Vec<Drawable<'a>>) {
        let (epoch, number) = (self.marks.epoch(), self.scratch.batches);
        for i in 0..batch.len() {
            let first = batch[i].clone();
            for (_, twin) in first.sides() {
                let Some((twin, _)) = twin else { continue };
                let drawn = self.scratch.drawn.get(twin);
                if drawn.epoch != epoch || drawn.batch == number {
                    continue;
                }
                let slot = self.scene.seams().owner(twin);
                let whole = DrawnPatch { batch: number, ..drawn };
                let Some(again) = self.drawable(slot, drawn.whole) else {
                    self.scratch.drawn.fill(twin..twin + 1, whole);
                    continue;
                };
                let numbers = again.numbers();
                self.scratch.drawn.fill(numbers, whole);
                batch.push(Drawable { again: true, ..again });
            }
        }
    }

    /// A patch of an object's surface ready to be drawn, if it can be.
    pub(super) fn drawable(&self, slot: u32, patch: u32) -> Option<Drawable<'a>> {
        let scene = self.scene;
        let occluder = scene.object(slot).occluder()?;
        let (surface, placement) = (occluder.surface()?, occluder.placement());
        let place = scene.seams().place(slot);
        let buffers = &self.scratch.buffers;
        let (eye, unsure) = (buffers.origin(), buffers.uncertainty());
        let own = &surface.patches[patch as usize];
        let world = placed_block(&own.block(), placement);
        let block = Block { min: world.min - eye - unsure, max: world.max - eye + unsure };
        let Slab { normal, lo, hi, error, slack } = placed_slab(own, placement, unsure)?;
        let base = normal.dot(eye);
        let room = error + SLAB * (base.abs() + eye.abs().max_element() + lo.abs().max(hi.abs()));
        let slab = (lo.min(hi) - base - room, lo.max(hi) - base + room);
        if buffers.direction().is_none() {
            let clear = buffers.clearance(error + slack);
            let outside = slab.0 > clear || slab.1 < -clear;
            if !outside && block.min.max(-block.max).max_element() <= clear {
                return None;
            }
        }
        // Unequal scales change the angles in a patch.
        let keeps_angles = placement.is_none_or(|p| p.keeps_angles);
        if surface.front && !(keeps_angles && self.is_front(normal, &block, f64::from(own.sine))) {
            return None;
        }
        // The far side of a closed surface lies behind its near side.
        if surface.outward != 0.0
            && keeps_angles
            && self.is_front(-surface.outward * normal, &block, f64::from(own.sine))
        {
            return None;
        }
        if self.near_plane_cuts_slab(&world, normal, slab, room)
            || buffers.direction().is_some_and(|d| self.view.cuts_front(d, &world))
        {
            return None;
        }
        // How far above the middle of its slab rays start.
        let height = match buffers.direction() {
            Some(d) => -normal.dot(d),
            None => -(slab.0 + slab.1) * 0.5,
        };
        Some(Drawable {
            surface,
            placement,
            patch,
            id: 0,
            number: place.base + patch,
            links: &place.links,
            block,
            normal,
            slab,
            again: false,
            turned: height < 0.0,
            error,
        })
    }

    /// Whether every triangle of a patch is turned to every ray: the directions from its points to the eye differ from
    /// its normal by less than a right angle less the greatest angle of its triangles, whose sine is given.
    fn is_front(&self, normal: DVec3, block: &Block, sine: f64) -> bool {
        let sine = sine + FRONT_SINE;
        match self.scratch.buffers.direction() {
            Some(d) => -normal.dot(d) > sine,
            None => {
                let d = -(block.min + block.max) * 0.5;
                let radius = (block.max - block.min).length() * 0.5;
                normal.dot(d) - radius > sine * (d.length() + radius)
            }
        }
    }

    /// Whether the near plane may cut into a patch: then one sees through it.
    fn near_plane_cuts_slab(&self, world: &Block, normal: DVec3, slab: (f64, f64), room: f64) -> bool {
        let eye = self.scratch.buffers.origin();
        self.cut.iter().any(|(region, around)| {
            let middle = normal.dot((around.min + around.max) * 0.5 - eye);
            let reach = normal.abs().dot((around.max - around.min) * 0.5) * (1.0 + CUT_REGION) + room;
            around.min.cmple(world.max).all()
                && world.min.cmple(around.max).all()
                && middle + reach >= slab.0
                && middle - reach <= slab.1
                && region.may_see_block(world)
        })
    }
}

/// The slab of a patch as it is placed; `None` if the placement has no normals or leaves the range of numbers.
fn placed_slab(patch: &Patch, placement: Option<&Placement>, unsure: f64) -> Option<Slab> {
    let (mut error, mut slack) = (unsure, f64::from(patch.slack));
    let Some(p) = placement else {
        return Some(Slab { normal: patch.normal, lo: patch.lo, hi: patch.hi, error, slack });
    };
    let turned = p.normals? * patch.normal;
    let length = turned.length();
    // The two planes of the slab, by a point of each.
    let at = |h: f64| turned.dot(p.affine.transform_point3(patch.normal * h)) / length;
    let (lo, hi) = (at(patch.lo), at(patch.hi));
    let normal = turned / length;
    if !(normal.is_finite() && lo.is_finite() && hi.is_finite()) {
        return None;
    }
    error += p.error;
    slack *= p.growth;
    Some(Slab { normal, lo, hi, error, slack })
}
