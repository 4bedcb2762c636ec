//! The walk over bricks finds those in sight, from near to far, and lists their objects.

use casca_slots::Slot;
use glam::{DVec3, IVec3};

use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::cell_box::CellBox;
use crate::grid::mask::{BRICK, Mask, cells_of, either};
use crate::query::point::drawing::Drawing;
use crate::query::point::finder::ObjectFinder;
use crate::query::point::run::{Run, pitch};
use crate::scene::Scene;
use crate::view::Origin;
use crate::walk::{CellFrustum, Shells, Start};

/// A brick with fewer objects yet undecided is not tested itself.
const WORTH_TESTING: usize = 3;

/// Bricks of views without shells are taken in portions of this many, front to back.
const PORTION: usize = 64;

/// The shells that a page may reach into: as many as it has bricks along an axis.
const SHELLS_OF_PAGE: usize = BRICK as usize;

/// What a brick contains that a walk looks for, as bits.
const OBJECTS: u8 = 1;
const VOLUMES: u8 = 2;

/// A brick that contains something.
#[derive(Debug, Clone, Copy)]
struct Found {
    brick: IVec3,
    contains: u8,
}

/// Lists of the walk, in memory that is used again.
#[derive(Debug, Clone, Default)]
pub(super) struct BrickLists {
    /// The pages in the frustum, with the shells that they begin in, from near to far.
    pages: Vec<(i32, IVec3)>,
    /// The bricks of the next shells, page by page: those of shell `m` are at `m` modulo 8.
    shells: [Vec<Found>; SHELLS_OF_PAGE],
    /// The bricks of a shell, or of a view without shells.
    bricks: Vec<Found>,
    /// Bricks with temporal bounding volumes that are not hidden.
    volumes: Vec<IVec3>,
    /// The undecided objects of a brick.
    slots: Vec<Slot>,
}

/// Lists the pages that contain something and may be in the frustum, from near to far.
fn list_pages(scene: &Scene, frustum: &CellFrustum, middle: IVec3, out: &mut Vec<(i32, IVec3)>) {
    out.clear();
    let mut add = |page: IVec3| {
        let lo = page * BRICK - middle;
        let hi = lo + (BRICK - 1);
        if frustum.meets(lo, hi) {
            out.push((lo.max(-hi).max_element().max(0), page));
        }
    };
    scene.id_matrix().pages().iter().for_each(&mut add);
    scene.tbv_matrix().pages().iter().for_each(&mut add);
    out.sort_unstable_by_key(|(nearest, page)| (*nearest, page.to_array()));
    out.dedup();
}

/// Calls `found` with the bricks of a page that contain something.
fn for_bricks(scene: &Scene, page: IVec3, mut found: impl FnMut(Found)) {
    let (objects, volumes) =
        (scene.id_matrix().pages().bricks(page), scene.tbv_matrix().pages().bricks(page));
    for brick in cells_of(page, &either(objects, volumes)) {
        let (slice, bit) = ((brick.z & 7) as usize, (brick.y & 7) << 3 | brick.x & 7);
        let has = |mask: &Mask, what: u8| if mask[slice] >> bit & 1 != 0 { what } else { 0 };
        let contains = has(objects, OBJECTS) | has(volumes, VOLUMES);
        found(Found { brick, contains });
    }
}

/// Finds the objects of the whole scene that the buffers do not hide, but for small moving ones.
pub(super) fn find_all(finder: &mut ObjectFinder, lists: &mut BrickLists) {
    let Run { scene, view, options, fixed_only, .. } = finder.drawing.run;
    scene.always().iter().copied().chain(scene.overdue()).for_each(|slot| finder.find(slot));
    finder.settle();
    if let (Some(eye), false) = (view.eye(), fixed_only) {
        reveal_around(finder, eye);
    }
    match (view.origin, finder.drawing.around.clone()) {
        (Origin::Eye { at, .. }, Some(shells)) => walk_shells(finder, lists, &shells, at),
        (Origin::Eye { at, .. }, None) => {
            walk_along(finder, lists, pitch(scene, options).middle - at);
        }
        (Origin::Direction(d), _) => walk_along(finder, lists, d),
    }
}

/// Reveals the volumes around the eye: their surface is not between the eye and the objects in
/// them.
fn reveal_around(finder: &mut ObjectFinder, eye: DVec3) {
    let scene = finder.drawing.run.scene;
    let around = scene.volumes_around(scene.grid().cell_of(eye));
    around.into_iter().for_each(|slot| finder.reveal(slot));
}

/// Walks the shells around the eye outwards, until every pixel is closed.
fn walk_shells(finder: &mut ObjectFinder, lists: &mut BrickLists, around: &Shells, eye: DVec3) {
    let scene = finder.drawing.run.scene;
    let BrickLists { pages, shells, bricks, volumes, slots } = lists;
    list_pages(scene, &around.frustum, around.cell, pages);
    shells.iter_mut().for_each(Vec::clear);
    let mut pages = pages.iter().peekable();
    let mut next = pages.peek().map(|(nearest, _)| *nearest);
    while let Some(m) = next {
        finder.drawing.stats.shells += 1;
        while let Some(&(_, page)) = pages.next_if(|(nearest, _)| *nearest == m) {
            list_page(&finder.drawing, around, page, shells);
        }
        bricks.clear();
        bricks.append(&mut shells[m as usize % SHELLS_OF_PAGE]);
        bricks.iter().for_each(|found| visit(finder, *found, slots, volumes));
        finish_bricks(finder, volumes);
        let in_shells =
            (m + 1..m + SHELLS_OF_PAGE as i32).find(|k| !shells[*k as usize % SHELLS_OF_PAGE].is_empty());
        next = in_shells.into_iter().chain(pages.peek().map(|(nearest, _)| *nearest)).min();
        let beyond = distance_beyond(&finder.drawing.bricks, around, m, eye);
        if finder.drawing.buffers().closed(beyond) {
            break;
        }
    }
}

/// Lists the bricks of a page in the frustum by their shells, unless the page is hidden.
fn list_page(drawing: &Drawing, around: &Shells, page: IVec3, shells: &mut [Vec<Found>; SHELLS_OF_PAGE]) {
    let (lo, hi) = drawing.bricks.range_bounds(page * BRICK, page * BRICK + (BRICK - 1));
    if drawing.hides(&Block { min: lo, max: hi }) {
        return;
    }
    for_bricks(drawing.run.scene, page, |found| {
        let at = found.brick - around.cell;
        if around.frustum.meets(at, at) {
            shells[at.abs().max_element() as usize % SHELLS_OF_PAGE].push(found);
        }
    });
}

/// Walks all bricks in the frustum, sorted along a direction.
fn walk_along(finder: &mut ObjectFinder, lists: &mut BrickLists, direction: DVec3) {
    let Run { scene, view, .. } = finder.drawing.run;
    let BrickLists { pages, bricks, volumes, slots, .. } = lists;
    let middle = scene.extent_in_bricks().middle();
    let frustum = CellFrustum::new(&finder.drawing.bricks, view, middle, Start::None);
    list_pages(scene, &frustum, middle, pages);
    bricks.clear();
    for (_, page) in &*pages {
        for_bricks(scene, *page, |found| {
            let at = found.brick - middle;
            bricks.extend(frustum.meets(at, at).then_some(found));
        });
    }
    bricks.sort_unstable_by(|a, b| {
        let depth = |found: &Found| found.brick.as_dvec3().dot(direction);
        depth(a).total_cmp(&depth(b)).then(a.brick.to_array().cmp(&b.brick.to_array()))
    });
    for portion in bricks.chunks(PORTION) {
        finder.drawing.stats.shells += 1;
        portion.iter().for_each(|found| visit(finder, *found, slots, volumes));
        finish_bricks(finder, volumes);
    }
    // Rays may start inside a volume, or enter it where no brick of the view is: all are tested.
    Slot::below(scene.slot_count()).filter(|&s| scene.is_hidden(s)).for_each(|slot| finder.test_volume(slot));
    finder.settle();
    finder.drawing.draw_patches();
}

/// The least distance along an axis from the eye to bricks beyond shell `m`.
fn distance_beyond(bricks: &Grid, around: &Shells, m: i32, eye: DVec3) -> f64 {
    let (lo, hi) = bricks.range_bounds(around.cell - m, around.cell + m);
    let (min, max) = bricks.range_bounds(around.extent.lo, around.extent.hi);
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

/// Finds the undecided objects of a brick, and lists it if it contains volumes, unless it is hidden.
fn visit(
    finder: &mut ObjectFinder,
    Found { brick, contains }: Found,
    slots: &mut Vec<Slot>,
    volumes: &mut Vec<IVec3>,
) {
    let Run { scene, view, fixed_only, .. } = finder.drawing.run;
    finder.drawing.stats.bricks_visited += 1;
    slots.clear();
    if contains & OBJECTS != 0 {
        slots.extend(scene.id_matrix().in_brick(brick).filter(|&slot| !finder.marks.is_decided(slot)));
    }
    let has_volumes = !fixed_only && contains & VOLUMES != 0;
    if (slots.len() >= WORTH_TESTING || has_volumes)
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
}

/// Tests and draws the objects found in bricks, then those of the volumes in them: these are tested
/// after all objects as near are drawn.
fn finish_bricks(finder: &mut ObjectFinder, volumes: &mut Vec<IVec3>) {
    let scene = finder.drawing.run.scene;
    finder.settle();
    finder.drawing.draw_patches();
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
    finder.drawing.draw_patches();
}
