//! Shapes under a transform: bounds rounded outwards, occluders inwards.
//!
//! A renderer transforms vertices in single precision, so that they lie up to an error from the
//! place that double precision gives ([`crate::numeric::mesh::SINGLE`]). Bounds grow by that error,
//! occluders shrink by it.

use std::sync::Arc;

use glam::{Affine3A, DMat3, DQuat, DVec3, Quat, Vec3};

use crate::error::Error;
use crate::geometry::block::{above, below};
use crate::geometry::offset::Offset;
use crate::geometry::placement::{Placement, scales_alike};
use crate::geometry::{Aabb, Block, Obb, Sphere};
use crate::mesh::Instance;
use crate::numeric::mesh::ANGLES;
use crate::numeric::shape::{ALIKE, LENGTH_OF_ERROR};
use crate::object::{Bounds, Occluder};
use crate::shape::Convex;
use crate::shape::kind::Kind;

/// The shapes of an object in its own space, and where it is.
#[derive(Debug, Clone)]
pub(crate) struct Placed {
    pub(crate) bounds: Bounds,
    pub(crate) occluder: Option<Occluder>,
    pub(crate) transform: Affine3A,
}

impl Placed {
    /// The shapes in world space under another transform. Whether the occluder sticks out of the
    /// bounds was decided in their own space.
    ///
    /// # Errors
    /// As [`Bounds::placed`].
    pub(crate) fn at(&self, transform: Affine3A) -> Result<(Bounds, Option<Occluder>), Error> {
        let bounds = self.bounds.placed(transform)?;
        let occluder = self.occluder.as_ref().map(|o| o.placed(transform)).transpose()?.flatten();
        bounds.check()?;
        occluder.iter().try_for_each(Occluder::check)?;
        Ok((bounds, occluder))
    }
}

/// The transform of an object that is an instance of a mesh, and hides others by an instance under
/// the same transform if at all.
pub(crate) fn transform_of_instances(bounds: &Bounds, occluder: Option<&Occluder>) -> Option<Affine3A> {
    let Bounds::Instance(own) = bounds else { return None };
    let alike = match occluder {
        Some(Occluder::Instance(other)) => other.transform() == own.transform(),
        Some(_) => false,
        None => true,
    };
    alike.then(|| own.transform())
}

/// The shapes of an object as [`transform_of_instances`] asks for, under another transform; `None`
/// for others.
///
/// # Errors
/// As [`Instance::new`].
pub(crate) fn instances_at(
    bounds: &Bounds,
    occluder: Option<&Occluder>,
    transform: Affine3A,
) -> Result<Option<(Bounds, Option<Occluder>)>, Error> {
    let again = |i: &Instance| Instance::new(i.mesh().clone(), transform);
    match (transform_of_instances(bounds, occluder), bounds, occluder) {
        (Some(_), Bounds::Instance(b), Some(Occluder::Instance(o))) => {
            Ok(Some((again(b)?.into(), Some(again(o)?.into()))))
        }
        (Some(_), Bounds::Instance(b), _) => Ok(Some((again(b)?.into(), None))),
        _ => Ok(None),
    }
}

/// A box of any orientation under a transform: a parallelepiped.
struct Cuboid {
    center: DVec3,
    /// The directions of its edges, scaled; columns.
    edges: DMat3,
    /// Half the lengths of the edges before the transform.
    half: DVec3,
}

impl Cuboid {
    fn new(center: DVec3, turn: DMat3, half: DVec3, placement: &Placement) -> Self {
        let affine = &placement.affine;
        Self { center: affine.transform_point3(center), edges: affine.matrix3 * turn, half }
    }

    fn of_box(b: &Aabb, placement: &Placement) -> Self {
        let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
        Self::new((min + max) * 0.5, DMat3::IDENTITY, (max - min) * 0.5, placement)
    }

    fn of_turned(b: &Obb, placement: &Placement) -> Self {
        Self::new(b.center.as_dvec3(), b.turn(), b.half.as_dvec3(), placement)
    }

    /// Bounds around it.
    fn bounds(&self, room: f64) -> Bounds {
        match self.rotation() {
            Some(rotation) => self.outer(rotation, room).into(),
            None => {
                let radius: DVec3 = self.axes().iter().map(|axis| axis.abs()).sum();
                let (min, max) = (self.center - radius - room, self.center + radius + room);
                Block { min, max }.to_aabb().into()
            }
        }
    }

    /// An occluder inside of it: a convex solid where its edges are askew.
    fn occluder(&self, room: f64) -> Option<Occluder> {
        match self.rotation() {
            Some(rotation) => self.inner(rotation, room).map(Into::into),
            None => Some(Arc::new(Convex::inside_hull(&self.corners(), room)?).into()),
        }
    }

    /// A rotation whose axes run along the edges, if these are at right angles.
    fn rotation(&self) -> Option<Quat> {
        let [x, y, z] =
            [self.edges.x_axis, self.edges.y_axis, self.edges.z_axis].map(DVec3::normalize_or_zero);
        let right = |a: DVec3, b: DVec3| a.dot(b).abs() <= ANGLES;
        let turn = DMat3::from_cols(x, y, x.cross(y));
        // Boxes are symmetrical: a mirrored one is a turned one.
        let turned = right(x, y) && right(y, z) && right(z, x) && turn.determinant() > 0.5;
        turned.then(|| DQuat::from_mat3(&turn).as_quat())
    }

    /// The half-axes.
    fn axes(&self) -> [DVec3; 3] {
        [0, 1, 2].map(|i| self.edges.col(i) * self.half[i])
    }

    fn corners(&self) -> [DVec3; 8] {
        let [x, y, z] = self.axes();
        std::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            self.center + x * sign(0) + y * sign(1) + z * sign(2)
        })
    }

    /// A box with this rotation around it, and by `room` farther.
    fn outer(&self, rotation: Quat, room: f64) -> Obb {
        let mut outer = Obb::new(self.center.as_vec3(), Vec3::ZERO, rotation);
        let (turn, off) = (outer.turn(), self.center - outer.center.as_dvec3());
        for i in 0..3 {
            let way = turn.col(i);
            let radius: f64 = self.axes().iter().map(|axis| way.dot(*axis).abs()).sum();
            outer.half[i] = above(radius + way.dot(off).abs() + room);
        }
        outer
    }

    /// A box with this rotation inside of it that keeps `room` to its faces; `None` if nothing is
    /// left.
    fn inner(&self, rotation: Quat, room: f64) -> Option<Obb> {
        let mut inner = Obb::new(self.center.as_vec3(), Vec3::ZERO, rotation);
        let (turn, off) = (inner.turn(), inner.center.as_dvec3() - self.center);
        let lengths = DVec3::from_array(self.axes().map(DVec3::length));
        let across = self.edges.inverse();
        for face in 0..3 {
            // Where the face is at distance 1, per unit of length.
            let normal = across.row(face) / self.half[face];
            let share = |axis: usize| normal.dot(turn.col(axis)).abs() * lengths[axis];
            let others: f64 = (0..3).filter(|&axis| axis != face).map(share).sum();
            let rest = 1.0 - normal.dot(off).abs() - room * normal.length() - others;
            let kept = rest / share(face);
            // Not a number for a flat box.
            if kept.is_nan() || kept <= 0.0 {
                return None;
            }
            inner.half[face] = below(lengths[face] * kept.min(1.0));
        }
        (inner.half.min_element() > 0.0).then_some(inner)
    }
}

/// The scale of a transform that scales all axes alike.
fn scale_of_sphere(what: &'static str, placement: &Placement) -> Result<f64, Error> {
    let m = &placement.affine.matrix3;
    if scales_alike(m) { Ok(m.x_axis.length()) } else { Err(Error::SphereScale { what }) }
}

/// The middle of a sphere under a transform, and how far its rounding to single precision moves it
/// at most.
fn middle_of_sphere(sphere: &Sphere, placement: &Placement) -> (Vec3, f64) {
    let exact = placement.affine.transform_point3(sphere.center.as_dvec3());
    let center = exact.as_vec3();
    (center, (center.as_dvec3() - exact).abs().element_sum())
}

/// The transform of a shape, with the numbers that follow from it.
fn placement(what: &'static str, shape: &dyn Kind, transform: Affine3A) -> Result<Placement, Error> {
    let block = shape.block();
    Placement::new(what, transform, block.min.abs().max(block.max.abs()).max_element(), &Offset::NONE)
}

impl Bounds {
    /// The bounds under a transform, rounded outwards.
    ///
    /// # Errors
    /// Refuses transforms that are not finite or lead to coordinates that are not, instances, and
    /// spheres that would not stay spheres.
    pub(crate) fn placed(&self, transform: Affine3A) -> Result<Self, Error> {
        const WHAT: &str = "the bounds as placed";
        let p = placement(WHAT, self.kind(), transform)?;
        let room = LENGTH_OF_ERROR * p.error;
        match self {
            Self::Sphere(sphere) => {
                let scale = scale_of_sphere(WHAT, &p)? * (1.0 + ALIKE);
                let (center, off) = middle_of_sphere(sphere, &p);
                Ok(Sphere::new(center, above(f64::from(sphere.radius) * scale + off + room)).into())
            }
            Self::Box(b) => Ok(Cuboid::of_box(b, &p).bounds(room)),
            Self::Oriented(b) => Ok(Cuboid::of_turned(b, &p).bounds(room)),
            Self::Mesh(mesh) => Instance::new(mesh.clone(), transform).map(Into::into),
            Self::Instance(_) => Err(Error::PlacedTwice { what: WHAT }),
        }
    }
}

impl Occluder {
    /// The occluder under a transform, rounded inwards; `None` if hardly anything of it is left.
    ///
    /// # Errors
    /// As [`Bounds::placed`].
    pub(crate) fn placed(&self, transform: Affine3A) -> Result<Option<Self>, Error> {
        const WHAT: &str = "the occluder as placed";
        let p = placement(WHAT, self.kind(), transform)?;
        let room = LENGTH_OF_ERROR * p.error;
        // A flat solid hides nothing. Triangles need no inside.
        let flat = p.normals.is_none();
        match self {
            Self::Sphere(sphere) => {
                let scale = scale_of_sphere(WHAT, &p)? * (1.0 - ALIKE);
                let (center, off) = middle_of_sphere(sphere, &p);
                let radius = f64::from(sphere.radius) * scale - off - room;
                Ok((radius > 0.0).then(|| Sphere::new(center, below(radius)).into()))
            }
            Self::Mesh(mesh) => Instance::new(mesh.clone(), transform).map(|i| Some(i.into())),
            Self::Instance(_) => Err(Error::PlacedTwice { what: WHAT }),
            _ if flat => Ok(None),
            Self::Box(b) => Ok(Cuboid::of_box(b, &p).occluder(room)),
            Self::Oriented(b) => Ok(Cuboid::of_turned(b, &p).occluder(room)),
            Self::Convex(solid) => Ok(solid.placed(&p).map(|solid| Arc::new(solid).into())),
        }
    }
}
