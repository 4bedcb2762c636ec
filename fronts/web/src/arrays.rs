//! Arrays of JavaScript as shapes, and ids as bigints.

use std::fmt::Display;

use casca::glam::{Affine3A, Mat4, Vec3};
use casca::{Aabb, Sphere};
use wasm_bindgen::prelude::*;

/// The error for something that cannot be used.
pub fn refused(why: impl Display) -> JsError {
    JsError::new(&why.to_string())
}

/// The same for one of several things.
pub fn refused_at(index: usize, why: impl Display) -> JsError {
    JsError::new(&format!("{index}: {why}"))
}

/// A point or direction.
pub fn vec3(name: &str, numbers: &[f32]) -> Result<Vec3, JsError> {
    let three = <[f32; 3]>::try_from(numbers);
    three.map(Vec3::from_array).map_err(|_| refused(format!("{name} has {} numbers, not 3", numbers.len())))
}

/// A matrix of 16 numbers, column by column.
pub fn mat4(name: &str, numbers: &[f32]) -> Result<Mat4, JsError> {
    let all = <[f32; 16]>::try_from(numbers);
    all.map(|all| Mat4::from_cols_array(&all))
        .map_err(|_| refused(format!("{name} has {} numbers, not 16", numbers.len())))
}

/// Groups of so many numbers.
pub fn groups<'a, T, const N: usize>(name: &str, numbers: &'a [T]) -> Result<&'a [[T; N]], JsError> {
    match numbers.as_chunks() {
        (groups, []) => Ok(groups),
        _ => Err(refused(format!("{name} have {N} numbers each, not {} in all", numbers.len()))),
    }
}

/// Boxes: the least corner and the greatest of each.
pub fn boxes(numbers: &[f32]) -> Result<Vec<Aabb>, JsError> {
    let one = |&[a, b, c, d, e, f]: &[f32; 6]| Aabb::new(Vec3::new(a, b, c), Vec3::new(d, e, f));
    Ok(groups::<_, 6>("boxes", numbers)?.iter().map(one).collect())
}

/// Spheres: the centre and the radius of each.
pub fn spheres(numbers: &[f32]) -> Result<Vec<Sphere>, JsError> {
    let one = |&[x, y, z, radius]: &[f32; 4]| Sphere::new(Vec3::new(x, y, z), radius);
    Ok(groups::<_, 4>("spheres", numbers)?.iter().map(one).collect())
}

/// Points.
pub fn points(name: &str, numbers: &[f32]) -> Result<Vec<Vec3>, JsError> {
    Ok(groups::<_, 3>(name, numbers)?.iter().copied().map(Vec3::from_array).collect())
}

/// Affine transforms: matrices of 16 numbers, column by column, whose last row is 0, 0, 0, 1.
pub fn affines(numbers: &[f32]) -> Result<Vec<Affine3A>, JsError> {
    let all = groups::<_, 16>("transforms", numbers)?;
    let one = |(index, all): (usize, &[f32; 16])| {
        let matrix = Mat4::from_cols_array(all);
        match matrix.row(3).to_array() {
            [0.0, 0.0, 0.0, 1.0] => Ok(Affine3A::from_mat4(matrix)),
            row => Err(refused_at(index, format!("the last row of a transform is 0, 0, 0, 1, not {row:?}"))),
        }
    };
    all.iter().enumerate().map(one).collect()
}

/// Two lists belong together.
pub fn same_length(ids: usize, others: usize) -> Result<(), JsError> {
    if ids == others { Ok(()) } else { Err(refused(format!("{ids} ids, but {others} shapes"))) }
}
