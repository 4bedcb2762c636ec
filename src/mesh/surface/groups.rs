//! Groups of patches as they are joined: which are parts of others, and which share borders.

use crate::mesh::surface::patch::NONE;

/// A border between two patches: both of them, and how long it is.
pub(super) type SharedBorder = (u32, u32, f64);

/// The groups that share borders with each group.
pub(super) struct Links {
    /// Where the links of each group start and end.
    ranges: Vec<[u32; 2]>,
    /// The other group of each link, and its length as bits: lengths are not negative, so that
    /// these are in their order.
    links: Vec<(u32, u64)>,
}

impl Links {
    /// In order of the other groups.
    pub(super) fn of(&self, group: u32) -> &[(u32, u64)] {
        let [first, last] = self.ranges[group as usize];
        &self.links[first as usize..last as usize]
    }
}

/// Groups of patches, numbered as nodes of the tree.
pub(super) struct Groups {
    /// The group that each one is a part of, or `NONE`.
    whole: Vec<u32>,
    /// The borders between groups that are no parts.
    borders: Vec<SharedBorder>,
    /// Groups from which larger ones may grow, in order: the largest first.
    pub(super) seeds: Vec<(u64, u32)>,
}

/// Orders groups, the largest first: areas are not negative.
fn seed(group: u32, area: f64) -> (u64, u32) {
    (!area.to_bits(), group)
}

impl Groups {
    /// Patches without groups.
    pub(super) fn new(borders: Vec<SharedBorder>, count: usize, area: impl Fn(u32) -> f64) -> Self {
        let mut has_border = vec![false; count];
        for &(a, b, _) in &borders {
            (has_border[a as usize], has_border[b as usize]) = (true, true);
        }
        let seeds = (0..count as u32).filter(|&g| has_border[g as usize]);
        let mut seeds: Vec<(u64, u32)> = seeds.map(|g| seed(g, area(g))).collect();
        seeds.sort_unstable();
        let borders = borders.into_iter().filter(|border| border.0 != border.1).collect();
        Self { whole: vec![NONE; count], borders, seeds }
    }

    /// Whether a group is a part of another.
    pub(super) fn is_part(&self, group: u32) -> bool {
        self.whole[group as usize] != NONE
    }

    /// Makes a group a part of another one, which may come later.
    pub(super) fn put(&mut self, part: u32, whole: u32) {
        self.whole[part as usize] = whole;
    }

    /// Adds groups up to a number, the seeds of the next level.
    pub(super) fn extend(&mut self, first: u32, count: usize, area: impl Fn(u32) -> f64) {
        self.whole.resize(count, NONE);
        self.seeds.extend((first..count as u32).map(|g| seed(g, area(g))));
        // Most of them are in order.
        self.seeds.sort();
        let whole = |group: u32| match self.whole[group as usize] {
            NONE => group,
            whole => whole,
        };
        self.borders.retain_mut(|(a, b, _)| {
            (*a, *b) = (whole(*a), whole(*b));
            a != b
        });
    }

    /// The borders of each group, those with the same one together.
    pub(super) fn links(&self) -> Links {
        let mut ranges = vec![[0u32; 2]; self.whole.len()];
        for &(a, b, _) in &self.borders {
            ranges[a as usize][1] += 1;
            ranges[b as usize][1] += 1;
        }
        let mut reached = 0;
        for range in &mut ranges {
            let start = reached;
            reached += range[1];
            *range = [start; 2];
        }
        let mut links = vec![(0, 0); reached as usize];
        for &(a, b, length) in &self.borders {
            for (own, other) in [(a, b), (b, a)] {
                let end = &mut ranges[own as usize][1];
                links[*end as usize] = (other, length.to_bits());
                *end += 1;
            }
        }
        for [first, last] in &mut ranges {
            let own = &mut links[*first as usize..*last as usize];
            own.sort_unstable();
            let mut kept = 0;
            let mut at = 0;
            while at < own.len() {
                let (other, mut bits) = own[at];
                at += 1;
                while own.get(at).is_some_and(|link| link.0 == other) {
                    bits = (f64::from_bits(bits) + f64::from_bits(own[at].1)).to_bits();
                    at += 1;
                }
                own[kept] = (other, bits);
                kept += 1;
            }
            *last = *first + kept as u32;
        }
        Links { ranges, links }
    }
}
