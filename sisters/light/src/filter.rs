//! Smoother light for pictures: means over states that see each other on one surface.
//!
//! A state's light is of a few rays, and neighbours send other ones: a picture shows that as
//! blotches. Means over linked states take them away. Links are free segments between starts, so
//! that no mean reaches through a wall. Passes go on with the light that is not smoothed, so that
//! errors of means do not add up.

use glam::Vec3;
use rayon::prelude::*;
use smallvec::SmallVec;

use crate::cache::{Cache, Links};
use crate::numeric::{LINK_HEIGHT, LINK_NORMAL, MOST_LINKS};
use crate::states::sign;
use crate::voxels::NONE;

impl Cache {
    /// Averages the indirect light of answers over neighbouring states, so many times: twice takes
    /// most blotches of 64 rays. Answers are of the smoothed light until the next pass, gathering
    /// or move.
    ///
    /// Costs look-ups, and a short ray for each link of states around which one was gathered or
    /// something moved since the last call.
    pub fn smooth(&mut self, times: u32) {
        let is_missing = |s: &u32| self.links[*s as usize].is_none();
        let missing: Vec<u32> = self.gathered.iter().copied().filter(is_missing).collect();
        let found: Vec<_> = missing.par_iter().map(|&state| self.links_of(state)).collect();
        for (state, links) in missing.into_iter().zip(found) {
            self.links[state as usize] = Some(links);
        }
        let mut light: Vec<Vec3> = self.glow.iter().map(|g| g.indirect).collect();
        for _ in 0..times {
            let mean = |&state: &u32| {
                let links = self.links[state as usize].iter().flatten();
                let linked = links.take_while(|l| **l != NONE);
                let (sum, count) = linked
                    .fold((light[state as usize], 1.0), |(sum, n), l| (sum + light[*l as usize], n + 1.0));
                sum / count
            };
            let means: Vec<Vec3> = self.gathered.iter().map(mean).collect();
            self.gathered.iter().zip(means).for_each(|(state, mean)| light[*state as usize] = mean);
        }
        self.smoothed = light;
    }

    /// The nearest gathered states on the surface of one that it sees.
    fn links_of(&self, state: u32) -> Links {
        let mut links = [NONE; MOST_LINKS];
        let Some(start) = self.starts(state).first() else { return links };
        let (at, voxels) = (start.at.as_dvec3(), &self.voxels);
        let entry = &voxels.entries[state as usize / 2];
        let normal = entry.normal.as_dvec3() * sign(state);
        let cell = voxels.lattice.place(entry.cell);
        let mut near: SmallVec<[(f64, u32); 32]> = SmallVec::new();
        let height = LINK_HEIGHT / voxels.lattice.fine(cell);
        for cell in voxels.lattice.around(cell) {
            for other in voxels.entries_of(cell) {
                let like = voxels.entries[other as usize].normal.as_dvec3().dot(normal);
                let other = 2 * other + u32::from(like < 0.0);
                if other == state || like.abs() < LINK_NORMAL || self.blocks[other as usize].count == 0 {
                    continue;
                }
                let Some(link) = self.starts(other).first() else { continue };
                let way = link.at.as_dvec3() - at;
                if way.dot(normal).abs() < height && link.covered == start.covered {
                    near.push((way.length_squared(), other));
                }
            }
        }
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut last = NONE;
        let free = |n: &&(f64, u32)| {
            self.starts(n.1).first().is_some_and(|s| voxels.free_of(at, s.at.as_dvec3(), &mut last))
        };
        links.iter_mut().zip(near.iter().filter(free)).for_each(|(link, n)| *link = n.1);
        links
    }

    /// States were gathered: they may be links of those around.
    pub(crate) fn unlink(&mut self, new: &[u32]) {
        let voxels = &self.voxels;
        for state in new {
            let cell = voxels.lattice.place(voxels.entries[*state as usize / 2].cell);
            for entry in voxels.lattice.around(cell).flat_map(|c| voxels.entries_of(c)) {
                self.links[2 * entry as usize..][..2].fill(None);
            }
        }
        self.smoothed.clear();
    }

    /// The indirect light of a state as answers give it.
    pub(crate) fn shown(&self, state: u32) -> Vec3 {
        self.smoothed.get(state as usize).copied().unwrap_or(self.glow[state as usize].indirect)
    }
}
