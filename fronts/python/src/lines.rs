//! Dense sets of lines: their ambient occlusion, and which of them can be seen.

use casca_lines::LineSet;
use casca_lines::buffers::{Fragment, nearest_lines};
use casca_lines::cells::Cells;
use casca_lines::glam::Vec3;
use casca_lines::occlusion::{AoOptions, Occlusion};
use casca_lines::samples::{MOST_POINTS, SampleSets};
use casca_lines::view::{Lens, View};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rayon::prelude::*;

use crate::arrays::{place, points};
use crate::error::{check, refused};
use crate::forms::{Form, Given, Rule, height, integers, rays, width};

/// The radii of hemispheres and tubes, the rays, and whether tubes are solid.
type How<R> = (f32, Option<f32>, R, bool);

/// The same, with rays that are so many.
fn checked((radius, tube, rays, solid): How<Bound<PyAny>>) -> PyResult<How<u32>> {
    Ok((radius, tube, self::rays(&rays)?, solid))
}

/// The lines between offsets.
fn set(points: Given, offsets: Given) -> PyResult<LineSet> {
    let points: Vec<Vec3> = self::points("points", points, Rule::Finite)?;
    let form = Form::new("offsets", &[0], "where each line starts in points, and where the last one ends");
    let offsets = integers(&form, offsets, points.len() as u64)?;
    let falls = offsets.windows(2).position(|pair| pair[0] > pair[1]);
    let ends = [offsets.first(), offsets.last()].map(|end| end.map(|end| *end as usize));
    check(falls.is_none() && ends == [Some(0), Some(points.len())], || match falls {
        Some(i) => format!("offsets must not fall: {} is before {}", offsets[i], offsets[i + 1]),
        None => format!("offsets must begin with 0 and end with {}, as many as points", points.len()),
    })?;
    let lines = offsets.windows(2).map(|w| points[w[0] as usize..w[1] as usize].iter().copied());
    LineSet::new(lines).map_err(refused)
}

/// The occlusion at fragments of a view; tubes are of a radius unless one is given.
fn occlusion(
    (lines, view): (&LineSet, &View),
    fragments: &[Option<Fragment>],
    tube: f32,
    (radius, given, rays, solid): How<u32>,
) -> PyResult<Vec<f32>> {
    let options = AoOptions { solid, ..AoOptions::rays(radius, given.unwrap_or(tube)) };
    let sets = (MOST_POINTS / rays.max(1)).clamp(1, 16);
    let samples = SampleSets::spirals(rays, sets).map_err(refused)?;
    let cells = Cells::new(lines, options.margin());
    let rays = Occlusion::by_rays(&cells, view, &samples, options).map_err(refused)?;
    Ok(fragments.par_iter().map(|f| f.as_ref().map_or(0.0, |f| rays.at(f))).collect())
}

/// The line that each pixel shows, and its occlusion if that is asked for, row by row.
#[pyfunction]
pub fn line_picture<'py>(
    py: Python<'py>,
    points: Given<'_, 'py>,
    offsets: Given<'_, 'py>,
    look: [Bound<'py, PyAny>; 3],
    lens: (f64, [f64; 2], [Bound<'py, PyAny>; 2]),
    how: Option<How<Bound<'py, PyAny>>>,
) -> PyResult<Bound<'py, PyTuple>> {
    let (lines, (fov_y, depths, size)) = (set(points, offsets)?, lens);
    let (size, how) = ([width(&size[0])?, height(&size[1])?], how.map(checked).transpose()?);
    let look: [Vec3; 3] = [place("eye", &look[0])?, place("target", &look[1])?, place("up", &look[2])?];
    let (shown, values) = py.detach(|| {
        let lens = Lens::Perspective { fov_y: fov_y.to_radians() };
        let view = View::look_at(look, lens, depths, size).map_err(refused)?;
        let nearest = nearest_lines(&lines, &view);
        let half = view.pixel_size((depths[0] + depths[1]) / 2.0) as f32 / 2.0;
        let values = how.map_or(Ok(Vec::new()), |how| occlusion((&lines, &view), &nearest, half, how))?;
        let line = |f: &Option<Fragment>| f.map_or(-1, |f| i64::from(f.line));
        PyResult::Ok((nearest.iter().map(line).collect::<Vec<i64>>(), values))
    })?;
    (shown.into_pyarray(py), values.into_pyarray(py)).into_pyobject(py)
}

/// The occlusion at each point of lines that are seen from a direction.
#[pyfunction]
pub fn line_occlusion<'py>(
    py: Python<'py>,
    points: Given<'_, 'py>,
    offsets: Given<'_, 'py>,
    direction: Given<'_, 'py>,
    how: How<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let how = checked(how)?;
    let lines = set(points, offsets)?;
    let way: Vec3 = place("direction", direction)?;
    let values = py.detach(|| {
        let view = View::around(lines.bounds(), way, None, [1, 1]).map_err(refused)?;
        let turn = view.eye_from_world().matrix3;
        let numbers = (0..).zip(lines.iter()).flat_map(|(line, all)| std::iter::repeat_n(line, all.len()));
        let of_points = lines.points().iter().zip(lines.tangents()).zip(lines.arc_lengths()).zip(numbers);
        let fragment = |(((point, tangent), along), line): (((&Vec3, Vec3), f32), u32)| {
            let (position, tangent) = (view.to_eye(*point).as_vec3(), (turn * tangent.as_dvec3()).as_vec3());
            Some(Fragment { position, tangent, line, along })
        };
        let fragments: Vec<_> = of_points.map(fragment).collect();
        occlusion((&lines, &view), &fragments, 0.0, how)
    });
    Ok(values?.into_pyarray(py))
}
