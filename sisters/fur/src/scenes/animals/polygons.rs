//! Closed meshes around solids: marching tetrahedra.

use std::collections::HashMap;

use glam::{IVec3, Vec3};

/// A field value nearer to 0 than this share of a grid cell moves away from 0, so that no vertex of
/// a generated mesh falls on a corner of the grid, where several would coincide.
const OFF_CORNER: f32 = 1e-2;

/// Each cell of the grid is six tetrahedra around its diagonal, one for each order of the axes.
/// Neighbours share the diagonals of their faces, so that the surface is closed and two-manifold
/// wherever it does not meet the border of the grid.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// The corners of tetrahedra with odd orders of axes are numbered the other way around.
const EVEN: usize = 3;

/// The surface on which `field` is 0, with negative values inside, on a grid of cubes between two
/// corners: positions, and triangles counter-clockwise seen from outside. Values on the border of
/// the grid count as outside.
pub(super) fn surface(
    field: impl Fn(Vec3) -> f32,
    lo: Vec3,
    cell: f32,
    dims: IVec3,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let points = dims + 1;
    let number = |p: IVec3| ((p.z * points.y + p.y) * points.x + p.x) as usize;
    let place = |n: usize| {
        let n = n as i32;
        let p = IVec3::new(n % points.x, n / points.x % points.y, n / points.x / points.y);
        lo + p.as_vec3() * cell
    };
    let least = OFF_CORNER * cell;
    let mut values = vec![least; (points.x * points.y * points.z) as usize];
    for z in 1..dims.z {
        for y in 1..dims.y {
            for x in 1..dims.x {
                let n = number(IVec3::new(x, y, z));
                let value = field(place(n));
                values[n] = if value.abs() >= least { value } else { least.copysign(value) };
            }
        }
    }
    let mut mesh = Builder {
        values: &values,
        place: &place,
        numbers: HashMap::new(),
        positions: Vec::new(),
        triangles: Vec::new(),
    };
    for z in 0..dims.z {
        for y in 0..dims.y {
            for x in 0..dims.x {
                let at = IVec3::new(x, y, z);
                for (i, order) in ORDERS.iter().enumerate() {
                    let mut p = at;
                    let mut corners = [number(at); 4];
                    for (corner, &axis) in corners[1..].iter_mut().zip(order) {
                        p[axis] += 1;
                        *corner = number(p);
                    }
                    if i >= EVEN {
                        corners.swap(1, 2);
                    }
                    mesh.tetrahedron(corners);
                }
            }
        }
    }
    (mesh.positions, mesh.triangles)
}

struct Builder<'a> {
    values: &'a [f32],
    place: &'a dyn Fn(usize) -> Vec3,
    numbers: HashMap<(usize, usize), u32>,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Builder<'_> {
    /// The vertex on an edge between inside and outside.
    fn vertex(&mut self, a: usize, b: usize) -> u32 {
        let (a, b) = (a.min(b), a.max(b));
        *self.numbers.entry((a, b)).or_insert_with(|| {
            let t = self.values[a] / (self.values[a] - self.values[b]);
            self.positions.push((self.place)(a).lerp((self.place)(b), t));
            self.positions.len() as u32 - 1
        })
    }

    /// The triangles of a tetrahedron whose corners 1, 2 and 3 run counter-clockwise seen from
    /// outside.
    fn tetrahedron(&mut self, c: [usize; 4]) {
        let inside = |i: usize| self.values[c[i]] < 0.0;
        let count = (0..4).filter(|&i| inside(i)).count();
        if !(1..=3).contains(&count) {
            return;
        }
        // Bring the corners inside to the front by an even permutation, so that the orientation
        // stays.
        let mut order: Vec<usize> = (0..4).filter(|&i| inside(i)).collect();
        order.extend((0..4).filter(|&i| !inside(i)));
        let inversions =
            (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|&(j, i)| order[j] > order[i]).count();
        if inversions % 2 == 1 {
            // Of any three on one side two may change places.
            if count >= 2 { order.swap(0, 1) } else { order.swap(2, 3) }
        }
        let [a, b, d, e] = [order[0], order[1], order[2], order[3]].map(|i| c[i]);
        match count {
            1 => {
                let t = [self.vertex(a, b), self.vertex(a, d), self.vertex(a, e)];
                self.triangles.push(t);
            }
            2 => {
                let q = [self.vertex(a, d), self.vertex(a, e), self.vertex(b, e), self.vertex(b, d)];
                self.triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
            }
            _ => {
                let t = [self.vertex(e, a), self.vertex(e, b), self.vertex(e, d)];
                self.triangles.push(t);
            }
        }
    }
}
