//! The trees of triangles: one of what rests, and one of what has moved, which is made anew when it
//! moves again.

use glam::DVec3;

use crate::lattice::Lattice;
use crate::surfaces::Surface;
use crate::tree::Tree;

/// Triangles that rays meet.
#[derive(Debug, Clone, Default)]
pub(crate) struct Forest {
    resting: Tree,
    moving: Tree,
    /// Objects that have moved, in order.
    movers: Vec<u32>,
}

impl Forest {
    /// The triangles in a lattice. O(n log n) for n triangles.
    pub(crate) fn new(lattice: &Lattice, surfaces: &[Surface]) -> Self {
        Self { resting: Tree::new(lattice, surfaces, |_| true), ..Self::default() }
    }

    /// The same after some objects changed; `numbers` are new numbers of triangles of others by
    /// their old ones. Costs O(n log n) for the triangles that have moved; for all if an object
    /// moves for the first time.
    pub(crate) fn moved(
        &self,
        lattice: &Lattice,
        surfaces: &[Surface],
        changed: &[u32],
        numbers: &[u32],
    ) -> Self {
        let mut movers = [&self.movers[..], changed].concat();
        movers.sort_unstable();
        movers.dedup();
        let moves = |s: &Surface| movers.binary_search(&s.object).is_ok();
        let resting = if movers == self.movers {
            let mut same = self.resting.clone();
            same.renumber(numbers);
            same
        } else {
            Tree::new(lattice, surfaces, |s| !moves(s))
        };
        let moving = Tree::new(lattice, surfaces, moves);
        Self { resting, moving, movers }
    }

    /// See [`Tree::first`].
    pub(crate) fn first(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<(f64, u32)> {
        let resting = self.resting.first(from, direction, reach);
        if self.moving.count() == 0 {
            return resting;
        }
        let moving = self.moving.first(from, direction, resting.map_or(reach, |r| r.0));
        [resting, moving].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
    }

    /// See [`Tree::blocker`]: places of what moves come after those of what rests.
    pub(crate) fn blocker(&self, from: DVec3, direction: DVec3, reach: f64, hint: u32) -> Option<u32> {
        let before = self.resting.count() as u32;
        if self.moving.count() == 0 {
            return self.resting.blocker(from, direction, reach, hint);
        }
        // A hint that no tree has is none.
        let of_moving = hint.wrapping_sub(before);
        let moving = || self.moving.blocker(from, direction, reach, of_moving).map(|place| place + before);
        let resting = || self.resting.blocker(from, direction, reach, hint);
        if hint < before { resting().or_else(moving) } else { moving().or_else(resting) }
    }

    /// All parts and triangles: see [`Tree::add_flat`].
    #[cfg(feature = "gpu")]
    pub(crate) fn flat(&self) -> (Vec<[u32; 8]>, Vec<u32>) {
        let (mut parts, mut triangles) = (Vec::new(), Vec::new());
        self.resting.add_flat(&mut parts, &mut triangles);
        self.moving.add_flat(&mut parts, &mut triangles);
        (parts, triangles)
    }

    /// Bytes of all parts.
    pub(crate) fn bytes(&self) -> usize {
        self.resting.bytes() + self.moving.bytes()
    }
}
