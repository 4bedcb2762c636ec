//! States: where their rays start, what these hit, and which state a hit reads.
//!
//! Light cannot cross a wall for three reasons. Rays are tested against triangles. All starts of a
//! state are joined by segments that are free. And a hit reads a state only if the segment from the
//! hit to one of its starts is free.

use std::ops::Range;

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::clip::{Polygon, cross, point_of};
use crate::numeric::{
    CANDIDATES, COVER, DOUBT, LEAST_HEIGHT, LEAST_NORMAL, LIFT, LIKE_HEIGHT, LIKE_NORMAL, OFF_CENTRE,
    OPEN_RAYS, OPEN_REACH, STAND_INS, STARTS, TOUCH,
};
use crate::spread::{Hemisphere, mix, unit};
use crate::surfaces::Surface;
use crate::voxels::{Hit, NONE, Voxels};

/// A ray that left the grid.
pub(crate) const SKY: u32 = u32::MAX;
/// A ray that hit a surface for which no state can stand.
pub(crate) const DARK: u32 = u32::MAX - 1;

/// Where rays start: just above a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start {
    /// In cells.
    pub(crate) at: Vec3,
    /// Unit normal of its side of the surface.
    pub(crate) normal: Vec3,
    /// See [`Voxels::is_covered`]. All starts of a state are alike.
    pub(crate) covered: bool,
}

/// The starts of a state, the most open one first. None if all candidates are buried.
pub(crate) type Starts = SmallVec<[Start; STARTS]>;

/// What one ray found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ray {
    /// The state that it reads, [`SKY`] or [`DARK`].
    pub(crate) target: u32,
    /// How far it went, in cells; infinite for the sky. Its sign is negative if the target is the
    /// only entry in the cell of the hit.
    signed: f32,
}

impl Ray {
    /// A ray of a state that is buried.
    pub(crate) const BURIED: Self = Self { target: DARK, signed: 0.0 };

    /// How far it went, in cells; infinite for the sky.
    pub(crate) fn distance(&self) -> f64 {
        f64::from(self.signed.abs())
    }

    /// Whether the target is the only entry in the cell of the hit, so that none stands in.
    pub(crate) fn is_own(&self) -> bool {
        self.signed.is_sign_negative()
    }
}

/// A point just above a surface, on the side of a normal. It is what single precision stores.
pub(crate) fn lifted(point: DVec3, normal: DVec3) -> Vec3 {
    (point + normal * LIFT).as_vec3()
}

/// 1 for the front of a state's entry, -1 for its back.
pub(crate) fn sign(state: u32) -> f64 {
    if state & 1 == 0 { 1.0 } else { -1.0 }
}

impl Voxels {
    /// States: two for each entry.
    pub(crate) fn states(&self) -> u32 {
        2 * self.entries.len() as u32
    }

    /// A number that belongs to a state in whichever order surfaces are given.
    pub(crate) fn key(&self, state: u32) -> u64 {
        let e = &self.entries[state as usize / 2];
        let kind = u64::from(e.rank) << 8 | u64::from(e.bin) << 1 | u64::from(state & 1);
        mix(mix(u64::from(e.cell) << 32) ^ kind)
    }

    /// The starts of a state. Pure: depends on the surfaces within [`OPEN_REACH`] only.
    pub(crate) fn starts(&self, state: u32) -> Starts {
        let key = self.key(state);
        let (candidates, middle) = self.candidates(state, key);
        let fine = self.lattice.fine(self.lattice.place(self.entries[state as usize / 2].cell));
        let Some(best) = self.most_open(&candidates, middle, fine, key) else { return Starts::new() };
        let is_covered = |s: &Start| self.is_covered(s.at.as_dvec3(), s.normal.as_dvec3(), fine);
        let (first, covered) = (candidates[best].at.as_dvec3(), is_covered(&candidates[best]));
        let is_free = |s: &Start| self.free(first, s.at.as_dvec3()) && is_covered(s) == covered;
        let joined = |i: &usize| *i != best && is_free(&candidates[*i]);
        std::iter::once(best)
            .chain((0..candidates.len()).filter(joined))
            .take(STARTS)
            .map(|i| Start { covered, ..candidates[i] })
            .collect()
    }

    /// Whether a surface lies less than [`COVER`] above a point, where so many cells are along an
    /// edge of one of the grid.
    pub(crate) fn is_covered(&self, at: DVec3, normal: DVec3, fine: f64) -> bool {
        !self.free(at, at + normal * (COVER / fine))
    }

    /// Points spread over the triangles of a state that are not buried, and the middle of them all.
    fn candidates(&self, state: u32, key: u64) -> (SmallVec<[Start; 8]>, DVec3) {
        let entry = state / 2;
        let cell = self.lattice.place(self.entries[entry as usize].cell);
        let mut parts: SmallVec<[(u32, Polygon, f64); 2]> = SmallVec::new();
        let mut area = 0.0;
        for &member in self.members_of(entry) {
            let polygon = self.lattice.part(&self.surfaces[member as usize].polygon(), cell);
            area += 0.5 * cross(&polygon).length();
            parts.push((member, polygon, area));
        }
        let (mut points, mut middle) = (SmallVec::new(), DVec3::ZERO);
        for i in 0..CANDIDATES {
            let dimension = 8 + 2 * u64::from(i);
            let share = (f64::from(i) + unit(key, dimension)) / f64::from(CANDIDATES) * area;
            let at = parts.partition_point(|p| p.2 <= share).min(parts.len() - 1);
            let before = if at == 0 { 0.0 } else { parts[at - 1].2 };
            let point = point_of(&parts[at].1, share - before, unit(key, dimension + 1));
            middle += point / f64::from(CANDIDATES);
            let normal = self.surfaces[parts[at].0 as usize].normal * sign(state);
            let start = Start { at: lifted(point, normal), normal: normal.as_vec3(), covered: false };
            if self.free(point + normal * TOUCH, start.at.as_dvec3()) {
                points.push(start);
            }
        }
        (points, middle)
    }

    /// The candidate from which rays go farthest, less what its distance to the middle costs; the
    /// first of equals. Candidates that cannot win send no more rays.
    fn most_open(&self, candidates: &[Start], middle: DVec3, fine: f64, key: u64) -> Option<usize> {
        let cost = |i: usize| OFF_CENTRE * fine * candidates[i].at.as_dvec3().distance(middle);
        let mut order: SmallVec<[(f64, usize); 8]> = (0..candidates.len()).map(|i| (cost(i), i)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (mut best, mut most) = (None, f64::NEG_INFINITY);
        for (cost, i) in order {
            let Some(open) = self.openness(&candidates[i], OPEN_REACH / fine, key, most + cost - DOUBT)
            else {
                continue;
            };
            let score = open - cost;
            if score > most || score == most && best.is_some_and(|b| i < b) {
                (best, most) = (Some(i), score);
            }
        }
        best
    }

    /// The mean share of a reach that rays from a start go, if it can reach a least one.
    fn openness(&self, start: &Start, reach: f64, key: u64, least: f64) -> Option<f64> {
        let ways = Hemisphere::new(start.normal.as_dvec3(), OPEN_RAYS, key);
        let mut sum = 0.0;
        for i in 0..OPEN_RAYS {
            if (sum + f64::from(OPEN_RAYS - i)) / f64::from(OPEN_RAYS) < least {
                return None;
            }
            let hit = self.first(start.at.as_dvec3(), ways.direction(i), reach);
            sum += hit.map_or(1.0, |h| h.distance / reach);
        }
        Some(sum / f64::from(OPEN_RAYS))
    }

    /// Which side of a surface a ray meets: its normal there, and 0 for the front or 1.
    pub(crate) fn facing(&self, surface: u32, direction: DVec3) -> (DVec3, u32) {
        let normal = self.surfaces[surface as usize].normal;
        if normal.dot(direction) > 0.0 { (-normal, 1) } else { (normal, 0) }
    }

    /// The state that a hit reads: that of its entry, or the nearest one like it, if the segment to
    /// one of its starts is free; else [`DARK`]. Also whether nothing else is in the cell. `starts`
    /// gives the starts of a state.
    pub(crate) fn read<'a>(
        &self,
        from: DVec3,
        direction: DVec3,
        hit: &Hit,
        starts: &impl Fn(u32) -> &'a [Start],
    ) -> (u32, bool) {
        let point = from + direction * hit.distance;
        let (normal, side) = self.facing(hit.surface, direction);
        let own = self.entry_at(hit.surface, point);
        if let Some(entry) = own.filter(|e| self.entries[*e as usize].alone) {
            return (2 * entry + side, true);
        }
        let mut spot = lifted(point, normal).as_dvec3();
        let near = point + normal * TOUCH;
        // The lift itself may pass a surface.
        if !self.free(near, spot) {
            spot = near;
        }
        let mut last = NONE;
        let mut sees = |s: &Start| self.free_of(spot, s.at.as_dvec3(), &mut last);
        let own = own.map(|e| 2 * e + side);
        let fine = self.lattice.fine(self.lattice.at(spot));
        let covered = self.is_covered(spot, normal, fine);
        let is_like = |state: u32| starts(state).first().is_some_and(|s| s.covered == covered);
        if let Some(state) = own.filter(|s| is_like(*s) && starts(*s).iter().any(&mut sees)) {
            return (state, false);
        }
        let mut tried: SmallVec<[u32; STAND_INS]> = SmallVec::new();
        // First states that are covered if the hit is, and open if it is open; then the others.
        for like in [true, false] {
            for rule in [(LIKE_NORMAL, LIKE_HEIGHT), (LEAST_NORMAL, LEAST_HEIGHT)] {
                for state in self.stand_ins(spot, normal, rule) {
                    if tried.contains(&state) || is_like(state) != like {
                        continue;
                    }
                    if starts(state).iter().any(&mut sees) {
                        return (state, false);
                    }
                    tried.push(state);
                }
            }
        }
        (DARK, false)
    }

    /// States near a point that face like a normal, by a least product of normals and a greatest
    /// height in cells of their size, nearest first.
    fn stand_ins(
        &self,
        spot: DVec3,
        normal: DVec3,
        (product, height): (f32, f64),
    ) -> impl Iterator<Item = u32> + use<> {
        let mut near: SmallVec<[(f64, u32); 64]> = SmallVec::new();
        for cell in self.lattice.all_at(spot).flat_map(|at| self.lattice.around(at)) {
            let height = height / self.lattice.fine(cell);
            for entry in self.entries_of(cell) {
                let e = &self.entries[entry as usize];
                let like = e.normal.dot(normal.as_vec3());
                let way = e.middle.as_dvec3() - spot;
                if like.abs() >= product && way.dot(normal).abs() <= height {
                    near.push((way.length_squared(), 2 * entry + u32::from(like < 0.0)));
                }
            }
        }
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.into_iter().take(STAND_INS).map(|n| n.1)
    }

    /// The `i`th ray of a state.
    pub(crate) fn trace<'a>(
        &self,
        start: &Start,
        direction: DVec3,
        starts: &impl Fn(u32) -> &'a [Start],
    ) -> Ray {
        let from = start.at.as_dvec3();
        match self.first(from, direction, f64::INFINITY) {
            None => Ray { target: SKY, signed: f32::INFINITY },
            Some(hit) => {
                let (target, is_own) = self.read(from, direction, &hit, starts);
                let distance = hit.distance as f32;
                Ray { target, signed: if is_own { -distance } else { distance } }
            }
        }
    }
}

/// The rays of a state: their starts in turn, and their directions.
pub(crate) struct Bundle<'a> {
    starts: &'a [Start],
    /// By start.
    ways: SmallVec<[Hemisphere; STARTS]>,
}

impl<'a> Bundle<'a> {
    pub(crate) fn new(starts: &'a [Start], count: u32, key: u64) -> Self {
        let way = |s: &Start| Hemisphere::new(s.normal.as_dvec3(), count, key);
        Self { starts, ways: starts.iter().map(way).collect() }
    }

    /// By start, which rays may meet one of some balls, each with a middle in cells and a radius.
    pub(crate) fn towards(&self, balls: &[(DVec3, f64)]) -> SmallVec<[Vec<Range<u32>>; STARTS]> {
        let of = |(start, ways): (&Start, &Hemisphere)| {
            let from = start.at.as_dvec3();
            let ranges = balls.iter().map(|(middle, radius)| ways.towards(*middle - from, *radius));
            ranges.filter(|r| !r.is_empty()).collect()
        };
        self.starts.iter().zip(&self.ways).map(of).collect()
    }

    /// The start and the direction of the `i`th ray. There must be starts.
    pub(crate) fn ray(&self, i: u32) -> (&'a Start, DVec3) {
        let of = i as usize % self.starts.len();
        (&self.starts[of], self.ways[of].direction(i))
    }
}

/// The middle of a triangle's corners, by barycentric coordinates.
pub(crate) fn mixed(surface: &Surface, shares: [f64; 3]) -> DVec3 {
    let [a, b, c] = surface.corners;
    a * shares[0] + b * shares[1] + c * shares[2]
}
