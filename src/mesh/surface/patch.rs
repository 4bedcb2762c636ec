//! Patches, their sides and groups: the prepared surface of a mesh.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::mesh::surface::index::PatchIndex;

/// The number of a chain without points between its ends.
pub(crate) const EDGE: u64 = 0xcbf2_9ce4_8422_2325;

/// No patch, or no triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// A side of a patch's outline: straight, in place of a chain of edges of triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PatchSide {
    /// Its start and its end: positions of the mesh.
    pub(crate) ends: [u32; 2],
    /// No point of the chain is farther from it.
    pub(crate) slack: f32,
    /// The patch on the other side with [`PatchSide::OPPOSITE`], or one of the numbers above.
    beyond: u32,
}

/// What is on the other side of a patch's side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Beyond {
    /// No patch.
    Open,
    /// Several patches, or one several times.
    More,
    /// One patch, and whether it runs along the side in the opposite direction, so that the two
    /// cancel.
    Patch(PatchIndex, bool),
}

impl PatchSide {
    /// There are fewer patches than this: triangles have 29 bits.
    const OPPOSITE: u32 = 1 << 30;
    const MORE: u32 = u32::MAX - 1;

    /// All patches are less.
    pub(crate) const MOST: PatchIndex = PatchIndex::new(Self::OPPOSITE);
    const OPEN: u32 = u32::MAX;

    pub(crate) fn new(ends: [u32; 2], slack: f32, beyond: Beyond) -> Self {
        let beyond = match beyond {
            Beyond::Open => Self::OPEN,
            Beyond::More => Self::MORE,
            Beyond::Patch(patch, opposite) => patch.get() | if opposite { Self::OPPOSITE } else { 0 },
        };
        Self { ends, slack, beyond }
    }

    /// The patch on the other side, if there is just one.
    #[inline]
    pub(crate) fn twin(&self) -> PatchIndex {
        match self.beyond {
            Self::MORE.. => PatchIndex::NONE,
            patch => PatchIndex::new(patch & !Self::OPPOSITE),
        }
    }

    /// Whether that runs along it in the opposite direction, so that the two cancel.
    #[inline]
    pub(crate) fn opposite(&self) -> bool {
        self.beyond >> 30 == 1
    }

    /// Whether there is no patch on the other side.
    pub(crate) fn is_open(&self) -> bool {
        self.beyond == Self::OPEN
    }

    /// The same with no patch on the other side.
    pub(crate) fn opened(self) -> Self {
        Self { beyond: Self::OPEN, ..self }
    }
}

/// Neighbouring triangles of similar directions, or a group of patches that can be drawn as one.
///
/// Groups come before their parts, and these follow each other: the parts of patch `i` start at
/// `i + 1`, each next one where the one before ends ([`Patch::next`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Patch {
    /// Its outline: a range of the list of sides, or of that of the outlines of groups if it has
    /// parts. Empty if it can only be drawn in parts.
    pub(crate) first: u32,
    pub(crate) last: u32,
    /// The place after that of its last part: the place after its own if it has none.
    pub(crate) next: PatchIndex,
    /// No triangle is turned from the normal by an angle of a greater sine.
    pub(crate) sine: f32,
    /// All of it lies where `lo <= normal . x <= hi`.
    pub(crate) normal: DVec3,
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    /// A box around it.
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
    /// The greatest slack of its sides.
    pub(crate) slack: f32,
}

/// The outlines of triangles, to hide other objects with.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Surface {
    /// The positions of the mesh.
    pub(crate) positions: Arc<[Vec3]>,
    /// The sides of patches without parts, in their order.
    pub(crate) sides: Vec<PatchSide>,
    /// The outlines of groups, as numbers of sides.
    pub(crate) group_outlines: Vec<u32>,
    /// All patches; the first one contains all others.
    pub(crate) patches: Vec<Patch>,
    /// Whether triangles hide from their front only.
    pub(crate) front: bool,
    /// The sign of the volume inside, if the surface is closed and wound alike: outsides are fronts
    /// if it is positive.
    pub(crate) outward: f64,
    /// Open sides in place of a chain with points between its ends, and a number that tells the
    /// chain from others; in the order of sides.
    pub(crate) chains: Vec<(u32, u64)>,
}

/// How triangles become patches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rules {
    /// Outlines may leave the edges of triangles by this.
    pub(crate) tolerance: f64,
    /// The greatest angle between the normals of a group and its triangles, as a cosine.
    pub(crate) cosine: f64,
    /// Groups of a smaller radius are left out.
    pub(crate) least: f64,
    /// Whether triangles hide from their front only.
    pub(crate) front: bool,
}

impl Surface {
    /// Bytes on the heap, without the positions.
    pub(crate) fn bytes(&self) -> usize {
        self.sides.capacity() * size_of::<PatchSide>()
            + self.patches.capacity() * size_of::<Patch>()
            + self.group_outlines.capacity() * size_of::<u32>()
            + self.chains.capacity() * size_of::<(u32, u64)>()
    }

    /// The start and the end of a side.
    #[inline]
    pub(crate) fn ends(&self, side: &PatchSide) -> [Vec3; 2] {
        side.ends.map(|v| self.positions[v as usize])
    }

    /// The sides of patches without parts: the patch, the number of the side and the side.
    pub(crate) fn leaf_sides(&self) -> impl Iterator<Item = (PatchIndex, u32, PatchSide)> {
        let leaves = self.places().filter(|&i| self.next(i) == i.after());
        leaves.flat_map(|i| self.outline(i).map(move |(number, side)| (i, number, side)))
    }

    /// A number that tells the chain of each open side from others, by the numbers of sides in
    /// order.
    pub(crate) fn chain(&self) -> impl FnMut(u32) -> u64 {
        let mut chains = self.chains.as_slice();
        move |number| match chains.split_first() {
            Some((&(side, chain), rest)) if side == number => {
                chains = rest;
                chain
            }
            _ => EDGE,
        }
    }

    /// Gives back memory that is not used.
    pub(crate) fn shrink(&mut self) {
        self.sides.shrink_to_fit();
        self.group_outlines.shrink_to_fit();
        self.patches.shrink_to_fit();
        self.chains.shrink_to_fit();
    }

    /// How many patches there are.
    #[inline]
    pub(crate) fn patch_count(&self) -> usize {
        self.patches.len()
    }

    /// A patch.
    #[inline]
    pub(crate) fn patch(&self, patch: PatchIndex) -> &Patch {
        &self.patches[patch.index()]
    }

    /// The place after that of the last part of a patch: [`Patch::next`].
    #[inline]
    pub(crate) fn next(&self, patch: PatchIndex) -> PatchIndex {
        self.patches[patch.index()].next
    }

    /// Whether a patch has an outline, so that it can be drawn as one.
    #[inline]
    pub(crate) fn has_outline(&self, patch: PatchIndex) -> bool {
        self.patch(patch).first < self.patch(patch).last
    }

    /// The places of all patches, in order.
    pub(crate) fn places(&self) -> impl Iterator<Item = PatchIndex> + use<> {
        (0..self.patch_count() as u32).map(PatchIndex::new)
    }

    /// All patches with their places, in order.
    pub(crate) fn indexed(&self) -> impl Iterator<Item = (PatchIndex, &Patch)> {
        self.places().map(|i| (i, self.patch(i)))
    }

    /// The sides of a patch, with their numbers.
    #[inline]
    pub(crate) fn outline(&self, patch: PatchIndex) -> PatchOutline<'_> {
        let &Patch { first, last, next, .. } = self.patch(patch);
        let group =
            if next > patch.after() { &self.group_outlines[first as usize..last as usize] } else { &[] };
        PatchOutline { sides: &self.sides, group, at: first, last }
    }

    /// How many patches have no parts.
    pub(crate) fn leaves(&self) -> usize {
        self.places().filter(|&at| self.next(at) == at.after()).count()
    }

    /// The places of the parts of a patch.
    #[cfg(test)]
    pub(crate) fn parts(&self, patch: PatchIndex) -> impl Iterator<Item = PatchIndex> {
        let end = self.next(patch);
        let mut part = patch.after();
        std::iter::from_fn(move || {
            let this = part;
            (this < end).then(|| {
                part = self.next(this);
                this
            })
        })
    }

    /// Finds the outlines of all groups: the sides of their parts that no other part cancels.
    pub(crate) fn find_group_outlines(&mut self) {
        self.group_outlines.clear();
        // Where the sides of each patch, or of its parts, begin.
        let mut starts = vec![0; self.patches.len() + 1];
        let mut reached = 0;
        for (start, (i, patch)) in starts.iter_mut().zip(self.indexed()) {
            *start = reached;
            if patch.next == i.after() {
                reached = patch.last;
            }
        }
        starts[self.patches.len()] = reached;
        for i in (0..self.patches.len() as u32).map(PatchIndex::new) {
            let Patch { next, lo, hi, .. } = self.patches[i.index()];
            if next == i.after() {
                continue;
            }
            let first = self.group_outlines.len() as u32;
            // One that can be drawn only in parts has an empty slab.
            if lo <= hi {
                let inside = i..next;
                let own = starts[i.index()]..starts[next.index()];
                let sides = &self.sides;
                self.group_outlines.extend(own.filter(|&s| {
                    let side = &sides[s as usize];
                    !(side.opposite() && inside.contains(&side.twin()))
                }));
            }
            let slack = self.group_outlines[first as usize..].iter().map(|&s| self.sides[s as usize].slack);
            let slack = slack.fold(0.0, f32::max);
            let last = self.group_outlines.len() as u32;
            let patch = &mut self.patches[i.index()];
            (patch.first, patch.last, patch.slack) = (first, last, slack);
        }
    }
}

/// The sides of a patch with their numbers, in order.
#[derive(Debug, Clone)]
pub(crate) struct PatchOutline<'a> {
    /// All sides of the surface.
    sides: &'a [PatchSide],
    /// Their numbers, if the patch has parts.
    group: &'a [u32],
    at: u32,
    last: u32,
}

impl Iterator for PatchOutline<'_> {
    type Item = (u32, PatchSide);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.last {
            return None;
        }
        let number = match self.group.split_first() {
            Some((&number, rest)) => {
                self.group = rest;
                number
            }
            None => self.at,
        };
        self.at += 1;
        Some((number, *self.sides.get(number as usize)?))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let count = (self.last - self.at) as usize;
        (count, Some(count))
    }
}

impl ExactSizeIterator for PatchOutline<'_> {}

/// The greatest slack of sides.
pub(crate) fn slack(sides: &[PatchSide]) -> f32 {
    sides.iter().map(|s| s.slack).fold(0.0, f32::max)
}
