//! View cells: eyes at their corners.

use casca::{CellOptions, Method, Query, View};
use glam::DVec3;

use super::solid::Start;
use super::stage::{Place, Stage};
use super::views::way;

/// Plays a scene with queries of [`Method::Cell`].
pub fn play(mut stage: Stage) -> Stage {
    let (eye, mask) = (stage.eye(), stage.mask());
    let Ok(view) = View::omnidirectional(eye) else { return stage };
    let view = view.with_layers(mask);
    let walls = 6 + stage.dice.below(14);
    stage.build_cells(walls);
    let grid = stage.scene.grid();
    let (min, max) = grid.cell_bounds(grid.cell_of(eye.as_dvec3()));
    for number in 0..1500 {
        let dice = &mut stage.dice;
        let mut at = DVec3::from_array(std::array::from_fn(|i| {
            // The upper border belongs to the next cell.
            if dice.once_in(2) { min[i] } else { max[i].next_down() }
        }));
        match number % 8 {
            0 => at = eye.as_dvec3(),
            1 => at = (min + max) * 0.5 + way(dice) * (max - min).min_element() * 0.499,
            _ => {}
        }
        // A set is that of the eyes in no occluder.
        let outside = stage.walls.iter().all(|w| !w.wall.solid.may_hold(at));
        if outside && stage.scene.grid().cell_of(at) == stage.scene.grid().cell_of(eye.as_dvec3()) {
            stage.aim(Start::Eye(at), Place::View(u8::from(at != eye.as_dvec3())), |_| true);
        }
    }
    stage.insert_targets();
    for resolution in [256, 64, 1024] {
        let method = Method::Cell(CellOptions::new().mask_resolution(resolution));
        let Ok(mut query) = Query::with_method(method) else { continue };
        let pvs = query.run(&stage.scene, &view).clone();
        stage.check("cell", mask, |_| true, &pvs);
    }
    stage
}
