//! One run of the cell method on a scene: which objects the cells in sight hold. If eyes
//! within a reach are in several cells, objects in sight of any of these are visible.

use casca_slots::Slot;
use glam::{DVec2, IVec2};

use crate::bits::BitGrid;
use crate::cell::marks::Marks;
use crate::cell::{CellMap, CellOptions, Region, Walk};
use crate::geometry::Shape;
use crate::numeric::{FAR_VIEWER, REACH};
use crate::point::Sight;
use crate::pvs::{Pvs, Stats};
use crate::raster::touched;
use crate::scene::Scene;
use crate::view::View;

/// Cells that the eyes of a view may be in, at most; beyond, nothing is hidden. Each takes a walk,
/// which keeps two bits for each cell of the grid.
const MOST_CELLS: i64 = 16;

/// The memory of the cell method, reused from run to run.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellScratch {
    /// One for each cell of the eyes; of these, the last run used the first.
    walks: Vec<Walk>,
    used: usize,
    found: Found,
}

/// The objects found by a run.
#[derive(Debug, Clone, Default)]
struct Found {
    marks: Marks,
    /// The slots of visible objects, each with the shell where it was found.
    visible: Vec<(i32, Slot)>,
    /// The slots of objects in volumes that are in sight.
    revealed: Vec<Slot>,
    /// Whether the view bounds nothing.
    everywhere: bool,
    /// The layers of the view.
    layers: u64,
    tested: u32,
}

/// Fills the set with the objects that can be seen from anywhere in the cells that the eyes of the
/// view may be in.
pub(crate) fn run(
    scene: &Scene,
    view: &View,
    options: &CellOptions,
    sight: &Sight,
    scratch: &mut CellScratch,
    pvs: &mut Pvs,
) {
    let CellScratch { walks, used, found } = scratch;
    let grid = scene.grid();
    let v = grid.cell_of(view.eye());
    found.begin(scene.slot_count());
    found.layers = view.layers();
    found.everywhere = view.direction().is_none() && view.range().is_none();
    let away = |v: IVec2| (-v).max(v - (grid.dims() - 1)).max_element();
    let eye_in_occluder = is_in_occluder(scene, view.eye(), v);
    let opacity = scene.opacity();
    let cells = cells_of_eyes(scene, view);
    let known = cells.is_some();
    let starts = cells.unwrap_or_else(|| vec![v]);
    let near = known && starts.iter().all(|&start| away(start) <= FAR_VIEWER);
    let map = CellMap {
        dims: grid.dims(),
        opaque: if near && !eye_in_occluder { &opacity } else { &[] },
        found: [scene.lists().occupied(), scene.volumes().bits()],
    };
    if !known {
        // Outlines do not stand for volumes that some eyes are in.
        let hidden = scene.living().filter(|(_, object)| object.is_hidden());
        hidden.for_each(|(slot, _)| found.reveal(slot));
    }
    *used = starts.len();
    walks.resize_with(walks.len().max(*used), Walk::default);
    let mut stats = Stats { eye_in_occluder, ..Stats::default() };
    let region = if near { region_of(scene, view, v) } else { Region::default() };
    for (walk, start) in walks.iter_mut().zip(starts) {
        scene.volumes_around(start, |slot| found.reveal(slot));
        // So far away all cells are in sight, and the numbers of shells must not overflow.
        let middle = start.clamp(IVec2::splat(-FAR_VIEWER), grid.dims() + FAR_VIEWER);
        let walked = walk.run(&map, middle, &region, options.hiding(), |cell, shell| {
            scene.lists().get(cell).iter().for_each(|&slot| found.decide(scene, sight, slot, shell));
            scene.volumes().at(cell).iter().for_each(|&slot| found.reveal(slot));
        });
        stats.shells += walked.shells;
        stats.cells_visited += walked.cells;
        stats.cells_hidden += walked.hidden;
        stats.occluders_drawn += walked.occluders;
        stats.occluders_skipped += walked.skipped;
    }
    found.settle(scene, sight, &walks[..*used]);
    // Nothing is known to hide objects beyond the grid, and large ones have too many cells.
    for &slot in scene.outer() {
        found.decide(scene, sight, slot, i32::MAX);
    }
    found.visible.sort_by_key(|&(shell, _)| shell);
    found.visible.iter().for_each(|&(_, slot)| pvs.push(scene.id(slot)));
    pvs.revealed.extend(found.revealed.iter().map(|&slot| scene.id(slot)));
    pvs.stats = Stats { objects_tested: found.tested, tbvs_revealed: found.revealed.len() as u32, ..stats };
}

impl CellScratch {
    /// The cells of the grid that the last run found in sight.
    pub(crate) fn seen_cells(&self, scene: &Scene) -> BitGrid {
        let dims = scene.grid().dims();
        let mut seen = BitGrid::new(dims.x as u32, dims.y as u32);
        for cell in (0..dims.y).flat_map(|y| (0..dims.x).map(move |x| IVec2::new(x, y))) {
            if self.walks[..self.used].iter().any(|walk| walk.is_seen(cell)) {
                seen.set(cell.x as u32, cell.y as u32, true);
            }
        }
        seen
    }
}

impl Found {
    fn begin(&mut self, slots: usize) {
        self.marks.begin(slots);
        self.visible.clear();
        self.revealed.clear();
        self.tested = 0;
    }

    /// Decides an object one of whose cells is in sight.
    fn decide(&mut self, scene: &Scene, sight: &Sight, slot: Slot, shell: i32) {
        let Some(object) = scene.object(slot).filter(|object| object.layers & self.layers != 0) else {
            return;
        };
        if !self.marks.decide(slot) {
            return;
        }
        self.tested += 1;
        if self.everywhere || object.is_lost() || sight.sees(object.place()) {
            self.visible.push((shell, slot));
        }
    }

    /// A volume came into sight.
    fn reveal(&mut self, slot: Slot) {
        if self.marks.reveal(slot) {
            self.revealed.push(slot);
        }
    }

    /// Decides the objects whose volumes are in sight. One whose moves are reported is visible if
    /// one of its cells is in sight; one that goes unreported may be anywhere in the volume.
    fn settle(&mut self, scene: &Scene, sight: &Sight, walks: &[Walk]) {
        // The order of look-ups among volumes must not show.
        self.revealed.sort_unstable();
        for at in 0..self.revealed.len() {
            let slot = self.revealed[at];
            let Some(object) = scene.object(slot) else { continue };
            let mut shell = if object.on_expiry() { Some(0) } else { None };
            if shell.is_none() {
                touched(&object.bounds, scene.grid(), &mut |y, xs| {
                    for cell in xs.map(|x| IVec2::new(x, y)) {
                        let seen = walks.iter().filter(|walk| walk.is_seen(cell));
                        shell = seen.map(|walk| walk.shell_of(cell)).chain(shell).min();
                    }
                });
            }
            shell.into_iter().for_each(|shell| self.decide(scene, sight, slot, shell));
        }
        scene.lost().iter().for_each(|&slot| self.decide(scene, sight, slot, 0));
    }
}

/// Whether the eye is inside a solid occluder. One sees through its inside then, so that opaque
/// cells hide nothing.
pub(crate) fn is_in_occluder(scene: &Scene, eye: DVec2, v: IVec2) -> bool {
    let in_cell = if scene.grid().contains(v) { scene.lists().get(v) } else { &[] };
    let mut around = in_cell.iter().chain(scene.outer()).filter_map(|&slot| scene.object(slot));
    around.any(|object| {
        object.fills() && object.occluder.as_ref().is_some_and(|shape: &Shape| shape.surrounds(eye))
    })
}

/// The cells that the eyes of a view may be in; `None` for more than [`MOST_CELLS`].
fn cells_of_eyes(scene: &Scene, view: &View) -> Option<Vec<IVec2>> {
    let (grid, eye, reach) = (scene.grid(), view.eye(), view.reach() * (1.0 + REACH));
    let (first, last) = (grid.cell_of(eye - reach), grid.cell_of(eye + reach));
    let size = last.as_i64vec2() - first.as_i64vec2() + 1;
    if size.x * size.y > MOST_CELLS {
        return None;
    }
    let all = (first.y..=last.y).flat_map(|y| (first.x..=last.x).map(move |x| IVec2::new(x, y)));
    let near = |cell: &IVec2| {
        let (lo, hi) = grid.cell_bounds(*cell);
        eye.clamp(lo, hi).distance(eye) <= reach
    };
    // The eye's own cell counts also where its borders are rounded.
    let own = grid.cell_of(eye);
    Some(all.filter(|cell| *cell == own || near(cell)).collect())
}

/// The cells that a view may see from its eye's cell, or from another one within its reach. That of
/// a sector wider than a half-plane is not convex, so it bounds nothing.
fn region_of(scene: &Scene, view: &View, v: IVec2) -> Region {
    let (lo, hi) = scene.grid().cell_bounds(v);
    let per_cell = 1.0 / scene.grid().cell_size();
    let eye = (view.eye() - (lo + hi) * 0.5) * per_cell;
    let quarter = std::f64::consts::FRAC_PI_2;
    let half = view.half_angle();
    let normals = match view.direction() {
        // The sectors of other eyes reach beyond these sides.
        Some(direction) if half < quarter && view.reach() == 0.0 => vec![half - quarter, quarter - half]
            .into_iter()
            .map(|by| DVec2::from_angle(by).rotate(direction))
            .collect(),
        _ => Vec::new(),
    };
    Region::new(eye, &normals, view.reach() * per_cell, view.range().map(|range| range * per_cell))
}
