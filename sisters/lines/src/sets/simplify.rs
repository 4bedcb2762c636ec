//! Lines with fewer vertices, within a tolerance: tractograms and streamlines are sampled far more
//! finely than a picture shows.
//!
//! Vertices are dropped, none is moved. From a vertex that stays, the next one is as far along the
//! line as the straight way there keeps to the tolerance: found by doubling the number of vertices
//! in between, and then halving the last step, so that a line takes n log n steps whatever its
//! shape (Douglas and Peucker's method of 1973 takes n² on some). A straight way is compared with
//! all that it replaces in the order of the line: each vertex with the place that the way has
//! reached, which never goes back. So the distance is that of Fréchet (Alt and Godau 1995), and
//! holds in both directions: no point of the new line is farther from the old one than the
//! tolerance, and none of the old one from the new.

#[cfg(test)]
mod tests;

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use crate::numeric::{SIMPLIFY_ROUNDING, VALUE_TOLERANCE};
use crate::sets::LineSet;
use crate::sets::attributes::{Attributes, Of};

/// How much simplified lines may differ from those that they were made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// The greatest distance of Fréchet between a line and its simplified one, in units of the
    /// scene. Negative and NaN count as 0, and so only vertices of straight parts are dropped.
    pub distance: f32,
    /// The greatest error of the numbers of vertices, as a share of the range of each array, and of
    /// colours, as a share of 255, where values between vertices are interpolated. Negative and
    /// NaN count as 0; with infinity values keep no vertex.
    pub values: f32,
}

impl Tolerance {
    /// Lines within a distance, and values within [`VALUE_TOLERANCE`].
    pub fn within(distance: f32) -> Self {
        Self { distance, values: VALUE_TOLERANCE }
    }
}

impl LineSet {
    /// The same lines with fewer vertices: both ends of each line and some of the others, with
    /// their numbers and colours. Lines within the tolerance of a point become their two ends.
    ///
    /// Error: as `tolerance` says, and by rounding [`SIMPLIFY_ROUNDING`] of the length of the part
    /// of a line that one segment replaces. Tangents, and colours by direction, are those of the
    /// new lines. A part that runs back by more than the tolerance keeps its turns.
    ///
    /// Time: n log n for a line of n vertices, lines on all cores. Memory: 24 bytes a line and 8
    /// bytes a vertex that stays, beside the new set.
    pub fn simplified(&self, tolerance: &Tolerance) -> Self {
        let way = Ways {
            points: self.points(),
            distance: f64::from(tolerance.distance.max(0.0)),
            channels: channels(self.attributes(), tolerance.values.max(0.0)),
        };
        let of_line = |line: usize| {
            let vertices = self.range(line).unwrap_or_default();
            let first = vertices.start;
            let kept = chain(vertices.len(), |from, to| way.fits(first + from..first + to));
            kept.into_iter().map(|v| (first + v) as u32).collect()
        };
        self.of_vertices(&(0..self.len()).into_par_iter().map(of_line).collect::<Vec<Vec<u32>>>())
    }
}

/// The vertices that stay of `count` in a row: the first, the last, and others so that `fits`
/// holds from each to the next. It is not asked about neighbours, for which it must hold.
///
/// If asking about n vertices in between costs n, the whole costs n log n.
fn chain(count: usize, fits: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let last = count.saturating_sub(1);
    let mut kept: Vec<usize> = (0..count.min(1)).collect();
    while let Some(&from) = kept.last().filter(|&&from| from < last) {
        let (mut good, mut bad) = (from + 1, last + 1);
        let mut step = 2;
        while good < last && bad > last {
            let to = last.min(from + step);
            if fits(from, to) {
                good = to
            } else {
                bad = to
            }
            step *= 2;
        }
        while bad - good > 1 && good < last {
            let middle = good + (bad - good) / 2;
            if fits(from, middle) { good = middle } else { bad = middle }
        }
        kept.push(good);
    }
    kept
}

/// Straight ways from vertex to vertex.
struct Ways<'a> {
    points: &'a [Vec3],
    distance: f64,
    channels: Vec<Channel<'a>>,
}

impl Ways<'_> {
    /// Whether a straight way from a vertex to a later one of its line, the ends of `ends`, keeps
    /// to the tolerance.
    fn fits(&self, ends: Range<usize>) -> bool {
        let at = |i: usize| self.points[i].as_dvec3();
        let start = at(ends.start);
        let way = at(ends.end) - start;
        let (square, long) = (way.length_squared(), way.abs().max_element());
        let mut reached = 0.0;
        (ends.start + 1..ends.end).all(|i| {
            let off = at(i) - start;
            if square > 0.0 {
                reached = (off.dot(way) / square).clamp(reached, 1.0);
            }
            let most = self.distance + SIMPLIFY_ROUNDING * (long + off.abs().max_element());
            (off - way * reached).length_squared() <= most * most
                && self.channels.iter().all(|c| c.is_near(&ends, i, reached))
        })
    }
}

/// Numbers of vertices, and their greatest error.
struct Channel<'a> {
    of: Numbers<'a>,
    most: f64,
}

enum Numbers<'a> {
    Scalars(&'a [f32]),
    /// One of red, green and blue.
    Colours(&'a [[u8; 3]], usize),
}

impl Channel<'_> {
    fn at(&self, vertex: usize) -> f64 {
        match self.of {
            Numbers::Scalars(values) => f64::from(values[vertex]),
            Numbers::Colours(colours, part) => f64::from(colours[vertex][part]),
        }
    }

    /// Whether the number of a vertex is near that at a share of the way between two others. One
    /// that is not known is near to no other.
    fn is_near(&self, ends: &Range<usize>, vertex: usize, share: f64) -> bool {
        let (first, here) = (self.at(ends.start), self.at(vertex));
        let between = first + (self.at(ends.end) - first) * share;
        if here.is_nan() { between.is_nan() } else { (here - between).abs() <= self.most }
    }
}

/// The numbers of vertices and their colours, if errors of them count.
fn channels(attributes: &Attributes, share: f32) -> Vec<Channel<'_>> {
    if share == f32::INFINITY {
        return Vec::new();
    }
    let of_vertices = attributes.scalars.iter().filter(|s| s.of == Of::Vertices);
    let scalars = of_vertices.map(|s| {
        let known = s.values.iter().map(|v| f64::from(*v)).filter(|v| v.is_finite());
        let [low, high] = known.fold([f64::MAX, f64::MIN], |[low, high], v| [low.min(v), high.max(v)]);
        let rounding = SIMPLIFY_ROUNDING * low.abs().max(high.abs());
        Channel { of: Numbers::Scalars(&s.values), most: f64::from(share) * (high - low).max(0.0) + rounding }
    });
    let colours = attributes.colours.iter().flat_map(|all| {
        (0..3).map(|part| Channel { of: Numbers::Colours(all, part), most: f64::from(share) * 255.0 })
    });
    scalars.chain(colours).collect()
}
