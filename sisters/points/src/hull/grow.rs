//! The hull grows by one point at a time, the farthest above some face.

use super::mesh::{Face, NONE};
use crate::numeric::above;
use bitvec::vec::BitVec;
use glam::DVec3;
use std::collections::VecDeque;

/// The extreme points of points of which four, the fourth below the first three, are not in a
/// plane.
pub(super) fn extreme(points: &[DVec3], simplex: [u32; 4]) -> BitVec {
    let mut hull = Hull::new(points, simplex);
    hull.grow();
    hull.extreme()
}

/// With this many new faces a binary search is faster than looking at each. Without it, points on
/// two circles take quadratic time.
const LARGE_FAN: usize = 32;

/// This part of the points is added all around before the hull is finished place by place, which is
/// faster as a place is in the processor's caches. Without it, one place can be finished while its
/// neighbours have huge faces, and each point of these meets most faces of the place: quadratic
/// time for points on two curves.
const BREADTH_FIRST_PART: usize = 32;

/// An edge of the border between the faces below a new point and the others.
#[derive(Clone, Copy)]
struct Border {
    from: u32,
    to: u32,
    /// The face that stays, and its edge.
    beyond: u32,
    edge: u8,
}

struct Hull<'a> {
    points: &'a [DVec3],
    faces: Vec<Face>,
    /// Removed faces, to be used again.
    free: Vec<u32>,
    /// Faces that may have points above them.
    pending: VecDeque<u32>,
    /// The next point of the list in which a point is.
    next: Vec<u32>,
    /// The new face whose border edge begins at a point; only read for corners of the current
    /// border.
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
        let mut hull = Self {
            points,
            faces: Vec::with_capacity(64),
            free: Vec::new(),
            pending: VecDeque::with_capacity(64),
            next: vec![NONE; count],
            begins: vec![NONE; count],
            twins: Vec::new(),
            step: 0,
            below: Vec::new(),
            border: Vec::new(),
            fresh: vec![0, 1, 2, 3],
        };
        for corners in [[a, b, c], [b, a, d], [c, b, d], [a, c, d]] {
            hull.faces.push(Face::new(points, corners));
        }
        for (face, neighbours) in [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]].into_iter().enumerate() {
            hull.faces[face].neighbours = neighbours;
        }
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
        while let Some(face) = self.next_pending() {
            let Face { mark, far, .. } = self.faces[face as usize];
            if mark != NONE && far != NONE {
                self.add(face, far);
            }
        }
    }

    /// A face that may have points above it.
    fn next_pending(&mut self) -> Option<u32> {
        if self.step < 2 * (self.points.len() / BREADTH_FIRST_PART) as u32 {
            self.pending.pop_front()
        } else {
            self.pending.pop_back()
        }
    }

    /// Puts a point into the list of a fresh face that it is above; if there is none, it is within
    /// the hull.
    fn put(&mut self, p: u32) {
        let point = self.points[p as usize];
        let Some((id, height)) = self.face_below(point) else { return };
        let face = &mut self.faces[id as usize];
        self.next[p as usize] = face.first;
        face.first = p;
        if face.far == NONE || height > face.far_height {
            (face.far, face.far_height) = (p, height);
        }
    }

    /// A fresh face that a point is above, and its height.
    fn face_below(&self, point: DVec3) -> Option<(u32, f64)> {
        let count = self.fresh.len();
        if count >= LARGE_FAN {
            let starts = [0, count / 3, 2 * count / 3];
            if let Some(found) = starts.into_iter().find_map(|start| self.search_fan(start, point)) {
                return found;
            }
        }
        self.scan_fan(point)
    }

    /// The same by looking at each face.
    fn scan_fan(&self, point: DVec3) -> Option<(u32, f64)> {
        let height = |id: u32| self.faces[id as usize].height(self.points, point);
        self.fresh.iter().map(|&id| (id, height(id))).find(|&(_, height)| height > 0.0)
    }

    /// The same by a binary search in a fan of fresh faces around a new point, the tip; `None` if
    /// the point is in the planes of both faces at the first corner, where `start` begins.
    ///
    /// A point that is above neither of these two faces is in the wedge between them. Planes
    /// through the tip, the first corner and each other corner cut the wedge into a sector for each
    /// face, and a point above no face of its sector is above none.
    fn search_fan(&self, start: usize, point: DVec3) -> Option<Option<(u32, f64)>> {
        let count = self.fresh.len();
        let id = |i: usize| self.fresh[(start + i) % count];
        let corner =
            |i: usize, corner: usize| self.points[self.faces[id(i) as usize].corners[corner] as usize];
        let above_face = |i: usize| {
            let height = self.faces[id(i) as usize].height(self.points, point);
            (height, Some((id(i), height)).filter(|_| height > 0.0))
        };
        let ((first, found), (last, found_last)) = (above_face(0), above_face(count - 1));
        if found.or(found_last).is_some() {
            return Some(found.or(found_last));
        }
        if first == 0.0 && last == 0.0 {
            return None;
        }
        let (mut low, mut high) = (1, count - 1);
        while high - low > 1 {
            let middle = low.midpoint(high);
            if above(corner(0, 0), corner(middle, 0), corner(0, 2), point) <= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(above_face(low).1)
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
                if q != p {
                    if self.points[q as usize] == self.points[p as usize] {
                        self.twins.push((q, p));
                    } else {
                        self.put(q);
                    }
                }
                q = next;
            }
        }
        self.free.append(&mut self.below);
        let faces = &self.faces;
        self.pending.extend(self.fresh.iter().filter(|&&id| faces[id as usize].first != NONE));
    }

    /// Finds all faces below a point, beginning with one, and the edges between them and the
    /// others.
    ///
    /// The faces below are one disc with one border, whether or not they include those whose plane
    /// holds the point. They do not, so that a point in the plane of a large facet does not cut it
    /// anew.
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
                    let edge_back = other.edge_to(id) as u8;
                    let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
                    self.border.push(Border { from, to, beyond, edge: edge_back });
                }
            }
        }
    }

    /// Joins a point to all edges of the border. Many new faces are put in the order in which they
    /// go around the point.
    fn close(&mut self, p: u32) {
        self.fresh.clear();
        for &Border { from, to, beyond, edge } in &self.border {
            let mut face = Face::new(self.points, [from, to, p]);
            face.neighbours[0] = beyond;
            let id = self.free.pop().unwrap_or(self.faces.len() as u32);
            if id as usize == self.faces.len() {
                self.faces.push(face);
            } else {
                self.faces[id as usize] = face;
            }
            self.faces[beyond as usize].neighbours[usize::from(edge)] = id;
            self.begins[from as usize] = id;
            self.fresh.push(id);
        }
        for (&id, border) in self.fresh.iter().zip(&self.border) {
            let after = self.begins[border.to as usize];
            self.faces[id as usize].neighbours[1] = after;
            self.faces[after as usize].neighbours[2] = id;
        }
        if self.fresh.len() >= LARGE_FAN {
            let mut id = self.fresh[0];
            for at in &mut self.fresh {
                *at = id;
                id = self.faces[id as usize].neighbours[1];
            }
        }
    }

    /// The corners at which at least three faces of different planes meet.
    ///
    /// Others lie in a facet or on an edge: they were corners until a point was added to their
    /// plane.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::start::{Start, find};
    use crate::hull::tests::circle;

    #[test]
    fn a_search_in_a_fan_finds_what_a_scan_finds() {
        let ring = circle().into_iter().map(|[x, y]| DVec3::new(x as f64, y as f64, 0.0));
        let mut points: Vec<DVec3> = ring.chain([DVec3::Z * -1e4]).collect();
        points.push(points[0]);
        let mut moved = points.clone();
        let tip = points.len() - 1;
        moved[tip] = DVec3::new(3e3, 4e3, 2e4);
        let Start::Solid(simplex) = find(&points) else { panic!() };
        // The tip is at the place of another point until the rest is complete.
        let mut hull = Hull::new(&points, simplex);
        hull.grow();
        hull.points = &moved;
        let below =
            hull.faces.iter().position(|face| face.mark != NONE && face.height(&moved, moved[tip]) > 0.0);
        hull.add(below.unwrap() as u32, tip as u32);
        assert!(hull.fresh.len() > 300, "{}", hull.fresh.len());
        // Beyond the tip as seen from the ring, on lines through the tip and on planes through many
        // corners, or anywhere.
        let beyond = (0..tip).flat_map(|i| [2.0, 3.0].map(|t| moved[i].lerp(moved[tip], t)));
        let between = (0..tip).map(|i| moved[i].midpoint(moved[(7 * i + 90) % tip]).lerp(moved[tip], 0.5));
        // On both sides of each face, of which those at the first corner decide.
        let faces = hull.fresh.iter().map(|&id| hull.faces[id as usize].corners.map(|i| moved[i as usize]));
        let near = faces.flat_map(|[a, b, c]| [-1.0, 1.0].map(|z| (a + b + c) / 3.0 + DVec3::Z * z));
        let grid = (0..1000)
            .map(|i| (DVec3::new((i % 10) as f64, (i / 10 % 10) as f64, (i / 100) as f64) - 4.5) * 1e4);
        let mut counts = [0; 2];
        for point in beyond.chain(between).chain(near).chain(grid) {
            let scanned = hull.scan_fan(point).is_some();
            counts[usize::from(scanned)] += 1;
            assert_eq!(hull.face_below(point).is_some_and(|(_, height)| height > 0.0), scanned, "{point}");
        }
        assert!(counts.iter().all(|&count| count > 300), "{counts:?}");
    }
}
