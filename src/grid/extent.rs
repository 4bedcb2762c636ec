//! A box around cells, bricks or zones that come and go.

use std::collections::VecDeque;

use glam::IVec3;

use crate::grid::cell_box::CellBox;

/// How many there are in each plane across an axis, from the first to the last that has any.
#[derive(Clone, Debug, Default)]
struct PlaneCounts {
    first: i32,
    counts: VecDeque<u32>,
}

impl PlaneCounts {
    fn add(&mut self, at: i32) {
        if self.counts.is_empty() {
            self.first = at;
        }
        while at < self.first {
            self.counts.push_front(0);
            self.first -= 1;
        }
        let index = (at - self.first) as usize;
        if index >= self.counts.len() {
            self.counts.resize(index + 1, 0);
        }
        self.counts[index] += 1;
    }

    fn take(&mut self, at: i32) {
        self.counts[(at - self.first) as usize] -= 1;
        while self.counts.back() == Some(&0) {
            self.counts.pop_back();
        }
        while self.counts.front() == Some(&0) {
            self.counts.pop_front();
            self.first += 1;
        }
    }
}

/// The least block around all that are there. One that is far away from all others costs four bytes
/// for each plane between them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Extent([PlaneCounts; 3]);

impl Extent {
    /// One comes or goes.
    pub(crate) fn change(&mut self, at: IVec3, comes: bool) {
        for (planes, at) in self.0.iter_mut().zip(at.to_array()) {
            if comes { planes.add(at) } else { planes.take(at) }
        }
    }

    /// The block around them; none if there are none.
    pub(crate) fn around(&self) -> Option<CellBox> {
        let lo = IVec3::from_array(self.0.each_ref().map(|planes| planes.first));
        let counts = IVec3::from_array(self.0.each_ref().map(|planes| planes.counts.len() as i32));
        (counts.x > 0).then(|| CellBox { lo, hi: lo + counts - 1 })
    }

    pub(crate) fn bytes(&self) -> usize {
        self.0.iter().map(|planes| planes.counts.capacity() * size_of::<u32>()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn the_block_is_the_least_one() {
        let (mut extent, mut there, mut random) = (Extent::default(), Vec::new(), Random::new(5));
        for step in 0..2000 {
            if !there.is_empty() && (step > 1500 || random.below(3) == 0) {
                let gone = there.swap_remove(random.below(there.len() as u32) as usize);
                extent.change(gone, false);
            } else {
                let at = (random.point(30.0)).as_ivec3();
                extent.change(at, true);
                there.push(at);
            }
            let least = there.iter().map(|&at| CellBox { lo: at, hi: at }).reduce(CellBox::join);
            assert_eq!(extent.around(), least);
        }
    }
}
