//! All that the library asks of a kind of shape besides cells.

use glam::{DVec3, Vec3};

use crate::error::Error;
use crate::geometry::Block;
use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::Part;
use crate::shape::Shape;

/// A kind of bounds or occluders. Answers that a kind does not give are those of its bounding box.
pub(crate) trait Kind: Shape {
    /// The shape behind a reference or an `Arc`.
    fn as_kind(&self) -> &dyn Kind
    where
        Self: Sized,
    {
        self
    }

    /// Refuses values that are no shape; `what` names the shape in the error.
    fn check(&self, _what: &'static str) -> Result<(), Error> {
        Ok(())
    }

    /// Refuses shapes that can hide nothing.
    fn check_hides(&self) -> Result<(), Error> {
        Ok(())
    }

    /// Whether both are the same shape at the same place.
    fn same(&self, other: &Self) -> bool
    where
        Self: Sized;

    /// The shape moved by an offset in world units; `None` if it stays where it is.
    fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error>
    where
        Self: Sized;

    /// Tells the parts of it that several objects may share: the place of each in memory, and its
    /// bytes.
    fn shared(&self, _: &mut dyn FnMut(*const u8, usize)) {}

    /// A box around the shape.
    fn block(&self) -> Block {
        Block::new(self.bounds())
    }

    /// The least box around its points, where [`Kind::block`] may be larger. May cost all vertices.
    fn least_block(&self) -> Block {
        self.block()
    }

    /// The box, if the shape is exactly a box along the axes.
    fn as_block(&self) -> Option<Block> {
        None
    }

    /// Whether it has an inside that points can lie in.
    fn is_solid(&self) -> bool {
        true
    }

    /// Whether it may have points in each of the half-spaces; in doubt, yes.
    fn may_reach(&self, planes: &[HalfSpace]) -> bool {
        self.block().may_reach(planes)
    }

    /// Whether it may meet the common part of half-spaces, which lies in the box `around`; in
    /// doubt, yes.
    fn may_meet(&self, planes: &[HalfSpace], around: &Block) -> bool {
        let block = self.block();
        around.meets(&block) && block.may_reach(planes)
    }

    /// How far its nearest point is from an eye; not positive for an eye inside.
    fn distance_from(&self, eye: DVec3) -> f64 {
        self.block().distance_from(eye)
    }

    /// The least coordinate of its points along a direction.
    fn distance_along(&self, direction: DVec3) -> f64 {
        self.block().distance_along(direction)
    }

    /// Centre and radius of a ball around it.
    fn ball(&self) -> (DVec3, f64) {
        self.block().ball()
    }

    /// A solid around it, relative to an origin of which each coordinate is known to within `grow`.
    fn outer(&self, origin: DVec3, grow: f64) -> Body<'_> {
        let b = self.block();
        Body::Block(Block { min: b.min - origin - grow, max: b.max - origin + grow })
    }

    /// A solid inside of it, relative to an origin of which each coordinate is known to within
    /// `shrink`; `None` if no such solid is left, and for shapes that are drawn by their triangles.
    fn inner(&self, _origin: DVec3, _shrink: f64) -> Option<Body<'_>> {
        None
    }

    /// Whether the middle of its box lies in it.
    fn is_centered(&self) -> bool {
        false
    }

    /// A point of its largest part, if it has parts (see [`Kind::all_parts`]).
    fn middle_of_parts(&self) -> Option<DVec3> {
        None
    }

    /// Whether all convex parts that together contain it pass a test, relative to an origin that is
    /// known exactly; `None` if it has no parts.
    fn all_parts(&self, _origin: DVec3, _test: &mut dyn FnMut(&Part) -> bool) -> Option<bool> {
        None
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec4, Quat};

    use super::*;
    use crate::geometry::{Aabb, Obb, Sphere};
    use crate::random::Random;
    use crate::shape::Convex;

    /// Whether a body contains a point, which is relative to its origin; by a margin for rounding.
    fn contains(body: &Body, p: DVec3) -> bool {
        match body {
            Body::Sphere { center, radius } => p.distance(*center) <= radius + 1e-9,
            Body::Block(b) => Block { min: b.min - 1e-9, max: b.max + 1e-9 }.contains_point(p),
            Body::Oriented { center, axes } => {
                (axes.inverse() * (p - *center)).abs().max_element() <= 1.0 + 1e-9
            }
            Body::Part(part) => part.faces().all(|face| face.distance(p) >= -1e-9),
        }
    }

    /// Points of the shape, to which all of its answers must do justice.
    fn check_answers(kind: &dyn Kind, random: &mut Random) -> usize {
        let block = kind.block();
        let point = |random: &mut Random| {
            block.min + (block.max - block.min) * (random.point(1.0) * 0.5 + DVec3::splat(0.5))
        };
        let points: Vec<DVec3> =
            (0..200).map(|_| point(random)).filter(|p| kind.contains_point(*p)).collect();
        let along = random.point(1.0).normalize();
        let (center, radius) = kind.ball();
        let (eye, origin) = (random.point(1.0) * 9.0, random.point(1.0) * 9.0);
        let outer = kind.outer(origin, 0.0);
        for &p in &points {
            assert!(p.distance(center) <= radius + 1e-9);
            assert!(kind.distance_from(eye) <= p.distance(eye) + 1e-9);
            assert!(kind.distance_along(along) <= p.dot(along) + 1e-9);
            assert!(contains(&outer, p - origin));
            let plane = HalfSpace::new(random.point(1.0).extend(0.0) + DVec4::W * 1e-3);
            let plane = plane.map(|n| HalfSpace { offset: 1e-9 - n.normal.dot(p), ..n });
            assert!(kind.may_reach(plane.as_slice()));
            assert!(kind.may_meet(plane.as_slice(), &Block { min: p - 1e-3, max: p + 1e-3 }));
        }
        if let Some(inner) = kind.inner(origin, 0.0) {
            let mut inside = (0..200).map(|_| point(random)).filter(|p| contains(&inner, *p - origin));
            assert!(inside.all(|p| kind.contains_point(p + (center - p) * 1e-6)));
        }
        let beyond = HalfSpace { normal: along, offset: -(center.dot(along) + 2.0 * radius + 1.0) };
        assert!(!kind.may_reach(&[beyond]));
        points.len()
    }

    #[test]
    fn answers_do_justice_to_all_points_of_a_shape() {
        let mut random = Random::new(7);
        let mut points = 0;
        for _ in 0..40 {
            let (center, half) = (random.point(1.0) * 5.0, random.point(1.0).abs() + 0.1);
            let axis = random.point(1.0).normalize().as_vec3();
            let turn = Quat::from_axis_angle(axis, random.within(-1.0, 1.0) as f32 * 3.0);
            let (center, half) = (center.as_vec3(), half.as_vec3());
            let turned = Obb::new(center, half, turn);
            let axes = DMat3::from_quat(turn.as_dquat().normalize());
            let corner = |v: DVec3| (center.as_dvec3() + axes * v).as_vec3();
            let corners = Block { min: -half.as_dvec3(), max: half.as_dvec3() }.corners().map(corner);
            let hull = Convex::from_points(&corners).unwrap();
            let kinds: [&dyn Kind; 4] =
                [&Sphere::new(center, half.x), &Aabb::new(center - half, center + half), &turned, &hull];
            points += kinds.into_iter().map(|kind| check_answers(kind, &mut random)).sum::<usize>();
        }
        assert!(points > 10_000, "{points}");
    }

    #[test]
    fn moved_shapes_are_other_shapes_of_the_same_kind() {
        let offset = Vec3::new(1.0, 2.0, 3.0);
        let ball = Sphere::new(Vec3::ONE, 0.5);
        let moved = Kind::moved(&ball, offset).unwrap().unwrap();
        assert!(ball.same(&ball) && !ball.same(&moved));
        assert_eq!(moved, Sphere::new(Vec3::new(2.0, 3.0, 4.0), 0.5));
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let hull = Convex::from_points(&points).unwrap();
        let moved = Kind::moved(&hull, offset).unwrap().unwrap();
        assert!(hull.same(&hull) && !hull.same(&hull.clone()));
        assert!(moved.vertices().eq(hull.vertices().map(|v| v + offset.as_dvec3())));
        let shared = |shape: &dyn Kind| {
            let mut bytes = 0;
            shape.shared(&mut |_, more| bytes += more);
            bytes
        };
        assert!(shared(&hull) > size_of::<Convex>() && shared(&ball) == 0);
    }
}
