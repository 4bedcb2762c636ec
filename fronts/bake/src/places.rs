//! The cells of a level, and those in which someone may stand.

use casca::Aabb;
use casca::glam::{DVec3, Vec3};
use casca_baked::Cells;
use casca_scenes::world::{BOX_TRIANGLES, Object, Shape, box_corners};

use crate::error::BakeError;
use crate::level::Level;

/// A surface carries someone if the cosine of its slope is more than this: 60 degrees.
const STEEPEST: f32 = 0.5;

/// Cells are this many at most: a file has four bytes for each.
const MOST_CELLS: f64 = (1u64 << 28) as f64;

/// Which cells are baked.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// The edge of a cell along x and z, in metres.
    pub edge: f32,
    /// The least and the greatest height of an eye over the floor, in metres: cells are as high as
    /// that, and only those are baked in which an eye may be so. `None` bakes all cells of the
    /// level's box, which are as high as they are wide.
    pub height: Option<(f32, f32)>,
    /// Of these, only the cells are baked whose middle lies in this box, in the coordinates of the
    /// file. `None` bakes all.
    pub within: Option<Aabb>,
}

impl Places {
    /// The grid of cells of a level, in the coordinates of the level: see [`Level::in_file`].
    ///
    /// # Errors
    /// [`BakeError::Places`].
    pub fn cells(&self, level: &Level) -> Result<Cells, BakeError> {
        let room = level.room();
        let (from, tall) = match self.height {
            Some((least, most)) => (room.min.y + least, most - least),
            None => (room.min.y, self.edge),
        };
        let size = [self.edge, tall, self.edge].map(f64::from);
        let low = DVec3::new(room.min.x.into(), from.into(), room.min.z.into());
        // As a double can tell it in the coordinates of the file.
        let low = ((low + level.origin) - level.origin).to_array();
        let high =
            [room.max.x, room.max.y + self.height.map_or(0.0, |(_, most)| most), room.max.z].map(f64::from);
        let dims: [f64; 3] = std::array::from_fn(|i| ((high[i] - low[i]) / size[i]).ceil().max(1.0));
        let sane = size.iter().all(|s| s.is_finite() && *s > 0.0) && low.iter().all(|l| l.is_finite());
        // Also not if it is not a number.
        if !(sane && dims.iter().product::<f64>() <= MOST_CELLS) {
            return Err(BakeError::Places);
        }
        Ok(Cells { low, size, dims: dims.map(|n| n as u32), origin: [0.0; 3] })
    }

    /// The numbers of the cells to bake, ascending.
    ///
    /// # Errors
    /// [`BakeError::Places`].
    pub fn numbers(&self, level: &Level) -> Result<Vec<u32>, BakeError> {
        let cells = self.cells(level)?;
        let count = cells.dims.iter().product::<u32>();
        let middle = |cell: u32| {
            let [x, y, _] = cells.dims;
            let at = [cell % x, cell / x % y, cell / x / y].map(|i| f64::from(i) + 0.5);
            DVec3::from_array(std::array::from_fn(|i| cells.low[i] + at[i] * cells.size[i])) + level.origin
        };
        let is_within = |cell: &u32| {
            self.within.is_none_or(|b| {
                let middle = middle(*cell);
                b.min.as_dvec3().cmple(middle).all() && middle.cmple(b.max.as_dvec3()).all()
            })
        };
        let Some((least, most)) = self.height else { return Ok((0..count).filter(is_within).collect()) };
        let mut stands = vec![false; count as usize];
        for object in level.objects() {
            for triangle in floors(object) {
                mark(&cells, &triangle, (least, most), &mut stands);
            }
        }
        Ok((0..count).filter(|&i| stands[i as usize]).filter(is_within).collect())
    }
}

/// The triangles of an object that face up or, seen from both sides, down.
fn floors(object: &Object) -> Vec<[Vec3; 3]> {
    let all: Vec<[Vec3; 3]> = match &object.shape {
        Shape::Sphere { .. } => Vec::new(),
        Shape::Box { min, max } => {
            let corners = box_corners(*min, *max);
            BOX_TRIANGLES.iter().map(|t| t.map(|v| corners[v as usize])).collect()
        }
        Shape::Mesh { mesh, transform } => {
            let corner = |v: u32| mesh.positions.get(v as usize).map(|&p| transform.transform_point3(p));
            let triangle = |t: &[u32; 3]| Some([corner(t[0])?, corner(t[1])?, corner(t[2])?]);
            mesh.triangles.iter().filter_map(triangle).collect()
        }
    };
    let is_floor = |[a, b, c]: &[Vec3; 3]| {
        let normal = (*b - *a).cross(*c - *a);
        normal.y.abs() > STEEPEST * normal.length()
    };
    all.into_iter().filter(is_floor).collect()
}

/// Marks the cells that hold an eye over a triangle.
fn mark(cells: &Cells, triangle: &[Vec3; 3], (least, most): (f32, f32), stands: &mut [bool]) {
    let [nx, ny, nz] = cells.dims.map(i64::from);
    let index = |axis: usize, at: f32| ((f64::from(at) - cells.low[axis]) / cells.size[axis]).floor();
    let range = |axis: usize, low: f32, high: f32, n: i64| {
        let (a, b) = (index(axis, low).max(0.0), index(axis, high).min((n - 1) as f64));
        if a <= b { a as i64..b as i64 + 1 } else { 0..0 }
    };
    let bounds = |axis: usize, points: &[Vec3]| {
        let along = points.iter().map(|p| p[axis]);
        along.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)))
    };
    let border = |axis: usize, i: i64| (cells.low[axis] + i as f64 * cells.size[axis]) as f32;
    let (z0, z1) = bounds(2, triangle);
    for z in range(2, z0, z1, nz) {
        let strip = between(between(triangle.to_vec(), 2, border(2, z), 1.0), 2, border(2, z + 1), -1.0);
        let (x0, x1) = bounds(0, &strip);
        for x in range(0, x0, x1, nx) {
            let piece = between(between(strip.clone(), 0, border(0, x), 1.0), 0, border(0, x + 1), -1.0);
            let (y0, y1) = bounds(1, &piece);
            for y in range(1, y0 + least, y1 + most, ny) {
                // A cell that the eyes only touch from below is left out.
                if f64::from(y1 + most) > cells.low[1] + y as f64 * cells.size[1] {
                    stands[((z * ny + y) * nx + x) as usize] = true;
                }
            }
        }
    }
}

/// The part of a polygon on one side of a plane across an axis.
fn between(polygon: Vec<Vec3>, axis: usize, at: f32, sign: f32) -> Vec<Vec3> {
    let side = |p: Vec3| (p[axis] - at) * sign;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        if side(p) >= 0.0 {
            kept.push(p);
        }
        if (side(p) >= 0.0) != (side(q) >= 0.0) {
            kept.push(p + (q - p) * (side(p) / (side(p) - side(q))));
        }
    }
    kept
}
