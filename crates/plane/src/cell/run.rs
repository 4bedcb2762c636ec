//! One run of the cell method on a scene: which objects the cells in sight hold.

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

/// The memory of the cell method, reused from run to run.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellScratch {
    walk: Walk,
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

/// Fills the set with the objects that can be seen from anywhere in the cell of the view's eye.
pub(crate) fn run(
    scene: &Scene,
    view: &View,
    options: &CellOptions,
    sight: &Sight,
    scratch: &mut CellScratch,
    pvs: &mut Pvs,
) {
    let CellScratch { walk, found } = scratch;
    let grid = scene.grid();
    let v = grid.cell_of(view.eye());
    found.begin(scene.slot_count());
    found.layers = view.layers();
    found.everywhere = view.direction().is_none() && view.range().is_none();
    let away = (-v).max(v - (grid.dims() - 1)).max_element();
    let eye_in_occluder = is_in_occluder(scene, view.eye(), v);
    let opacity = scene.opacity();
    let stays = stays_in_cell(scene, view, v);
    let hides = !eye_in_occluder && away <= FAR_VIEWER && stays;
    let map = CellMap {
        dims: grid.dims(),
        opaque: if hides { &opacity } else { &[] },
        found: [scene.lists().occupied(), scene.volumes().bits()],
    };
    let region = if away <= FAR_VIEWER && stays { region_of(scene, view, v) } else { Region::default() };
    scene.volumes_around(v, |slot| found.reveal(slot));
    if !stays {
        // Outlines do not stand for volumes that some eyes are in.
        let hidden = scene.living().filter(|(_, object)| object.is_hidden());
        hidden.for_each(|(slot, _)| found.reveal(slot));
    }
    // So far away all cells are in sight, and the numbers of shells must not overflow.
    let middle = v.clamp(IVec2::splat(-FAR_VIEWER), grid.dims() + FAR_VIEWER);
    let walked = walk.run(&map, middle, &region, options.hiding(), |cell, shell| {
        scene.lists().get(cell).iter().for_each(|&slot| found.decide(scene, sight, slot, shell));
        scene.volumes().at(cell).iter().for_each(|&slot| found.reveal(slot));
    });
    found.settle(scene, sight, walk);
    // Nothing is known to hide objects beyond the grid, and large ones have too many cells.
    for &slot in scene.outer() {
        found.decide(scene, sight, slot, i32::MAX);
    }
    found.visible.sort_by_key(|&(shell, _)| shell);
    found.visible.iter().for_each(|&(_, slot)| pvs.push(scene.id(slot)));
    pvs.revealed.extend(found.revealed.iter().map(|&slot| scene.id(slot)));
    pvs.stats = Stats {
        shells: walked.shells,
        cells_visited: walked.cells,
        cells_hidden: walked.hidden,
        occluders_drawn: walked.occluders,
        occluders_skipped: walked.skipped,
        objects_tested: found.tested,
        tbvs_revealed: found.revealed.len() as u32,
        eye_in_occluder,
        ..Stats::default()
    };
}

impl CellScratch {
    /// The cells of the grid that the last run found in sight.
    pub(crate) fn seen_cells(&self, scene: &Scene) -> BitGrid {
        let dims = scene.grid().dims();
        let mut seen = BitGrid::new(dims.x as u32, dims.y as u32);
        for cell in (0..dims.y).flat_map(|y| (0..dims.x).map(move |x| IVec2::new(x, y))) {
            if self.walk.is_seen(cell) {
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
    fn settle(&mut self, scene: &Scene, sight: &Sight, walk: &Walk) {
        // The order of look-ups among volumes must not show.
        self.revealed.sort_unstable();
        for at in 0..self.revealed.len() {
            let slot = self.revealed[at];
            let Some(object) = scene.object(slot) else { continue };
            let mut shell = if object.on_expiry() { Some(0) } else { None };
            if shell.is_none() {
                touched(&object.bounds, scene.grid(), &mut |y, xs| {
                    let seen = xs.map(|x| IVec2::new(x, y)).filter(|&cell| walk.is_seen(cell));
                    shell = seen.map(|cell| walk.shell_of(cell)).chain(shell).min();
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

/// Whether no eye within the reach of a view leaves a cell; not known on its border.
fn stays_in_cell(scene: &Scene, view: &View, v: IVec2) -> bool {
    let (lo, hi) = scene.grid().cell_bounds(v);
    let room = (view.eye() - lo).min(hi - view.eye()).min_element();
    view.reach() == 0.0 || room > view.reach() * (1.0 + REACH)
}

/// The cells that a view may see. That of a sector wider than a half-plane is not convex, so it
/// bounds nothing.
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
    Region::new(eye, &normals, view.farthest().map(|range| range * per_cell))
}
