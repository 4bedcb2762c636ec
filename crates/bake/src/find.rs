//! The set of one cell.
//!
//! *A cell sees the objects that meet it, and those that its six sides see*: a free segment from an
//! eye in it to a point outside leaves it at a point of a side, and its rest is free as well. So
//! the sides are divided into parts, and the sets of the parts are joined. A part gets the objects
//! that casca does not prove hidden from all of it, of those of the part that it was divided from.
//! The part with most objects that no point of the sides is known to see, times its longest edge,
//! is divided next, until there is none or enough queries were asked.
//!
//! With enough queries, each cell of the grid that a side passes is asked first, by `Method::Cell`:
//! behind walls of solid boxes that is tightest.
//!
//! Parts inside of a box that holds no eye are left out: no free segment passes them. Others are
//! cut off at solid boxes that they reach into ([`TOUCH`]), since a solid that holds an eye hides
//! nothing from it.

use std::collections::BTreeSet;

use casca::glam::{IVec3, Vec3};
use casca::{Aabb, Method, Query, View};

use crate::level::Level;

/// Solids count as larger by this share of the coordinates of the part that meets them: four
/// roundings to single precision, in which their own corners are given. 10 micrometres at 40 m.
const TOUCH: f32 = 4.0 / (1 << 24) as f32;

/// The sides of a cell, each of which may take its share of the queries for cells of the grid.
const SIDES: f64 = 6.0;

/// A part is divided up to so often.
const DEEPEST: u32 = 24;

/// Up to this depth the middles of parts are looked from, so that it is known what is surely worth
/// no further division.
const LOOKED_FROM: u32 = 6;

/// Finds sets of cells, one after the other.
pub struct Finder<'l> {
    level: &'l Level,
    query: Query,
    by_cells: Query,
    queries: u32,
    most: u32,
}

/// A part of a side of a cell.
struct Part {
    low: Vec3,
    high: Vec3,
    depth: u32,
    /// The objects that may be seen from it, ascending.
    set: Vec<u32>,
}

impl<'l> Finder<'l> {
    /// A finder that asks up to about `queries` queries for each cell, 16 at least. More make
    /// smaller sets.
    pub fn new(level: &'l Level, queries: u32) -> Self {
        // The method's defaults are accepted.
        let by_cells = Query::with_method(Method::cell()).unwrap_or_default();
        Self { level, query: Query::new(), by_cells, queries: 0, most: queries.max(16) }
    }

    /// The objects that can be seen from anywhere in a box, ascending.
    pub fn set(&mut self, cell: Aabb) -> Vec<u32> {
        self.queries = 0;
        let level = self.level;
        let all: Vec<u32> = (0..level.len()).filter(|&i| level.bounds[i as usize].is_some()).collect();
        let meets = |&&i: &&u32| {
            level.bounds[i as usize]
                .is_some_and(|b| b.min.cmple(cell.max).all() && cell.min.cmple(b.max).all())
        };
        let mut found: BTreeSet<u32> = all.iter().filter(meets).copied().collect();
        let mut known = vec![false; level.len() as usize];
        found.iter().for_each(|&i| known[i as usize] = true);
        let mut parts = Vec::new();
        for axis in 0..3 {
            for at_high in [false, true] {
                let (mut low, mut high) = (cell.min, cell.max);
                if at_high {
                    low[axis] = high[axis]
                } else {
                    high[axis] = low[axis]
                }
                let faces = |&&i: &&u32| {
                    level.bounds[i as usize].is_some_and(|b| match at_high {
                        true => b.max[axis] >= cell.max[axis],
                        false => b.min[axis] <= cell.min[axis],
                    })
                };
                let set = all.iter().filter(faces).copied().collect();
                parts.push(Part { low, high, depth: 0, set });
            }
        }
        if level.has_solids {
            parts.iter_mut().for_each(|side| self.narrow_by_cells(side));
        }
        let mut open: Vec<Part> = Vec::new();
        for part in parts {
            self.put(part, &mut known, &mut open);
        }
        while self.queries < self.most {
            let undecided = |p: &Part| p.set.iter().filter(|&&i| !known[i as usize]).count() as f32;
            let worth = |p: &Part| undecided(p) * (p.high - p.low).max_element();
            let all = open.iter().enumerate().filter(|(_, p)| p.depth < DEEPEST);
            let most = all.map(|(at, p)| (at, worth(p)));
            // The first of several: the order of parts is that of their making.
            let Some((at, worth)) = most.rev().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            if worth == 0.0 {
                break;
            }
            let part = open.remove(at);
            for half in self.divided(part) {
                self.put(half, &mut known, &mut open);
            }
        }
        open.iter().for_each(|part| found.extend(&part.set));
        found.into_iter().collect()
    }

    /// Takes up a part: cuts off what lies in solids, and finds its set. Nothing may be left.
    fn put(&mut self, mut part: Part, known: &mut [bool], open: &mut Vec<Part>) {
        if !self.cut_off_solids(&mut part) {
            return;
        }
        let cell = Aabb::new(part.low, part.high);
        self.narrow(cell, &mut part.set);
        if part.depth <= LOOKED_FROM {
            let middle = (part.low + part.high) * 0.5;
            let mut seen = part.set.clone();
            self.narrow(Aabb::new(middle, middle), &mut seen);
            seen.iter().for_each(|&i| known[i as usize] = true);
        }
        open.push(part);
    }

    /// Keeps the objects of a side that may be seen from the cells of the grid that it passes, if
    /// there are queries for all of these. A result of [`Method::Cell`] holds for all eyes of its
    /// cell that are in no occluder.
    fn narrow_by_cells(&mut self, side: &mut Part) {
        let grid = self.level.scene.grid();
        let (first, last) = (grid.cell_of(side.low.as_dvec3()), grid.cell_of(side.high.as_dvec3()));
        let count = (last.as_dvec3() - first.as_dvec3() + 1.0).element_product();
        if count > f64::from(self.most) / SIDES {
            return;
        }
        let mut seen = vec![false; self.level.len() as usize];
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let cell = IVec3::new(x, y, z);
                    let (min, max) = grid.cell_bounds(cell);
                    let (low, high) = (min.as_vec3().max(side.low), max.as_vec3().min(side.high));
                    let mut part = Part { low, high: high.max(low), depth: 0, set: Vec::new() };
                    if self.cut_off_solids(&mut part) {
                        self.see_from_cell(cell, &part, &mut seen);
                    }
                }
            }
        }
        side.set.retain(|&i| seen[i as usize]);
    }

    /// Marks the objects that may be seen from the part of a side in one cell of the grid.
    fn see_from_cell(&mut self, cell: IVec3, part: &Part, seen: &mut [bool]) {
        self.queries += 1;
        // Some eyes may be inside of a closed mesh, where the result does not hold: so casca is
        // asked about all of the part, less the splinter at its border that the next cell may own.
        let inset = Vec3::splat(touch(&Aabb::new(part.low, part.high)));
        let inset = inset.min((part.high - part.low) * 0.5);
        let eyes = Aabb::new(part.low + inset, part.high - inset);
        let Ok(view) = View::of_cell(eyes) else { return seen.fill(true) };
        let mut pvs = self.by_cells.run(&self.level.scene, &view);
        // A splinter of a part may be rounded into the next cell.
        let is_there = self.level.scene.grid().cell_of(((eyes.min + eyes.max) * 0.5).as_dvec3()) == cell;
        if pvs.stats().eye_in_occluder || !is_there {
            self.queries += 1;
            let Ok(view) = View::of_cell(Aabb::new(part.low, part.high)) else { return seen.fill(true) };
            pvs = self.query.run(&self.level.scene, &view);
        }
        for id in pvs.iter() {
            if let Some(seen) = self.level.number(id).and_then(|number| seen.get_mut(number)) {
                *seen = true;
            }
        }
    }

    /// Keeps the objects of a set that may be seen from a box.
    fn narrow(&mut self, cell: Aabb, set: &mut Vec<u32>) {
        let Ok(view) = View::of_cell(cell) else { return };
        self.queries += 1;
        let pvs = self.query.run(&self.level.scene, &view);
        let mut seen = vec![false; self.level.len() as usize];
        for id in pvs.iter() {
            if let Some(seen) = self.level.number(id).and_then(|number| seen.get_mut(number)) {
                *seen = true;
            }
        }
        set.retain(|&i| seen[i as usize]);
    }

    /// Cuts off the ends of a part that lie in a solid box. Returns whether anything is left.
    fn cut_off_solids(&self, part: &mut Part) -> bool {
        // A cut may be what another box needs to reach across all of the rest.
        loop {
            let before = (part.low, part.high);
            let b = Aabb::new(part.low, part.high);
            for solid in self.level.solids_in(&b) {
                let touch = touch(&b);
                let (min, max) = (solid.min - touch, solid.max + touch);
                let spans = |i: usize| min[i] <= part.low[i] && max[i] >= part.high[i];
                match (0..3).filter(|&i| !spans(i)).collect::<Vec<_>>()[..] {
                    [] => return false,
                    [i] if min[i] <= part.low[i] && max[i] > part.low[i] => part.low[i] = max[i],
                    [i] if max[i] >= part.high[i] && min[i] < part.high[i] => part.high[i] = min[i],
                    _ => {}
                }
            }
            if before == (part.low, part.high) {
                return true;
            }
        }
    }

    /// Two parts of a part: at a side of a solid box that reaches into it, or in the middle of its
    /// longest edge.
    fn divided(&self, part: Part) -> [Part; 2] {
        let b = Aabb::new(part.low, part.high);
        let mut place: Option<(f32, usize, f32)> = None;
        for solid in self.level.solids_in(&b) {
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
        let edges = part.high - part.low;
        let longest = (0..3).max_by(|&i, &j| edges[i].total_cmp(&edges[j])).unwrap_or(0);
        let (axis, at) = match place {
            // Thin splinters are no better than halves.
            Some((least, axis, at)) if least >= 0.125 * edges.max_element() => (axis, at),
            _ => (longest, (part.low[longest] + part.high[longest]) * 0.5),
        };
        let depth = part.depth + 1;
        let mut halves = [
            Part { depth, set: part.set.clone(), ..part },
            Part { depth, set: part.set, low: part.low, high: part.high },
        ];
        halves[0].high[axis] = at;
        halves[1].low[axis] = at;
        halves
    }
}

/// By how much solids count as larger for a part.
fn touch(b: &Aabb) -> f32 {
    TOUCH * b.min.abs().max(b.max.abs()).max_element()
}
