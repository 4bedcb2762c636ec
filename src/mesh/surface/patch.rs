//! Patches, their sides and groups: the prepared surface of a mesh.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::mesh::surface::index::PatchIndex;
use crate::mesh::surface::lone::{Lone, Record, Slab, Stored, sine_of, slab_of};

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
    /// Its triangles, once the surface is packed.
    pub(crate) triangles: Arc<[[u32; 3]]>,
    /// The sides of patches without parts, in their order; if packed, without those of lone
    /// triangles.
    pub(crate) sides: Vec<PatchSide>,
    /// The outlines of groups, as numbers of sides.
    pub(crate) group_outlines: Vec<u32>,
    /// All patches; the first one contains all others. If packed, those that are neither lone
    /// triangles nor bundles.
    pub(crate) patches: Vec<Patch>,
    /// Where each patch is stored; none if the surface is not packed.
    pub(crate) records: Vec<Record>,
    /// The boxes around them: the least and the greatest corner.
    pub(crate) boxes: Vec<(Vec3, Vec3)>,
    /// Whether each patch is a lone triangle as it is given, until the surface is packed; empty if
    /// that is not known.
    pub(crate) lone: Vec<bool>,
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
            + self.records.capacity() * size_of::<Record>()
            + self.boxes.capacity() * size_of::<(Vec3, Vec3)>()
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
        self.patches.len().max(self.records.len())
    }

    /// Where a patch is stored.
    #[inline]
    fn stored(&self, patch: PatchIndex) -> Stored {
        self.records.get(patch.index()).map_or(Stored::Patch(patch.index()), |record| record.stored())
    }

    /// The corners of a triangle, as it is given.
    #[inline]
    fn corners(&self, lone: Lone) -> [Vec3; 3] {
        self.triangles[lone.triangle()].map(|v| self.positions[v as usize])
    }

    /// A bundle: it is only drawn in parts.
    pub(super) fn bundle(next: PatchIndex, (min, max): (Vec3, Vec3)) -> Patch {
        let (lo, hi) = (f64::INFINITY, f64::NEG_INFINITY);
        Patch { first: 0, last: 0, next, sine: 1.0, normal: DVec3::Z, lo, hi, min, max, slack: 0.0 }
    }

    /// The patch that is a lone triangle.
    pub(super) fn lone_patch(&self, lone: Lone, place: PatchIndex, (min, max): (Vec3, Vec3)) -> Patch {
        let corners = self.corners(lone);
        let Slab { normal, lo, hi, slack } = slab_of(corners);
        let (first, next, sine) = (lone.first_side(), place.after(), sine_of(corners));
        Patch { first, last: first + 3, next, sine, normal, lo, hi, min, max, slack }
    }

    /// A patch.
    #[inline]
    pub(crate) fn patch(&self, patch: PatchIndex) -> Patch {
        match self.stored(patch) {
            Stored::Patch(at) => self.patches[at],
            Stored::Bundle(next) => Self::bundle(next, self.boxes[patch.index()]),
            Stored::Lone(lone) => self.lone_patch(lone, patch, self.boxes[patch.index()]),
        }
    }

    /// The slab of a patch that has one.
    #[inline]
    pub(crate) fn slab(&self, patch: PatchIndex) -> Slab {
        let whole = |&Patch { normal, lo, hi, slack, .. }: &Patch| Slab { normal, lo, hi, slack };
        match self.stored(patch) {
            Stored::Patch(at) => whole(&self.patches[at]),
            Stored::Bundle(next) => whole(&Self::bundle(next, (Vec3::ZERO, Vec3::ZERO))),
            Stored::Lone(lone) => slab_of(self.corners(lone)),
        }
    }

    /// The place after that of the last part of a patch: [`Patch::next`].
    #[inline]
    pub(crate) fn next(&self, patch: PatchIndex) -> PatchIndex {
        match self.stored(patch) {
            Stored::Patch(at) => self.patches[at].next,
            Stored::Bundle(next) => next,
            Stored::Lone(_) => patch.after(),
        }
    }

    /// The least and the greatest corner of the box around a patch.
    #[inline]
    pub(crate) fn extent(&self, patch: PatchIndex) -> (Vec3, Vec3) {
        self.boxes.get(patch.index()).copied().unwrap_or_else(|| {
            let Patch { min, max, .. } = self.patches[patch.index()];
            (min, max)
        })
    }

    /// Whether a patch has an outline, so that it can be drawn as one.
    #[inline]
    pub(crate) fn has_outline(&self, patch: PatchIndex) -> bool {
        match self.stored(patch) {
            Stored::Patch(at) => self.patches[at].first < self.patches[at].last,
            Stored::Bundle(_) => false,
            Stored::Lone(_) => true,
        }
    }

    /// Whether a patch is a lone triangle.
    #[cfg(test)]
    pub(crate) fn is_lone(&self, patch: PatchIndex) -> bool {
        matches!(self.stored(patch), Stored::Lone(_))
    }

    /// The places of all patches, in order.
    pub(crate) fn places(&self) -> impl Iterator<Item = PatchIndex> + use<> {
        (0..self.patch_count() as u32).map(PatchIndex::new)
    }

    /// All patches with their places, in order.
    pub(crate) fn indexed(&self) -> impl Iterator<Item = (PatchIndex, Patch)> {
        self.places().map(|i| (i, self.patch(i)))
    }

    /// The sides of a patch, with their numbers.
    #[inline]
    pub(crate) fn outline(&self, patch: PatchIndex) -> PatchOutline<'_> {
        let (sides, none) = (self.sides.as_slice(), [].as_slice());
        match self.stored(patch) {
            Stored::Patch(at) => {
                let Patch { first, last, next, .. } = self.patches[at];
                let group = if next > patch.after() {
                    &self.group_outlines[first as usize..last as usize]
                } else {
                    none
                };
                PatchOutline { sides, group, ring: [0; 3], at: first, last }
            }
            Stored::Bundle(_) => PatchOutline { sides, group: none, ring: [0; 3], at: 0, last: 0 },
            Stored::Lone(lone) => {
                let (ring, at) = (lone.ring(&self.triangles), lone.first_side());
                PatchOutline { sides: &[], group: none, ring, at, last: at + 3 }
            }
        }
    }

    /// How many patches have no parts.
    pub(crate) fn leaves(&self) -> usize {
        self.places().filter(|&at| self.next(at) == at.after()).count()
    }

    /// How many sides the patches without parts have.
    pub(crate) fn side_count(&self) -> usize {
        let lone = |record: &&Record| matches!(record.stored(), Stored::Lone(_));
        self.sides.len() + 3 * self.records.iter().filter(lone).count()
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

    /// Finds the outlines of all groups: the sides of their parts that no other part cancels. The
    /// surface is not packed yet.
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
    /// All sides that are stored; none for a lone triangle.
    sides: &'a [PatchSide],
    /// Their numbers, if the patch has parts.
    group: &'a [u32],
    /// The corners of a lone triangle.
    ring: [u32; 3],
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
        let side = self.sides.get(number as usize).copied().unwrap_or_else(|| {
            let [a, b, c] = self.ring;
            self.ring = [b, c, a];
            PatchSide::new([a, b], 0.0, Beyond::Open)
        });
        Some((number, side))
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
