//! How far an eye may be from its place.

use glam::DVec3;

use crate::numeric::shape::REGION;

/// A ball or a box around a place, or around each point of a way through that, in world units: an
/// eye may be anywhere in it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Room {
    /// No point of it is farther from the place.
    radius: f64,
    /// Half of the way: it goes from the place to this point and to the opposite one.
    pub(crate) way: DVec3,
    /// No point is farther from the way,
    aside: f64,
    /// nor farther along an axis.
    half: DVec3,
}

impl Room {
    /// The place alone.
    pub(crate) const NONE: Self = Self { radius: 0.0, way: DVec3::ZERO, aside: 0.0, half: DVec3::ZERO };

    /// A ball.
    pub(crate) fn ball(radius: f64) -> Self {
        Self { radius, aside: radius, half: DVec3::splat(radius), ..Self::NONE }
    }

    /// A box, by half its edges. `radius` is no less than half of its diagonal.
    pub(crate) fn cuboid(half: DVec3, radius: f64) -> Self {
        Self { radius, aside: radius, half, ..Self::NONE }
    }

    /// All points within `aside` of a way, of which `way` is half.
    pub(crate) fn along_way(way: DVec3, aside: f64) -> Self {
        Self { radius: (way.length() + aside) * (1.0 + REGION), way, ..Self::ball(aside) }
    }

    /// The radius of a ball that holds it.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// How far it goes along each axis.
    pub(crate) fn half(&self) -> DVec3 {
        self.way.abs() + self.half
    }

    /// No point of it is farther along a direction; in units of the direction's length.
    #[inline]
    pub(crate) fn along(&self, direction: DVec3) -> f64 {
        self.way.dot(direction).abs() + self.aside(direction)
    }

    /// No point of it is farther from its way along a direction.
    #[inline]
    pub(crate) fn aside(&self, direction: DVec3) -> f64 {
        self.half.dot(direction.abs()).min(self.aside * direction.length())
    }

    /// The same, as it reaches along other axes: three directions of length 1 at right angles.
    pub(crate) fn turned(&self, axes: [DVec3; 3]) -> Self {
        let way = DVec3::from_array(axes.map(|axis| axis.dot(self.way)));
        Self { way, half: DVec3::from_array(axes.map(|axis| self.aside(axis))), ..*self }
    }

    /// A room that holds all points within `by` along each axis of points of this one.
    pub(crate) fn grown(&self, by: f64) -> Self {
        let far = 3f64.sqrt() * by;
        Self { radius: self.radius + far, aside: self.aside + far, half: self.half + by, ..*self }
    }

    /// Whether it surely holds another one around a place that is `offset` away.
    pub(crate) fn holds(&self, other: &Self, offset: DVec3) -> bool {
        let share = offset.dot(self.way) / self.way.length_squared();
        let offset = if share.is_nan() { offset } else { offset - self.way * share.clamp(-1.0, 1.0) };
        offset.length() + other.radius <= self.aside && (offset.abs() + other.half()).cmple(self.half).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Any point of a room.
    fn point(room: &Room, random: &mut Random) -> DVec3 {
        loop {
            let p = room.half * random.point(1.0);
            if p.length() <= room.aside {
                return p + room.way * random.within(-1.0, 1.0);
            }
        }
    }

    /// A ball, a box, or the points around a way.
    fn any(round: usize, half: DVec3, way: DVec3) -> Room {
        match round % 3 {
            0 => Room::cuboid(half, half.length()),
            1 => Room::ball(half.x),
            _ => Room::along_way(way, half.x),
        }
    }

    #[test]
    fn no_point_is_farther_along_a_direction_and_some_are_nearly_as_far() {
        let mut random = Random::new(3);
        for round in 0..200 {
            let room = any(round, random.point(2.0).abs(), random.point(2.0));
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
            let room = any(round, random.point(2.0).abs(), random.point(2.0));
            let other = any(round / 3, random.point(0.5).abs(), random.point(0.5));
            let offset = random.point(1.0);
            if !room.holds(&other, offset) {
                not += 1;
                continue;
            }
            held += 1;
            for _ in 0..20 {
                let p = offset + point(&other, &mut random);
                let share = (p.dot(room.way) / room.way.length_squared()).clamp(-1.0, 1.0);
                let aside = if share.is_nan() { p } else { p - room.way * share };
                assert!(aside.length() <= room.aside * (1.0 + 1e-12) && p.length() <= room.radius);
                assert!(p.abs().cmple(room.half() * (1.0 + 1e-12)).all());
            }
        }
        assert!(held > 100 && not > 500, "{held} {not}");
    }
}
