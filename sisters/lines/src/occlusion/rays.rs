//! Rays through the cells of a grid of segments (Amanatides and Woo 1987), that tubes stop.
//!
//! A ray stands for the share of the hemisphere around it, so it has a width that grows with its
//! way. A tube beside its middle stops the part of that width that it covers, and so does the ball
//! that rounds the bend of a line where no tube of it comes nearest; parts of several tubes are
//! taken as independent of each other. Lengths are in radii of the hemisphere.

#[cfg(test)]
mod tests;

use glam::{UVec3, Vec2, Vec3};

use crate::buffers::Fragment;
use crate::cells::{Cells, NONE};
use crate::directions::decoded;
use crate::numeric::{ALONG_VIEW, LEAST_WAY, RAY_LIFT, RAY_PARALLEL, STOPPED};
use crate::view::View;

/// The hemisphere around a point of a line (Benevides 2015, section 3.3.1): its base is tangent to
/// the line, its pole is turned to the viewer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hemisphere {
    /// The receiver in eye space, in units of the scene.
    middle: Vec3,
    pub(super) pole: Vec3,
    /// In units of the scene.
    radius: f32,
    /// A direction normal to the direction of view, for lines without a tangent.
    across: Vec3,
}

impl Hemisphere {
    /// `None` for a receiver at or behind the eye of a perspective view.
    pub(super) fn new(at: &Fragment, radius: f32, view: &View) -> Option<Self> {
        if !at.position.is_finite() || (view.is_perspective() && at.position.z >= 0.0) {
            return None;
        }
        let away = view.away(at.position);
        let pole = -away - at.tangent * at.tangent.dot(-away);
        // A line along the view: every direction is normal to it but the one to the eye, which
        // shows best.
        let pole = if pole.length() > ALONG_VIEW { pole.normalize() } else { -away };
        let across = (Vec3::X - away * away.x).normalize_or(Vec3::Y);
        Some(Self { middle: at.position, pole, radius, across })
    }
}

/// The share of the rays of a set that tubes of a radius in units of the scene stop. A point of the
/// disc is a direction: evenly spread points are cosine-weighted ones.
pub(super) fn stopped(
    cells: &Cells,
    view: &View,
    above: &Hemisphere,
    tangent: Vec3,
    (set, line_radius, own): (&[Vec2], f32, Option<u32>),
) -> f32 {
    let across = (tangent - above.pole * tangent.dot(above.pole)).try_normalize().unwrap_or(above.across);
    let to_world = view.eye_from_world().matrix3.transpose();
    let [x, y, z] =
        [across, above.pole.cross(across), above.pole].map(|v| (to_world * v.as_dvec3()).as_vec3());
    let rays = Rays::new(cells, [above.radius, line_radius], view.to_world(above.middle).as_vec3(), z);
    rays.stopped([x, y, z], set, 1.0, own)
}

/// The rays of a receiver.
pub(super) struct Rays<'a> {
    cells: &'a Cells,
    /// In the world.
    start: Vec3,
    /// Radii of the hemisphere in a unit of the scene.
    scale: f32,
    /// The radius of a tube.
    tube: f32,
    /// Half of the greatest width of a ray.
    soft: f32,
    /// Half of the width of a ray for each unit of its way.
    spread: f32,
}

impl<'a> Rays<'a> {
    /// From the middle of a line in the world, lifted along the pole; with the radii of the
    /// hemisphere and of a tube, in units of the scene. They have no width.
    pub(super) fn new(cells: &'a Cells, [radius, line_radius]: [f32; 2], middle: Vec3, pole: Vec3) -> Self {
        Self {
            cells,
            start: middle + pole * (line_radius * RAY_LIFT),
            scale: 1.0 / radius,
            tube: line_radius / radius,
            soft: (cells.margin() - line_radius).max(0.0) / radius,
            spread: 0.0,
        }
    }

    /// The share that is stopped of the rays of a set, in a frame of the world whose last direction
    /// is the pole. Each is as wide as its share of the hemisphere times `wide`. With the number of
    /// the receiver's own line, tubes of other lines are solid.
    pub(super) fn stopped(self, [x, y, z]: [Vec3; 3], set: &[Vec2], wide: f32, own: Option<u32>) -> f32 {
        if own.is_some_and(|own| self.is_buried(own)) {
            return 1.0;
        }
        let rays = Self { spread: wide / (set.len() as f32).sqrt(), ..self };
        let hidden = |at: &Vec2| {
            let up = (1.0 - at.length_squared()).max(0.0).sqrt();
            1.0 - rays.passed(x * at.x + y * at.y + z * up)
        };
        set.iter().map(hidden).sum::<f32>() / set.len() as f32
    }

    /// Whether the tube of another line than `own` holds the start.
    fn is_buried(&self, own: u32) -> bool {
        let at = ((self.start - self.cells.origin()) / self.cells.side()).floor();
        // Whatever holds a start is named by its cell; outside of the grid there is nothing.
        let is_inside = at.cmpge(Vec3::ZERO).all() && at.cmplt(self.cells.dims().as_vec3()).all();
        is_inside
            && self.cells.named(at.as_uvec3()).iter().any(|&segment| {
                let [a, b] = self.cells.ends()[segment as usize];
                let is_other = self.cells.lines()[segment as usize] != own;
                is_other && self.holds((a - self.start) * self.scale, (b - a) * self.scale)
            })
    }

    /// The share of a ray of length 1 in a direction that gets through.
    fn passed(&self, way: Vec3) -> f32 {
        let (side, dims) = (self.cells.side(), self.cells.dims().as_vec3());
        let from = (self.start - self.cells.origin()) / side;
        let step = step_of(way, side * self.scale);
        // Where the ray enters and leaves the grid.
        let (low, high) = (-from / step, (dims - from) / step);
        let mut enter = low.min(high).max_element().max(0.0);
        let exit = low.max(high).min_element().min(1.0);
        let is_inside = enter <= exit;
        if !is_inside {
            return 1.0;
        }
        let mut cell = (from + step * enter).clamp(Vec3::ZERO, dims - 1.0).floor();
        let forth = step.signum();
        let mut open = 1.0;
        loop {
            let borders = (cell + forth.max(Vec3::ZERO) - from) / step;
            let leave = borders.min_element().min(exit);
            open *= self.beside(way, [enter, leave], cell.as_uvec3());
            if open < STOPPED || leave >= exit || leave.is_nan() {
                return open;
            }
            enter = enter.max(leave);
            let axis = borders.min_position();
            cell[axis] += forth[axis];
            // Each step leads on towards a side of the grid, so that rays end.
            if !(0.0..dims[axis]).contains(&cell[axis]) {
                return open;
            }
        }
    }

    /// The share of a ray that the tubes let through that come nearest to it on a part of its way.
    fn beside(&self, way: Vec3, [from, to]: [f32; 2], cell: UVec3) -> f32 {
        let mut open = 1.0;
        // The square of the greatest distance at which a tube stops some of it.
        let reach = (self.tube + self.soft.min(to * self.spread)).powi(2);
        for &segment in self.cells.named(cell) {
            let [a, b] = self.cells.ends()[segment as usize];
            let (to_a, axis) = ((a - self.start) * self.scale, (b - a) * self.scale);
            let normal = way.cross(axis);
            let square = normal.length_squared();
            let is_across = square > RAY_PARALLEL * axis.length_squared();
            let beside = to_a.dot(normal);
            if is_across && beside * beside > reach * square {
                continue;
            }
            let share = to_a.cross(way).dot(normal) / square;
            let covered = if is_across && (0.0..1.0).contains(&share) {
                let t = to_a.cross(axis).dot(normal) / square;
                let is_here = t > from && t <= to;
                if is_here { self.covered(t, beside.abs() / square.sqrt()) } else { 0.0 }
            } else {
                let neighbours = self.cells.neighbours()[segment as usize];
                self.rounded(way, [from, to], ([to_a, axis], neighbours), is_across)
            };
            if covered > 0.0 && !self.holds(to_a, axis) {
                open *= 1.0 - covered.min(1.0);
            }
        }
        open
    }

    /// The share of the width of a ray that a tube covers, at a way and a distance from its middle.
    fn covered(&self, t: f32, distance: f32) -> f32 {
        let half = self.half(t);
        (half.min(distance + self.tube) - (-half).max(distance - self.tube)) / (2.0 * half)
    }

    /// Half of the width of a ray.
    fn half(&self, t: f32) -> f32 {
        (t * self.spread).min(self.soft).max(f32::MIN_POSITIVE)
    }

    /// The share that the ball at an end of a tube covers, of a ray that comes nearest to the line
    /// of the tube beyond that end, or runs along the tube and comes to that end first; 0 where the
    /// tube after it on its line, or the ball of that one, covers it.
    fn rounded(
        &self,
        way: Vec3,
        [from, to]: [f32; 2],
        ([to_a, axis], neighbours): ([Vec3; 2], [u32; 2]),
        is_across: bool,
    ) -> f32 {
        let at = |end: Vec3| (end.dot(way), way * end.dot(way) - end);
        let (t, off) = at(to_a);
        let is_first = if is_across { off.dot(axis) < 0.0 } else { way.dot(axis) > 0.0 };
        let (end, neighbour) = match is_first {
            true => (to_a, neighbours[0]),
            false => (to_a + axis, neighbours[1]),
        };
        let (t, off) = if is_first { (t, off) } else { at(end) };
        if !(t > from && t <= to) {
            return 0.0;
        }
        if neighbour != NONE {
            let on = decoded(neighbour);
            // A tube that holds the start stops nothing, and its ball neither.
            let is_alone = (end + on * (-end.dot(on)).max(0.0)).length() <= self.tube;
            // Where both stop rays, the ball at their joint counts for the second one.
            let is_own = is_alone || (is_across && is_first && off.dot(on) < 0.0);
            if !is_own {
                return 0.0;
            }
        }
        // A ball is no longer than it is wide.
        self.covered(t, off.length()) * (self.tube / self.half(t)).min(1.0)
    }

    /// Whether the start lies in a tube.
    fn holds(&self, to_a: Vec3, axis: Vec3) -> bool {
        let along = (-to_a.dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
        (to_a + axis * along).length() <= self.tube
    }
}

/// The cells, with a side in radii, that a ray crosses on each unit of its way: 0 in no direction,
/// so that the crossing of any border is a number.
fn step_of(way: Vec3, side: f32) -> Vec3 {
    way.map(|w| w.abs().max(LEAST_WAY).copysign(w)) / side
}
