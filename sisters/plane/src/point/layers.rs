//! Parts of walls in layers: those of a layer follow each other.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use crate::point::arcs::{Arc, Ray, order};

/// A part of a wall in an arc of the view.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Item {
    /// The number of the arc.
    pub(crate) domain: u8,
    /// The wall, or what stands for it.
    pub(crate) wall: u32,
    pub(crate) arc: Arc,
}

/// No item follows.
const NONE: u32 = u32::MAX;

/// Layers of items that are sorted by the directions where they begin.
#[derive(Debug, Clone, Default)]
pub(crate) struct Layers {
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
    pub(crate) fn build(&mut self, eye: DVec2, items: &[Item], sorted: &[(u64, u32)]) {
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

    /// How many layers there are.
    pub(crate) fn count(&self) -> usize {
        self.ends.len()
    }

    /// The items of a layer, in their order.
    pub(crate) fn items<'a>(&'a self, layer: usize, items: &'a [Item]) -> impl Iterator<Item = &'a Item> {
        let first = Some(self.ends[layer][0]);
        let next = |&at: &u32| Some(self.next[at as usize]).filter(|&next| next != NONE);
        std::iter::successors(first, next).map(|at| &items[at as usize])
    }
}
