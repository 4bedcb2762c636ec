//! Numbers from and to numpy arrays, as shapes.

use casca::glam::{Affine3A, Mat3A, Mat4, Vec3, Vec3A};
use casca::{Aabb, ObjectId, Sphere};
use casca_plane::Segment;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::error::{check, refused};
use crate::forms::{Float, Form, Given, Rule, entries, integers, one};

/// Ids of objects, as an array.
pub type Keys<'py> = PyResult<Bound<'py, PyArray1<u64>>>;

/// A flag for each of some things, as an array.
pub type Flags<'py> = PyResult<Bound<'py, PyArray1<bool>>>;

/// A place or a direction, of floats of one of two sizes.
pub fn place<T: Float, P: From<[T; 3]>>(name: &'static str, object: Given) -> PyResult<P> {
    one(&Form::new(name, &[3], "x, y and z"), object).map(P::from)
}

/// A place or a direction in the plane.
pub fn place2<P: From<[f32; 2]>>(name: &'static str, object: Given) -> PyResult<P> {
    one(&Form::new(name, &[2], "x and y"), object).map(P::from)
}

/// A box.
pub fn span<T: Float>(name: &'static str, object: Given) -> PyResult<[[T; 3]; 2]> {
    let form = Form::new(name, &[2, 3], "the lower and the upper corner of a box");
    one::<T, 6>(&form, object).map(|[a, b, c, d, e, f]| [[a, b, c], [d, e, f]])
}

/// A matrix that takes columns: entry `[i, j]` stands in row i and column j.
pub fn mat4(name: &'static str, object: Given) -> PyResult<Mat4> {
    let form = Form::new(name, &[4, 4], "a matrix that takes columns");
    one(&form, object).map(|rows| Mat4::from_cols_array(&rows).transpose())
}

/// Transforms. The last row of each must be 0, 0, 0, 1.
pub fn affines(object: Given) -> PyResult<Vec<Affine3A>> {
    let form = Form::new("transforms", &[0, 4, 4], "n matrices from mesh to world space");
    let matrices = entries(&form, object, Rule::Finite, |rows| Mat4::from_cols_array(rows).transpose())?;
    let affine = |(i, m): (usize, Mat4)| {
        let last = m.row(3).to_array();
        check(last == [0.0, 0.0, 0.0, 1.0], || {
            format!("transforms[{i}]: its last row must be 0, 0, 0, 1, not {last:?}")
        })?;
        let [x, y, z, at] = [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(Vec3A::from_vec4);
        Ok(Affine3A { matrix3: Mat3A::from_cols(x, y, z), translation: at })
    };
    matrices.into_iter().enumerate().map(affine).collect()
}

/// Boxes: the lower and the upper corner of each.
pub fn boxes(object: Given, rule: Rule) -> PyResult<Vec<Aabb>> {
    let form = Form::new("boxes", &[0, 2, 3], "n boxes, each a lower and an upper corner");
    let one = |&[a, b, c, d, e, f]: &[f32; 6]| Aabb::new(Vec3::new(a, b, c), Vec3::new(d, e, f));
    entries(&form, object, rule, one)
}

/// Spheres: the center and the radius of each.
pub fn spheres(object: Given) -> PyResult<Vec<Sphere>> {
    let form = Form::new("spheres", &[0, 4], "n spheres, each x, y, z and a radius");
    let one = |&[x, y, z, radius]: &[f32; 4]| Sphere::new(Vec3::new(x, y, z), radius);
    entries(&form, object, Rule::Finite, one)
}

/// Points.
pub fn points<T: Float, P: From<[T; 3]>>(name: &'static str, object: Given, rule: Rule) -> PyResult<Vec<P>> {
    entries(&Form::new(name, &[0, 3], "n points, each x, y and z"), object, rule, |&point| point.into())
}

/// Walls in the plane.
pub fn walls(object: Given) -> PyResult<Vec<Segment>> {
    let form = Form::new("walls", &[0, 2, 2], "n walls, each two ends of x and y");
    let wall = |&[a, b, c, d]: &[f32; 4]| Segment::new([a, b].into(), [c, d].into());
    entries(&form, object, Rule::Finite, wall)
}

/// Triangles: indices of points.
pub fn triangles(object: Given) -> PyResult<Vec<[u32; 3]>> {
    let form = Form::new("triangles", &[0, 3], "n triangles, each three indices of positions");
    let corners = integers(&form, object, u32::MAX.into())?;
    Ok(corners.as_chunks().0.iter().map(|triangle| triangle.map(|corner| corner as u32)).collect())
}

/// Cells of a bake.
pub fn cells(object: Given) -> PyResult<Vec<u32>> {
    let form = Form::new("cells", &[0], "n numbers of cells");
    Ok(integers(&form, object, u32::MAX.into())?.into_iter().map(|cell| cell as u32).collect())
}

/// The objects of a scene with these ids.
pub fn ids(scene: &casca::Scene, object: Given) -> PyResult<Vec<ObjectId>> {
    let form = Form::new("ids", &[0], "n ids of objects");
    let keys = integers(&form, object, u64::MAX)?;
    let id = |(i, key): (usize, u64)| {
        let none = |_| {
            refused(format!(
                "ids[{i}] is {key}, which names no object of this scene: it was removed, or is of another"
            ))
        };
        scene.id_from_key(key).map_err(none)
    };
    keys.into_iter().enumerate().map(id).collect()
}

/// The ids of some objects.
pub fn keys<'py>(py: Python<'py>, scene: &casca::Scene, ids: impl Iterator<Item = ObjectId>) -> Keys<'py> {
    let keys: Vec<u64> = ids.map(|id| scene.key(id)).collect::<Result<_, _>>().map_err(refused)?;
    Ok(PyArray1::from_vec(py, keys))
}
