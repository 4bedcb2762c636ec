//! Questions: the light at a point of a surface.

use glam::{DVec3, Vec3};

use crate::cache::Cache;
use crate::direct::Spot;
use crate::error::{LightError, numbers, way};
use crate::lattice::Cell;
use crate::numeric::{ABOVE, ANSWER_AREA, ANSWER_HEIGHT, ANSWER_NORMAL, ANSWER_REACH};
use crate::queues::Wish;
use crate::spread::{Hemisphere, mix};
use crate::states::{DARK, SKY, Start, lifted};
use crate::voxels::NONE;

/// The irradiance of a surface, in watts per square metre by channel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Irradiance {
    /// From lights and lamps, without a bounce. Found by shadow rays from the point itself.
    pub direct: Vec3,
    /// From the sky and from all bounces.
    pub indirect: Vec3,
    /// How many states around the point gave the indirect light. If it is 0, rays from the point
    /// read the states that they hit.
    pub states: u32,
}

/// A state near a question, and what it counts.
type Near = (u32, f64);

impl Cache {
    /// The spot of a question.
    pub(crate) fn spot(&self, point: Vec3, normal: Vec3) -> Result<Spot, LightError> {
        numbers("the point of question", 0, point, -f32::MAX..=f32::MAX)?;
        way("the normal of question", 0, normal)?;
        let normal = normal.as_dvec3().normalize();
        let place = self.voxels.lattice.cells(point);
        let bits = point.to_array().map(|c| u64::from(c.to_bits()));
        let key = bits.iter().fold(0, |h, c| mix(h ^ c));
        Ok(Spot { at: lifted(place, normal).as_dvec3(), normal, key })
    }

    /// Asks for the states that will answer a question at a point with a normal: gather next.
    ///
    /// # Errors
    /// If a number is not finite, or the normal has no length.
    pub fn request(&mut self, point: Vec3, normal: Vec3) -> Result<(), LightError> {
        let targets = self.answering(&self.spot(point, normal)?);
        self.want_all(&targets);
        Ok(())
    }

    /// Asks for states, of which some may be [`SKY`] or [`DARK`].
    pub(crate) fn want_all(&mut self, targets: &[u32]) {
        targets.iter().filter(|t| **t < DARK).for_each(|t| self.want(*t, Wish::Asked));
    }

    /// The states that answer at a spot.
    pub(crate) fn answering(&self, spot: &Spot) -> Vec<u32> {
        let near = self.near(spot, |_| true);
        match near.is_empty() {
            false => near.iter().map(|n| n.0).collect(),
            true => self.seen(spot).into_iter().map(|(target, _)| target).collect(),
        }
    }

    /// The irradiance of a surface at a point with a normal, on the side of the normal: the mean of
    /// the gathered states around it to which a segment is free; if there are none, what rays read.
    ///
    /// # Errors
    /// If a number is not finite, or the normal has no length.
    pub fn irradiance(&self, point: Vec3, normal: Vec3) -> Result<Irradiance, LightError> {
        let spot = self.spot(point, normal)?;
        let direct = self.sources().irradiance(&spot, 1);
        let near = self.ready(&spot);
        let states = near.len() as u32;
        let indirect = match near.is_empty() {
            true => self.by_rays(&spot),
            false => self.mean(&near, |state| self.shown(state)),
        };
        Ok(Irradiance { direct, indirect, states })
    }

    /// The irradiance that states around a spot hold, direct and indirect; by rays, and then
    /// without direct light, where there are none.
    pub(crate) fn stored(&self, spot: &Spot) -> Vec3 {
        let near = self.ready(spot);
        match near.is_empty() {
            true => self.by_rays(spot),
            false => self.mean(&near, |state| self.glow[state as usize].direct + self.shown(state)),
        }
    }

    /// The gathered states around a spot.
    fn ready(&self, spot: &Spot) -> Vec<Near> {
        self.near(spot, |state| self.blocks[state as usize].count > 0)
    }

    fn mean(&self, near: &[Near], light: impl Fn(u32) -> Vec3) -> Vec3 {
        let weight: f64 = near.iter().map(|n| n.1).sum();
        let of = |n: &Near| light(n.0).as_dvec3() * n.1;
        (near.iter().map(of).sum::<DVec3>() / weight).as_vec3()
    }

    /// The states around a spot that stand for it, with their weights.
    fn near(&self, spot: &Spot, is_ready: impl Fn(u32) -> bool) -> Vec<Near> {
        // Far outside, whole numbers end.
        let (reach, size) = (2.0 * ANSWER_REACH, self.voxels.lattice.dims.as_dvec3());
        if !(spot.at.cmpgt(DVec3::splat(-reach)).all() && spot.at.cmplt(size + reach).all()) {
            return Vec::new();
        }
        let of = |cell: Cell| {
            let reaches = [ANSWER_REACH, 2.0 * ANSWER_REACH].into_iter();
            reaches.map(|reach| self.within(spot, cell, reach, &is_ready)).find(|near| !near.is_empty())
        };
        self.voxels.lattice.all_at(spot.at).find_map(of).unwrap_or_default()
    }

    /// The same among cells around one, within a reach in cells of its size.
    fn within(&self, spot: &Spot, middle: Cell, reach: f64, is_ready: &impl Fn(u32) -> bool) -> Vec<Near> {
        let mut near = Vec::new();
        let lattice = &self.voxels.lattice;
        let fine = lattice.fine(middle);
        let (at, above) = (spot.at * fine, ABOVE * fine);
        // Starts lie in their cells, or just above: those of others weigh nothing.
        let is_in_reach = |c: &Cell| {
            let low = c.at.as_dvec3() - above;
            at.distance(at.clamp(low, low + 1.0 + 2.0 * above)) < reach
        };
        let cells = lattice.block(middle, reach.ceil() as i32).filter(is_in_reach);
        let mut last = NONE;
        let covered = self.voxels.is_covered(spot.at, spot.normal, fine);
        for cell in cells {
            for entry in self.voxels.entries_of(cell) {
                let e = &self.voxels.entries[entry as usize];
                let like = e.normal.as_dvec3().dot(spot.normal);
                let state = 2 * entry + u32::from(like < 0.0);
                if like.abs() <= ANSWER_NORMAL || !is_ready(state) {
                    continue;
                }
                let starts = self.starts(state);
                let weight = weight(spot, starts, fine, reach) * (like.abs() - ANSWER_NORMAL);
                let area = ANSWER_AREA + (1.0 - ANSWER_AREA) * f64::from(e.area).min(1.0);
                let sees = |s: &Start| self.voxels.free_of(spot.at, s.at.as_dvec3(), &mut last);
                let is_like = starts.first().is_some_and(|s| s.covered == covered);
                if weight > 0.0 && is_like && starts.iter().any(sees) {
                    near.push((state, weight * area));
                }
            }
        }
        near
    }

    /// What rays from a spot see: states, [`SKY`] or [`DARK`], with their directions.
    fn seen(&self, spot: &Spot) -> Vec<(u32, DVec3)> {
        let count = self.settings.answer_rays;
        let ways = Hemisphere::new(spot.normal, count, spot.key);
        let start = Start { at: spot.at.as_vec3(), normal: spot.normal.as_vec3(), covered: false };
        let of = |i| {
            let direction = ways.direction(i);
            (self.voxels.trace(&start, direction, &|s| self.starts(s)).target, direction)
        };
        (0..count).map(of).collect()
    }

    fn by_rays(&self, spot: &Spot) -> Vec3 {
        let seen = self.seen(spot);
        let radiance = |(target, direction): &(u32, DVec3)| match *target {
            SKY => self.sky.radiance(direction.as_vec3()),
            DARK => Vec3::ZERO,
            state => self.glow[state as usize].out,
        };
        seen.iter().map(radiance).sum::<Vec3>() * (std::f32::consts::PI / seen.len() as f32)
    }
}

/// How much a state counts by the distance and the height of the middle of its starts, in cells of
/// which so many are along an edge of one of the grid.
fn weight(spot: &Spot, starts: &[Start], fine: f64, reach: f64) -> f64 {
    if starts.is_empty() {
        return 0.0;
    }
    let middle = starts.iter().map(|s| s.at.as_dvec3()).sum::<DVec3>() / starts.len() as f64;
    let way = (middle - spot.at) * fine;
    let (near, height) = (1.0 - way.length() / reach, way.dot(spot.normal).abs());
    near.max(0.0).powi(2) * (1.0 - ANSWER_HEIGHT * height).max(0.0)
}
