//! How far an eye may be from its place.

use glam::DVec3;

/// A ball or a box around a place, in world units: an eye may be anywhere in it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Room {
    /// No point of it is farther from the place,
    radius: f64,
    /// nor farther along an axis.
    half: DVec3,
}

impl Room {
    /// The place alone.
    pub(crate) const NONE: Self = Self { radius: 0.0, half: DVec3::ZERO };

    /// A ball.
    pub(crate) fn ball(radius: f64) -> Self {
        Self { radius, half: DVec3::splat(radius) }
    }

    /// A box, by half its edges. `radius` is no less than half of its diagonal.
    pub(crate) fn cuboid(half: DVec3, radius: f64) -> Self {
        Self { radius, half }
    }

    /// The radius of a ball that holds it.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// How far it goes along each axis.
    pub(crate) fn half(&self) -> DVec3 {
        self.half
    }

    /// No point of it is farther along a direction; in units of the direction's length.
    #[inline]
    pub(crate) fn along(&self, direction: DVec3) -> f64 {
        self.half.dot(direction.abs()).min(self.radius * direction.length())
    }

    /// The same, as it reaches along other axes: three directions of length 1 at right angles.
    pub(crate) fn turned(&self, axes: [DVec3; 3]) -> Self {
        Self { radius: self.radius, half: DVec3::from_array(axes.map(|axis| self.along(axis))) }
    }

    /// A room that holds all points within `by` along each axis of points of this one.
    pub(crate) fn grown(&self, by: f64) -> Self {
        Self { radius: self.radius + 3f64.sqrt() * by, half: self.half + by }
    }

    /// Whether it surely holds another one around a place that is `offset` away.
    pub(crate) fn holds(&self, other: &Self, offset: DVec3) -> bool {
        offset.length() + other.radius <= self.radius && (offset.abs() + other.half).cmple(self.half).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Any point of a room.
    fn point(room: &Room, random: &mut Random) -> DVec3 {
        loop {
            let p = room.half() * random.point(1.0);
            if p.length() <= room.radius() {
                return p;
            }
        }
    }

    #[test]
    fn no_point_is_farther_along_a_direction_and_some_are_nearly_as_far() {
        let mut random = Random::new(3);
        for round in 0..200 {
            let half = random.point(2.0).abs();
            let room = if round % 2 == 0 { Room::cuboid(half, half.length()) } else { Room::ball(half.x) };
            let turn = glam::DQuat::from_scaled_axis(random.point(3.0));
            let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis);
            let (turned, grown, n) = (room.turned(axes), room.grown(0.25), random.point(3.0));
            let mut most = 0f64;
            for _ in 0..400 {
                let p = point(&room, &mut random);
                most = most.max(p.dot(n));
                assert!(p.dot(n) <= room.along(n) * (1.0 + 1e-12), "{room:?} {p} {n}");
                let there = DVec3::from_array(axes.map(|axis| axis.dot(p)));
                assert!(there.dot(n) <= turned.along(n) * (1.0 + 1e-12), "{room:?} {there} {n}");
                let beside = p + random.point(0.25);
                assert!(beside.dot(n) <= grown.along(n) * (1.0 + 1e-12), "{room:?} {beside} {n}");
            }
            assert!(most > 0.6 * room.along(n), "{room:?} {n} {most}");
        }
    }

    #[test]
    fn a_room_holds_another_if_it_holds_its_points() {
        let mut random = Random::new(4);
        let (mut held, mut not) = (0, 0);
        for round in 0..2000 {
            let mut any = |scale: f64, ball: bool| {
                let half = random.point(scale).abs();
                if ball { Room::ball(half.x) } else { Room::cuboid(half, half.length()) }
            };
            let (room, other) = (any(2.0, round % 2 == 0), any(0.5, round % 4 < 2));
            let offset = random.point(1.0);
            if !room.holds(&other, offset) {
                not += 1;
                continue;
            }
            held += 1;
            for _ in 0..20 {
                let p = offset + point(&other, &mut random);
                assert!(p.length() <= room.radius() && p.abs().cmple(room.half()).all());
            }
        }
        assert!(held > 100 && not > 500, "{held} {not}");
    }
}
