//! The occlusion at places along lines, on all sides of them, for all views.
//!
//! The pole of a hemisphere is normal to its line: all hemispheres of a place are turned copies of
//! one around the line. So a place has some sides at equal angles, and rays are sent from a side
//! once, when a view first asks for it. A pixel takes the two places beside it, of each the two
//! sides beside its pole, and interpolates: it has the rays of all four. Nothing but these weights
//! changes with the view.

#[cfg(test)]
mod tests;

use std::f32::consts::TAU;
use std::sync::atomic::{AtomicU16, Ordering};

use glam::Vec3;

use super::options::{AoOptions, Estimator, OptionsError};
use super::rays::Rays;
use crate::cells::Cells;
use crate::directions::decoded;
use crate::numeric::{SIDE_SPREAD, SIDES, hash};
use crate::places::{Places, segment};
use crate::samples::SampleSets;
use crate::sets::LineSet;

/// The occlusion on the sides of places, each computed when it is first asked for.
#[derive(Debug)]
pub struct Sides<'a> {
    lines: &'a LineSet,
    cells: &'a Cells,
    samples: &'a SampleSets,
    places: Places,
    lengths: Vec<f32>,
    options: AoOptions,
    /// One more than the share of 255; 0 before it is computed.
    values: Vec<[AtomicU16; SIDES as usize]>,
}

/// A value that a pixel takes: the place, its side, and the share of the pixel that it has.
pub(super) type Part = (u32, u32, f32);

impl<'a> Sides<'a> {
    /// For lines and their cells.
    ///
    /// Memory: 36 bytes a place, 16 a line and 4 a vertex.
    ///
    /// # Errors
    /// If an option is out of its range, the estimator is another than [`Estimator::Places`], or
    /// its tubes are thicker than the margin of the cells.
    pub fn new(
        lines: &'a LineSet,
        cells: &'a Cells,
        samples: &'a SampleSets,
        options: AoOptions,
    ) -> Result<Self, OptionsError> {
        options.check_with(cells)?;
        let Estimator::Places { step, .. } = options.estimator else { return Err(OptionsError::Source) };
        let places = Places::new(lines, step);
        let values = (0..places.count()).map(|_| Default::default()).collect();
        let lengths = lines.arc_lengths();
        Ok(Self { lines, cells, samples, places, lengths, options, values })
    }

    /// The options of the estimate.
    pub(super) fn options(&self) -> &AoOptions {
        &self.options
    }

    /// The occlusion of the hemisphere around a pole in the world, at a way along a line.
    pub(super) fn at(&self, line: u32, along: f32, pole: Vec3) -> f32 {
        self.parts(line, along, pole)
            .iter()
            .map(|&(place, side, share)| share * self.value(line, place, side))
            .sum()
    }

    /// The values that a pixel takes.
    fn parts(&self, line: u32, along: f32, pole: Vec3) -> [Part; 4] {
        let Some(span) = self.places.spans().get(line as usize) else { return [(0, 0, 0.0); 4] };
        let (steps, long) = (span.steps as f32, self.lengths[span.last_vertex as usize]);
        let at = if span.steps > 0 { (along / long * steps).clamp(0.0, steps) } else { 0.0 };
        let before = at.floor().min((steps - 1.0).max(0.0));
        let of = |number: f32, share: f32| {
            let place = span.place + number as u32;
            let (side, up) = decoded(self.places.tangents()[place as usize]).any_orthonormal_pair();
            let angle = pole.dot(up).atan2(pole.dot(side)) / TAU * SIDES as f32;
            let turn = angle.floor();
            let first = (turn as i32).rem_euclid(SIDES as i32) as u32;
            let second = share * (angle - turn);
            [(place, first, share - second), (place, (first + 1) % SIDES, second)]
        };
        let (near, far) = (of(before, 1.0 - (at - before)), of((before + 1.0).min(steps), at - before));
        [near[0], near[1], far[0], far[1]]
    }

    fn value(&self, line: u32, place: u32, side: u32) -> f32 {
        let Some(known) = self.values.get(place as usize).map(|sides| &sides[side as usize]) else {
            return 0.0;
        };
        // Two threads that compute a value at once compute the same.
        let mut value = known.load(Ordering::Relaxed);
        if value == 0 {
            value = 1 + (self.traced(line, place, side) * 255.0).round() as u16;
            known.store(value, Ordering::Relaxed);
        }
        f32::from(value - 1) / 255.0
    }

    /// The rays of a side.
    fn traced(&self, line: u32, place: u32, side: u32) -> f32 {
        let span = &self.places.spans()[line as usize];
        let (first, share) = segment(&self.lengths, span, place - span.place);
        let points = self.lines.points();
        let [a, b] = [first, span.last_vertex.min(first + 1)].map(|v| points[v as usize]);
        let along = decoded(self.places.tangents()[place as usize]);
        let (x, y) = along.any_orthonormal_pair();
        let (sine, cosine) = (side as f32 * (TAU / SIDES as f32)).sin_cos();
        let pole = x * cosine + y * sine;
        let set = self.samples.set(hash(place, side) as usize);
        let AoOptions { radius, estimator, solid } = self.options;
        let rays = Rays::new(self.cells, [radius, estimator.line_radius()], a.lerp(b, share), pole);
        rays.stopped([along, pole.cross(along), pole], set, SIDE_SPREAD, solid.then_some(line))
    }
}
