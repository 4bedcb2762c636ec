//! Places along lines, evenly spaced on each. What is computed there serves all views of the lines.

#[cfg(test)]
mod tests;

use glam::Vec3;
use rayon::prelude::*;

use crate::directions::coded;
use crate::numeric::MOST_PLACES;
use crate::sets::{LineSet, arc_lengths_of, tangents_of};

/// Places along the lines of a set. Each line has one at both ends and others at equal ways between
/// them; a dot has one.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    spans: Vec<Span>,
    tangents: Vec<u32>,
    /// The way from place to place.
    step: f64,
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
        let whole: f64 = spans.iter().filter(|s| is_line(s)).map(long).sum();
        let step = fitting(step, whole, lines.len());
        let mut count = 0;
        for span in &mut spans {
            span.place = count;
            span.steps = if is_line(span) { (long(span) / step).ceil().max(1.0) as u32 } else { 0 };
            count += span.steps + 1;
        }
        let vertices = lines.tangents();
        let of = |span: &Span| tangents(span, &lengths, &vertices);
        let tangents = spans.par_iter().flat_map_iter(of).collect();
        Self { spans, tangents, step }
    }

    /// The way from place to place, in units of the scene, that [`Self::new`] takes: `step`, or a
    /// longer one where the set has too many lines for it.
    ///
    /// Time and memory: proportional to the vertices.
    pub fn step_for(lines: &LineSet, step: f32) -> f64 {
        let lengths = lines.arc_lengths();
        let last =
            |line: usize| lines.range(line).filter(|range| !range.is_empty()).map(|range| range.end - 1);
        let whole = (0..lines.len()).filter_map(last).map(|vertex| f64::from(lengths[vertex])).sum();
        fitting(step, whole, lines.len())
    }

    /// Puts the places of some lines to where these are in `lines`. Their numbers stay, so that
    /// places of a line that grew are farther apart. `false`, and some lines may be moved, if a
    /// line has another number of vertices, or should have less than half or more than twice as
    /// many places: then places must be made anew.
    ///
    /// Time: proportional to the vertices and places of the moved lines.
    #[must_use]
    pub fn update(&mut self, lines: &LineSet, moved: &[u32]) -> bool {
        for &line in moved {
            let span = self.spans.get(line as usize).copied();
            let (Some(span), Some(range)) = (span, lines.range(line as usize)) else { return false };
            let last = range.end.saturating_sub(1);
            if range.start != span.vertex as usize || last.max(range.start) != span.last_vertex as usize {
                return false;
            }
            let vertices = &lines.points()[range];
            if vertices.is_empty() {
                continue;
            }
            let lengths: Vec<f32> = arc_lengths_of(vertices).collect();
            let steps = f64::from(lengths.last().copied().unwrap_or_default()) / self.step;
            let now = f64::from(span.steps);
            if span.steps > 0 && !(steps.ceil().max(1.0) / 2.0..=2.0 * steps.ceil().max(1.0)).contains(&now) {
                return false;
            }
            let alone = Span { vertex: 0, last_vertex: span.last_vertex - span.vertex, ..span };
            let made = tangents(&alone, &lengths, &tangents_of(vertices).collect::<Vec<_>>());
            self.tangents[span.place as usize..][..made.len()].copy_from_slice(&made);
        }
        true
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

/// The least way from place to place on lines of a length in all that there is room for.
fn fitting(step: f32, whole: f64, lines: usize) -> f64 {
    // Two places of each line in any case.
    let room = f64::from(MOST_PLACES) - 2.0 * lines as f64;
    f64::from(step).max(whole / room.max(1.0)).max(f64::MIN_POSITIVE)
}
