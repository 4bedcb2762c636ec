//! The point method: what can be seen from the eye, at pixel precision.
//!
//! The walk goes out from the eye in chessboard shells of bricks (8x8x8 cells), only
//! inside the frustum. A brick is tested before the objects in it, an object before
//! it is drawn as an occluder, and the walk ends when every pixel is closed. What was found visible is
//! tested once more when all occluders are drawn, so that the order matters
//! only for speed; what then hangs on undecided pixels is refined.

use glam::{DMat3, DVec3, IVec3};

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::geometry::polytope::Polytope;
use crate::grid::Grid;
use crate::grid::bricks::Pages;
use crate::grid::cell_box::CellBox;
use crate::grid::side::Side;
use crate::method::Settings;
use crate::object::{Bounds, Occluder};
use crate::occlusion::buffers::{OcclusionBuffers, Verdict};
use crate::occlusion::magnify::Magnifier;
use crate::occlusion::pitch::Pitch;
use crate::occlusion::refine::Effort;
use crate::occlusion::solid::Solid;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::target::Target;
use crate::pvs::{Pvs, Stats};
use crate::query::{FAR_VIEWER, Scratch};
use crate::scene::{Object, Scene};
use crate::shape::Shape;
use crate::view::cut::may_meet;
use crate::view::{Origin, View};
use crate::walk::{CellFrustum, shell_range};

/// A brick with fewer objects yet undecided is not tested itself.
const WORTH_TESTING: usize = 3;

/// More bricks in a row than this are first tested together, and so are bands of rows
/// of as many bricks.
const WORTH_TESTING_ROW: i32 = 4;
const BAND: i32 = 8;
const WORTH_TESTING_BAND: i64 = 32;

/// Objects nearer to the eye than this share of a cell are visible without a test.
const NEAREST: f64 = 0.02;

/// Patches are drawn from this radius on, in pixels, and clusters of them from this one: small patches hide
/// nothing alone, but a surface may be made of them.
const SMALLEST_PATCH: f64 = 2.0;
const SMALLEST_CLUSTER: f64 = 4.0;

/// In whose name boxes of cells are drawn.
const NOBODY: u32 = u32::MAX;

/// Bricks of parallel views are taken in portions of this many, front to back.
const PORTION: usize = 64;

/// What the walk keeps from query to query to spare allocations.
#[derive(Debug, Default)]
pub(crate) struct PointScratch {
    pub(crate) buffers: OcclusionBuffers,
    bricks: Vec<IVec3>,
    /// Bricks of a shell with volumes, if they are not hidden.
    volumes: Vec<IVec3>,
    /// Objects of a shell: distance and slot.
    found: Vec<(f64, u32)>,
    /// Objects found visible so far.
    candidates: Vec<u32>,
    /// Clusters of visible surfaces by the shell that they begin in: object and cluster.
    clusters: Vec<Vec<(u32, u32)>>,
    /// For each patch of the scene, the last query that drew it, and in which batch.
    drawn: Vec<(u32, u32)>,
    batches: u32,
    /// The patches drawn: object and patch.
    patches: Vec<(u32, u32)>,
    magnifier: Magnifier,
}

/// One run of the point method.
pub(crate) struct Walk<'a> {
    scene: &'a Scene,
    view: &'a View,
    settings: &'a Settings,
    pvs: &'a mut Pvs,
    scratch: &'a mut Scratch,
    /// What the near plane cuts away of the view.
    cut: Vec<(View, Block)>,
    /// Where an eye that is not known exactly may be.
    unsure: Option<(View, Block)>,
    grid: Grid,
    /// Whether boxes of opaque cells may be drawn, once that was asked.
    fuses: Option<bool>,
    /// The eye's brick, and the last shell around it, if the walk goes in shells.
    around: Option<(IVec3, i32)>,
    stats: Stats,
}

impl<'a> Walk<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        view: &'a View,
        settings: &'a Settings,
        pvs: &'a mut Pvs,
        scratch: &'a mut Scratch,
    ) -> Self {
        scratch.begin(scene.slots.len());
        let (min, max) = scene.extent();
        let cut = view.cut_regions(min, max).collect();
        let unsure = view.eye_region();
        let grid = scene.grid.bricks();
        let (fuses, around, stats) = (None, None, Stats::default());
        Self { scene, view, settings, pvs, scratch, cut, unsure, grid, fuses, around, stats }
    }

    pub(crate) fn run(mut self) {
        let grid = self.grid;
        let (min, max) = self.scene.extent();
        let pitch = Pitch {
            pixels: 90.0 / f64::from(self.settings.pixel_degrees),
            least: f64::from(self.settings.min_pixels),
            nearest: NEAREST * self.scene.grid.cell_size(),
            reach: (max - min).length() * 0.5,
            middle: (min + max) * 0.5,
        };
        self.scratch.point.buffers.begin(self.view, &pitch);
        self.stats.pixels = self.scratch.point.buffers.pixels();
        self.scratch.point.candidates.clear();
        self.scratch.point.clusters.iter_mut().for_each(Vec::clear);
        self.scratch.point.patches.clear();
        let patches = self.scene.seams.patches();
        let drawn = &mut self.scratch.point.drawn;
        drawn.resize(patches.max(drawn.len()), (0, 0));
        if self.scratch.epoch == 1 {
            drawn.fill((0, 0));
        }
        if let Origin::Eye { at, .. } = self.view.origin {
            let brick = grid.cell_of(at);
            let (nearest, farthest) = shell_range(&grid, brick);
            self.around = (nearest <= FAR_VIEWER).then_some((brick, farthest));
        }
        for &slot in &self.scene.always {
            self.find(slot);
        }
        self.settle();
        match self.view.origin {
            Origin::Eye { at, .. } => {
                self.around_eye(at);
                if let Some((brick, farthest)) = self.around {
                    let frustum = CellFrustum::new(&grid, self.view, brick);
                    for m in shell_range(&grid, brick).0..=farthest {
                        self.stats.shells += 1;
                        self.shell(&frustum, brick, m);
                        if self.scratch.point.buffers.closed(self.distance_beyond(brick, m, at)) {
                            break;
                        }
                    }
                } else {
                    self.everywhere((min + max) * 0.5 - at);
                }
            }
            Origin::Direction(d) => self.everywhere(d),
        }
        self.meet_outer_volumes();
        self.decide();
        self.pvs.stats = self.stats;
    }

    /// The least distance along an axis from the eye to bricks beyond shell `m` around `brick`.
    fn distance_beyond(&self, brick: IVec3, m: i32, eye: DVec3) -> f64 {
        let (lo, hi) = self.grid.range_bounds(brick - m, brick + m);
        let (min, max) = (self.grid.min(), self.grid.max());
        let mut least = f64::INFINITY;
        for axis in 0..3 {
            if lo[axis] > min[axis] {
                least = least.min(eye[axis] - lo[axis]);
            }
            if hi[axis] < max[axis] {
                least = least.min(hi[axis] - eye[axis]);
            }
        }
        least
    }

    /// All bricks in the frustum, sorted along a direction.
    fn everywhere(&mut self, direction: DVec3) {
        let grid = self.grid;
        let middle = grid.dims() / 2;
        let frustum = CellFrustum::without_eye(&grid, self.view, middle);
        let (_, farthest) = shell_range(&grid, middle);
        let mut bricks = std::mem::take(&mut self.scratch.point.bricks);
        bricks.clear();
        for m in 0..=farthest {
            self.shell_bricks(&frustum, middle, m, &mut bricks);
        }
        bricks.sort_by(|a, b| {
            let depth = |c: &IVec3| c.as_dvec3().dot(direction);
            depth(a).total_cmp(&depth(b)).then(a.to_array().cmp(&b.to_array()))
        });
        for portion in bricks.chunks(PORTION) {
            self.stats.shells += 1;
            for &brick in portion {
                self.brick(brick);
            }
            self.settle();
            self.draw_clusters(0);
            self.meet_volumes();
            self.settle();
            self.draw_clusters(0);
        }
        self.scratch.point.bricks = bricks;
        // Rays may start inside a volume, or enter it where no brick of the view is: all are tested.
        for slot in 0..self.scene.slots.len() as u32 {
            if self.scene.slots[slot as usize].object.as_ref().is_some_and(Object::is_hidden) {
                self.meet_volume(slot);
            }
        }
        self.settle();
        self.draw_clusters(0);
    }

    /// The bricks of shell `m` around `brick` in the frustum that hold anything.
    fn shell_bricks(&self, frustum: &CellFrustum, brick: IVec3, m: i32, out: &mut Vec<IVec3>) {
        let dims = self.grid.dims();
        let scene = self.scene;
        let holds = |b: IVec3| {
            scene.ids.in_brick(b).len() > 0
                || !scene.volumes.matrix.is_empty(b)
                || !scene.fused.in_brick(b).is_empty()
        };
        let (ids, volumes, fused) = (scene.ids.pages(), scene.volumes.matrix.pages(), scene.fused.pages());
        let plane_is_empty = |axis: usize, page: IVec3| {
            ids.plane_is_empty(axis, page)
                && volumes.plane_is_empty(axis, page)
                && fused.plane_is_empty(axis, page)
        };
        let row_is_empty = |along: usize, page: IVec3| {
            ids.row_is_empty(along, page)
                && volumes.row_is_empty(along, page)
                && fused.row_is_empty(along, page)
        };
        let page_is_empty =
            |page: IVec3| ids.page_is_empty(page) && volumes.page_is_empty(page) && fused.page_is_empty(page);
        if m == 0 {
            if self.grid.contains(brick) && holds(brick) {
                out.push(brick);
            }
            return;
        }
        for (index, side) in Side::ALL.iter().enumerate() {
            let axes = side.axes;
            let depth = m * side.sign;
            let at = brick[axes.normal] + depth;
            if !(0..dims[axes.normal]).contains(&at) || plane_is_empty(axes.normal, page_at(axes.normal, at))
            {
                continue;
            }
            // Edges belong to the first of their sides.
            let reach = |axis: usize| if axis < index / 2 { m - 1 } else { m };
            let span = |axis: usize| {
                let r = reach(axis);
                ((-brick[axis]).max(-r), (dims[axis] - 1 - brick[axis]).min(r))
            };
            let ((r0, r1), (c0, c1)) = (span(axes.row), span(axes.col));
            if r0 > r1 || c0 > c1 {
                continue;
            }
            let corner = |row, col| {
                let mut c = IVec3::ZERO;
                (c[axes.normal], c[axes.row], c[axes.col]) = (depth, row, col);
                c
            };
            if !frustum.meets(corner(r0, c0), corner(r1, c1)) {
                continue;
            }
            let on_side = frustum.on_side(side, depth);
            let block = |lo: IVec3, hi: IVec3| {
                Block::new(self.grid.range_bounds(brick + lo.min(hi), brick + lo.max(hi)))
            };
            let mut first = r0;
            while first <= r1 {
                let last = r1.min(first + BAND - 1);
                // A band of rows lies in at most two rows of pages.
                if [first, last].iter().all(|&row| row_is_empty(axes.col, (brick + corner(row, c0)) >> 3i32))
                {
                    first = last + 1;
                    continue;
                }
                let wide = i64::from(last - first + 1) * i64::from(c1 - c0 + 1) >= WORTH_TESTING_BAND;
                if wide && self.hides(&block(corner(first, c0), corner(last, c1))) {
                    first = last + 1;
                    continue;
                }
                for row in first..=last {
                    let Some((lo, hi)) = on_side.row(row, (c0, c1)) else { continue };
                    let wide = hi - lo >= WORTH_TESTING_ROW;
                    if wide && self.hides(&block(corner(row, lo), corner(row, hi))) {
                        continue;
                    }
                    let mut col = lo;
                    while col <= hi {
                        let b = brick + corner(row, col);
                        let last = hi.min(col + 7 - (b[axes.col] & 7));
                        if !page_is_empty(b >> 3i32) {
                            out.extend(
                                (col..=last).map(|col| brick + corner(row, col)).filter(|&b| holds(b)),
                            );
                        }
                        col = last + 1;
                    }
                }
                first = last + 1;
            }
        }
    }

    fn shell(&mut self, frustum: &CellFrustum, brick: IVec3, m: i32) {
        let mut bricks = std::mem::take(&mut self.scratch.point.bricks);
        bricks.clear();
        self.shell_bricks(frustum, brick, m, &mut bricks);
        for &b in &bricks {
            self.brick(b);
        }
        self.scratch.point.bricks = bricks;
        self.settle();
        self.draw_clusters(m);
        self.meet_volumes();
        self.settle();
        self.draw_clusters(m);
    }

    /// Finds the objects of one brick, unless the brick is hidden.
    fn brick(&mut self, brick: IVec3) {
        self.stats.bricks_visited += 1;
        let scene = self.scene;
        let fused = scene.fused.in_brick(brick);
        let volumes = !scene.volumes.matrix.is_empty(brick);
        let open = scene.ids.in_brick(brick).filter(|&s| !self.scratch.is_decided(s)).count();
        if open == 0 && fused.is_empty() && !volumes {
            return;
        }
        if open >= WORTH_TESTING || !fused.is_empty() || volumes {
            let bounds = Block::new(self.grid.cell_bounds(brick));
            if self.hides(&bounds) {
                self.stats.bricks_hidden += 1;
                return;
            }
        }
        for slot in scene.ids.in_brick(brick) {
            self.find(slot);
        }
        if volumes {
            self.scratch.point.volumes.push(brick);
        }
        if !fused.is_empty() && self.may_fuse() {
            for cells in fused {
                self.draw_cells(cells);
            }
        }
    }

    /// Whether opaque cells hide: rays must surely start outside the solids that make them.
    fn may_fuse(&mut self) -> bool {
        let (scene, view) = (self.scene, self.view);
        let ask = || match view.origin {
            Origin::Eye { at, .. } => !scene.inside_occluder(at) && !scene.near_plane_cuts(view),
            _ => false,
        };
        *self.fuses.get_or_insert_with(ask)
    }

    /// Draws a box of opaque cells.
    fn draw_cells(&mut self, cells: &CellBox) {
        let buffers = &mut self.scratch.point.buffers;
        let (min, max) = self.scene.grid.range_bounds(cells.lo, cells.hi);
        let (origin, shrink) = (buffers.origin(), buffers.uncertainty());
        let block = Block { min: min - origin + shrink, max: max - origin - shrink };
        if block.min.cmplt(block.max).all()
            && !buffers.hides(&block)
            && let Some(solid) = Solid::polytope(Polytope::block(&block), buffers.direction())
        {
            self.stats.cells_drawn += 1;
            buffers.draw(&solid, NOBODY);
        }
    }

    /// Volumes around the eye: their surface is not between it and what they hold.
    fn around_eye(&mut self, eye: DVec3) {
        let scene = self.scene;
        let cell = scene.grid.cell_of(eye);
        if !scene.grid.contains(cell) {
            return;
        }
        let mut around = Vec::new();
        scene.volumes.holding(cell, |slot| around.push(slot));
        around.sort_unstable();
        around.into_iter().for_each(|slot| self.reveal(slot));
    }

    /// Tests the volumes of the bricks met since the last time, once what is as near is drawn.
    fn meet_volumes(&mut self) {
        let mut bricks = std::mem::take(&mut self.scratch.point.volumes);
        let scene = self.scene;
        for brick in bricks.drain(..) {
            let Some(CellBox { lo, hi }) = scene.volumes.matrix.extent(brick) else { continue };
            let mut ids = scene.volumes.matrix.ids(brick);
            if ids.all(|s| self.scratch.is_revealed(s))
                || self.hides(&Block::new(scene.grid.range_bounds(lo, hi)))
            {
                continue;
            }
            for slot in scene.volumes.matrix.ids(brick) {
                self.meet_volume(slot);
            }
        }
        self.scratch.point.volumes = bricks;
    }

    /// Tests the volumes that leave the grid, which the walk does not meet.
    fn meet_outer_volumes(&mut self) {
        let scene = self.scene;
        for bucket in scene.volumes.outer() {
            if self.view.may_see_volume(&bucket.around) && !self.hides(&bucket.around) {
                bucket.slots.iter().for_each(|&slot| self.meet_volume(slot));
            }
        }
        self.settle();
    }

    fn meet_volume(&mut self, slot: u32) {
        if self.scratch.is_revealed(slot) {
            return;
        }
        let bounds = self.scene.volumes.block(&self.scene.grid, slot);
        // A hollow volume that rays start in does not stand for what it holds.
        let starts = self.scratch.point.buffers.direction().is_some_and(|d| self.view.cuts_front(d, &bounds));
        if self.view.may_see_volume(&bounds) && (starts || !self.hides(&bounds)) {
            self.reveal(slot);
        }
    }

    fn reveal(&mut self, slot: u32) {
        if !self.scratch.reveal(slot) {
            return;
        }
        self.stats.tbvs_revealed += 1;
        self.pvs.revealed.push(self.scene.id(slot));
        self.find(slot);
    }

    /// An object in sight, as far as its brick or volume tells.
    fn find(&mut self, slot: u32) {
        if !self.scratch.mark_decided(slot) {
            return;
        }
        let object = self.scene.object(slot);
        let scratch = &mut self.scratch.point;
        if object.is_unlocated() || object.is_hidden_unreported() {
            // It may be anywhere: visible, whatever its old bounds say.
            scratch.candidates.push(slot);
            return;
        }
        self.stats.objects_tested += 1;
        if self.view.may_see(&object.bounds) {
            let block = object.bounds.block();
            let distance = match scratch.buffers.direction() {
                Some(d) => ((block.min + block.max) * 0.5).dot(d),
                None => {
                    let eye = scratch.buffers.origin();
                    (block.min - eye).max(eye - block.max).max(DVec3::ZERO).length_squared()
                }
            };
            scratch.found.push((distance, slot));
        }
    }

    /// Tests what was found, front to back, and draws what may be seen: at once, or,
    /// where only some may be drawn, the largest of the shell first.
    fn settle(&mut self) {
        let mut found = std::mem::take(&mut self.scratch.point.found);
        let limited = self.settings.max_occluders < u32::MAX;
        let mut seen: Vec<(f64, u32)> = Vec::new();
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, slot) in found.drain(..) {
            self.stats.occlusion_tests += 1;
            if !self.hides(&self.scene.object(slot).bounds.block()) {
                self.scratch.point.candidates.push(slot);
                if limited {
                    seen.push((self.solid_angle(slot), slot));
                } else {
                    self.draw(slot);
                }
            }
        }
        seen.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, slot) in seen {
            self.draw(slot);
        }
        self.scratch.point.found = found;
    }

    /// How large an object's occluder appears, in steradians, as if it were a ball (Coorg &
    /// Teller 1997). For parallel rays, the area of that ball's disc.
    fn solid_angle(&self, slot: u32) -> f64 {
        let Some(occluder) = &self.scene.object(slot).occluder else { return 0.0 };
        let (block, buffers) = (occluder.block(), &self.scratch.point.buffers);
        let area = std::f64::consts::PI * (block.max - block.min).length_squared() * 0.25;
        match buffers.direction() {
            Some(_) => area,
            None => area / ((block.min + block.max) * 0.5 - buffers.origin()).length_squared(),
        }
    }

    fn draw(&mut self, slot: u32) {
        if !self.view.is_ordered() {
            return;
        }
        let Some(occluder) = &self.scene.object(slot).occluder else { return };
        let least = f64::from(self.settings.min_solid_angle);
        let small = least > 0.0 && self.solid_angle(slot) < least;
        if small || self.stats.occluders_drawn >= self.settings.max_occluders {
            self.stats.occluders_skipped += 1;
            return;
        }
        if let Some(surface) = occluder.surface() {
            self.stats.occluders_drawn += 1;
            for index in 0..surface.clusters.len() as u32 {
                let around = placed_block(&surface.clusters[index as usize].block(), occluder.placement());
                let shell = self.shell_of(&around);
                let clusters = &mut self.scratch.point.clusters;
                if clusters.len() <= shell {
                    clusters.resize_with(shell + 1, Vec::new);
                }
                clusters[shell].push((slot, index));
            }
            return;
        }
        let buffers = &mut self.scratch.point.buffers;
        let block = occluder.block();
        // Where the near plane cuts into a solid, one sees through it.
        let cut = self.cut.iter().any(|(region, around)| may_meet(occluder, region, around));
        let cut = cut || buffers.direction().is_some_and(|d| self.view.cuts_front(d, &block));
        let unsure = |(region, around): &(View, Block)| may_meet(occluder, region, around);
        let inside = buffers.direction().is_none()
            && (occluder.contains_point(buffers.origin()) || self.unsure.as_ref().is_some_and(unsure));
        if cut || inside {
            self.stats.eye_in_occluder = true;
            return;
        }
        if let Some(solid) = solid(occluder, buffers) {
            self.stats.occluders_drawn += 1;
            self.stats.occluders_useful += u32::from(buffers.draw(&solid, slot));
        }
    }

    /// The shell of bricks around the eye that a box begins in.
    fn shell_of(&self, block: &Block) -> usize {
        let Some((brick, farthest)) = self.around else { return 0 };
        let (lo, hi) = self.grid.cover(block.min, block.max);
        (lo - brick).max(brick - hi).max_element().clamp(0, farthest.max(0)) as usize
    }

    /// Draws the visible clusters of surfaces that begin up to shell `m`, as one.
    fn draw_clusters(&mut self, m: i32) {
        let scene = self.scene;
        let epoch = self.scratch.epoch;
        let eye = self.scratch.point.buffers.origin();
        let direction = self.scratch.point.buffers.direction();
        let pixel = f64::from(self.settings.pixel_degrees).to_radians();
        // Whether a box is smaller than some pixels.
        let small = |b: &Block, pixels: f64| {
            let distance = (b.min - eye).max(eye - b.max).max(DVec3::ZERO).length();
            direction.is_none() && (b.max - b.min).length() * 0.5 < pixel * pixels * distance
        };
        let mut batch: Vec<Drawable> = Vec::new();
        self.scratch.point.batches += 1;
        let number = self.scratch.point.batches;
        let last = self.scratch.point.clusters.len().min(m.max(0) as usize + 1);
        for shell in 0..last {
            let mut clusters = std::mem::take(&mut self.scratch.point.clusters[shell]);
            for (slot, index) in clusters.drain(..) {
                let Some(occluder) = &scene.object(slot).occluder else { continue };
                let Some(surface) = occluder.surface() else { continue };
                let placement = occluder.placement();
                let cluster = &surface.clusters[index as usize];
                let around = placed_block(&cluster.block(), placement);
                if small(&around, SMALLEST_CLUSTER)
                    || !self.view.may_see_block(&around)
                    || self.hides(&around)
                {
                    continue;
                }
                for patch in cluster.first..cluster.last {
                    let block = placed_block(&surface.patches[patch as usize].block(), placement);
                    if small(&block, SMALLEST_PATCH) {
                        continue;
                    }
                    if let Some(mut drawable) = self.drawable(slot, patch) {
                        drawable.id = self.scratch.point.patches.len() as u32;
                        self.scratch.point.patches.push((slot, patch));
                        self.scratch.point.drawn[drawable.number as usize] = (epoch, number);
                        batch.push(drawable);
                    }
                }
            }
            self.scratch.point.clusters[shell] = clusters;
        }
        if batch.is_empty() {
            return;
        }
        // Neighbours drawn before are drawn again, so that no seam stays between batches.
        for i in 0..batch.len() {
            let first = batch[i].clone();
            for (_, twin) in first.sides() {
                let Some((twin, _)) = twin else { continue };
                let drawn = &mut self.scratch.point.drawn[twin as usize];
                if drawn.0 != epoch || drawn.1 == number {
                    continue;
                }
                drawn.1 = number;
                let slot = scene.seams.owner(twin);
                let again = self.drawable(slot, twin - scene.seams.place(slot).base);
                batch.extend(again.map(|d| Drawable { again: true, ..d }));
            }
        }
        self.stats.patches_drawn += batch.len() as u32;
        let news = self.scratch.point.buffers.draw_surfaces(&batch, scene.seams.patches());
        self.stats.occluders_useful += u32::from(news);
    }

    /// A patch of an object's surface ready to be drawn, if it can be.
    fn drawable(&self, slot: u32, patch: u32) -> Option<Drawable<'a>> {
        let scene = self.scene;
        let occluder = scene.object(slot).occluder.as_ref()?;
        let (surface, placement) = (occluder.surface()?, occluder.placement());
        let place = scene.seams.place(slot);
        let buffers = &self.scratch.point.buffers;
        let (eye, unsure) = (buffers.origin(), buffers.uncertainty());
        let own = &surface.patches[patch as usize];
        let world = placed_block(&own.block(), placement);
        let block = Block { min: world.min - eye - unsure, max: world.max - eye + unsure };
        let (mut normal, mut lo, mut hi) = (own.normal, own.lo, own.hi);
        let (mut error, mut slack) = (unsure, f64::from(own.slack));
        if let Some(p) = placement {
            let turned = p.normals? * normal;
            let length = turned.length();
            // The slab's two planes, by a point of each.
            let at = |h: f64| turned.dot(p.affine.transform_point3(normal * h)) / length;
            (lo, hi) = (at(lo), at(hi));
            normal = turned / length;
            if !(normal.is_finite() && lo.is_finite() && hi.is_finite()) {
                return None;
            }
            error += p.error;
            slack *= p.growth;
        }
        let base = normal.dot(eye);
        let room = error + 1e-12 * (base.abs() + eye.abs().max_element() + lo.abs().max(hi.abs()));
        let slab = (lo.min(hi) - base - room, lo.max(hi) - base + room);
        // How far above the middle of its slab rays start.
        let height = match buffers.direction() {
            Some(d) => -normal.dot(d),
            None => -(slab.0 + slab.1) * 0.5,
        };
        if buffers.direction().is_none() {
            let clear = buffers.clearance(error + slack);
            let outside = slab.0 > clear || slab.1 < -clear;
            if !outside && block.min.max(-block.max).max_element() <= clear {
                return None;
            }
        }
        if let Some(sine) = surface.front {
            // Every triangle is turned to every ray: the directions from its points to the eye
            // are less than a right angle less the patch's own from its normal.
            let sine = sine + 1e-4;
            let front = match buffers.direction() {
                Some(d) => -normal.dot(d) > sine,
                None => {
                    let d = -(block.min + block.max) * 0.5;
                    let radius = (block.max - block.min).length() * 0.5;
                    normal.dot(d) - radius > sine * (d.length() + radius)
                }
            };
            // Unequal scales change the angles in a patch.
            if !front || placement.is_some_and(|p| !p.keeps_angles) {
                return None;
            }
        }
        // Where the near plane cuts into it, one sees through it.
        let cut = self.cut.iter().any(|(region, around)| {
            let middle = normal.dot((around.min + around.max) * 0.5 - eye);
            let reach = normal.abs().dot((around.max - around.min) * 0.5) * (1.0 + 1e-9) + room;
            around.min.cmple(world.max).all()
                && world.min.cmple(around.max).all()
                && middle + reach >= slab.0
                && middle - reach <= slab.1
                && region.may_see_block(&world)
        });
        if cut || buffers.direction().is_some_and(|d| self.view.cuts_front(d, &world)) {
            return None;
        }
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

    /// Whether a box in world units is hidden.
    fn hides(&self, bounds: &Block) -> bool {
        let buffers = &self.scratch.point.buffers;
        let (origin, grow) = (buffers.origin(), buffers.uncertainty());
        buffers.hides(&Block { min: bounds.min - origin - grow, max: bounds.max - origin + grow })
    }

    /// Tests all candidates again, with every occluder drawn, and refines what stays open.
    fn decide(&mut self) {
        let mut candidates = std::mem::take(&mut self.scratch.point.candidates);
        let mut magnifier = std::mem::take(&mut self.scratch.point.magnifier);
        let mut left =
            Left { squares: u64::from(self.settings.refine_budget), patches: self.settings.refine_patches };
        for slot in candidates.drain(..) {
            let object = self.scene.object(slot);
            if !(object.is_unlocated() || object.is_hidden_unreported()) {
                self.stats.occlusion_tests += 1;
                let before = left;
                let hidden = self.is_hidden(&object.bounds, slot, &mut magnifier, &mut left);
                self.stats.refined += u32::from(left != before);
                if hidden {
                    self.stats.refined_hidden += u32::from(left != before);
                    continue;
                }
            }
            self.pvs.push(self.scene.id(slot));
        }
        self.stats.refine_squares = u64::from(self.settings.refine_budget) - left.squares;
        self.stats.refine_patches = self.settings.refine_patches - left.patches;
        self.scratch.point.candidates = candidates;
        self.scratch.point.magnifier = magnifier;
    }
}

/// What refinement may still use in a query.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Left {
    squares: u64,
    patches: u32,
}

impl Walk<'_> {
    /// Whether nothing of what is tested can be seen, all occluders being drawn.
    fn is_hidden(&self, bounds: &Bounds, slot: u32, magnifier: &mut Magnifier, left: &mut Left) -> bool {
        let buffers = &self.scratch.point.buffers;
        let effort = Effort { squares: self.settings.refine_squares, depth: self.settings.refine_depth };
        let drawable = |id: u32| {
            let (slot, patch) = self.scratch.point.patches[id as usize];
            self.drawable(slot, patch)
        };
        let mut hidden = |target: &Target| {
            let verdict = if effort.squares > 0 {
                buffers.refine(target, slot, &effort, &mut left.squares)
            } else {
                buffers.test(target)
            };
            verdict == Verdict::Hidden
                || left.patches > 0
                    && magnifier.hides(
                        buffers,
                        target,
                        self.scene.seams.patches(),
                        &mut left.patches,
                        drawable,
                    )
        };
        let (origin, direction) = (buffers.origin(), buffers.direction());
        let meshes = matches!(bounds, Bounds::Mesh(_) | Bounds::Instance(_));
        if meshes && self.hides(&bounds.block()) {
            return true;
        }
        // The quick way to see what is plainly in sight.
        let shown = match bounds {
            Bounds::Mesh(mesh) => buffers.shows(mesh.middle() - origin),
            Bounds::Instance(i) => {
                buffers.shows(i.placement().affine.transform_point3(i.mesh().middle()) - origin)
            }
            _ => false,
        };
        if shown {
            return false;
        }
        let mut part_is_hidden = |polytope: Polytope| {
            let block = polytope.bounds();
            hidden(&Target::polytope(polytope, block, direction))
        };
        match bounds {
            // Only eyes known exactly see more than the box.
            Bounds::Mesh(mesh) if buffers.uncertainty() == 0.0 => {
                mesh.parts().iter().all(|part| part_is_hidden(part.seen_from(origin)))
            }
            Bounds::Instance(instance) if buffers.uncertainty() == 0.0 => {
                instance.parts_from(origin).all(part_is_hidden)
            }
            _ => hidden(&target(bounds, buffers)),
        }
    }
}

/// A box around a box as it is placed.
fn placed_block(block: &Block, placement: Option<&Placement>) -> Block {
    let Some(p) = placement else { return *block };
    let (center, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
    let m = p.affine.matrix3;
    let reach = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z + p.error;
    let center = p.affine.transform_point3(center);
    Block { min: center - reach, max: center + reach }
}

/// A page that holds bricks with a coordinate along an axis.
fn page_at(axis: usize, brick: i32) -> IVec3 {
    let mut page = IVec3::ZERO;
    page[axis] = brick >> 3;
    page
}

/// What is tested, with room for what is not known of the eye.
fn target(bounds: &Bounds, buffers: &OcclusionBuffers) -> Target {
    let (origin, grow) = (buffers.origin(), buffers.uncertainty());
    match bounds {
        Bounds::Sphere(s) => Target::sphere(s.center.as_dvec3() - origin, f64::from(s.radius) + grow),
        Bounds::Oriented(b) => {
            let (center, _, margin) = b.parts();
            let (turn, half) = (b.turn(), b.half.as_dvec3() + grow + margin);
            let axes = DMat3::from_cols(turn.x_axis * half.x, turn.y_axis * half.y, turn.z_axis * half.z);
            Target::oriented(center - origin, &axes, buffers.direction())
        }
        other => {
            let b = other.block();
            Target::block(
                Block { min: b.min - origin - grow, max: b.max - origin + grow },
                buffers.direction(),
            )
        }
    }
}

/// What is drawn, less what is not known of the eye; `None` if nothing is left.
fn solid(occluder: &Occluder, buffers: &OcclusionBuffers) -> Option<Solid> {
    let (origin, shrink) = (buffers.origin(), buffers.uncertainty());
    match occluder {
        Occluder::Sphere(s) => {
            Solid::sphere(s.center.as_dvec3() - origin, f64::from(s.radius) - shrink, buffers.direction())
        }
        Occluder::Box(b) => {
            let b = Block::from(*b);
            let b = Block { min: b.min - origin + shrink, max: b.max - origin - shrink };
            let solid = b.min.cmplt(b.max).all();
            solid.then(|| Solid::polytope(Polytope::block(&b), buffers.direction()))?
        }
        Occluder::Oriented(b) => {
            let (center, axes, margin) = b.parts();
            let shorter = |a: DVec3| a - a.normalize_or_zero() * (shrink + margin);
            let axes = DMat3::from_cols(shorter(axes.x_axis), shorter(axes.y_axis), shorter(axes.z_axis));
            let solid = f64::from(b.half.min_element()) > shrink + margin;
            solid.then(|| Solid::polytope(Polytope::boxed(center - origin, &axes), buffers.direction()))?
        }
        // Only eyes known exactly see it whole.
        Occluder::Convex(c) if shrink == 0.0 => Solid::polytope(c.seen_from(origin), buffers.direction()),
        Occluder::Convex(_) | Occluder::Mesh(_) | Occluder::Instance(_) => None,
    }
}
