//! Drawing surfaces of triangles, cluster by cluster.

use glam::DVec3;

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::mesh::surface::{Patch, Surface};
use crate::numeric::query::{CUT_REGION, FRONT_SINE, SLAB};
use crate::occlusion::surface::drawable::Drawable;
use crate::query::point::Walk;
use crate::walk::Shells;

/// Patches are drawn from this radius on, in pixels, and clusters of them from that one: a small patch hides
/// nothing alone, but a surface may consist of small ones.
const SMALLEST_PATCH: f64 = 2.0;
const SMALLEST_CLUSTER: f64 = 4.0;

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
    /// Lists the clusters of an object's surface by the shells that they begin in.
    pub(super) fn list_clusters(&mut self, slot: u32, surface: &Surface, placement: Option<&Placement>) {
        for index in 0..surface.clusters.len() as u32 {
            let around = placed_block(&surface.clusters[index as usize].block(), placement);
            let shell = self.shell_of(&around);
            let clusters = &mut self.scratch.clusters;
            if clusters.len() <= shell {
                clusters.resize_with(shell + 1, Vec::new);
            }
            clusters[shell].push((slot, index));
        }
    }

    /// The shell of bricks around the eye that a box begins in.
    fn shell_of(&self, block: &Block) -> usize {
        let Some(&Shells { cell: brick, farthest, .. }) = self.around.as_ref() else { return 0 };
        let (lo, hi) = self.grid.cover(block.min, block.max);
        (lo - brick).max(brick - hi).max_element().clamp(0, farthest.max(0)) as usize
    }

    /// Whether a box is smaller than some pixels.
    fn is_small(&self, b: &Block, pixels: f64) -> bool {
        let buffers = &self.scratch.buffers;
        let (eye, pixel) = (buffers.origin(), f64::from(self.options.pixel_degrees).to_radians());
        let distance = (b.min - eye).max(eye - b.max).max(DVec3::ZERO).length();
        buffers.direction().is_none() && (b.max - b.min).length() * 0.5 < pixel * pixels * distance
    }

    /// Draws the visible clusters of surfaces that begin up to shell `m`, together.
    pub(super) fn draw_clusters(&mut self, m: i32) {
        let mut batch: Vec<Drawable> = Vec::new();
        self.scratch.batches += 1;
        let last = self.scratch.clusters.len().min(m.max(0) as usize + 1);
        for shell in 0..last {
            let mut clusters = std::mem::take(&mut self.scratch.clusters[shell]);
            for (slot, index) in clusters.drain(..) {
                self.collect_cluster(slot, index, &mut batch);
            }
            self.scratch.clusters[shell] = clusters;
        }
        if batch.is_empty() {
            return;
        }
        self.collect_neighbours(&mut batch);
        self.stats.patches_drawn += batch.len() as u32;
        let changed = self.scratch.buffers.draw_surfaces(&batch, self.scene.seams().patches());
        self.stats.occluders_useful += u32::from(changed);
    }

    /// Appends the patches of a cluster to a batch, unless it is small or hidden.
    fn collect_cluster(&mut self, slot: u32, index: u32, batch: &mut Vec<Drawable<'a>>) {
        let scene = self.scene;
        let Some(occluder) = scene.object(slot).occluder() else { return };
        let Some(surface) = occluder.surface() else { return };
        let placement = occluder.placement();
        let cluster = &surface.clusters[index as usize];
        let around = placed_block(&cluster.block(), placement);
        if self.is_small(&around, SMALLEST_CLUSTER)
            || !self.view.may_see_block(&around)
            || self.hides(&around)
        {
            return;
        }
        for patch in cluster.first..cluster.last {
            let block = placed_block(&surface.patches[patch as usize].block(), placement);
            if self.is_small(&block, SMALLEST_PATCH) {
                continue;
            }
            if let Some(mut drawable) = self.drawable(slot, patch) {
                drawable.id = self.scratch.patches.len() as u32;
                self.scratch.patches.push((slot, patch));
                self.scratch.drawn[drawable.number as usize] = (self.marks.epoch(), self.scratch.batches);
                batch.push(drawable);
            }
        }
    }

    /// Appends the neighbours of a batch that were drawn before, so that no seam stays between batches.
    fn collect_neighbours(&mut self, batch: &mut Vec<Drawable<'a>>) {
        let (epoch, number) = (self.marks.epoch(), self.scratch.batches);
        for i in 0..batch.len() {
            let first = batch[i].clone();
            for (_, twin) in first.sides() {
                let Some((twin, _)) = twin else { continue };
                let drawn = &mut self.scratch.drawn[twin as usize];
                if drawn.0 != epoch || drawn.1 == number {
                    continue;
                }
                drawn.1 = number;
                let seams = &self.scene.seams();
                let slot = seams.owner(twin);
                let again = self.drawable(slot, twin - seams.place(slot).base);
                batch.extend(again.map(|d| Drawable { again: true, ..d }));
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
        if let Some(sine) = surface.front
            && !(self.is_front(normal, &block, sine) && placement.is_none_or(|p| p.keeps_angles))
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
