//! The part of a file that is read: levels of an octree, and a box.

use glam::{DVec3, U64Vec3};

use crate::numeric;

/// Levels of a COPC or EPT file. A point lies in one level only: levels 0 to L together are the
/// cloud at the spacing of level L, half that of level L - 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Levels {
    /// All of them; other formats have no levels, and are read whole.
    #[default]
    All,
    /// Level 0, the coarsest, to this one.
    To(u32),
    /// Level 0 to the first whose spacing is at most this, in the units of the file; all levels if
    /// it is not positive.
    Spacing(f64),
}

/// The part of a file that is read.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Selection {
    /// The levels of COPC and EPT files.
    pub levels: Levels,
    /// The low and the high corner of a box: only points in it, or on its sides, are read. COPC and
    /// EPT files are read only where their nodes meet it.
    pub within: Option<[DVec3; 2]>,
}

impl Selection {
    /// Whether a point belongs to it.
    pub(super) fn has(&self, p: DVec3) -> bool {
        self.within.is_none_or(|[low, high]| p.cmpge(low).all() && p.cmple(high).all())
    }
}

/// The finest level that an octree may have: the numbers of its nodes fit into 32 bits.
const FINEST: u32 = 31;

/// A node of an octree: its level, and its place among those of that level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Key {
    pub level: u32,
    pub place: [u32; 3],
}

impl Key {
    pub const ROOT: Self = Self { level: 0, place: [0; 3] };

    /// The node of a level, x, y and z, if there is one.
    pub fn new(numbers: [i64; 4]) -> Option<Self> {
        let level = u32::try_from(numbers[0]).ok().filter(|&level| level <= FINEST)?;
        let inside = |i: i64| u32::try_from(i).ok().filter(|i| u64::from(*i) < 1 << level);
        let [_, x, y, z] = numbers.map(inside);
        Some(Self { level, place: [x?, y?, z?] })
    }
}

impl std::fmt::Display for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.place;
        write!(f, "{}-{x}-{y}-{z}", self.level)
    }
}

/// The octree of a file, and what is wanted of it.
pub(super) struct Octree {
    low: DVec3,
    side: f64,
    /// How far points may lie outside of their node.
    slack: DVec3,
    finest: u32,
    within: Option<[DVec3; 2]>,
}

impl Octree {
    /// In a cube, with the spacing of points at its root. `step` is the resolution of coordinates.
    pub fn new(
        (low, side): (DVec3, f64),
        spacing: f64,
        step: DVec3,
        wanted: &Selection,
    ) -> Result<Self, String> {
        if !(low.is_finite() && side > 0.0 && side.is_finite()) {
            return Err(format!("its octree has a side of {side} from {low}"));
        }
        let finest = match wanted.levels {
            Levels::Spacing(most) if most > 0.0 => {
                if !(spacing > 0.0 && spacing.is_finite()) {
                    return Err(format!("points of level 0 have a spacing of {spacing}"));
                }
                (spacing / most).log2().ceil().clamp(0.0, FINEST.into()) as u32
            }
            Levels::To(level) => level,
            Levels::All | Levels::Spacing(_) => FINEST,
        };
        let slack = step.abs() + side * numeric::NODE_SLACK;
        Ok(Self { low, side, slack, finest, within: wanted.within })
    }

    /// Whether points of a node or of nodes below it are wanted.
    pub fn wants(&self, key: Key) -> bool {
        let side = self.side / (1_u64 << key.level) as f64;
        let low = self.low + U64Vec3::from(key.place.map(u64::from)).as_dvec3() * side;
        let meets = |[from, to]: [DVec3; 2]| {
            (low - self.slack).cmple(to).all() && (low + side + self.slack).cmpge(from).all()
        };
        key.level <= self.finest && self.within.is_none_or(meets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octree(levels: Levels, within: Option<[DVec3; 2]>) -> Octree {
        let cube = (DVec3::splat(-4.0), 8.0);
        Octree::new(cube, 0.5, DVec3::splat(1e-3), &Selection { levels, within }).unwrap()
    }

    #[test]
    fn levels_end_at_the_spacing_that_is_wanted() {
        let ends = [(0.5, 0), (9.0, 0), (0.49, 1), (0.25, 1), (0.06, 4), (1e-300, 31), (f64::NAN, 31)];
        for (spacing, finest) in ends {
            assert_eq!(octree(Levels::Spacing(spacing), None).finest, finest, "{spacing}");
        }
        assert!(Octree::new((DVec3::ZERO, f64::NAN), 1.0, DVec3::ONE, &Selection::default()).is_err());
        let spaced = Selection { levels: Levels::Spacing(1.0), within: None };
        assert!(Octree::new((DVec3::ZERO, 1.0), 0.0, DVec3::ONE, &spaced).is_err());
    }

    #[test]
    fn nodes_are_wanted_where_they_meet_the_box() {
        let tree = octree(Levels::To(1), Some([DVec3::new(1.0, -9.0, -9.0), DVec3::splat(9.0)]));
        let wants = |numbers| tree.wants(Key::new(numbers).unwrap());
        assert!(wants([0, 0, 0, 0]) && wants([1, 1, 0, 1]) && !wants([1, 0, 0, 1]) && !wants([2, 3, 0, 0]));
        let touching = octree(Levels::All, Some([DVec3::ZERO, DVec3::ONE]));
        assert!(touching.wants(Key::new([1, 0, 0, 0]).unwrap()), "points on a side of a node");
    }

    #[test]
    fn numbers_that_no_node_has_are_refused() {
        for numbers in [[-1, 0, 0, 0], [32, 0, 0, 0], [1, 2, 0, 0], [1, 0, -1, 0], [0, 0, 0, i64::MAX]] {
            assert_eq!(Key::new(numbers), None);
        }
        assert_eq!(Key::new([31, (1 << 31) - 1, 0, 7]).unwrap().to_string(), "31-2147483647-0-7");
    }
}
