//! Transforms of shapes, with the bounds and normals that follow from them.

use glam::{Affine3A, DAffine3, DMat3, DVec3, Mat3, Vec3};

use crate::error::Error;
use crate::geometry::offset::Offset;
use crate::numeric::mesh::{ANGLES, FLATTENS, SINGLE};
use crate::numeric::place::ONE_ROUNDING;

/// A transform, with the numbers that follow from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub(crate) affine: DAffine3,
    /// The greatest factor by which lengths grow is no larger.
    pub(crate) growth: f64,
    /// Points may lie this far from where the transform puts them, along each axis.
    pub(crate) error: f64,
    /// Turns normals; `None` if the transform flattens space.
    pub(crate) normals: Option<DMat3>,
    /// Whether it turns, moves and scales all axes alike, and mirrors nothing.
    pub(crate) keeps_angles: bool,
    /// Whether it mirrors space, or flattens it.
    pub(crate) mirrors: bool,
}

impl Placement {
    /// A transform of a shape whose coordinates are no greater than `largest`, and the offset that
    /// follows.
    ///
    /// # Errors
    /// Refuses transforms that are not finite, or may lead to coordinates that are not in single
    /// precision; `what` names the transformed shape.
    pub(crate) fn new(
        what: &'static str,
        transform: Affine3A,
        largest: f64,
        offset: &Offset,
    ) -> Result<Self, Error> {
        let affine = DAffine3::from_mat3_translation(
            Mat3::from(transform.matrix3).as_dmat3(),
            Vec3::from(transform.translation).as_dvec3() + offset.by,
        );
        if !affine.is_finite() {
            return Err(Error::NotFinite { what, value: affine.translation });
        }
        let m = affine.matrix3;
        let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
        let growth = (x.length_squared() + y.length_squared() + z.length_squared()).sqrt();
        let bound = growth * largest + affine.translation.abs().max_element();
        if bound.is_nan() || bound > f64::from(f32::MAX) {
            return Err(Error::NotFinite { what, value: DVec3::splat(bound) });
        }
        // The cofactors are the inverse transpose times the determinant, and need no division.
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let turned = m.determinant();
        let normals = (turned.abs() > FLATTENS * growth.powi(3)).then(|| cofactors * turned.signum());
        let mirrors = turned.is_nan() || turned <= 0.0;
        let keeps_angles = !mirrors && scales_alike(&m);
        // An offset may be rounded, and so is its sum with the translation, once.
        let error = SINGLE * bound + offset.error + ONE_ROUNDING * offset.by.abs().max_element();
        Ok(Self { affine, growth, error, normals, keeps_angles, mirrors })
    }
}

/// Whether a matrix keeps all angles, mirrored or not, but for [`ANGLES`].
pub(crate) fn scales_alike(m: &DMat3) -> bool {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let square = x.length_squared();
    let alike = |v: DVec3| (v.length_squared() - square).abs() <= ANGLES * square;
    let right = |a: DVec3, b: DVec3| a.dot(b).abs() <= ANGLES * square;
    alike(y) && alike(z) && right(x, y) && right(y, z) && right(z, x)
}
