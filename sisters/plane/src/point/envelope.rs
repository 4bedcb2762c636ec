//! The nearest wall in each direction: the lower envelope of the walls around the eye.
//!
//! The walls, sorted by the directions where they begin, are put into layers, each of walls that
//! follow each other: as few layers as there are walls one behind the other. Two layers each are
//! merged, again and again (Hershberger 1989, "Finding the upper envelope of n line segments in
//! O(n log n) time"). An envelope of n walls has O(n α(n)) steps, also if walls cross, so that all
//! merges together cost O(n α(n) log k) comparisons for k layers, however many crossings there are
//! behind it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::DVec2;

use crate::numeric::KEY;
use crate::point::arcs::{Arc, Ray, keys_tell, order};
use crate::point::wall::{Around, Direction};

/// In place of a wall: nothing stops the eye.
pub(crate) const OPEN: u32 = u32::MAX;

/// In place of a wall: a solid stops the eye at once.
pub(crate) const BLOCKED: u32 = u32::MAX - 1;

/// Room for so many more steps and parts of walls than there are walls, as a few are cut in two.
const MORE: usize = 8;

/// From this direction on, a wall is the nearest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    pub(crate) from: Direction,
    /// Its number, [`OPEN`] or [`BLOCKED`].
    pub(crate) wall: u32,
}

/// A part of the view in one quarter of the circle.
#[derive(Debug, Clone)]
pub(crate) struct Domain {
    pub(crate) arc: Arc,
    /// The steps that cover it.
    pub(crate) steps: Range<usize>,
}

impl Domain {
    /// One of the pieces that it falls into at its steps.
    pub(crate) fn piece(&self, steps: &[Step], i: usize) -> Piece {
        let to = steps.get(i + 1).map_or(self.arc.to.into(), |next| next.from);
        Piece { from: steps[i].from, to, wall: steps[i].wall }
    }
}

/// A part of the region: the directions between two, as far as a wall, [`OPEN`] or [`BLOCKED`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) from: Direction,
    pub(crate) to: Direction,
    pub(crate) wall: u32,
}

/// The nearest walls in all directions of a view.
#[derive(Debug, Clone, Default)]
pub(crate) struct Envelope {
    pub(crate) domains: Vec<Domain>,
    pub(crate) steps: Vec<Step>,
    /// Walls that no direction of the view reaches, not even their ends: some of them.
    pub(crate) hidden: Vec<u32>,
    /// Memory used again.
    items: Vec<Item>,
    /// Keys to sort the items by, and their places, in order.
    keys: Vec<(u64, u32)>,
    /// The keys of the items in one arc of the view that one wall alone does not plainly hide.
    kept: Vec<(u64, u32)>,
    layers: Layers,
    runs: [Runs; 2],
}

/// Envelopes one after the other: their steps, and where each ends.
#[derive(Debug, Clone, Default)]
struct Runs {
    steps: Vec<Step>,
    ends: Vec<usize>,
}

impl Runs {
    fn clear(&mut self) {
        self.steps.clear();
        self.ends.clear();
    }

    fn get(&self, run: usize) -> &[Step] {
        &self.steps[run.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[run]]
    }

    fn end(&mut self) {
        self.ends.push(self.steps.len());
    }

    /// Adds a step to the last envelope.
    fn push(&mut self, from: Direction, wall: u32) {
        let first = self.ends.last().copied().unwrap_or(0);
        if self.steps[first..].last().is_none_or(|last| last.wall != wall) {
            self.steps.push(Step { from, wall });
        }
    }
}

impl Envelope {
    /// Finds the nearest walls in the arcs of a view, of which each is in one quarter. In the arcs
    /// of `blocked` nothing is seen.
    pub(crate) fn build(&mut self, around: &Around, view: &[Arc], blocked: &[Arc]) {
        self.collect(around, view, blocked);
        self.domains.clear();
        self.steps.clear();
        self.hidden.clear();
        let items = &self.items[..];
        let mut rest = &self.keys[..];
        for (number, arc) in view.iter().enumerate() {
            let count = rest.partition_point(|key| usize::from(items[key.1 as usize].domain) == number);
            let (own, others) = rest.split_at(count);
            rest = others;
            let first = self.steps.len();
            drop_hidden(around, (items, own), &mut self.kept, &mut self.hidden);
            merge_all(around, arc, (items, &self.kept), &mut self.layers, &mut self.runs);
            self.steps.extend_from_slice(self.runs[0].get(0));
            self.domains.push(Domain { arc: *arc, steps: first..self.steps.len() });
        }
    }

    /// Clips the walls to the arcs of the view, and sorts the parts by arc and by the direction
    /// where they begin.
    fn collect(&mut self, around: &Around, view: &[Arc], blocked: &[Arc]) {
        let eye = around.eye;
        self.items.clear();
        self.items.reserve(around.walls.len() + MORE);
        let walls = around.walls.iter().zip(0u32..);
        let walls = walls.flat_map(|(wall, number)| wall.arcs(around.circle).map(move |arc| (number, arc)));
        for (wall, part) in walls.chain(blocked.iter().map(|&arc| (BLOCKED, arc))) {
            for (number, arc) in view.iter().enumerate().filter(|(_, arc)| arc.quarter == part.quarter) {
                let clipped = part.within(eye, arc);
                self.items.extend(clipped.map(|arc| Item { domain: number as u8, wall, arc }));
            }
        }
        // A number from 0 to 1 has 62 bits, which grow with it; there are five arcs at most.
        let items = &self.items;
        let key = |item: &Item| (item.arc.from.key / 4.0).to_bits() >> 1 | u64::from(item.domain) << 61;
        self.keys.clear();
        self.keys.extend(items.iter().map(key).zip(0..));
        self.keys.sort_unstable_by_key(|key| key.0);
        // Keys tell apart all but those that are near.
        let item = |key: &(u64, u32)| &items[key.1 as usize];
        let near = |a: &(u64, u32), b: &(u64, u32)| {
            let (a, b) = (item(a), item(b));
            a.domain == b.domain && !keys_tell(b.arc.from.key - a.arc.from.key, KEY)
        };
        for run in self.keys.chunk_by_mut(near).filter(|run| run.len() > 1) {
            run.sort_unstable_by(|a, b| {
                let (a, b) = (item(a), item(b));
                order(eye, &a.arc.from, &b.arc.from).then(a.wall.cmp(&b.wall))
            });
        }
    }
}

/// A part of a wall in an arc of the view.
#[derive(Debug, Clone, Copy)]
struct Item {
    /// The number of the arc.
    domain: u8,
    /// The wall, or what stands for it.
    wall: u32,
    arc: Arc,
}

/// No item follows.
const NONE: u32 = u32::MAX;

/// Layers of items that are sorted by the directions where they begin.
#[derive(Debug, Clone, Default)]
struct Layers {
    /// The first item of each layer, and the last.
    ends: Vec<[u32; 2]>,
    /// By item: the next one of its layer.
    next: Vec<u32>,
    /// The layers by the key where each ends, about.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Layers {
    /// Puts each item into the layer that ends first, or into a new one if none ends before it.
    /// `sorted` are the places of the items, each with a key. There are as many layers as items
    /// overlap. Costs the logarithm of that for each item.
    fn build(&mut self, eye: DVec2, items: &[Item], sorted: &[(u64, u32)]) {
        self.ends.clear();
        self.queue.clear();
        self.next.clear();
        self.next.resize(items.len(), NONE);
        // Keys are not negative: their bits grow with them.
        let key = |ray: &Ray| ray.key.to_bits();
        for &(_, number) in sorted {
            let item = &items[number as usize];
            let follows =
                |layer: &[u32; 2]| order(eye, &items[layer[1] as usize].arc.to, &item.arc.from).is_le();
            if let Some(mut least) = self.queue.peek_mut()
                && let layer = &mut self.ends[least.0.1 as usize]
                && follows(layer)
            {
                self.next[layer[1] as usize] = number;
                layer[1] = number;
                least.0.0 = key(&item.arc.to);
            } else {
                self.queue.push(Reverse((key(&item.arc.to), self.ends.len() as u32)));
                self.ends.push([number; 2]);
            }
        }
    }

    /// The items of a layer, in their order.
    fn items<'a>(&'a self, layer: usize, items: &'a [Item]) -> impl Iterator<Item = &'a Item> {
        let first = Some(self.ends[layer][0]);
        let next = |&at: &u32| Some(self.next[at as usize]).filter(|&next| next != NONE);
        std::iter::successors(first, next).map(|at| &items[at as usize])
    }
}

/// Drops the parts of walls that lie behind one wall that was in front when they began: most of
/// those that are hidden, for two comparisons each.
fn drop_hidden(
    around: &Around,
    (items, sorted): (&[Item], &[(u64, u32)]),
    kept: &mut Vec<(u64, u32)>,
    hidden: &mut Vec<u32>,
) {
    let eye = around.eye;
    kept.clear();
    kept.reserve(sorted.len());
    // The part in front, and one that goes on behind it.
    let mut fronts: [Option<&Item>; 2] = [None; 2];
    for &key in sorted {
        let item = &items[key.1 as usize];
        let goes_on = |front: &&Item| order(eye, &item.arc.from, &front.arc.to).is_lt();
        if fronts[0].filter(goes_on).is_none() {
            fronts = [fronts[1].filter(goes_on), None];
        }
        match fronts[0] {
            _ if item.wall == BLOCKED => {}
            None => fronts[0] = Some(item),
            Some(front) => {
                let [wall, other] = [front, item].map(|item| around.wall(item.wall));
                let hides = |along: Ray| around.nearer(wall, other, &along.into()) > 0.0;
                let ends = order(eye, &front.arc.to, &item.arc.to);
                let is_longer = ends.is_lt();
                if !hides(item.arc.from) {
                    fronts = [Some(item), (!is_longer).then_some(front)];
                } else if is_longer {
                    fronts[1] = Some(item);
                } else if hides(item.arc.to) {
                    // Beside the one in front, its end may be seen.
                    let is_inside = ends.is_gt() && order(eye, &front.arc.from, &item.arc.from).is_lt();
                    hidden.extend((is_inside && other.is_in_one_quarter()).then_some(item.wall));
                    continue;
                }
            }
        }
        kept.push(key);
    }
}

/// Makes the envelope of parts of walls in an arc: it is the only one in the first of `runs` then.
/// `sorted` are places of items, each with a key.
fn merge_all(
    around: &Around,
    arc: &Arc,
    (items, sorted): (&[Item], &[(u64, u32)]),
    layers: &mut Layers,
    runs: &mut [Runs; 2],
) {
    let eye = around.eye;
    let [now, next] = runs;
    now.clear();
    now.steps.reserve(2 * sorted.len() + MORE);
    next.steps.reserve(2 * sorted.len() + MORE);
    layers.build(eye, items, sorted);
    for layer in 0..layers.ends.len() {
        // Where the part before ends.
        let mut at = arc.from;
        for item in layers.items(layer, items) {
            if order(eye, &at, &item.arc.from).is_lt() {
                now.push(at.into(), OPEN);
            }
            now.push(item.arc.from.into(), item.wall);
            at = item.arc.to;
        }
        if order(eye, &at, &arc.to).is_lt() {
            now.push(at.into(), OPEN);
        }
        now.end();
    }
    if sorted.is_empty() {
        now.push(arc.from.into(), OPEN);
        now.end();
    }
    while now.ends.len() > 1 {
        next.clear();
        for pair in 0..now.ends.len() / 2 {
            merge(around, arc, [now.get(2 * pair), now.get(2 * pair + 1)], next);
            next.end();
        }
        if now.ends.len() % 2 == 1 {
            next.steps.extend_from_slice(now.get(now.ends.len() - 1));
            next.end();
        }
        std::mem::swap(now, next);
    }
}

/// Merges two envelopes of an arc.
fn merge(around: &Around, arc: &Arc, [a, b]: [&[Step]; 2], out: &mut Runs) {
    let (mut i, mut j) = (0, 0);
    let end = arc.to.into();
    let Some(Step { from, .. }) = a.first() else { return };
    let mut from = *from;
    loop {
        let (next_a, next_b) = (a.get(i + 1), b.get(j + 1));
        let turn = match (next_a, next_b) {
            (Some(a), Some(b)) => around.turn(&a.from, &b.from),
            (Some(_), None) => 1.0,
            (None, Some(_)) => -1.0,
            (None, None) => 0.0,
        };
        let next = if turn >= 0.0 { next_a } else { next_b };
        let to = next.map_or(&end, |step| &step.from);
        nearest(around, [a[i].wall, b[j].wall], [&from, to], arc.quarter, out);
        if next.is_none() {
            return;
        }
        from = *to;
        i += usize::from(turn >= 0.0);
        j += usize::from(turn <= 0.0);
    }
}

/// Adds the nearer of two walls between two directions.
fn nearest(around: &Around, [a, b]: [u32; 2], [from, to]: [&Direction; 2], quarter: u8, out: &mut Runs) {
    if a == b || a == OPEN || b == BLOCKED {
        return out.push(*from, b);
    }
    if b == OPEN || a == BLOCKED {
        return out.push(*from, a);
    }
    let walls = [a, b].map(|number| around.wall(number));
    let [first, last] = [from, to].map(|along| around.nearer(walls[0], walls[1], along));
    if first >= 0.0 && last >= 0.0 {
        out.push(*from, a);
    } else if first <= 0.0 && last <= 0.0 {
        out.push(*from, b);
    } else {
        // The first is nearer clockwise of the crossing, or else counterclockwise.
        let flipped = first < 0.0;
        out.push(*from, if flipped { b } else { a });
        out.push(around.crossing([a, b], flipped, quarter), if flipped { a } else { b });
    }
}
