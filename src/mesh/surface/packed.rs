//! Packing surfaces: patches that follow from a triangle, and bundles of patches, take few bytes.
//!
//! In a soup nearly every patch is a triangle that shares no vertex with others. Its normal, slab
//! and sides follow from its corners, so only its number and its box are kept; of a bundle only the
//! box. Whoever asks gets the same numbers, bit for bit.

use crate::mesh::surface::index::PatchIndex;
use crate::mesh::surface::lone::{Lone, Record, Stored};
use crate::mesh::surface::patch::{NONE, Patch, PatchSide, Surface};

/// A surface is packed if at least one patch in this many is a triangle: records take room, too.
const WORTH: usize = 4;

/// Whether two patches are the same in each bit but for the numbers of their sides.
fn same(a: &Patch, b: &Patch) -> bool {
    let bits = |p: &Patch| {
        let singles = [p.min, p.max].map(|v| v.to_array().map(f32::to_bits));
        let doubles = [p.normal.x, p.normal.y, p.normal.z, p.lo, p.hi].map(f64::to_bits);
        (p.next, p.last - p.first, [p.sine, p.slack].map(f32::to_bits), singles, doubles)
    };
    bits(a) == bits(b)
}

/// The corners of an outline of three open sides without slack, in order.
fn ring(sides: &[PatchSide]) -> Option<[u32; 3]> {
    let &[p, q, r] = sides else { return None };
    let plain = |s: &PatchSide| s.is_open() && s.slack.to_bits() == 0;
    let closed = p.ends[1] == q.ends[0] && q.ends[1] == r.ends[0] && r.ends[1] == p.ends[0];
    (closed && sides.iter().all(plain)).then_some([p.ends[0], q.ends[0], r.ends[0]])
}

impl Surface {
    /// Packs a surface that has its positions and triangles, if that takes less memory. Outlines of
    /// groups are known.
    pub(crate) fn pack(&mut self) {
        let known = std::mem::take(&mut self.lone);
        let count = match known.as_slice() {
            [] => self.patches.iter().enumerate().filter(|&(at, p)| self.ring(at, p).is_some()).count(),
            known => known.iter().filter(|&&is_lone| is_lone).count(),
        };
        if count == 0 || count * WORTH < self.patches.len() {
            return;
        }
        let lone = self.triangles_of(&known);
        let (mut sides, mut patches) = (Vec::new(), Vec::new());
        let mut records = Vec::with_capacity(self.patches.len());
        let mut numbers = vec![NONE; self.sides.len()];
        for (lone, patch) in lone.into_iter().zip(&self.patches) {
            let bundle = || Self::bundle(patch.next, (patch.min, patch.max));
            records.push(Record::new(match lone {
                Some(lone) => Stored::Lone(lone),
                None if same(&bundle(), patch) => Stored::Bundle(patch.next),
                None => {
                    let mut patch = *patch;
                    if patch.next.index() == records.len() + 1 {
                        let first = sides.len() as u32;
                        let own = patch.first as usize..patch.last as usize;
                        numbers[own.clone()].iter_mut().zip(first..).for_each(|(new, n)| *new = n);
                        sides.extend_from_slice(&self.sides[own]);
                        (patch.first, patch.last) = (first, sides.len() as u32);
                    }
                    patches.push(patch);
                    Stored::Patch(patches.len() - 1)
                }
            }));
        }
        self.group_outlines.iter_mut().for_each(|side| *side = numbers[*side as usize]);
        self.chains.iter_mut().for_each(|(side, _)| *side = numbers[*side as usize]);
        self.boxes = self.patches.iter().map(|patch| (patch.min, patch.max)).collect();
        (self.sides, self.patches, self.records) = (sides, patches, records);
        self.shrink();
    }

    /// The corners of a patch at a place that may be a lone triangle, before the surface is packed.
    fn ring(&self, at: usize, patch: &Patch) -> Option<[u32; 3]> {
        let is_leaf = patch.next.index() == at + 1;
        is_leaf.then(|| ring(&self.sides[patch.first as usize..patch.last as usize])).flatten()
    }

    /// The triangle that each patch is, if it follows from that. `known` says of which patches
    /// this is known, if not empty; else all of them are compared.
    fn triangles_of(&self, known: &[bool]) -> Vec<Option<Lone>> {
        let mut owners = vec![NONE; self.positions.len()];
        for (t, corners) in (0..).zip(&*self.triangles) {
            corners.iter().for_each(|&v| owners[v as usize] = t);
        }
        // Sides that are named stay.
        let mut named = vec![false; self.sides.len()];
        let names = self.group_outlines.iter().copied().chain(self.chains.iter().map(|chain| chain.0));
        names.for_each(|side| named[side as usize] = true);
        let lone = |(at, patch): (usize, &Patch)| {
            let is_known = known.get(at).copied();
            if is_known == Some(false) {
                return None;
            }
            let ring = self.ring(at, patch)?;
            if named[patch.first as usize..patch.last as usize].contains(&true) {
                return None;
            }
            let owner = owners[ring[0] as usize];
            let corners = self.triangles.get(owner as usize)?;
            let start = corners.iter().position(|&v| v == ring[0])?;
            let lone = Lone::new(owner, start as u32);
            let made = || self.lone_patch(lone, PatchIndex::new(at as u32), (patch.min, patch.max));
            let follows = lone.ring(&self.triangles) == ring && (is_known.is_some() || same(&made(), patch));
            follows.then_some(lone)
        };
        self.patches.iter().enumerate().map(lone).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::mesh::surface::Rules;
    use crate::random::Random;

    /// The width of a needle.
    const NEEDLE: f64 = 1e-4;

    /// Lone triangles, needles and triangles without area among them, and pairs that share an edge
    /// or turn it into a group.
    fn soup(random: &mut Random, count: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..count {
            let at = random.point(10.0).as_vec3();
            let size = if i % 7 == 0 { NEEDLE } else { 1.0 };
            let first = positions.len() as u32;
            let side = random.point(1.0).as_vec3();
            positions.extend([at, at + side, at + random.point(size).as_vec3()]);
            // Each corner may come first, in both directions.
            let turned = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2], [0, 0, 1]];
            triangles.push(turned[(i % 13 % 7) as usize].map(|v| first + v));
            if i % 5 == 0 {
                positions.push(at + side * 0.5 + random.point(1.0).as_vec3());
                triangles.push([first, first + 1, first + 3]);
            }
        }
        (positions, triangles)
    }

    #[test]
    fn packed_surfaces_tell_the_same_numbers() {
        let (mut random, mut groups) = (Random::new(8), 0);
        for round in 0..40 {
            let (positions, triangles) = soup(&mut random, 20 + 10 * round);
            let rules = Rules { tolerance: 0.01, cosine: 0.2, least: 0.0, front: round % 3 == 2 };
            let mut whole = Surface::new(&positions, &triangles, &rules);
            whole.triangles = triangles.into();
            for known in [true, false] {
                let mut packed = whole.clone();
                if !known {
                    packed.lone.clear();
                }
                packed.pack();
                let lone = packed.places().filter(|&i| packed.is_lone(i)).count();
                assert!(lone * 4 > packed.patch_count() && packed.bytes() < whole.bytes());
                groups += packed.group_outlines.len();
                assert!(!packed.patches.is_empty());
                assert_eq!(
                    (packed.patch_count(), packed.leaves(), packed.side_count()),
                    (whole.patch_count(), whole.leaves(), whole.side_count())
                );
                for (i, patch) in whole.indexed() {
                    assert!(same(&packed.patch(i), &patch), "{i:?}");
                    let (slab, bits) = (packed.slab(i), |v: f64| v.to_bits());
                    assert_eq!([slab.lo, slab.hi].map(bits), [patch.lo, patch.hi].map(bits));
                    assert_eq!((slab.normal, slab.slack), (patch.normal, patch.slack));
                    assert_eq!(packed.extent(i), (patch.min, patch.max));
                    assert_eq!((packed.next(i), packed.has_outline(i)), (patch.next, whole.has_outline(i)));
                    let sides = |s: &Surface| s.outline(i).map(|(_, side)| side).collect::<Vec<_>>();
                    assert_eq!(sides(&packed), sides(&whole));
                }
                let numbers = |s: &Surface| {
                    let mut numbers: Vec<u32> = s.leaf_sides().map(|side| side.1).collect();
                    numbers.sort_unstable();
                    numbers.dedup();
                    numbers.len()
                };
                assert_eq!(numbers(&packed), packed.side_count(), "no two sides have one number");
                let chains = |s: &Surface| {
                    let mut chain = s.chain();
                    s.leaf_sides().map(|(_, number, _)| chain(number)).collect::<Vec<u64>>()
                };
                assert_eq!(chains(&packed), chains(&whole));
            }
        }
        assert!(groups > 100, "{groups}");
    }
}
