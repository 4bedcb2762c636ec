//! The visible region as a polygon.

use std::f64::consts::PI;

use glam::{DVec2, Vec2};

use crate::geometry::block::Block;
use crate::point::envelope::{BLOCKED, OPEN, Piece};
use crate::point::region::Region;
use crate::point::target::inside_circle;

/// Chords that the circle at the end of a range would have if all of it were seen.
const CHORDS: f64 = 64.0;

/// A polygon that is being made.
struct Outline {
    eye: DVec2,
    corners: Vec<Vec2>,
}

/// The corners of the visible region, counterclockwise; `whole` if the view looks all round. Where nothing stops the eye, the region
/// ends at the range or else at `extent`, a block around the eye.
pub(crate) fn polygon(region: &Region, whole: bool, range: Option<f64>, extent: &Block) -> Vec<Vec2> {
    if region.is_empty() {
        return Vec::new();
    }
    let mut outline = Outline { eye: region.around.eye, corners: Vec::new() };
    if !whole {
        outline.push(DVec2::ZERO);
    }
    for domain in &region.envelope.domains {
        for piece in region.pieces(domain) {
            outline.add(region, &piece, range, extent);
        }
    }
    if outline.corners.len() > 1 && outline.corners.first() == outline.corners.last() {
        outline.corners.pop();
    }
    outline.corners
}

impl Outline {
    /// Adds a corner, given from the eye.
    fn push(&mut self, offset: DVec2) {
        let most = DVec2::splat(f32::MAX.into());
        let corner = (self.eye + offset).clamp(-most, most).as_vec2();
        if self.corners.last() != Some(&corner) {
            self.corners.push(corner);
        }
    }

    fn add(&mut self, region: &Region, piece: &Piece, range: Option<f64>, extent: &Block) {
        let sides = [&piece.from, &piece.to].map(|along| region.around.vague(along).v.normalize_or(DVec2::X));
        match (piece.wall, range) {
            (BLOCKED, _) => self.push(DVec2::ZERO),
            (OPEN, Some(range)) => self.add_arc(sides, range),
            (OPEN, None) => self.add_border(sides, extent),
            (wall, _) => {
                let wall = region.around.wall(wall);
                let ends = [&piece.from, &piece.to].map(|along| region.around.hit(wall, along).0 - self.eye);
                self.add_wall(ends, sides, range);
            }
        }
    }

    /// Adds a part of a wall, as far as it lies within the range.
    fn add_wall(&mut self, ends: [DVec2; 2], sides: [DVec2; 2], range: Option<f64>) {
        let Some(range) = range.filter(|range| ends.iter().any(|end| end.length() > *range)) else {
            return ends.into_iter().for_each(|end| self.push(end));
        };
        let Some([first, last]) = inside_circle(ends[0], ends[1], range) else {
            return self.add_arc(sides, range);
        };
        if ends[0].length() > range {
            self.add_arc([sides[0], first.normalize_or(sides[0])], range);
        }
        self.push(first);
        self.push(last);
        if ends[1].length() > range {
            self.add_arc([last.normalize_or(sides[1]), sides[1]], range);
        }
    }

    /// Adds a part of a circle: its ends, and the points where its tangents meet.
    fn add_arc(&mut self, [from, to]: [DVec2; 2], range: f64) {
        let angle = from.perp_dot(to).atan2(from.dot(to)).max(0.0);
        let count = (angle * CHORDS / (2.0 * PI)).ceil().max(1.0);
        let half = angle / count / 2.0;
        self.push(from * range);
        for i in 0..count as u32 {
            let middle = DVec2::from_angle(half * f64::from(2 * i + 1)).rotate(from);
            self.push(middle * (range / half.cos()));
        }
        self.push(to * range);
    }

    /// Adds a part of the border of a block around the eye, in one quarter of the circle.
    fn add_border(&mut self, [from, to]: [DVec2; 2], extent: &Block) {
        let (low, high) = (extent.min - self.eye, extent.max - self.eye);
        let end = |d: DVec2| {
            let far = |axis: usize| match d[axis] {
                0.0 => f64::INFINITY,
                v => (if v > 0.0 { high[axis] } else { low[axis] }) / v,
            };
            d * far(0).min(far(1))
        };
        let middle = from + to;
        let corner = DVec2::select(middle.cmpge(DVec2::ZERO), high, low);
        self.push(end(from));
        if from.perp_dot(corner) > 0.0 && corner.perp_dot(to) > 0.0 {
            self.push(corner);
        }
        self.push(end(to));
    }
}
