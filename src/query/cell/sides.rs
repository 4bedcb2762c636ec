//! The six sides of the shells that a walk goes through.

use crate::grid::side::Side;
use crate::query::cell::masks::DirectionMasks;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::side_cells::SideCells;
use crate::walk::Shells;

/// The sides of one shell, and what hides cells of farther ones.
#[derive(Debug, Clone)]
pub(super) struct ShellSides {
    pub(super) masks: DirectionMasks,
    pub(super) cells: [SideCells; 6],
}

impl ShellSides {
    /// Begins a walk.
    pub(super) fn clear(&mut self) {
        self.masks.clear();
        self.cells.iter_mut().for_each(|cells| cells.seen_at = 0.5);
    }

    /// Whether some cell in sight is in a band of the side that was passed over.
    pub(super) fn sees_passed_over(&mut self, index: usize, scale: &ShellScale, shells: &Shells) -> bool {
        let (masks, cells, side) = (&self.masks, &mut self.cells[index], Side::ALL[index]);
        let (depth, columns) = (scale.shell() * side.sign, cells.columns());
        let on_side = shells.frustum.on_side(&side, depth);
        let sees = |row: i32| {
            let Some((lo, hi)) = on_side.row(row, columns) else { return false };
            let mut open = hi - lo + 1;
            masks.hidden_runs(index, scale, row, (lo, hi), |a, b| open -= b - a + 1);
            open > 0
        };
        cells.sees_passed_over(|(first, last)| {
            let meets =
                |(c0, c1)| shells.frustum.meets(side.cell(depth, first, c0), side.cell(depth, last, c1));
            meets(columns) && (first..=last).any(sees)
        })
    }

    /// Writes the open cells of bands that were passed over, around the rows with fresh occluders.
    /// Returns whether there are some.
    pub(super) fn complete(&mut self, index: usize, scale: &ShellScale, shells: &Shells) -> bool {
        let (masks, cells, side) = (&self.masks, &mut self.cells[index], Side::ALL[index]);
        if !cells.fresh.contains(&true) {
            return false;
        }
        let (base, columns) = (cells.base(), cells.columns());
        let on_side = shells.frustum.on_side(&side, scale.shell() * side.sign);
        cells.complete(scale.spread(), |row, line| {
            if let Some(span) = on_side.row(row, columns) {
                masks.open_cells(index, scale, row, span, base, line);
            }
        });
        true
    }
}
