//! The surface of a union of boxes as one mesh, exactly.
//!
//! Walls of a level are often boxes that touch or overlap. One by one, each shrinks when eyes may
//! move, and gaps open between them. Their union has no such gaps. The planes of all sides cut
//! space into blocks, each wholly inside of the union or outside. Faces between the two are merged
//! to rectangles, and the corners of all rectangles become corners of those beside them, so that
//! the mesh is closed edge by edge.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use casca::Aabb;
use casca::glam::Vec3;

/// The planes of all boxes cut their room into so many blocks at most; beyond, the smallest boxes
/// are left out.
const MOST_BLOCKS: usize = 1 << 26;

/// A mesh: positions and triangles, counter-clockwise seen from outside.
pub(crate) type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// The blocks that the planes of boxes make.
struct Blocks {
    /// The coordinates of planes along each axis, ascending.
    planes: [Vec<f32>; 3],
    inside: Vec<bool>,
}

/// The surface of the union of boxes. Boxes that are empty, not finite or too many are left out.
pub(crate) fn surface(boxes: &[Aabb]) -> Triangles {
    let blocks = Blocks::of(boxes);
    let mut faces = Vec::new();
    for axis in 0..3 {
        for plane in 0..blocks.planes[axis].len() {
            blocks.rectangles(axis, plane, &mut faces);
        }
    }
    blocks.mesh(&faces)
}

/// A rectangle of a plane, in numbers of planes.
struct Rectangle {
    axis: usize,
    /// Whether the outside lies beyond the plane.
    up: bool,
    low: [usize; 3],
    high: [usize; 3],
}

impl Blocks {
    fn of(boxes: &[Aabb]) -> Self {
        let mut boxes: Vec<Aabb> = boxes
            .iter()
            .copied()
            .filter(|b| b.min.is_finite() && b.max.is_finite() && b.min.cmplt(b.max).all())
            .collect();
        let volume = |b: &Aabb| (b.max - b.min).as_dvec3().element_product();
        boxes.sort_by(|a, b| volume(b).total_cmp(&volume(a)));
        let mut planes = planes_of(&boxes);
        while planes
            .iter()
            .map(Vec::len)
            .try_fold(1usize, |n, m| n.checked_mul(m))
            .is_none_or(|n| n > MOST_BLOCKS)
        {
            boxes.truncate(boxes.len() * 3 / 4);
            planes = planes_of(&boxes);
        }
        let count = planes.iter().map(|p| p.len().saturating_sub(1)).product();
        let mut blocks = Self { planes, inside: vec![false; count] };
        for b in boxes {
            let [x, y, z] = std::array::from_fn(|i| blocks.index(i, b.min[i])..blocks.index(i, b.max[i]));
            for k in z {
                for j in y.clone() {
                    let row = blocks.number([0, j, k]);
                    blocks.inside[row + x.start..row + x.end].fill(true);
                }
            }
        }
        blocks
    }

    fn index(&self, axis: usize, at: f32) -> usize {
        self.planes[axis].partition_point(|p| *p < at)
    }

    fn dims(&self) -> [usize; 3] {
        std::array::from_fn(|i| self.planes[i].len().saturating_sub(1))
    }

    fn number(&self, at: [usize; 3]) -> usize {
        let [x, y, _] = self.dims();
        (at[2] * y + at[1]) * x + at[0]
    }

    fn is_inside(&self, at: [usize; 3]) -> bool {
        self.inside[self.number(at)]
    }

    /// The rectangles of a plane that part inside from outside.
    fn rectangles(&self, axis: usize, plane: usize, out: &mut Vec<Rectangle>) {
        let dims = self.dims();
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let at = |along: usize, i: usize, j: usize| {
            let mut at = [0; 3];
            (at[axis], at[u], at[v]) = (along, i, j);
            at
        };
        for up in [false, true] {
            let is_face = |i: usize, j: usize| {
                let below = plane > 0 && self.is_inside(at(plane - 1, i, j));
                let above = plane < dims[axis] && self.is_inside(at(plane, i, j));
                below != above && below == up
            };
            let mut done = vec![false; dims[u] * dims[v]];
            for j in 0..dims[v] {
                for i in 0..dims[u] {
                    let open = |i: usize, j: usize, done: &[bool]| !done[j * dims[u] + i] && is_face(i, j);
                    if !open(i, j, &done) {
                        continue;
                    }
                    let mut to = i + 1;
                    while to < dims[u] && open(to, j, &done) {
                        to += 1;
                    }
                    let mut upto = j + 1;
                    while upto < dims[v] && (i..to).all(|i| open(i, upto, &done)) {
                        upto += 1;
                    }
                    for j in j..upto {
                        done[j * dims[u] + i..j * dims[u] + to].fill(true);
                    }
                    out.push(Rectangle { axis, up, low: at(plane, i, j), high: at(plane, to, upto) });
                }
            }
        }
    }

    /// Triangles of rectangles.
    fn mesh(&self, faces: &[Rectangle]) -> Triangles {
        // The corners on each line along an axis.
        let mut lines: HashMap<(usize, usize, usize), BTreeSet<usize>> = HashMap::new();
        for face in faces {
            for corner in face.corners() {
                for axis in 0..3 {
                    let line = (axis, corner[(axis + 1) % 3], corner[(axis + 2) % 3]);
                    lines.entry(line).or_default().insert(corner[axis]);
                }
            }
        }
        let mut positions = Vec::new();
        let mut numbers: BTreeMap<[usize; 3], u32> = BTreeMap::new();
        let mut triangles = Vec::new();
        for face in faces {
            let mut ring = Vec::new();
            let corners = face.corners();
            for (k, from) in corners.iter().enumerate() {
                let to = corners[(k + 1) % 4];
                let axis = (0..3).find(|&i| from[i] != to[i]).unwrap_or(0);
                let line = &lines[&(axis, from[(axis + 1) % 3], from[(axis + 2) % 3])];
                let mut between: Vec<usize> =
                    line.range(from[axis].min(to[axis]) + 1..from[axis].max(to[axis])).copied().collect();
                if from[axis] > to[axis] {
                    between.reverse();
                }
                for at in std::iter::once(from[axis]).chain(between) {
                    let mut corner = *from;
                    corner[axis] = at;
                    ring.push(*numbers.entry(corner).or_insert_with(|| {
                        positions.push(Vec3::from_array(std::array::from_fn(|i| self.planes[i][corner[i]])));
                        positions.len() as u32 - 1
                    }));
                }
            }
            if ring.len() == 4 {
                triangles.extend([[ring[0], ring[1], ring[2]], [ring[0], ring[2], ring[3]]]);
                continue;
            }
            let corner = |c: &[usize; 3]| Vec3::from_array(std::array::from_fn(|i| self.planes[i][c[i]]));
            let middle = corner(&face.low).midpoint(corner(&face.high));
            positions.push(middle);
            let middle = positions.len() as u32 - 1;
            triangles.extend((0..ring.len()).map(|k| [middle, ring[k], ring[(k + 1) % ring.len()]]));
        }
        (positions, triangles)
    }
}

impl Rectangle {
    /// Its corners, counter-clockwise seen from outside.
    fn corners(&self) -> [[usize; 3]; 4] {
        let [u, v] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        let with = |high_u: bool, high_v: bool| {
            let mut at = self.low;
            if high_u {
                at[u] = self.high[u];
            }
            if high_v {
                at[v] = self.high[v];
            }
            at
        };
        let mut ring = [with(false, false), with(true, false), with(true, true), with(false, true)];
        if !self.up {
            ring.reverse();
        }
        ring
    }
}

fn planes_of(boxes: &[Aabb]) -> [Vec<f32>; 3] {
    std::array::from_fn(|i| {
        // A zero with a sign is the same plane.
        let mut planes: Vec<f32> = boxes.iter().flat_map(|b| [b.min[i] + 0.0, b.max[i] + 0.0]).collect();
        planes.sort_by(f32::total_cmp);
        planes.dedup();
        planes
    })
}

#[cfg(test)]
mod tests {
    use casca_scenes::random::generator;
    use rand::RngExt;

    use super::*;

    /// Six times the volume inside of a mesh, and whether as many triangles run along each edge in
    /// one direction as in the other.
    fn measure((positions, triangles): &Triangles) -> (f64, bool) {
        let mut volume = 0.0;
        let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        for t in triangles {
            let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
            volume += a.dot(b.cross(c));
            for i in 0..3 {
                let (from, to) = (t[i], t[(i + 1) % 3]);
                *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
        (volume, edges.values().all(|balance| *balance == 0))
    }

    #[test]
    fn the_surface_is_closed_and_holds_what_the_boxes_hold() {
        for seed in 0..200 {
            let mut random = generator(seed, 0x0b0c);
            // Numbers without fractions, so that volumes are exact, and boxes touch in all ways.
            let count = random.random_range(1..7);
            let mut corner = || Vec3::from_array(std::array::from_fn(|_| random.random_range(0..6u8).into()));
            let boxes: Vec<Aabb> = (0..count)
                .map(|_| {
                    let (a, b) = (corner(), corner());
                    Aabb::new(a.min(b), a.max(b) + 1.0)
                })
                .collect();
            let mut held = 0;
            for i in 0..512 {
                let middle = Vec3::new((i % 8) as f32, (i / 8 % 8) as f32, (i / 64) as f32) + 0.5;
                let holds = |b: &Aabb| b.min.cmplt(middle).all() && middle.cmplt(b.max).all();
                held += usize::from(boxes.iter().any(holds));
            }
            let (volume, closed) = measure(&surface(&boxes));
            assert!(closed && volume == 6.0 * held as f64, "{seed}: {volume} {held} {boxes:?}");
        }
    }

    #[test]
    fn boxes_that_are_none_are_left_out() {
        let odd = |x: f32| Aabb::new(Vec3::ZERO, Vec3::new(x, 1.0, 1.0));
        let (_, triangles) = surface(&[odd(0.0), odd(-1.0), odd(f32::NAN), odd(f32::INFINITY)]);
        assert!(triangles.is_empty());
    }
}
