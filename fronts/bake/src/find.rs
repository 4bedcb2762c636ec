//! The set of one cell.
//!
//! *A cell sees the objects that meet it, and those that its six sides see*: a free segment from an
//! eye in it to a point outside leaves it at a point of a side, and its rest is free and beyond
//! that side. So the sides are divided into parts, and the sets of the parts are joined. A part
//! gets the objects that neither walls ([`casca_walls`]) nor casca prove hidden from all of it, of
//! those of the part that it was divided from. The part with most objects that no point of the
//! sides is known to see, times its longest edge, is divided next, until there is none or enough
//! queries were asked.

use std::collections::BTreeSet;

use casca::{Aabb, Query, View};
use casca_walls::Span;

use crate::level::Level;
use crate::part::{Part, Side, sides, touch};

/// A part is divided up to so often.
const DEEPEST: u32 = 24;

/// Queries ask from an eye in each part up to this depth: objects that it sees are worth no further
/// division.
const LOOKED_FROM: u32 = 6;

/// Parts of a part of a side and of an object that walls are asked about, at most.
const MOST_PARTS: u32 = 256;

/// The same for an eye and an object that a query from there found: it is seen mostly.
const MOST_PARTS_OF_SEEN: u32 = 16;

/// Finds sets of cells, one after the other.
pub struct Finder<'l> {
    level: &'l Level,
    query: Query,
    queries: u32,
    most: u32,
}

impl<'l> Finder<'l> {
    /// A finder that asks up to about `queries` queries for each cell, 16 at least. More make
    /// smaller sets.
    pub fn new(level: &'l Level, queries: u32) -> Self {
        Self { level, query: Query::new(), queries: 0, most: queries.max(16) }
    }

    /// The objects that can be seen from anywhere in a box, ascending.
    pub fn set(&mut self, cell: Aabb) -> Vec<u32> {
        self.queries = 0;
        let level = self.level;
        let meets = |&i: &u32| {
            level.bounds[i as usize]
                .is_some_and(|b| b.min.cmple(cell.max).all() && cell.min.cmple(b.max).all())
        };
        let mut found: BTreeSet<u32> = (0..level.len()).filter(meets).collect();
        let mut known = vec![false; level.len() as usize];
        found.iter().for_each(|&i| known[i as usize] = true);
        let mut open: Vec<Part> = Vec::new();
        for part in sides(level, &cell) {
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
            for half in part.divided(level) {
                self.put(half, &mut known, &mut open);
            }
        }
        open.iter().for_each(|part| found.extend(&part.set));
        found.into_iter().collect()
    }

    /// Takes up a part: cuts off what lies in solids, and finds its set. Nothing may be left.
    fn put(&mut self, mut part: Part, known: &mut [bool], open: &mut Vec<Part>) {
        if !part.cut_off_solids(self.level) {
            return;
        }
        let eyes = Aabb::new(part.low, part.high);
        // All objects of a side are many: one query leaves few of them for the walls.
        if part.depth == 0 {
            self.narrow(eyes, &mut part.set);
        }
        if let Some(eye) = part.eye(self.level).filter(|_| part.depth <= LOOKED_FROM) {
            let mut seen: Vec<u32> = part.set.iter().filter(|&&i| !known[i as usize]).copied().collect();
            let eye = Aabb::new(eye, eye);
            self.narrow(eye, &mut seen);
            self.narrow_by_walls(&eye, part.side, &mut seen, MOST_PARTS_OF_SEEN, known);
            seen.iter().for_each(|&i| known[i as usize] = true);
        }
        self.narrow_by_walls(&eyes, part.side, &mut part.set, MOST_PARTS, known);
        if part.depth > 0 && part.set.iter().any(|&i| !known[i as usize]) {
            self.narrow(eyes, &mut part.set);
        }
        open.push(part);
    }

    /// Keeps the objects beyond a side that are known to be seen from somewhere, or that walls do
    /// not hide from all eyes in a box.
    fn narrow_by_walls(&self, eyes: &Aabb, side: Side, set: &mut Vec<u32>, most: u32, known: &[bool]) {
        let level = self.level;
        let span = |b: &Aabb| Span { min: b.min.as_dvec3(), max: b.max.as_dvec3() };
        let eyes = span(eyes);
        let mut hint = 0;
        set.retain(|&i| {
            let Some(b) = level.bounds[i as usize].filter(|_| !known[i as usize]) else { return true };
            // An object is hidden neither by its own faces, nor by a wall that it hangs on; a cell
            // has no faces.
            let apart = if level.cells.is_some() { 0.0 } else { f64::from(touch(&b)) };
            !level.walls.hide_in_parts(&eyes, &span(&side.beyond(&b)), apart, most, &mut hint)
        });
    }

    /// Keeps the objects of a set that may be seen from a box.
    fn narrow(&mut self, eyes: Aabb, set: &mut Vec<u32>) {
        let Ok(view) = View::of_cell(eyes) else { return };
        self.queries += 1;
        let mut seen = vec![false; self.level.len() as usize];
        for id in self.query.run(&self.level.scene, &view).iter() {
            if let Some(seen) = self.level.number(id).and_then(|number| seen.get_mut(number)) {
                *seen = true;
            }
        }
        set.retain(|&i| seen[i as usize]);
    }
}
