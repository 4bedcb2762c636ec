//! Numbers from and to numpy arrays.

use casca::glam::{Affine3A, Mat3A, Mat4, Vec3, Vec3A};
use casca::{Aabb, ObjectId, Sphere};
use numpy::ndarray::{ArrayView1, ArrayView2, ArrayView3, s};
use numpy::ndarray::{Dimension, Ix1, Ix2, Ix3};
use numpy::{
    AllowTypeChange, Element, PyArray1, PyArrayLike, PyArrayMethods, PyReadonlyArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::error::refused;

/// An array, or what numpy makes one of. An array of the same type is not copied, unless its numbers
/// do not lie at addresses of their size: those that came over a network often do not.
pub struct Array<'py, T: Element, D: Dimension>(PyArrayLike<'py, T, D, AllowTypeChange>);

impl<'a, 'py, T, D> FromPyObject<'a, 'py> for Array<'py, T, D>
where
    T: Element + 'py,
    D: Dimension + 'py,
    Vec<T>: FromPyObject<'a, 'py>,
    PyArrayLike<'py, T, D, AllowTypeChange>: for<'b> FromPyObject<'b, 'py, Error = PyErr>,
{
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let array: PyArrayLike<'py, T, D, AllowTypeChange> = object.extract()?;
        let at = array.data() as usize;
        let off = |place: usize| !place.is_multiple_of(align_of::<T>());
        if off(at) || array.strides().iter().any(|stride| off(stride.unsigned_abs())) {
            return Ok(Self(array.call_method0("copy")?.extract()?));
        }
        Ok(Self(array))
    }
}

impl<'py, T: Element, D: Dimension> std::ops::Deref for Array<'py, T, D> {
    type Target = PyReadonlyArray<'py, T, D>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

/// Arrays of floats.
pub type Floats1<'py> = Array<'py, f32, Ix1>;
/// A vector of doubles, for places in large worlds.
pub type Doubles<'py> = Array<'py, f64, Ix1>;
pub type Floats2<'py> = Array<'py, f32, Ix2>;
pub type Floats3<'py> = Array<'py, f32, Ix3>;

/// Ids as they come from a scene.
pub type Ids<'py> = Array<'py, u64, Ix1>;

fn vec3_of(row: ArrayView1<f32>) -> Vec3 {
    Vec3::new(row[0], row[1], row[2])
}

/// A vector of three numbers.
pub fn vec3(name: &str, array: &Floats1) -> PyResult<Vec3> {
    let array = array.as_array();
    check(array.len() == 3, || format!("{name} must have 3 numbers, not {}", array.len()))?;
    Ok(vec3_of(array))
}

/// The same in double precision.
pub fn dvec3(name: &str, array: &Doubles) -> PyResult<[f64; 3]> {
    let numbers: Vec<f64> = array.as_array().iter().copied().collect();
    let count = numbers.len();
    numbers
        .try_into()
        .or_else(|_| check(false, || format!("{name} must have 3 numbers, not {count}")).map(|()| [0.0; 3]))
}

/// A matrix that takes columns: entry `[i, j]` stands in row i and column j.
pub fn mat4(name: &str, array: &Floats2) -> PyResult<Mat4> {
    let array = array.as_array();
    check(array.dim() == (4, 4), || format!("{name} must be of shape (4, 4), not {:?}", array.dim()))?;
    Ok(mat4_of(array))
}

fn mat4_of(array: ArrayView2<f32>) -> Mat4 {
    let mut columns = [0.0; 16];
    for ((i, j), value) in array.indexed_iter() {
        columns[4 * j + i] = *value;
    }
    Mat4::from_cols_array(&columns)
}

/// Transforms of shape (n, 4, 4). The last row of each must be 0, 0, 0, 1.
pub fn affines(array: ArrayView3<f32>) -> PyResult<Vec<Affine3A>> {
    let (count, rows, columns) = array.dim();
    check((rows, columns) == (4, 4), || {
        format!("transforms must be of shape (n, 4, 4), not {:?}", array.dim())
    })?;
    (0..count)
        .map(|i| {
            let m = mat4_of(array.slice(s![i, .., ..]));
            let last = m.row(3).to_array();
            check(last == [0.0, 0.0, 0.0, 1.0], || {
                format!("transform {i}: its last row must be 0, 0, 0, 1, not {last:?}")
            })?;
            let [x, y, z, at] = [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(Vec3A::from_vec4);
            Ok(Affine3A { matrix3: Mat3A::from_cols(x, y, z), translation: at })
        })
        .collect()
}

/// Boxes of shape (n, 2, 3): the least and the greatest corner of each.
pub fn boxes(array: ArrayView3<f32>) -> PyResult<Vec<Aabb>> {
    let (count, corners, axes) = array.dim();
    check((corners, axes) == (2, 3), || format!("boxes must be of shape (n, 2, 3), not {:?}", array.dim()))?;
    let corner = |i, k| vec3_of(array.slice(s![i, k, ..]));
    Ok((0..count).map(|i| Aabb::new(corner(i, 0), corner(i, 1))).collect())
}

/// Spheres of shape (n, 4): the center and the radius of each.
pub fn spheres(array: ArrayView2<f32>) -> PyResult<Vec<Sphere>> {
    check(array.ncols() == 4, || format!("spheres must be of shape (n, 4), not {:?}", array.dim()))?;
    Ok(array.rows().into_iter().map(|row| Sphere::new(vec3_of(row), row[3])).collect())
}

/// Points of shape (n, 3).
pub fn points(name: &str, array: ArrayView2<f32>) -> PyResult<Vec<Vec3>> {
    check(array.ncols() == 3, || format!("{name} must be of shape (n, 3), not {:?}", array.dim()))?;
    Ok(array.rows().into_iter().map(vec3_of).collect())
}

/// Triangles of shape (n, 3): indices of points.
pub fn triangles(array: ArrayView2<u32>) -> PyResult<Vec<[u32; 3]>> {
    check(array.ncols() == 3, || format!("triangles must be of shape (n, 3), not {:?}", array.dim()))?;
    Ok(array.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// The objects of a scene with these ids.
pub fn ids(scene: &casca::Scene, array: &Ids) -> PyResult<Vec<ObjectId>> {
    let id = |key: &u64| scene.id_from_key(*key).map_err(refused);
    array.as_array().iter().map(id).collect()
}

/// The ids of objects, as an array.
pub fn keys<'py>(
    py: Python<'py>,
    scene: &casca::Scene,
    ids: impl Iterator<Item = ObjectId>,
) -> PyResult<Bound<'py, PyArray1<u64>>> {
    let keys: Vec<u64> = ids.map(|id| scene.key(id)).collect::<Result<_, _>>().map_err(refused)?;
    Ok(PyArray1::from_vec(py, keys))
}

/// Refuses a call unless something holds.
pub fn check(holds: bool, why: impl FnOnce() -> String) -> PyResult<()> {
    if holds { Ok(()) } else { Err(refused(why())) }
}

/// Refuses lists of two lengths.
pub fn same_length(ids: usize, others: usize) -> PyResult<()> {
    check(ids == others, || format!("{ids} ids do not fit {others} shapes"))
}
