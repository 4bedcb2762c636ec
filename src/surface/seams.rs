//! Seams: where the surfaces of different static objects meet.

use std::collections::HashMap;

use super::weld::key;
use super::{NONE, Surface};

/// The ends of an open edge in order, and what tells its chain from others.
type Chain = ([[u32; 3]; 2], u64);

/// An open side of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Open {
    slot: u32,
    side: u32,
    /// Number of its patch.
    number: u32,
    /// Whether the patch runs along it from its lesser end.
    upwards: bool,
}

/// What is known of the surface of one object.
#[derive(Debug, Clone, Default)]
pub(crate) struct Place {
    /// Number of its first patch, if it has any.
    pub(crate) base: u32,
    /// Its open sides that run along one of another object: side, number of the other patch, and
    /// whether the two run in opposite directions. In order of sides.
    pub(crate) links: Vec<(u32, u32, bool)>,
}

/// Numbers the patches of all surfaces, and joins static ones.
#[derive(Debug, Clone, Default)]
pub(crate) struct Seams {
    places: Vec<Place>,
    /// For each number ever given, the object.
    owners: Vec<u32>,
    /// Ranges given back, by the logarithm of their length.
    free: Vec<Vec<u32>>,
    open: HashMap<Chain, Vec<Open>>,
}

impl Seams {
    /// All numbers are smaller.
    pub(crate) fn patches(&self) -> usize {
        self.owners.len()
    }

    /// The object that has a patch.
    pub(crate) fn owner(&self, number: u32) -> u32 {
        self.owners[number as usize]
    }

    pub(crate) fn place(&self, slot: u32) -> &Place {
        &self.places[slot as usize]
    }

    fn class(count: usize) -> usize {
        count.next_power_of_two().trailing_zeros() as usize
    }

    /// Numbers the patches of an object's surface, for as long as it has it.
    pub(crate) fn insert(&mut self, slot: u32, surface: &Surface, fixed: bool) {
        if self.places.len() <= slot as usize {
            self.places.resize_with(slot as usize + 1, Place::default);
        }
        let class = Self::class(surface.patches.len());
        if self.free.len() <= class {
            self.free.resize_with(class + 1, Vec::new);
        }
        let base = self.free[class].pop().unwrap_or_else(|| {
            self.owners.resize(self.owners.len() + (1 << class), NONE);
            self.owners.len() as u32 - (1 << class)
        });
        self.owners[base as usize..][..surface.patches.len()].fill(slot);
        self.places[slot as usize] = Place { base, links: Vec::new() };
        if !fixed {
            return;
        }
        for (chain, open) in opens(slot, surface, base) {
            let all = self.open.entry(chain).or_default();
            all.push(open);
            match *all.as_slice() {
                [a, b] if a.slot != b.slot => link(&mut self.places, a, b),
                // More than two: none of them cancels any other.
                [a, b, _] if a.slot != b.slot => {
                    unlink(&mut self.places, a);
                    unlink(&mut self.places, b);
                }
                _ => {}
            }
        }
    }

    /// Takes a surface out.
    pub(crate) fn remove(&mut self, slot: u32, surface: &Surface, fixed: bool) {
        let place = std::mem::take(&mut self.places[slot as usize]);
        self.free[Self::class(surface.patches.len())].push(place.base);
        if !fixed {
            return;
        }
        for (chain, open) in opens(slot, surface, place.base) {
            let Some(all) = self.open.get_mut(&chain) else { continue };
            let pair = all.len() == 2;
            all.retain(|o| *o != open);
            match *all.as_slice() {
                [] => {
                    self.open.remove(&chain);
                }
                [rest] if pair => unlink(&mut self.places, rest),
                [a, b] if a.slot != b.slot => link(&mut self.places, a, b),
                _ => {}
            }
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.owners.capacity() * 4
            + self.places.capacity() * size_of::<Place>()
            + self.places.iter().map(|p| p.links.capacity() * 12).sum::<usize>()
            + self.open.capacity() * size_of::<(Chain, Vec<Open>)>()
            + self.open.values().map(|v| v.capacity() * size_of::<Open>()).sum::<usize>()
    }
}

fn link(places: &mut [Place], a: Open, b: Open) {
    let opposite = a.upwards != b.upwards;
    for (own, other) in [(a, b), (b, a)] {
        let links = &mut places[own.slot as usize].links;
        let at = links.partition_point(|l| l.0 < own.side);
        links.insert(at, (own.side, other.number, opposite));
    }
}

fn unlink(places: &mut [Place], open: Open) {
    let links = &mut places[open.slot as usize].links;
    let at = links.partition_point(|l| l.0 < open.side);
    if links.get(at).is_some_and(|l| l.0 == open.side) {
        links.remove(at);
    }
}

/// The open sides of a surface.
fn opens(slot: u32, surface: &Surface, base: u32) -> impl Iterator<Item = (Chain, Open)> {
    let mut patch = 0;
    surface.open.iter().map(move |&(index, chain)| {
        // Sides are in the order of their patches.
        while surface.patches[patch as usize].last <= index {
            patch += 1;
        }
        let side = &surface.sides[index as usize];
        let ends = [key(side.from), key(side.to)];
        let upwards = ends[0] <= ends[1];
        let ends = if upwards { ends } else { [ends[1], ends[0]] };
        ((ends, chain), Open { slot, side: index, number: base + patch, upwards })
    })
}
