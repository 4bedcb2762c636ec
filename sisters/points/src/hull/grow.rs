//! The hull grows by one point at a time, the farthest above some face.

use crate::numeric::{PLANE_ERROR, above};
use bitvec::vec::BitVec;
use glam::DVec3;
use std::collections::VecDeque;

/// No point, or no face.
const NONE: u32 = u32::MAX;

/// A triangle of the hull, counterclockwise as seen from outside.
#[derive(Debug, Clone)]
struct Face {
    normal: DVec3,
    offset: f64,
    error: f64,
    /// The height of `far` above the plane.
    far_height: f64,
    /// Its corners.
    corners: [u32; 3],
    /// The faces across the edges from corner `i` to the next one.
    neighbours: [u32; 3],
    /// The first of a list of points above this face; [`NONE`] if there is none.
    first: u32,
    /// The point of the list that is farthest from the plane.
    far: u32,
    /// The last step at which a point was found to be above (even) or not above (odd) this face;
    /// [`NONE`] for a removed face.
    mark: u32,
}

impl Face {
    fn new(points: &[DVec3], corners: [u32; 3], neighbours: [u32; 3]) -> Self {
        let [a, b, c] = corners.map(|i| points[i as usize]);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let error = PLANE_ERROR * ab.abs().max_element() * ac.abs().max_element();
        let offset = normal.dot(a);
        let (first, far, far_height, mark) = (NONE, NONE, 0.0, 0);
        Self { normal, offset, error, far_height, corners, neighbours, first, far, mark }
    }

    /// Positive if a point is strictly above the plane, zero on it, negative below; the sign is exact.
    #[inline]
    fn height(&self, points: &[DVec3], p: DVec3) -> f64 {
        let height = self.normal.dot(p) - self.offset;
        if height.abs() > self.error {
            return height;
        }
        let [a, b, c] = self.corners.map(|i| points[i as usize]);
        above(a, b, c, p)
    }
}

/// The extreme points of points of which four, the fourth below the first three, are not in a plane.
pub(super) fn extreme(points: &[DVec3], simplex: [u32; 4]) -> BitVec {
    let mut hull = Hull::new(points, simplex);
    hull.grow();
    hull.extreme()
}

/// This part of the points is added all around before the hull is finished place by place, which is faster as
/// a place is in the processor's caches. Without it, one place can be finished while its neighbours have huge
/// faces, and each point of these meets most faces of the place: quadratic time for points on two curves.
const BREADTH_FIRST_PART: usize = 32;

/// An edge of the border between the faces below a new point and the others.
#[derive(Clone, Copy)]
struct Border {
    from: u32,
    to: u32,
    /// The face that stays, and its edge.
    beyond: u32,
    edge: usize,
}

#[derive(Default)]
struct Hull<'a> {
    points: &'a [DVec3],
    faces: Vec<Face>,
    /// Removed faces, to be used again.
    free: Vec<u32>,
    /// Faces that may have points above them.
    pending: VecDeque<u32>,
    /// The next point of the list in which a point is.
    next: Vec<u32>,
    /// The new face whose border edge begins at a point; only read for corners of the current border.
    begins: Vec<u32>,
    /// Points at the place of a corner, and that corner.
    twins: Vec<(u32, u32)>,
    /// The number of points added so far, doubled.
    step: u32,
    // Kept for their memory.
    below: Vec<u32>,
    border: Vec<Border>,
    fresh: Vec<u32>,
}

impl<'a> Hull<'a> {
    fn new(points: &'a [DVec3], [a, b, c, d]: [u32; 4]) -> Self {
        let count = points.len();
        let (next, begins) = (vec![NONE; count], vec![NONE; count]);
        let mut hull = Self { points, next, begins, fresh: vec![0, 1, 2, 3], ..Self::default() };
        let corners = [[a, b, c], [b, a, d], [c, b, d], [a, c, d]];
        let neighbours = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        let faces = corners.into_iter().zip(neighbours);
        hull.faces.extend(faces.map(|(corners, neighbours)| Face::new(points, corners, neighbours)));
        let simplex = [a, b, c, d];
        for p in 0..count as u32 {
            if !simplex.contains(&p) {
                match simplex.into_iter().find(|&q| points[q as usize] == points[p as usize]) {
                    Some(twin) => hull.twins.push((p, twin)),
                    None => hull.put(p),
                }
            }
        }
        hull.pending.extend([0, 1, 2, 3]);
        hull
    }

    fn grow(&mut self) {
        let breadth_first = 2 * (self.points.len() / BREADTH_FIRST_PART) as u32;
        loop {
            let is_early = self.step < breadth_first;
            let next = if is_early { self.pending.pop_front() } else { self.pending.pop_back() };
            let Some(face) = next else { return };
            let Face { mark, far, .. } = self.faces[face as usize];
            if mark != NONE && far != NONE {
                self.add(face, far);
            }
        }
    }

    /// Puts a point into the list of a fresh face that it is above; if there is none, it is within the hull.
    fn put(&mut self, p: u32) {
        let point = self.points[p as usize];
        let height = |id: u32| self.faces[id as usize].height(self.points, point);
        let mut heights = self.fresh.iter().map(|&id| (id, height(id)));
        let Some((id, height)) = heights.find(|&(_, height)| height > 0.0) else { return };
        let face = &mut self.faces[id as usize];
        self.next[p as usize] = face.first;
        face.first = p;
        if face.far == NONE || height > face.far_height {
            (face.far, face.far_height) = (p, height);
        }
    }

    /// Adds a point that is above a face.
    fn add(&mut self, face: u32, p: u32) {
        self.step += 2;
        self.find_border(face, p);
        self.close(p);
        for at in 0..self.below.len() {
            let old = self.below[at];
            let mut q = self.faces[old as usize].first;
            self.faces[old as usize].mark = NONE;
            while q != NONE {
                let next = self.next[q as usize];
                if q != p && self.points[q as usize] == self.points[p as usize] {
                    self.twins.push((q, p));
                } else if q != p {
                    self.put(q);
                }
                q = next;
            }
        }
        self.free.append(&mut self.below);
        let faces = &self.faces;
        self.pending.extend(self.fresh.iter().filter(|&&id| faces[id as usize].first != NONE));
    }

    /// Finds all faces below a point, beginning with one, and the edges between them and the others.
    ///
    /// The faces below are one disc with one border, whether or not they include those whose plane holds the
    /// point. They do not, so that a point in the plane of a large facet does not cut it anew.
    fn find_border(&mut self, face: u32, p: u32) {
        let (points, point) = (self.points, self.points[p as usize]);
        self.border.clear();
        self.faces[face as usize].mark = self.step;
        self.below.push(face);
        let mut at = 0;
        while let Some(&id) = self.below.get(at) {
            at += 1;
            let Face { corners, neighbours, .. } = self.faces[id as usize];
            for edge in 0..3 {
                let beyond = neighbours[edge];
                let other = &mut self.faces[beyond as usize];
                if other.mark != self.step && other.mark != self.step + 1 {
                    let below = other.height(points, point) > 0.0;
                    other.mark = self.step + u32::from(!below);
                    if below {
                        self.below.push(beyond);
                    }
                }
                if other.mark == self.step + 1 {
                    let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
                    let edge = other.neighbours.iter().position(|&n| n == id).unwrap_or(0);
                    self.border.push(Border { from, to, beyond, edge });
                }
            }
        }
    }

    /// Joins a point to all edges of the border.
    fn close(&mut self, p: u32) {
        self.fresh.clear();
        for &Border { from, to, beyond, edge } in &self.border {
            let face = Face::new(self.points, [from, to, p], [beyond, NONE, NONE]);
            let id = self.free.pop().unwrap_or(self.faces.len() as u32);
            if id as usize == self.faces.len() {
                self.faces.push(face);
            } else {
                self.faces[id as usize] = face;
            }
            self.faces[beyond as usize].neighbours[edge] = id;
            self.begins[from as usize] = id;
            self.fresh.push(id);
        }
        for (&id, border) in self.fresh.iter().zip(&self.border) {
            let after = self.begins[border.to as usize];
            self.faces[id as usize].neighbours[1] = after;
            self.faces[after as usize].neighbours[2] = id;
        }
    }

    /// The corners at which at least three faces of different planes meet.
    ///
    /// Others lie in a facet or on an edge: they were corners until a point was added to their plane.
    fn extreme(&self) -> BitVec {
        let mut edges = vec![0_u8; self.points.len()];
        for face in self.faces.iter().filter(|face| face.mark != NONE) {
            for (edge, &beyond) in face.neighbours.iter().enumerate() {
                let other = &self.faces[beyond as usize];
                let from = face.corners[edge] as usize;
                let to = face.corners[(edge + 1) % 3];
                let third = other.corners.into_iter().find(|&c| c as usize != from && c != to);
                let point = self.points[third.unwrap_or(to) as usize];
                if edges[from] < 3 && face.height(self.points, point) != 0.0 {
                    edges[from] += 1;
                }
            }
        }
        let mut extreme: BitVec = edges.iter().map(|&count| count == 3).collect();
        for &(p, twin) in &self.twins {
            let bit = extreme[twin as usize];
            extreme.set(p as usize, bit);
        }
        extreme
    }
}
