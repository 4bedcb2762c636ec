//! The six sides of a chessboard shell of cells.

use glam::IVec3;

/// Which axes of space are the normal, the columns and the rows of a side of
/// a chessboard shell. Columns run along x where they can.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SideAxes {
    pub(crate) normal: usize,
    pub(crate) col: usize,
    pub(crate) row: usize,
}

impl SideAxes {
    pub(crate) const ALL: [Self; 3] = [
        Self { normal: 0, col: 1, row: 2 },
        Self { normal: 1, col: 0, row: 2 },
        Self { normal: 2, col: 0, row: 1 },
    ];
}

/// The six sides of a shell: normal axis and sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Side {
    pub(crate) axes: SideAxes,
    pub(crate) sign: i32,
}

impl Side {
    pub(crate) const ALL: [Self; 6] = {
        let [x, y, z] = SideAxes::ALL;
        [
            Self { axes: x, sign: 1 },
            Self { axes: x, sign: -1 },
            Self { axes: y, sign: 1 },
            Self { axes: y, sign: -1 },
            Self { axes: z, sign: 1 },
            Self { axes: z, sign: -1 },
        ]
    };
}

impl Side {
    /// The cell in a row and column of the side, relative to V.
    #[inline]
    pub(crate) fn cell(&self, depth: i32, row: i32, col: i32) -> IVec3 {
        let mut c = IVec3::ZERO;
        (c[self.axes.normal], c[self.axes.row], c[self.axes.col]) = (depth, row, col);
        c
    }
}
