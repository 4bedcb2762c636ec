//! Seams: where the surfaces of different static objects share an edge.

use std::collections::BTreeMap;

use casca_slots::Slot;
use smallvec::SmallVec;

use crate::heap::in_tree;
use crate::mesh::surface::index::PatchNumber;
use crate::mesh::surface::patch::Surface;
use crate::mesh::surface::position::key;

/// The ends of an open edge in order, and a number that tells its chain from others.
type Chain = ([[u32; 3]; 2], u64);

/// An open side of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Open {
    slot: Slot,
    side: u32,
    /// Number of its patch.
    number: PatchNumber,
    /// Whether the patch runs along it from its lesser end.
    upwards: bool,
}

/// A link of an object's side that comes, or goes: object, side, number of the other patch and
/// whether the two run in opposite directions.
type LinkChange = (Slot, u32, Option<(PatchNumber, bool)>);

/// Up to this many changes of an object's links are made one by one; more are merged into the list.
const FEW: usize = 4;

/// The numbers and links of the surface of one object.
#[derive(Debug, Clone, Default)]
pub(crate) struct Place {
    /// Number of its first patch, if it has any.
    pub(crate) base: PatchNumber,
    /// Its open sides that run along one of another object: side, number of the other patch, and
    /// whether the two run in opposite directions. In order of sides.
    pub(crate) links: Vec<(u32, PatchNumber, bool)>,
}

/// Numbers the patches of all surfaces, and joins static ones.
#[derive(Debug, Clone, Default)]
pub(crate) struct Seams {
    places: Vec<Place>,
    /// All numbers ever given are smaller.
    end: PatchNumber,
    /// Ranges given back, by the logarithm of their length.
    free: Vec<Vec<PatchNumber>>,
    /// The open sides of static objects at each chain: number of the patch and its direction, by
    /// object and side. Thousands may share one.
    open: BTreeMap<(Chain, Slot, u32), (PatchNumber, bool)>,
}

impl Seams {
    /// All numbers are smaller.
    pub(crate) fn patches(&self) -> usize {
        self.end.index()
    }

    pub(crate) fn place(&self, slot: Slot) -> &Place {
        &self.places[slot.index()]
    }

    fn class(count: usize) -> usize {
        count.next_power_of_two().trailing_zeros() as usize
    }

    /// Leaves no numbers that were not given before.
    #[cfg(test)]
    pub(crate) fn use_up(&mut self) {
        self.end = PatchNumber::new(u32::MAX - 1);
    }

    /// Numbers the patches of an object's surface, for as long as it has it; false, without a
    /// change, if there are no numbers left.
    pub(crate) fn insert(&mut self, slot: Slot, surface: &Surface, fixed: bool) -> bool {
        if self.places.len() <= slot.index() {
            self.places.resize_with(slot.index() + 1, Place::default);
        }
        let class = Self::class(surface.patch_count());
        if self.free.len() <= class {
            self.free.resize_with(class + 1, Vec::new);
        }
        let base = match self.free[class].pop() {
            Some(base) => base,
            None => {
                // The last number means none.
                let end = self.end.get().checked_add(1 << class).map(PatchNumber::new);
                let Some(end) = end.filter(|&end| end < PatchNumber::NONE) else { return false };
                std::mem::replace(&mut self.end, end)
            }
        };
        self.places[slot.index()] = Place { base, links: Vec::new() };
        if !fixed {
            return true;
        }
        let mut changes = Vec::new();
        for (chain, open) in opens(slot, surface, base) {
            self.open.insert((chain, slot, open.side), (open.number, open.upwards));
            let all = self.at(chain);
            match *all.as_slice() {
                [a, b] => link(a, b, &mut changes),
                // More than two: none of them cancels any other.
                [_, _, _] => unlink(all.into_iter().filter(|o| *o != open), &mut changes),
                _ => {}
            }
        }
        self.apply(changes);
        true
    }

    /// The open sides at a chain: four of them, if there are more.
    fn at(&self, chain: Chain) -> SmallVec<[Open; 4]> {
        let (first, last) = (Slot::new(0), Slot::new(u32::MAX));
        let all = self.open.range((chain, first, 0)..=(chain, last, u32::MAX)).take(4);
        all.map(|(&(_, slot, side), &(number, upwards))| Open { slot, side, number, upwards }).collect()
    }

    /// Changes links; of several changes of one the last counts.
    fn apply(&mut self, mut changes: Vec<LinkChange>) {
        changes.sort_by_key(|c| (c.0, c.1));
        for own in changes.chunk_by(|a, b| a.0 == b.0) {
            let links = &mut self.places[own[0].0.index()].links;
            let last = own.chunk_by(|a, b| a.1 == b.1).filter_map(|same| same.last());
            if own.len() <= FEW {
                for &(_, side, new) in last {
                    let at = links.partition_point(|l| l.0 < side);
                    let there = links.get(at).is_some_and(|l| l.0 == side);
                    links.splice(at..at + usize::from(there), new.map(|(number, way)| (side, number, way)));
                }
                continue;
            }
            let mut merged = Vec::with_capacity(links.len() + own.len());
            let mut rest = links.as_slice();
            for &(_, side, new) in last {
                let before = rest.partition_point(|l| l.0 < side);
                merged.extend_from_slice(&rest[..before]);
                let there = rest.get(before).is_some_and(|l| l.0 == side);
                rest = &rest[before + usize::from(there)..];
                merged.extend(new.map(|(number, way)| (side, number, way)));
            }
            merged.extend_from_slice(rest);
            *links = merged;
        }
    }

    /// Takes a surface out.
    pub(crate) fn remove(&mut self, slot: Slot, surface: &Surface, fixed: bool) {
        let place = std::mem::take(&mut self.places[slot.index()]);
        self.free[Self::class(surface.patch_count())].push(place.base);
        if !fixed {
            return;
        }
        let mut changes = Vec::new();
        for (chain, open) in opens(slot, surface, place.base) {
            self.open.remove(&(chain, slot, open.side));
            let all = self.at(chain);
            match *all.as_slice() {
                [_] => unlink(all.into_iter(), &mut changes),
                [a, b] => link(a, b, &mut changes),
                _ => {}
            }
        }
        // Its own links are gone already.
        changes.retain(|c| c.0 != slot);
        self.apply(changes);
    }

    pub(crate) fn bytes(&self) -> usize {
        self.places.capacity() * size_of::<Place>()
            + self
                .places
                .iter()
                .map(|p| p.links.capacity() * size_of::<(u32, PatchNumber, bool)>())
                .sum::<usize>()
            + self.free.iter().map(|list| list.capacity() * size_of::<PatchNumber>()).sum::<usize>()
            + in_tree::<((Chain, Slot, u32), (PatchNumber, bool))>(self.open.len())
    }
}

/// Two open sides of different objects run along each other.
fn link(a: Open, b: Open, changes: &mut Vec<LinkChange>) {
    if a.slot != b.slot {
        let opposite = a.upwards != b.upwards;
        changes.extend([(a, b), (b, a)].map(|(o, other)| (o.slot, o.side, Some((other.number, opposite)))));
    }
}

fn unlink(sides: impl Iterator<Item = Open>, changes: &mut Vec<LinkChange>) {
    changes.extend(sides.map(|o| (o.slot, o.side, None)));
}

/// The open sides of a surface.
fn opens(slot: Slot, surface: &Surface, base: PatchNumber) -> impl Iterator<Item = (Chain, Open)> {
    let mut chain = surface.chain();
    let open = surface.leaf_sides().filter(|(_, _, side)| side.is_open());
    open.map(move |(patch, index, side)| {
        let chain = chain(index);
        let ends = surface.ends(&side).map(key);
        let upwards = ends[0] <= ends[1];
        let ends = if upwards { ends } else { [ends[1], ends[0]] };
        ((ends, chain), Open { slot, side: index, number: base.of(patch), upwards })
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::mesh::surface::patch::Rules;
    use crate::random::Random;

    /// A strip along x with a jagged upper side of `n` edges, `upper` or lower of it.
    fn strip(n: u32, upper: bool) -> Surface {
        let jag = |i: u32| Vec3::new(i as f32, if i.is_multiple_of(2) { 0.3 } else { -0.3 }, 0.0);
        let far = |i: u32| Vec3::new(i as f32, if upper { 2.0 } else { -2.0 }, 0.0);
        // Sides of the two run along the jags in opposite orders.
        let p: Vec<Vec3> = (0..=n).map(jag).chain((0..=n).map(far)).collect();
        let quad = |i: u32| {
            let (a, b, c, d) = (i, i + 1, n + 2 + i, n + 1 + i);
            if upper { [[a, b, c], [a, c, d]] } else { [[b, a, d], [b, d, c]] }
        };
        let t: Vec<[u32; 3]> = (0..n).flat_map(quad).collect();
        Surface::new(&p, &t, &Rules { tolerance: 0.0, cosine: 0.2, least: 0.0, front: false })
    }

    /// The links of each object, found anew: where just two open sides have the same chain.
    fn links(seams: &Seams, there: &[(Slot, &Surface)]) -> Vec<Vec<(u32, PatchNumber, bool)>> {
        let mut all: Vec<(Chain, Open)> = Vec::new();
        for &(slot, surface) in there {
            all.extend(opens(slot, surface, seams.place(slot).base));
        }
        let one = |slot: Slot| {
            let own = all.iter().filter(|o| o.1.slot == slot);
            let linked = own.filter_map(|(chain, o)| {
                let same: Vec<&Open> = all.iter().filter(|x| x.0 == *chain).map(|x| &x.1).collect();
                let other = same.iter().find(|x| x.slot != slot).filter(|_| same.len() == 2)?;
                Some((o.side, other.number, o.upwards != other.upwards))
            });
            linked.collect()
        };
        there.iter().map(|t| one(t.0)).collect()
    }

    #[test]
    fn links_are_those_of_pairs_whatever_came_and_went() {
        let surfaces = [strip(7, false), strip(7, true), strip(3, true), strip(1, false)];
        let mut seams = Seams::default();
        let mut there: Vec<(Slot, &Surface)> = Vec::new();
        let mut random = Random::new(9);
        let mut most = 0;
        for _ in 0..400 {
            let slot = Slot::new(random.below(8));
            match there.iter().position(|t| t.0 == slot) {
                Some(at) => {
                    let (_, surface) = there.swap_remove(at);
                    seams.remove(slot, surface, true);
                }
                None => {
                    let surface = &surfaces[random.below(4) as usize];
                    seams.insert(slot, surface, true);
                    there.push((slot, surface));
                }
            }
            let wanted = links(&seams, &there);
            for (&(slot, _), wanted) in there.iter().zip(&wanted) {
                assert_eq!(&seams.place(slot).links, wanted);
                most = most.max(wanted.len());
            }
        }
        assert!(most >= 7, "{most}");
    }

    #[test]
    fn numbers_that_were_given_back_are_given_again_when_no_others_are_left() {
        let small = strip(1, false);
        let corners = [0.0, 9.0, 18.0].map(|x| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + x)).concat();
        let rules = Rules { tolerance: 0.0, cosine: 0.2, least: 0.0, front: false };
        let large = Surface::new(&corners, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]], &rules);
        assert!(large.patches.len() > small.patches.len());
        let mut seams = Seams::default();
        assert!(seams.insert(Slot::new(0), &small, true) && seams.insert(Slot::new(1), &small, true));
        seams.remove(Slot::new(0), &small, true);
        seams.use_up();
        assert!(!seams.insert(Slot::new(2), &large, true), "no numbers are left");
        assert!(seams.insert(Slot::new(3), &small, true), "those of object 0 are");
        assert!(!seams.insert(Slot::new(4), &small, true));
        assert_eq!(seams.place(Slot::new(3)).base, PatchNumber::new(0));
    }

    #[test]
    fn thousands_of_objects_share_a_seam() {
        let (low, high) = (strip(4, false), strip(4, true));
        let mut seams = Seams::default();
        for slot in Slot::below(30_000) {
            seams.insert(slot, if slot.get() % 2 == 0 { &low } else { &high }, true);
        }
        for slot in Slot::below(30_000).skip(2) {
            // The last ones are pairs.
            assert!(slot.get() > 29_000 || seams.place(slot).links.is_empty());
            seams.remove(slot, if slot.get() % 2 == 0 { &low } else { &high }, true);
        }
        assert!(seams.place(Slot::new(0)).links.len() == 4 && seams.place(Slot::new(1)).links.len() == 4);
        // Links that come in the opposite order of the other object's sides.
        let (low, high) = (strip(20_000, false), strip(20_000, true));
        let mut seams = Seams::default();
        seams.insert(Slot::new(0), &low, true);
        seams.insert(Slot::new(1), &high, true);
        assert!(
            seams.place(Slot::new(0)).links.len() == 20_000
                && seams.place(Slot::new(1)).links.len() == 20_000
        );
        seams.remove(Slot::new(1), &high, true);
        assert!(seams.place(Slot::new(0)).links.is_empty());
    }
}
