//! The walk over bricks finds those in sight, from near to far, and lists their objects.

use casca_slots::Slot;
use glam::{DVec3, IVec3};
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::bricks::Pages;
use crate::grid::cell_box::CellBox;
use crate::grid::side::Side;
use crate::matrix::fused::Fused;
use crate::query::point::drawing::Drawing;
use crate::query::point::finder::ObjectFinder;
use crate::query::point::run::{Run, pitch};
use crate::scene::{LayerOpacity, Scene};
use crate::view::Origin;
use crate::walk::Shells;

/// A brick with fewer objects yet undecided is not tested itself.
const WORTH_TESTING: usize = 3;

/// More bricks in a row than this are first tested together.
const WORTH_TESTING_ROW: i32 = 4;

/// So are bands of this many rows, if they have this many bricks.
const BAND: i32 = 8;
const WORTH_TESTING_BAND: i64 = 32;

/// Bricks of views without shells are taken in portions of this many, front to back.
const PORTION: usize = 64;

/// Lists of the walk, in memory that is used again.
#[derive(Debug, Clone, Default)]
pub(super) struct BrickLists {
    /// The bricks of a shell.
    bricks: Vec<IVec3>,
    /// Those of them with temporal bounding volumes that are not hidden.
    volumes: Vec<IVec3>,
    /// The undecided objects of a brick, or those beyond the grid.
    slots: Vec<Slot>,
}

/// What the bricks of a scene contain that a walk looks for.
struct BrickContents<'a> {
    scene: &'a Scene,
    /// The boxes of opaque cells of the occluders that the view shows.
    fused: SmallVec<[&'a Fused; 2]>,
}

impl BrickContents<'_> {
    /// Whether boxes of opaque cells start in a brick.
    #[inline]
    fn has_fused(&self, brick: IVec3) -> bool {
        self.fused.iter().any(|fused| !fused.in_brick(brick).is_empty())
    }

    /// Whether a brick contains nothing.
    #[inline]
    fn is_empty(&self, brick: IVec3) -> bool {
        self.scene.id_matrix().in_brick(brick).len() == 0
            && self.scene.tbv_matrix().is_empty(brick)
            && !self.has_fused(brick)
    }

    /// Whether some pages contain nothing, by a question that is put to those of all kinds.
    #[inline]
    fn none_in(&self, empty: impl Fn(&dyn Pages) -> bool) -> bool {
        empty(self.scene.id_matrix().pages())
            && empty(self.scene.tbv_matrix().pages())
            && self.fused.iter().all(|fused| empty(fused.pages()))
    }
}

/// Finds the objects of the whole scene that the buffers do not hide, but for small moving ones.
pub(super) fn find_all(finder: &mut ObjectFinder, lists: &mut BrickLists) {
    let Run { scene, view, options, fixed_only, .. } = finder.drawing.run;
    let fused = scene.opacity(view.layers()).map(LayerOpacity::fused).collect();
    let contents = BrickContents { scene, fused };
    scene.always().iter().copied().chain(scene.overdue()).for_each(|slot| finder.find(slot));
    finder.settle();
    if let (Some(eye), false) = (view.eye(), fixed_only) {
        reveal_around(finder, eye);
    }
    match (view.origin, finder.drawing.around.clone()) {
        (Origin::Eye { at, .. }, Some(shells)) => walk_shells(finder, &contents, lists, &shells, at),
        (Origin::Eye { at, .. }, None) => {
            walk_along(finder, &contents, lists, pitch(scene, options).middle - at);
        }
        (Origin::Direction(d), _) => walk_along(finder, &contents, lists, d),
    }
    // A brick out of sight, or a hidden one, tells nothing about the parts of its objects beyond
    // the grid.
    let slots = &mut lists.slots;
    slots.clear();
    scene.overhang().slots_where(|block| may_see_around(&finder.drawing, block), |slot| slots.push(slot));
    slots.iter().for_each(|&slot| finder.find(slot));
    if finder.settle() {
        finder.drawing.draw_all_patches(i32::MAX);
    }
    if !fixed_only {
        // Nor does the walk go where volumes leave the grid.
        slots.clear();
        let outer = scene.volumes().outer();
        outer.slots_where(|block| may_see_around(&finder.drawing, block), |slot| slots.push(slot));
        slots.iter().for_each(|&slot| finder.test_volume(slot));
        finder.settle();
    }
}

/// Whether a box around boxes beyond the grid may be in sight.
fn may_see_around(drawing: &Drawing, block: &Block) -> bool {
    drawing.run.view.may_see_volume(block) && !drawing.hides(block)
}

/// Reveals the volumes around the eye: their surface is not between the eye and the objects in
/// them.
fn reveal_around(finder: &mut ObjectFinder, eye: DVec3) {
    let scene = finder.drawing.run.scene;
    let cell = scene.grid().cell_of(eye);
    if scene.grid().contains(cell) {
        let mut around = Vec::new();
        scene.volumes().holding(cell, |slot| around.push(slot));
        around.sort_unstable();
        around.into_iter().for_each(|slot| finder.reveal(slot));
    }
}

/// Walks the shells around the eye outwards, until every pixel is closed.
fn walk_shells(
    finder: &mut ObjectFinder,
    contents: &BrickContents,
    lists: &mut BrickLists,
    shells: &Shells,
    eye: DVec3,
) {
    let BrickLists { bricks, volumes, slots } = lists;
    for m in shells.nearest..=shells.farthest {
        finder.drawing.stats.shells += 1;
        bricks.clear();
        list_shell(&finder.drawing, contents, shells, m, bricks);
        bricks.iter().for_each(|&brick| visit(finder, contents, brick, slots, volumes));
        finish_bricks(finder, volumes, m);
        let beyond = distance_beyond(&finder.drawing.bricks, shells.cell, m, eye);
        if finder.drawing.buffers().closed(beyond) {
            break;
        }
    }
    if finder.drawing.buffers().reach() > 0.0 {
        finder.drawing.draw_all_patches(i32::MAX);
    }
}

/// Walks all bricks in the frustum, sorted along a direction.
fn walk_along(finder: &mut ObjectFinder, contents: &BrickContents, lists: &mut BrickLists, direction: DVec3) {
    let Run { scene, view, .. } = finder.drawing.run;
    let BrickLists { bricks, volumes, slots } = lists;
    let shells = Shells::around_middle(&finder.drawing.bricks, view);
    bricks.clear();
    for m in 0..=shells.farthest {
        list_shell(&finder.drawing, contents, &shells, m, bricks);
    }
    bricks.sort_unstable_by(|a, b| {
        let depth = |c: &IVec3| c.as_dvec3().dot(direction);
        depth(a).total_cmp(&depth(b)).then(a.to_array().cmp(&b.to_array()))
    });
    for portion in bricks.chunks(PORTION) {
        finder.drawing.stats.shells += 1;
        portion.iter().for_each(|&brick| visit(finder, contents, brick, slots, volumes));
        finish_bricks(finder, volumes, 0);
    }
    // Rays may start inside a volume, or enter it where no brick of the view is: all are tested.
    Slot::below(scene.slot_count()).filter(|&s| scene.is_hidden(s)).for_each(|slot| finder.test_volume(slot));
    finder.settle();
    finder.drawing.draw_all_patches(i32::MAX);
}

/// The least distance along an axis from the eye to bricks beyond shell `m` around `brick`.
fn distance_beyond(grid: &Grid, brick: IVec3, m: i32, eye: DVec3) -> f64 {
    let (lo, hi) = grid.range_bounds(brick - m, brick + m);
    let mut least = f64::INFINITY;
    for axis in 0..3 {
        if lo[axis] > grid.min()[axis] {
            least = least.min(eye[axis] - lo[axis]);
        }
        if hi[axis] < grid.max()[axis] {
            least = least.min(hi[axis] - eye[axis]);
        }
    }
    least
}

/// Appends the bricks of shell `m` in the frustum that contain anything and are not hidden.
fn list_shell(drawing: &Drawing, contents: &BrickContents, shells: &Shells, m: i32, out: &mut Vec<IVec3>) {
    let (grid, middle) = (&drawing.bricks, shells.cell);
    if m == 0 {
        out.extend((grid.contains(middle) && !contents.is_empty(middle)).then_some(middle));
        return;
    }
    for (index, side) in Side::ALL.iter().enumerate() {
        let (axes, dims, depth) = (side.axes, grid.dims(), m * side.sign);
        let mut page = IVec3::ZERO;
        page[axes.normal] = (middle[axes.normal] + depth) >> 3;
        if !(0..dims[axes.normal]).contains(&(middle[axes.normal] + depth))
            || contents.none_in(|pages| pages.plane_is_empty(axes.normal, page))
        {
            continue;
        }
        // Edges belong to the first of their sides.
        let span = |axis: usize| {
            let last = if axis < index / 2 { m - 1 } else { m };
            ((-middle[axis]).max(-last), (dims[axis] - 1 - middle[axis]).min(last))
        };
        let ((r0, r1), (c0, c1)) = (span(axes.row), span(axes.col));
        // Relative to the middle.
        let at = |row: i32, col: i32| side.cell(depth, row, col);
        if r0 > r1 || c0 > c1 || !shells.frustum.meets(at(r0, c0), at(r1, c1)) {
            continue;
        }
        let is_hidden = |a: IVec3, b: IVec3| {
            drawing.hides(&Block::new(grid.range_bounds(middle + a.min(b), middle + a.max(b))))
        };
        let on_side = shells.frustum.on_side(side, depth);
        for first in (r0..=r1).step_by(BAND as usize) {
            let last = r1.min(first + BAND - 1);
            // A band of rows is in at most two rows of pages.
            let is_empty = |row: i32| {
                let page = (middle + at(row, c0)) >> 3i32;
                contents.none_in(|pages| pages.row_is_empty(axes.col, page))
            };
            let is_wide = i64::from(last - first + 1) * i64::from(c1 - c0 + 1) >= WORTH_TESTING_BAND;
            if is_empty(first) && is_empty(last) || is_wide && is_hidden(at(first, c0), at(last, c1)) {
                continue;
            }
            for row in first..=last {
                let Some((lo, hi)) = on_side.row(row, (c0, c1)) else { continue };
                if hi - lo >= WORTH_TESTING_ROW && is_hidden(at(row, lo), at(row, hi)) {
                    continue;
                }
                let mut col = lo;
                while col <= hi {
                    let mut brick = middle + at(row, col);
                    let end = hi.min(col + 7 - (brick[axes.col] & 7)) + 1;
                    if !contents.none_in(|pages| pages.page_is_empty(brick >> 3i32)) {
                        for _ in col..end {
                            if !contents.is_empty(brick) {
                                out.push(brick);
                            }
                            brick[axes.col] += 1;
                        }
                    }
                    col = end;
                }
            }
        }
    }
}

/// Finds the undecided objects of a brick, lists it if it contains volumes, and draws its boxes of
/// opaque cells, unless it is hidden.
fn visit(
    finder: &mut ObjectFinder,
    contents: &BrickContents,
    brick: IVec3,
    slots: &mut Vec<Slot>,
    volumes: &mut Vec<IVec3>,
) {
    let Run { scene, view, fixed_only, .. } = finder.drawing.run;
    finder.drawing.stats.bricks_visited += 1;
    slots.clear();
    slots.extend(scene.id_matrix().in_brick(brick).filter(|&slot| !finder.marks.is_decided(slot)));
    let has_volumes = !fixed_only && !scene.tbv_matrix().is_empty(brick);
    let has_fused = contents.has_fused(brick);
    if (slots.len() >= WORTH_TESTING || has_fused || has_volumes)
        && finder.drawing.hides(&Block::new(finder.drawing.bricks.cell_bounds(brick)))
    {
        finder.drawing.stats.bricks_hidden += 1;
        return;
    }
    // In a loop that does little else, the processor waits for the memory of many objects at once.
    slots.retain(|&slot| {
        let own = scene.boxes().of(slot);
        own.is_shown(view) || scene.object(slot).is_shown(view)
    });
    slots.iter().for_each(|&slot| finder.find(slot));
    if has_volumes {
        volumes.push(brick);
    }
    if has_fused && finder.drawing.may_fuse() {
        let boxes = contents.fused.iter().flat_map(|fused| fused.in_brick(brick));
        boxes.for_each(|cells| finder.drawing.draw_cells(cells));
    }
}

/// Tests and draws the objects found in the bricks up to shell `m`, and those of the volumes in
/// them, which are tested after all objects as near are drawn.
fn finish_bricks(finder: &mut ObjectFinder, volumes: &mut Vec<IVec3>, m: i32) {
    let scene = finder.drawing.run.scene;
    finder.settle();
    finder.drawing.draw_patches(m);
    for brick in volumes.drain(..) {
        let Some(CellBox { lo, hi }) = scene.tbv_matrix().extent(brick) else { continue };
        if scene.tbv_matrix().ids(brick).all(|slot| finder.marks.is_revealed(slot))
            || finder.drawing.hides(&Block::new(scene.grid().range_bounds(lo, hi)))
        {
            continue;
        }
        scene.tbv_matrix().ids(brick).for_each(|slot| finder.test_volume(slot));
    }
    finder.settle();
    finder.drawing.draw_patches(m);
}
