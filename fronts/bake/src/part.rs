//! The sides of a cell, and parts of them.
//!
//! Parts inside of a box that holds no eye are left out: no free segment passes them. Others are
//! cut off at solid boxes that they reach into ([`TOUCH`]), since a solid that holds an eye hides
//! nothing from it.

use casca::Aabb;
use casca::glam::Vec3;

use crate::level::Level;

/// Solids count as larger by this share of the coordinates of the part that meets them, 10
/// micrometres at 40 m. Objects that are nearer behind a wall, by the same share, lie in it.
const TOUCH: f32 = casca_baked::NEAR as f32;

/// Solids that reach less than this share of its longest edge into a part do not divide it: thin
/// splinters are no better than halves.
const SPLINTER: f32 = 0.125;

/// One of the six sides of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    axis: usize,
    at_high: bool,
    at: f32,
}

impl Side {
    /// The part of a box that lies beyond the side, or in it.
    pub(crate) fn beyond(&self, b: &Aabb) -> Aabb {
        let (mut min, mut max) = (b.min, b.max);
        match self.at_high {
            true => min[self.axis] = min[self.axis].max(self.at),
            false => max[self.axis] = max[self.axis].min(self.at),
        }
        Aabb::new(min.min(max), max.max(min))
    }

    /// Whether a box ends at the side, on the cell's side of it: an eye on its face looks away.
    fn backs(&self, b: &Aabb) -> bool {
        self.at == if self.at_high { b.max[self.axis] } else { b.min[self.axis] }
    }

    /// Whether a part of a box lies beyond the side. What lies in it is seen through the cell or
    /// through another side.
    fn faces(&self, b: &Aabb) -> bool {
        match self.at_high {
            true => b.max[self.axis] > self.at,
            false => b.min[self.axis] < self.at,
        }
    }
}

/// A part of a side of a cell.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) side: Side,
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
    pub(crate) depth: u32,
    /// The objects that may be seen from it, ascending.
    pub(crate) set: Vec<u32>,
}

/// The sides of a cell, each with all objects beyond it.
pub(crate) fn sides(level: &Level, cell: &Aabb) -> Vec<Part> {
    let each = (0..3).flat_map(|axis| [(axis, false), (axis, true)]);
    let side = |(axis, at_high): (usize, bool)| {
        let (mut low, mut high) = (cell.min, cell.max);
        if at_high {
            low[axis] = high[axis]
        } else {
            high[axis] = low[axis]
        }
        let side = Side { axis, at_high, at: low[axis] };
        let is_beyond = |&i: &u32| level.bounds[i as usize].is_some_and(|b| side.faces(&b));
        let set = (0..level.len()).filter(is_beyond).collect();
        Part { side, low, high, depth: 0, set }
    };
    each.map(side).collect()
}

impl Part {
    /// Cuts off the ends that lie in a solid box. Returns whether anything is left.
    pub(crate) fn cut_off_solids(&mut self, level: &Level) -> bool {
        // A cut may be what another box needs to reach across all of the rest.
        loop {
            let before = (self.low, self.high);
            let b = Aabb::new(self.low, self.high);
            for solid in level.solids_in(&b).filter(|solid| !self.side.backs(solid)) {
                let touch = touch(&b);
                let (min, max) = (solid.min - touch, solid.max + touch);
                let spans = |i: usize| min[i] <= self.low[i] && max[i] >= self.high[i];
                match (0..3).filter(|&i| !spans(i)).collect::<Vec<_>>()[..] {
                    [] => return false,
                    [i] if min[i] <= self.low[i] && max[i] > self.low[i] => self.low[i] = max[i],
                    [i] if max[i] >= self.high[i] && min[i] < self.high[i] => self.high[i] = min[i],
                    _ => {}
                }
            }
            if before == (self.low, self.high) {
                return true;
            }
        }
    }

    /// An eye in it that is in no solid box, if its middle or the middle of a quarter is that.
    pub(crate) fn eye(&self, level: &Level) -> Option<Vec3> {
        let at = |x: f32, y: f32, z: f32| self.low + (self.high - self.low) * Vec3::new(x, y, z);
        let quarters = (0..8).map(|i: u8| {
            let share = |bit: u8| if i >> bit & 1 == 0 { 0.25 } else { 0.75 };
            at(share(0), share(1), share(2))
        });
        let is_free = |eye: &Vec3| level.solids_in(&Aabb::new(*eye, *eye)).next().is_none();
        std::iter::once(at(0.5, 0.5, 0.5)).chain(quarters).find(is_free)
    }

    /// Two parts of it: at a side of a solid box that reaches into it, or in the middle of its
    /// longest edge.
    pub(crate) fn divided(self, level: &Level) -> [Self; 2] {
        let b = Aabb::new(self.low, self.high);
        let mut place: Option<(f32, usize, f32)> = None;
        for solid in level.solids_in(&b) {
            let touch = touch(&b);
            let (min, max) = (solid.min - touch, solid.max + touch);
            let edges = max.min(b.max) - min.max(b.min);
            let least =
                (0..3).filter(|&i| b.max[i] > b.min[i]).map(|i| edges[i]).fold(f32::INFINITY, f32::min);
            for i in 0..3 {
                for at in [min[i], max[i]] {
                    let is_inside = b.min[i] < at && at < b.max[i];
                    if is_inside && place.is_none_or(|(most, ..)| least > most) {
                        place = Some((least, i, at));
                    }
                }
            }
        }
        let edges = self.high - self.low;
        let longest = (0..3).max_by(|&i, &j| edges[i].total_cmp(&edges[j])).unwrap_or(0);
        let (axis, at) = match place {
            Some((least, axis, at)) if least >= SPLINTER * edges.max_element() => (axis, at),
            _ => (longest, (self.low[longest] + self.high[longest]) * 0.5),
        };
        let depth = self.depth + 1;
        let mut halves = [
            Self { depth, set: self.set.clone(), ..self },
            Self { depth, set: self.set, side: self.side, low: self.low, high: self.high },
        ];
        halves[0].high[axis] = at;
        halves[1].low[axis] = at;
        halves
    }
}

/// By how much solids count as larger for a part, and objects for the walls.
pub(crate) fn touch(b: &Aabb) -> f32 {
    TOUCH * b.min.abs().max(b.max.abs()).max_element()
}
