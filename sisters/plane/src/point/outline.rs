//! The visible region as a polygon.

use std::f64::consts::PI;

use glam::{DVec2, Vec2};

use crate::geometry::Block;
use crate::point::envelope::{BLOCKED, OPEN, Piece};
use crate::point::region::{Region, inside_circle};

/// Chords that the circle at the end of a range would have if all of it were seen.
const CHORDS: f64 = 64.0;

/// A polygon that is being made.
struct Outline {
    eye: DVec2,
    corners: Vec<Vec2>,
    /// The wall of the last piece, or [`OPEN`], if the next piece may go on along it.
    before: Option<u32>,
}

/// The corners of the visible region, counterclockwise; `whole` if the view looks all round. Where
/// nothing stops the eye, the region ends at the range or else at `extent`, a block around the eye.
pub(crate) fn polygon(region: &Region, whole: bool, range: Option<f64>, extent: &Block) -> Vec<Vec2> {
    if region.is_empty() {
        return Vec::new();
    }
    let corners = Vec::with_capacity(2 * region.envelope.steps.len() + 1);
    let mut outline = Outline { eye: region.around.eye, corners, before: None };
    if !whole {
        outline.push(DVec2::ZERO);
    }
    let mut first = None;
    for domain in &region.envelope.domains {
        for piece in region.pieces(domain) {
            outline.add(region, &piece, range, extent);
            first = first.or(Some(outline.before));
        }
    }
    if outline.corners.len() > 1 && outline.corners.first() == outline.corners.last() {
        outline.corners.pop();
        // The first corner lies inside a side if one wall begins and ends the circle.
        if whole && outline.before.is_some() && first == Some(outline.before) {
            outline.corners.remove(0);
        }
    }
    outline.corners
}

impl Outline {
    /// Adds a corner, given from the eye, unless it is rounded to the last one.
    fn push(&mut self, offset: DVec2) -> bool {
        let most = DVec2::splat(f32::MAX.into());
        let corner = (self.eye + offset).clamp(-most, most).as_vec2();
        let is_new = self.corners.last() != Some(&corner);
        if is_new {
            self.corners.push(corner);
        }
        is_new
    }

    fn add(&mut self, region: &Region, piece: &Piece, range: Option<f64>, extent: &Block) {
        let along = [&piece.from, &piece.to];
        let sides = || along.map(|along| region.around.vague(along).v.normalize_or(DVec2::X));
        let before = self.before.take();
        match (piece.wall, range) {
            (BLOCKED, _) => _ = self.push(DVec2::ZERO),
            (OPEN, Some(range)) => self.add_arc(sides(), range),
            (OPEN, None) => {
                let sides = sides();
                let [from, to] = sides.map(|side| self.border(side, extent));
                self.start(from, before, OPEN);
                self.add_corner(sides, extent);
                self.end(to, OPEN);
            }
            (number, _) => {
                let wall = region.around.wall(number);
                let ends = along.map(|along| region.around.hit(wall, along).0 - self.eye);
                match range.filter(|range| ends.iter().any(|end| end.length() > *range)) {
                    Some(range) => self.add_within(ends, sides(), range),
                    None => {
                        self.start(ends[0], before, number);
                        self.end(ends[1], number);
                    }
                }
            }
        }
    }

    /// Adds the beginning of a piece, unless it is a joint: the end of the last piece on the same
    /// wall.
    fn start(&mut self, offset: DVec2, before: Option<u32>, wall: u32) {
        if before == Some(wall) {
            self.corners.pop();
        } else {
            self.push(offset);
        }
    }

    /// Adds the end of a piece, which may be a joint.
    fn end(&mut self, offset: DVec2, wall: u32) {
        let is_new = self.push(offset);
        self.before = is_new.then_some(wall);
    }

    /// Adds the part of a wall that lies within the range, and the parts of the circle beside it.
    fn add_within(&mut self, ends: [DVec2; 2], sides: [DVec2; 2], range: f64) {
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

    /// The point of the border of a block around the eye in a direction, from the eye.
    fn border(&self, direction: DVec2, extent: &Block) -> DVec2 {
        let (low, high) = (extent.min - self.eye, extent.max - self.eye);
        let far = |axis: usize| match direction[axis] {
            0.0 => f64::INFINITY,
            v => (if v > 0.0 { high[axis] } else { low[axis] }) / v,
        };
        direction * far(0).min(far(1))
    }

    /// Adds the corner of a block around the eye that lies between two directions of one quarter of
    /// the circle, if there is one.
    fn add_corner(&mut self, [from, to]: [DVec2; 2], extent: &Block) {
        let corner =
            DVec2::select((from + to).cmpge(DVec2::ZERO), extent.max - self.eye, extent.min - self.eye);
        if from.perp_dot(corner) > 0.0 && corner.perp_dot(to) > 0.0 {
            self.push(corner);
        }
    }
}
