//! The six sides of the shells that a walk goes through.

use glam::IVec3;

use crate::grid::side::Side;
use crate::query::cell::mask::DirectionMask;
use crate::query::cell::shell_scale::ShellScale;
use crate::query::cell::side_cells::SideCells;
use crate::walk::Shells;

/// One of the six sides of the shells: the cells of the shell that is walked, and the mask of
/// directions in which farther cells are hidden.
#[derive(Debug, Clone)]
pub(super) struct ShellSide {
    pub(super) side: Side,
    pub(super) mask: DirectionMask,
    pub(super) cells: SideCells,
}

impl ShellSide {
    /// Begins a walk.
    pub(super) fn clear(&mut self) {
        self.mask.clear();
        self.cells.seen_at = 0.5;
    }

    /// Whether some cell in sight is in a band that was passed over.
    pub(super) fn sees_passed_over(&mut self, scale: &ShellScale, shells: &Shells) -> bool {
        let Self { side, mask, cells } = self;
        let (depth, columns) = (scale.shell() * side.sign, cells.columns());
        cells.sees_passed_over(|(first, last)| {
            let (lo, hi) = (side.cell(depth, first, columns.0), side.cell(depth, last, columns.1));
            if !shells.frustum.meets(lo, hi) {
                return false;
            }
            let on_side = shells.frustum.on_side(side, depth);
            (first..=last).any(|row| {
                let Some((lo, hi)) = on_side.row(row, columns) else { return false };
                let mut open = hi - lo + 1;
                mask.hidden_runs(scale, row, (lo, hi), |a, b| open -= b - a + 1);
                open > 0
            })
        })
    }

    /// Writes the open cells of bands that were passed over, around the rows with fresh occluders.
    /// Returns whether there are some.
    pub(super) fn complete(&mut self, scale: &ShellScale, shells: &Shells) -> bool {
        let Self { side, mask, cells } = self;
        if !cells.fresh.contains(&true) {
            return false;
        }
        let (base, columns) = (cells.base(), cells.columns());
        let on_side = shells.frustum.on_side(side, scale.shell() * side.sign);
        cells.complete(scale.spread(), |row, line| {
            if let Some(span) = on_side.row(row, columns) {
                mask.open_cells(scale, row, span, base, line);
            }
        });
        true
    }
}

/// Whether a cell of the scale's shell is hidden by the mask of a side that it belongs to.
pub(super) fn is_hidden(sides: &[ShellSide; 6], c: IVec3, scale: &ShellScale) -> bool {
    sides.iter().any(|ShellSide { side, mask, .. }| {
        c[side.axes.normal] * side.sign == scale.shell()
            && mask.is_hidden(scale, c[side.axes.row], c[side.axes.col])
    })
}
