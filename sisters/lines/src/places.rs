//! Places along lines, evenly spaced on each. What is computed there serves all views of the lines.

#[cfg(test)]
mod tests;

use glam::Vec3;
use rayon::prelude::*;

use crate::directions::coded;
use crate::numeric::MOST_PLACES;
use crate::sets::{LineSet, arc_lengths_of};

/// Places along the lines of a set. Each line has one at both ends and others at equal ways between
/// them; a dot has one.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    spans: Vec<Span>,
    tangents: Vec<u32>,
}

/// The places of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// The number of its first vertex in the set.
    pub vertex: u32,
    /// The number of its last vertex; that of the first on dots.
    pub last_vertex: u32,
    /// The number of its first place.
    pub place: u32,
    /// The ways from place to place: one less than the places.
    pub steps: u32,
}

impl Places {
    /// Places about `step` apart, in units of the scene; farther apart where there were more than
    /// [`MOST_PLACES`] otherwise. With a step that is not greater than 0 there are as many as there
    /// may be.
    ///
    /// Time: proportional to the vertices and places. Memory: 16 bytes a line, 4 bytes a place;
    /// while it is made, 16 bytes a vertex.
    pub fn new(lines: &LineSet, step: f32) -> Self {
        let lengths = lines.arc_lengths();
        let long = |span: &Span| f64::from(lengths[span.last_vertex as usize]);
        let is_line = |span: &Span| span.last_vertex > span.vertex;
        let mut vertex = 0;
        let mut spans = Vec::with_capacity(lines.len());
        for line in lines.iter() {
            let first = vertex;
            vertex += line.len() as u32;
            // No pixel asks for the places of a line without vertices.
            spans.push(Span { vertex: first, last_vertex: vertex.max(first + 1) - 1, place: 0, steps: 0 });
        }
        let step = Self::step_for(lines, step);
        let mut count = 0;
        for span in &mut spans {
            span.place = count;
            span.steps = if is_line(span) { (long(span) / step).ceil().max(1.0) as u32 } else { 0 };
            count += span.steps + 1;
        }
        let vertices = lines.tangents();
        let of = |span: &Span| tangents(span, &lengths, &vertices);
        let tangents = spans.par_iter().flat_map_iter(of).collect();
        Self { spans, tangents }
    }

    /// The way from place to place, in units of the scene, that [`Self::new`] takes: `step`, or a
    /// longer one where the set has too many lines for it.
    ///
    /// Time: proportional to the vertices.
    pub fn step_for(lines: &LineSet, step: f32) -> f64 {
        let ends = lines.iter().filter_map(|line| arc_lengths_of(line).last());
        let whole: f64 = ends.map(f64::from).sum();
        // Two places of each line in any case.
        let room = f64::from(MOST_PLACES) - 2.0 * lines.len() as f64;
        f64::from(step).max(whole / room.max(1.0)).max(f64::MIN_POSITIVE)
    }

    /// The number of places.
    pub fn count(&self) -> u32 {
        self.tangents.len() as u32
    }

    /// Those of each line.
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// The tangent at each place: as [`crate::directions::decoded`] reads it.
    pub fn tangents(&self) -> &[u32] {
        &self.tangents
    }
}

/// The tangents at the places of a line, of those at vertices.
fn tangents(span: &Span, lengths: &[f32], vertices: &[Vec3]) -> Vec<u32> {
    let at = |number| {
        let (segment, share) = segment(lengths, span, number);
        let [a, b] = [segment, span.last_vertex.min(segment + 1)].map(|v| vertices[v as usize]);
        coded(a.lerp(b, share))
    };
    // An empty last line has no vertex of its own.
    let is_there = (span.vertex as usize) < vertices.len();
    (0..=span.steps).map(|n| if is_there { at(n) } else { 0 }).collect()
}

/// The segment of a place of a line with these ways along all lines, by its first vertex, and the
/// share of it that lies before the place.
pub(crate) fn segment(lengths: &[f32], span: &Span, number: u32) -> (u32, f32) {
    if span.steps == 0 {
        return (span.vertex, 0.0);
    }
    let line = &lengths[span.vertex as usize..=span.last_vertex as usize];
    let last = line.len() - 1;
    let along = line[last] * (number as f32 / span.steps as f32);
    let next = line.partition_point(|&l| l <= along).clamp(1, last);
    let way = line[next] - line[next - 1];
    let share = if way > 0.0 { ((along - line[next - 1]) / way).clamp(0.0, 1.0) } else { 0.0 };
    (span.vertex + next as u32 - 1, share)
}
